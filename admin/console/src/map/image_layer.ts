import L from 'leaflet';
import { useEffect } from 'preact/hooks';
import { ask, askBytes, Refusal } from '../wire/api';
import type { FloorImage } from '../wire/plan_shapes';

/// A picture that may lie turned on the floor: three corners give its affine place.
class TurnedImage extends L.ImageOverlay {
  constructor(url: string, private readonly place: FloorImage) {
    super(url, [[0, 0], [1, 1]], { pane: 'image', className: 'floor-picture', interactive: false });
  }

  private corner(right_m: number, up_m: number): L.LatLngTuple {
    const { origin_x_m, origin_y_m, azimuth_deg } = this.place;
    const turn = (-azimuth_deg * Math.PI) / 180;
    return [origin_y_m + right_m * Math.sin(turn) + up_m * Math.cos(turn), origin_x_m + right_m * Math.cos(turn) - up_m * Math.sin(turn)];
  }

  // Leaflet calls this whenever the view changed.
  _reset(): void {
    const { _image: image, _map: map } = this as unknown as { _image: HTMLImageElement; _map: L.Map };
    const { width_m, height_m, width_px, height_px } = this.place;
    const top = map.latLngToLayerPoint(this.corner(0, height_m));
    const right = map.latLngToLayerPoint(this.corner(width_m, height_m)).subtract(top).divideBy(width_px);
    const down = map.latLngToLayerPoint(this.corner(0, 0)).subtract(top).divideBy(height_px);
    Object.assign(image.style, {
      width: `${width_px}px`, height: `${height_px}px`, transformOrigin: '0 0',
      transform: `matrix(${right.x}, ${right.y}, ${down.x}, ${down.y}, ${top.x}, ${top.y})`,
    });
  }

  // A picture turned or not, it is placed anew at the end of a zoom.
  _animateZoom(): void {}
}

/// Shows the floor's picture, if it has one, beneath everything else.
export function useFloorImage(map: L.Map | null, building: number, floor: number | null, round = 0): void {
  useEffect(() => {
    if (!map || floor === null) return;
    const path = `/v1/buildings/${building}/floors/${floor}/image`;
    const stop = new AbortController();
    let layer: L.ImageOverlay | null = null;
    let url = '';
    (async () => {
      const place = await ask<FloorImage>(`${path}/placement`, { signal: stop.signal });
      url = URL.createObjectURL(await askBytes(path, { signal: stop.signal }));
      layer = new TurnedImage(url, place).addTo(map);
      map.getContainer().classList.add('has-picture');
    })().catch((error: unknown) => {
      // Most floors have no picture; anything else is said where pictures are changed.
      if (!(error instanceof Refusal)) return;
    });
    return () => {
      stop.abort();
      layer?.remove();
      map.getContainer().classList.remove('has-picture');
      if (url) URL.revokeObjectURL(url);
    };
  }, [map, building, floor, round]);
}
