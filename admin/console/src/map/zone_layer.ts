import L from 'leaflet';
import type { Ring } from '../wire/shapes';
import type { Zone } from '../wire/zone_shapes';
import { toLatLng, toLatLngs } from './floor_map';

function middleOf(ring: Ring): [number, number] {
  const xs = ring.map((point) => point[0]);
  const ys = ring.map((point) => point[1]);
  return [(Math.min(...xs) + Math.max(...xs)) / 2, (Math.min(...ys) + Math.max(...ys)) / 2];
}

/// A floor's zones with their names.
export function zoneLayer(zones: Zone[], chosen: number | null, quiet = false): L.LayerGroup {
  const group = L.layerGroup();
  for (const zone of zones) {
    const className = `zone ${zone.id === chosen ? 'chosen' : ''} ${quiet ? 'quiet' : ''}`;
    group.addLayer(L.polygon(toLatLngs(zone.region), { pane: 'zones', className, interactive: false }));
    const outer = zone.region[0];
    if (!outer) continue;
    const name = document.createElement('span');
    name.textContent = zone.name;
    const icon = L.divIcon({ className: 'zone-name', html: name, iconSize: [0, 0] });
    group.addLayer(L.marker(toLatLng(middleOf(outer)), { pane: 'zones', icon, interactive: false, keyboard: false }));
  }
  return group;
}

/// The zone at a point: the smallest, where zones lie inside each other.
export function zoneAt(zones: Zone[], x: number, y: number): Zone | null {
  const inside = zones.filter((zone) => zone.region.filter((ring) => isInside(ring, x, y)).length % 2 === 1);
  return inside.sort((a, b) => areaOf(a.region[0]!) - areaOf(b.region[0]!))[0] ?? null;
}

function isInside(ring: Ring, x: number, y: number): boolean {
  let inside = false;
  for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
    const [[xi, yi], [xj, yj]] = [ring[i]!, ring[j]!];
    if (yi > y !== yj > y && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) inside = !inside;
  }
  return inside;
}

export function areaOf(ring: Ring): number {
  let twice = 0;
  ring.forEach(([x, y], i) => {
    const [nx, ny] = ring[(i + 1) % ring.length]!;
    twice += x * ny - nx * y;
  });
  return Math.abs(twice) / 2;
}
