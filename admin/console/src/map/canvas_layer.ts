import L from 'leaflet';

export interface Pen {
  ctx: CanvasRenderingContext2D;
  scale: number;                       // pixels a metre
  x(x_m: number): number;
  y(y_m: number): number;
  width: number;
  height: number;
}

type Paint = (pen: Pen) => void;

// What Leaflet's own renderers use and its types leave out.
interface MapInside {
  _latLngToNewLayerPoint(latlng: L.LatLng, zoom: number, center: L.LatLng): L.Point;
}

// Painted beyond the map's edges by this part of its size, so that a map under a finger shows no bare edge before it is painted anew.
const kMargin = 0.2;

/// A canvas over the whole map that paints itself anew when the view or its data changed: at most once a frame. While the map is
/// dragged it moves along with Leaflet's pane.
export class CanvasLayer extends L.Layer {
  private canvas: HTMLCanvasElement | null = null;
  private frame = 0;
  private paintedAt = L.latLng(0, 0);      // the canvas's upper left corner
  private paint: Paint;

  constructor(paint: Paint, private readonly paneName: string, private readonly name: string) {
    super();
    this.paint = paint;
  }

  override onAdd(map: L.Map): this {
    this.canvas = L.DomUtil.create('canvas', 'leaflet-zoom-animated canvas-layer', map.getPane(this.paneName)!);
    this.canvas.dataset.layer = this.name;
    this.redraw();
    return this;
  }

  override onRemove(): this {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.canvas?.remove();
    this.canvas = null;
    return this;
  }

  override getEvents(): Record<string, L.LeafletEventHandlerFn> {
    return {
      moveend: () => this.redraw(),
      viewreset: () => this.redraw(),
      zoomend: () => this.redraw(),
      resize: () => this.redraw(),
      zoomanim: (event) => this.follow(event as L.ZoomAnimEvent),
    };
  }

  redraw(): void {
    if (!this.frame && this.canvas) this.frame = requestAnimationFrame(() => { this.frame = 0; this.draw(); });
  }

  private draw(): void {
    const { canvas, _map: map } = this as unknown as { canvas: HTMLCanvasElement | null; _map: L.Map };
    if (!canvas || !map) return;
    const margin = map.getSize().multiplyBy(kMargin).round();
    const size = map.getSize().add(margin.multiplyBy(2));
    const ratio = Math.min(devicePixelRatio || 1, 2);
    const [width, height] = [Math.round(size.x * ratio), Math.round(size.y * ratio)];
    if (canvas.width !== width || canvas.height !== height) {
      Object.assign(canvas, { width, height });
      Object.assign(canvas.style, { width: `${size.x}px`, height: `${size.y}px` });
    }
    L.DomUtil.setPosition(canvas, map.containerPointToLayerPoint(margin.multiplyBy(-1)));
    this.paintedAt = map.containerPointToLatLng(margin.multiplyBy(-1));
    const scale = 2 ** map.getZoom();
    const origin = map.latLngToContainerPoint([0, 0]).add(margin);
    const ctx = canvas.getContext('2d')!;
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.clearRect(0, 0, size.x, size.y);
    this.paint({ ctx, scale, x: (x) => origin.x + x * scale, y: (y) => origin.y - y * scale, width: size.x, height: size.y });
  }

  // While Leaflet animates a zoom, the picture painted last is stretched along with it.
  private follow(event: L.ZoomAnimEvent): void {
    const map = this._map;
    const corner = (map as unknown as MapInside)._latLngToNewLayerPoint(this.paintedAt, event.zoom, event.center);
    L.DomUtil.setTransform(this.canvas!, corner, map.getZoomScale(event.zoom, map.getZoom()));
  }
}
