import type L from 'leaflet';
import { useEffect } from 'preact/hooks';
import { useBuilding } from '../context';
import { kLevels } from '../map/scale_colours';
import { useLayer } from '../map/use_layer';
import { PointLayer } from '../survey/point_layer';
import { usePoints } from '../survey/points';

/// Shows on the map at what level the survey heard an access point; null shows nothing.
export function useSurveyOf(map: L.Map | null, bssid: string | null): void {
  const { building, floor } = useBuilding();
  const { points } = usePoints(building.id, bssid ? floor : null, building.survey_version);
  const layer = useLayer(map, (made) => new PointLayer(made));
  useEffect(() => {
    layer?.show({ points: bssid ? points : [], valueOf: (point) => (bssid ? point.heard.get(bssid) ?? null : null), scale: kLevels, chosen: null });
  }, [layer, points, bssid]);
}
