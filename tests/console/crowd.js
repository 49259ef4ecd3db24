// Stands in for the observer's WebSocket: kCrowd phones walk about the demo office and are observed five times a second, 64 to a message,
// as the server sends them (proto/README.md, observation).
window.WebSocket = class {
  constructor() {
    this.phones = Array.from({ length: kCrowd }, (_, i) => ({ name: `crowd-${String(i).padStart(4, '0')}`, x: (i * 7.3) % 60, y: (i * 3.1) % 32, azimuth: (i * 37) % 360 }));
    setTimeout(() => this.onopen(), 0);
  }
  close() { clearInterval(this.timer); }
  send(text) {
    const { type } = JSON.parse(text);
    if (type === 'hello') this.tell({ type: 'welcome', radio_map_version: 1 });
    if (type === 'subscribe') this.timer = setInterval(() => this.walk(), 200);
  }
  tell(message) { this.onmessage({ data: JSON.stringify(message) }); }
  walk() {
    const tracked = this.phones.map((phone, i) => {
      phone.azimuth = (phone.azimuth + (i % 7) - 3 + 360) % 360;
      phone.x = Math.min(Math.max(phone.x + 0.25 * Math.sin(phone.azimuth * Math.PI / 180), 0), 60);
      phone.y = Math.min(Math.max(phone.y + 0.25 * Math.cos(phone.azimuth * Math.PI / 180), 0), 32);
      return { tracked: phone.name, received_at_us: Date.now() * 1000, position: {
        valid_at_us: 0, building: 1, place: { x_m: phone.x, y_m: phone.y, floor: 0 }, floors: [{ floor: 0, probability: 1 }],
        covariance: { xx_m2: 2 + i % 3, xy_m2: 0.4, yy_m2: 1.5 }, radius68_m: 2.4, radius95_m: 4.6, azimuth_deg: phone.azimuth, azimuth_sigma_deg: 10,
        speed_mps: 1.25, radio_map_version: 1, integrity: ['ok', 'ok', 'ok', 'degraded', 'suspect'][i % 5],
        from: { transmitters_used: 9, transmitters_unknown: 1, scan_age_us: 900000, steps_since_scan: 2 } } };
    });
    for (let at = 0; at < tracked.length; at += 64) this.tell({ type: 'observation', tracked: tracked.slice(at, at + 64) });
  }
};
