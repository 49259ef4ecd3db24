import type L from 'leaflet';
import { CanvasLayer, type Pen } from '../map/canvas_layer';
import { inks } from '../map/inks';
import { cssColourAt, partOf, type Scale } from '../map/scale_colours';
import type { SurveyedPoint } from './points';

export interface PointView {
  points: SurveyedPoint[];
  valueOf: ((point: SurveyedPoint) => number | null) | null;   // null: one colour for all; a point's null: drawn hollow
  scale: Scale;
  chosen: number | null;
}

/// Reference points as dots that keep their size on screen.
export class PointLayer {
  private readonly layer: CanvasLayer;
  private view: PointView = { points: [], valueOf: null, scale: { least: 0, most: 1, unit: '' }, chosen: null };

  constructor(private readonly map: L.Map) {
    this.layer = new CanvasLayer((pen) => this.paint(pen), 'points', 'points');
    this.layer.addTo(map);
  }

  show(view: Partial<PointView>): void {
    Object.assign(this.view, view);
    this.layer.redraw();
  }

  remove(): void {
    this.layer.removeFrom(this.map);
  }

  private paint({ ctx, x, y, scale }: Pen): void {
    const { points, valueOf, scale: colours, chosen } = this.view;
    const size = Math.min(Math.max(scale * 0.28, 2), 6);
    const ink = inks();
    for (const point of points) {
      const value = valueOf?.(point);
      const [px, py] = [x(point.place.x_m), y(point.place.y_m)];
      ctx.beginPath();
      ctx.arc(px, py, point.id === chosen ? size + 3 : size, 0, 2 * Math.PI);
      if (value === null) {
        Object.assign(ctx, { strokeStyle: ink.point, lineWidth: 1 });
        ctx.stroke();
        continue;
      }
      ctx.fillStyle = value === undefined ? ink.point : cssColourAt(partOf(colours, value));
      ctx.fill();
      if (point.id !== chosen) continue;
      Object.assign(ctx, { strokeStyle: ink.ink, lineWidth: 2 });
      ctx.stroke();
    }
  }
}

export function nearestPoint(points: SurveyedPoint[], x: number, y: number, reach: number): SurveyedPoint | null {
  let best: SurveyedPoint | null = null;
  let least = reach;
  for (const point of points) {
    const distance = Math.hypot(point.place.x_m - x, point.place.y_m - y);
    if (distance < least) [best, least] = [point, distance];
  }
  return best;
}
