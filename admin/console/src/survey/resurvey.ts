import L from 'leaflet';
import { useEffect } from 'preact/hooks';
import { useBuilding } from '../context';
import { toLatLng } from '../map/floor_map';
import type { AccessPoint } from '../wire/map_shapes';
import { useAnswer } from '../wire/use_answer';

/// Marks where an access point's surroundings should be surveyed again; null marks nothing.
export function useResurvey(map: L.Map | null, bssid: string | null): void {
  const { building, floor } = useBuilding();
  const { data } = useAnswer<{ items: AccessPoint[] }>(bssid && `/v1/buildings/${building.id}/access-points?most=1000`);
  useEffect(() => {
    const places = data?.items.find((one) => one.bssid === bssid)?.resurvey.filter((place) => place.floor === floor) ?? [];
    if (!map || places.length === 0) return;
    const layers = L.layerGroup(places.map((place) => L.marker(toLatLng([place.x_m, place.y_m]), {
      pane: 'marks', keyboard: false, interactive: false, icon: L.divIcon({ className: 'walk-mark', html: '!', iconSize: [22, 22] }),
    }))).addTo(map);
    return () => { layers.remove(); };
  }, [map, data, bssid, floor]);
}
