import type L from 'leaflet';
import { isGliding, shownAt, type Phone, type Phones } from '../live/phones';
import type { Integrity } from '../wire/shapes';
import { CanvasLayer, type Pen } from './canvas_layer';
import { calibratedEllipse } from './ellipse';
import { inks, type Inks } from './inks';

export interface PhoneView { floor: number | null; chosen: string | null; inner: boolean; outer: boolean; tracks: boolean }

const kStates: Integrity[] = ['ok', 'degraded', 'suspect'];
const kInkOf = { ok: 'phone', degraded: 'warn', suspect: 'bad' } as const;
const kGroundEveryMs = 250;
const kOuterAtMost = 60;      // with more phones on a floor their 95 % regions would cover it all: then only the chosen one's is drawn

/// Draws every phone of a floor on two canvases. The ground (regions and tracks) is painted four times a second: all phones of one state
/// share one path a shape, so that it costs a fixed number of fills and strokes whether 5 phones or 500 are there, and overlapping regions do
/// not pile up into a dark blot. The dots glide: they are copied from pictures painted once.
export class PhoneLayer {
  view: PhoneView = { floor: null, chosen: null, inner: true, outer: true, tracks: true };
  private readonly dots: CanvasLayer;
  private readonly ground: CanvasLayer;
  private readonly deaf: () => void;
  private groundAt = 0;
  private groundTimer = 0;

  constructor(private readonly map: L.Map, private readonly phones: Phones) {
    this.ground = new CanvasLayer((pen) => this.paintGround(pen), 'tracks', 'ground');
    this.dots = new CanvasLayer((pen) => this.paintPhones(pen), 'phones', 'phones');
    this.ground.addTo(map);
    this.dots.addTo(map);
    this.deaf = phones.listen(() => this.refresh());
  }

  remove(): void {
    this.deaf();
    clearTimeout(this.groundTimer);
    this.ground.removeFrom(this.map);
    this.dots.removeFrom(this.map);
  }

  show(view: Partial<PhoneView>): void {
    Object.assign(this.view, view);
    this.groundAt = 0;
    this.refresh();
  }

  refresh(): void {
    this.dots.redraw();
    if (this.groundTimer) return;
    const wait = this.groundAt + kGroundEveryMs - performance.now();
    this.groundTimer = window.setTimeout(() => {
      this.groundTimer = 0;
      this.groundAt = performance.now();
      this.ground.redraw();
    }, Math.max(wait, 0));
  }

  private onFloor(): Phone[] {
    return this.phones.present().filter((phone) => phone.position.place.floor === this.view.floor);
  }

  private paintGround(pen: Pen): void {
    const now = performance.now();
    const phones = this.onFloor();
    const ink = inks();
    for (const state of kStates) {
      const alike = phones.filter((phone) => phone.position.integrity === state);
      if (!alike.length) continue;
      const colour = ink[kInkOf[state]];
      const others = alike.filter((phone) => phone.name !== this.view.chosen);   // the chosen one's regions glide with it
      if (this.view.outer && phones.length <= kOuterAtMost) fillEllipses(pen, others, now, 'radius95_m', colour, 0.07);
      if (this.view.inner) fillEllipses(pen, others, now, 'radius68_m', colour, 0.18);
      if (this.view.tracks) strokeTracks(pen, alike, this.view.floor, colour, 1.5, 0.35);
    }
    const chosen = this.view.chosen ? this.phones.byName.get(this.view.chosen) : undefined;
    if (chosen) strokeTracks(pen, [chosen], this.view.floor, ink[kInkOf[chosen.position.integrity]], 3, 0.85);
  }

  private paintPhones(pen: Pen): void {
    const now = performance.now();
    const ink = inks();
    const phones = this.onFloor();
    for (const state of kStates) {
      const alike = phones.filter((phone) => phone.position.integrity === state);
      if (!alike.length) continue;
      drawHeadings(pen, alike, now, ink[kInkOf[state]]);
      drawDots(pen, alike, now, ink[kInkOf[state]], ink.halo);
    }
    const chosen = phones.find((phone) => phone.name === this.view.chosen);
    if (chosen) drawChosen(pen, chosen, now, ink);
    if (phones.some((phone) => isGliding(phone, now))) this.dots.redraw();
  }
}

function strokeTracks({ ctx, x, y }: Pen, phones: Phone[], floor: number | null, ink: string, width: number, alpha: number): void {
  ctx.beginPath();
  for (const phone of phones) traceTrack(ctx, phone, floor, x, y);
  Object.assign(ctx, { strokeStyle: ink, lineWidth: width, lineJoin: 'round', globalAlpha: alpha });
  ctx.stroke();
  ctx.globalAlpha = 1;
}

function traceTrack(ctx: CanvasRenderingContext2D, phone: Phone, floor: number | null, x: Pen['x'], y: Pen['y']): void {
  let down = false;
  for (const point of phone.track) {
    if (point.floor !== floor) { down = false; continue; }
    if (down) ctx.lineTo(x(point.x), y(point.y));
    else ctx.moveTo(x(point.x), y(point.y));
    down = true;
  }
}

function traceEllipse({ ctx, x, y, scale }: Pen, phone: Phone, now: number, radius: 'radius68_m' | 'radius95_m'): void {
  const place = shownAt(phone, now);
  const { major, minor, angle } = calibratedEllipse(phone.position.covariance, phone.position[radius]);
  const [cx, cy] = [x(place.x_m), y(place.y_m)];
  ctx.moveTo(cx + major * scale * Math.cos(angle), cy - major * scale * Math.sin(angle));
  ctx.ellipse(cx, cy, major * scale, minor * scale, -angle, 0, 2 * Math.PI);
}

function fillEllipses(pen: Pen, phones: Phone[], now: number, radius: 'radius68_m' | 'radius95_m', ink: string, alpha: number): void {
  pen.ctx.beginPath();
  for (const phone of phones) traceEllipse(pen, phone, now, radius);
  Object.assign(pen.ctx, { fillStyle: ink, globalAlpha: alpha });
  pen.ctx.fill('nonzero');
  pen.ctx.globalAlpha = 1;
}

function drawHeadings({ ctx, x, y }: Pen, phones: Phone[], now: number, ink: string): void {
  ctx.beginPath();
  for (const phone of phones) {
    if (phone.position.speed_mps < 0.1) continue;
    const place = shownAt(phone, now);
    const angle = ((90 - phone.position.azimuth_deg) * Math.PI) / 180;
    const [cx, cy] = [x(place.x_m), y(place.y_m)];
    const [ux, uy] = [Math.cos(angle), -Math.sin(angle)];
    ctx.moveTo(cx + 14 * ux, cy + 14 * uy);
    ctx.lineTo(cx + 6 * ux - 5 * uy, cy + 6 * uy + 5 * ux);
    ctx.lineTo(cx + 6 * ux + 5 * uy, cy + 6 * uy - 5 * ux);
    ctx.closePath();
  }
  Object.assign(ctx, { fillStyle: ink, globalAlpha: 1 });
  ctx.fill();
}

const kDotPixels = 16;
const dots = new Map<string, ImageBitmap>();

// The picture of a phone of this colour, at twice its size for sharp screens.
function dotOf(ink: string, halo: string): ImageBitmap {
  const name = `${ink} ${halo}`;
  const known = dots.get(name);
  if (known) return known;
  const canvas = new OffscreenCanvas(2 * kDotPixels, 2 * kDotPixels);
  const ctx = canvas.getContext('2d')!;
  ctx.arc(kDotPixels, kDotPixels, 11, 0, 2 * Math.PI);
  Object.assign(ctx, { fillStyle: ink, strokeStyle: halo, lineWidth: 4 });
  ctx.stroke();
  ctx.fill();
  const picture = canvas.transferToImageBitmap();
  dots.set(name, picture);
  return picture;
}

function drawDots({ ctx, x, y }: Pen, phones: Phone[], now: number, ink: string, halo: string): void {
  const picture = dotOf(ink, halo);
  for (const phone of phones) {
    const place = shownAt(phone, now);
    ctx.drawImage(picture, x(place.x_m) - kDotPixels / 2, y(place.y_m) - kDotPixels / 2, kDotPixels, kDotPixels);
  }
}

function drawChosen(pen: Pen, phone: Phone, now: number, ink: Inks): void {
  const { ctx, x, y } = pen;
  const colour = ink[kInkOf[phone.position.integrity]];
  for (const radius of ['radius68_m', 'radius95_m'] as const) {
    ctx.beginPath();
    traceEllipse(pen, phone, now, radius);
    Object.assign(ctx, { fillStyle: colour, strokeStyle: colour, lineWidth: radius === 'radius68_m' ? 2 : 1.25, globalAlpha: 0.12 });
    ctx.fill();
    ctx.globalAlpha = 1;
    ctx.setLineDash(radius === 'radius68_m' ? [] : [5, 4]);
    ctx.stroke();
  }
  ctx.setLineDash([]);
  const place = shownAt(phone, now);
  ctx.beginPath();
  ctx.arc(x(place.x_m), y(place.y_m), 8, 0, 2 * Math.PI);
  Object.assign(ctx, { fillStyle: colour, strokeStyle: ink.halo, lineWidth: 3 });
  ctx.stroke();
  ctx.fill();
}
