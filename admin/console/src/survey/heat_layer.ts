import L from 'leaflet';
import { colourAt, partOf, type Scale } from '../map/scale_colours';

export interface Grid { origin_x_m: number; origin_y_m: number; cell_m: number; columns: number; rows: number }

/// A picture of a grid over the floor, a pixel a cell; null cells stay clear. Rows run from the origin upwards.
export function heatLayer(grid: Grid, values: (number | null)[], scale: Scale): L.ImageOverlay {
  const canvas = document.createElement('canvas');
  Object.assign(canvas, { width: grid.columns, height: grid.rows });
  const ctx = canvas.getContext('2d')!;
  const picture = ctx.createImageData(grid.columns, grid.rows);
  values.forEach((value, i) => {
    if (value === null) return;
    const [column, row] = [i % grid.columns, Math.floor(i / grid.columns)];
    const at = 4 * ((grid.rows - 1 - row) * grid.columns + column);
    picture.data.set([...colourAt(partOf(scale, value)), 255], at);
  });
  ctx.putImageData(picture, 0, 0);
  const corner: L.LatLngTuple = [grid.origin_y_m + grid.rows * grid.cell_m, grid.origin_x_m + grid.columns * grid.cell_m];
  return L.imageOverlay(canvas.toDataURL(), [[grid.origin_y_m, grid.origin_x_m], corner], { pane: 'heat', className: 'heat', interactive: false });
}
