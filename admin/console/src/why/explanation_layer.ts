import type L from 'leaflet';
import { CanvasLayer, type Pen } from '../map/canvas_layer';
import { calibratedEllipse } from '../map/ellipse';
import { inks, type Inks } from '../map/inks';
import type { ExplainedPosition, Explanation } from '../wire/explanation_shapes';
import type { Point } from '../wire/shapes';

export interface Drawn { explanation: Explanation | null; trail: Point[]; truth: Point | null; floor: number | null }

const kInkOf = { ok: 'phone', degraded: 'warn', suspect: 'bad' } as const;

/// One explained position: the filter's particles, the regions, the way there and, where it is known, the truth.
export class ExplanationLayer {
  private readonly canvas: CanvasLayer;
  private drawn: Drawn = { explanation: null, trail: [], truth: null, floor: null };

  constructor(private readonly map: L.Map) {
    this.canvas = new CanvasLayer((pen) => this.paint(pen), 'tracks', 'explanation');
    this.canvas.addTo(map);
  }

  show(drawn: Partial<Drawn>): void {
    Object.assign(this.drawn, drawn);
    this.canvas.redraw();
  }

  remove(): void {
    this.canvas.removeFrom(this.map);
  }

  private paint(pen: Pen): void {
    const { explanation, trail, truth, floor } = this.drawn;
    if (!explanation || explanation.position.floor !== floor) return;
    const ink = inks();
    const colour = ink[kInkOf[explanation.integrity.state]];
    drawRegions(pen, explanation.position, colour);
    drawParticles(pen, explanation.particles, ink.zone);
    drawLine(pen, trail, colour);
    if (truth) drawTruth(pen, truth, explanation.position, ink);
    drawPhone(pen, explanation.position, colour, ink.halo);
  }
}

function drawRegions({ ctx, x, y, scale }: Pen, position: ExplainedPosition, colour: string): void {
  const [xx_m2, xy_m2, yy_m2] = position.covariance_m2;
  for (const [radius, dash, alpha] of [[position.radius95_m, [5, 4], 0.06], [position.radius68_m, [], 0.12]] as [number, number[], number][]) {
    const { major, minor, angle } = calibratedEllipse({ xx_m2, xy_m2, yy_m2 }, radius);
    ctx.beginPath();
    ctx.ellipse(x(position.x_m), y(position.y_m), major * scale, minor * scale, -angle, 0, 2 * Math.PI);
    Object.assign(ctx, { fillStyle: colour, strokeStyle: colour, lineWidth: 1.5, globalAlpha: alpha });
    ctx.fill();
    ctx.globalAlpha = 1;
    ctx.setLineDash(dash);
    ctx.stroke();
  }
  ctx.setLineDash([]);
}

// A particle's area grows with its weight.
function drawParticles({ ctx, x, y }: Pen, particles: Explanation['particles'], colour: string): void {
  ctx.beginPath();
  for (const [px, py, weight] of particles) {
    const radius = Math.min(Math.max(1.6 * Math.sqrt(weight * particles.length), 0.8), 5);
    ctx.moveTo(x(px) + radius, y(py));
    ctx.arc(x(px), y(py), radius, 0, 2 * Math.PI);
  }
  Object.assign(ctx, { fillStyle: colour, globalAlpha: 0.5 });
  ctx.fill();
  ctx.globalAlpha = 1;
}

function drawLine({ ctx, x, y }: Pen, points: Point[], colour: string): void {
  ctx.beginPath();
  points.forEach(([px, py], i) => (i ? ctx.lineTo(x(px), y(py)) : ctx.moveTo(x(px), y(py))));
  Object.assign(ctx, { strokeStyle: colour, lineWidth: 2, lineJoin: 'round', globalAlpha: 0.7 });
  ctx.stroke();
  ctx.globalAlpha = 1;
}

function drawTruth({ ctx, x, y }: Pen, [tx, ty]: Point, position: ExplainedPosition, ink: Inks): void {
  ctx.beginPath();
  ctx.moveTo(x(tx), y(ty));
  ctx.lineTo(x(position.x_m), y(position.y_m));
  Object.assign(ctx, { strokeStyle: ink.ink, lineWidth: 1.25 });
  ctx.setLineDash([2, 3]);
  ctx.stroke();
  ctx.setLineDash([]);
  ctx.beginPath();
  ctx.rect(x(tx) - 5, y(ty) - 5, 10, 10);
  Object.assign(ctx, { strokeStyle: ink.ink, fillStyle: ink.halo, lineWidth: 2 });
  ctx.fill();
  ctx.stroke();
}

function drawPhone({ ctx, x, y }: Pen, position: ExplainedPosition, colour: string, halo: string): void {
  const [cx, cy] = [x(position.x_m), y(position.y_m)];
  const angle = ((90 - position.azimuth_deg) * Math.PI) / 180;
  const [ux, uy] = [Math.cos(angle), -Math.sin(angle)];
  ctx.beginPath();
  ctx.moveTo(cx + 17 * ux, cy + 17 * uy);
  ctx.lineTo(cx + 8 * ux - 6 * uy, cy + 8 * uy + 6 * ux);
  ctx.lineTo(cx + 8 * ux + 6 * uy, cy + 8 * uy - 6 * ux);
  ctx.closePath();
  Object.assign(ctx, { fillStyle: colour, strokeStyle: halo, lineWidth: 3 });
  ctx.fill();
  ctx.beginPath();
  ctx.arc(cx, cy, 7, 0, 2 * Math.PI);
  ctx.stroke();
  ctx.fill();
}
