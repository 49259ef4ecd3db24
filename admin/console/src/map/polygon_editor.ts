import L from 'leaflet';
import 'leaflet-editable';
import type { Point, Ring } from '../wire/shapes';
import { toLatLngs, toPoint } from './floor_map';

// What Leaflet.Editable adds to a map and a polygon.
interface EditableMap extends L.Map { editTools: { startPolygon(at?: L.LatLng, options?: L.PolylineOptions): EditablePolygon; stopDrawing(): void } }
interface EditablePolygon extends L.Polygon { enableEdit(map?: L.Map): void; disableEdit(): void }

const kStyle = { pane: 'zones', className: 'zone chosen' };
const round = (value: number) => Math.round(value * 100) / 100;
const ringOf = (corners: L.LatLng[]): Ring => corners.map(toPoint).map(([x, y]): Point => [round(x), round(y)]);

/// One polygon under the operator's hand: drawn anew, or an existing one with corners to drag. Tells every change.
export class PolygonEditor {
  private polygon: EditablePolygon;

  constructor(private readonly map: L.Map, rings: Ring[], private readonly onChange: (rings: Ring[], drawn: boolean) => void) {
    const tools = (map as EditableMap).editTools;
    if (rings.length) {
      this.polygon = L.polygon(toLatLngs(rings), kStyle).addTo(map) as EditablePolygon;
      this.polygon.enableEdit(map);
    } else {
      this.polygon = tools.startPolygon(undefined, kStyle);
    }
    this.polygon.on('editable:vertex:dragend editable:vertex:deleted editable:vertex:new', () => this.tell(false));
    this.polygon.on('editable:drawing:commit', () => this.tell(true));
  }

  show(rings: Ring[]): void {
    (this.map as EditableMap).editTools.stopDrawing();
    this.polygon.disableEdit();
    this.polygon.setLatLngs(toLatLngs(rings));
    if (!this.map.hasLayer(this.polygon)) this.polygon.addTo(this.map);
    this.polygon.enableEdit(this.map);
  }

  remove(): void {
    (this.map as EditableMap).editTools.stopDrawing();
    this.polygon.off();
    this.polygon.disableEdit();
    this.polygon.remove();
  }

  private tell(drawn: boolean): void {
    const rings = (this.polygon.getLatLngs() as L.LatLng[][]).map(ringOf).filter((ring) => ring.length >= 3);
    this.onChange(rings, drawn);
  }
}
