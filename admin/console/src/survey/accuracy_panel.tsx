import L from 'leaflet';
import { Footprints } from 'lucide-preact';
import { useEffect, useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { toLatLng } from '../map/floor_map';
import type { Scale } from '../map/scale_colours';
import { Empty, Facts, Fault, Loading } from '../parts/parts';
import { metres } from '../parts/words';
import type { Accuracy, SurveyPlan } from '../wire/map_shapes';
import { useAnswer } from '../wire/use_answer';
import { heatLayer } from './heat_layer';

/// Scale of the expected error: rounded up, so that two floors of one building can be compared at a glance.
export function errorScale(accuracy: Accuracy | null): Scale {
  const known = (accuracy?.expected_m ?? []).filter((value): value is number => value !== null).sort((a, b) => a - b);
  const most = known[Math.floor(known.length * 0.98)] ?? 10;
  return { least: Math.max(2, Math.ceil(most / 2) * 2), most: 0, unit: 'm' };   // yellow = accurate
}

export function useAccuracy(on: boolean) {
  const { building, floor } = useBuilding();
  return useAnswer<Accuracy>(on && floor !== null ? `/v1/buildings/${building.id}/accuracy?floor=${floor}` : null);
}

export function useHeat(map: L.Map | null, accuracy: Accuracy | null): void {
  useEffect(() => {
    if (!map || !accuracy || accuracy.columns * accuracy.rows === 0) return;
    const layer = heatLayer(accuracy, accuracy.expected_m, errorScale(accuracy)).addTo(map);
    return () => { layer.remove(); };
  }, [map, accuracy]);
}

/// What to walk next, best first, on the map and in words.
export function PlanPanel({ map, accuracy }: { map: L.Map | null; accuracy: Accuracy | null }) {
  const { building, floor } = useBuilding();
  const { data, fault, loading, again } = useAnswer<SurveyPlan>(floor === null ? null : `/v1/buildings/${building.id}/survey-plan?floor=${floor}`);
  const [chosen, setChosen] = useState<number | null>(null);
  useEffect(() => {
    if (!map || !data) return;
    const layers = L.layerGroup().addTo(map);
    data.walks.forEach((walk, i) => {
      const path = walk.path.map(toLatLng);
      layers.addLayer(L.polyline(path, { pane: 'walks', className: 'walk-casing', interactive: false }));
      layers.addLayer(L.polyline(path, { pane: 'walks', className: `walk-plan ${i === chosen ? 'chosen' : ''}`, interactive: false }));
      if (path[0]) layers.addLayer(L.marker(path[0], { pane: 'marks', icon: L.divIcon({ className: 'walk-mark', html: String(i + 1), iconSize: [22, 22] }), keyboard: false, interactive: false }));
    });
    return () => { layers.remove(); };
  }, [map, data, chosen]);
  const show = (i: number) => {
    setChosen(i === chosen ? null : i);
    const path = data?.walks[i]?.path.map(toLatLng) ?? [];
    if (map && i !== chosen && path.length) map.fitBounds(L.latLngBounds(path), { padding: [140, 140], maxZoom: 4 });
  };
  return (
    <section>
      <h2>Walk next</h2>
      <Facts big facts={[['Expected median error here now', metres(data?.median_now_m ?? accuracy?.median_m)]]} />
      {fault ? <Fault fault={fault} again={again} /> : loading ? <><p class="hint">Looking for the walks that help most …</p><Loading what="the plan" /></>
        : data?.walks.length === 0 ? <Empty icon={<Footprints />} title="Nothing to gain">More survey would not lower the expected error on this floor.</Empty> : (
        <ol class="walks">
          {data?.walks.map((walk, i) => (
            <li key={i}>
              <button class={i === chosen ? 'on' : ''} aria-pressed={i === chosen} onClick={() => show(i)}>
                <span class="walk-mark" aria-hidden="true">{i + 1}</span>
                <span><strong>Walk {walk.length_m.toFixed(0)} m: the median falls to {metres(walk.median_after_m)}</strong><small>{walk.why}</small></span>
              </button>
            </li>
          ))}
        </ol>
      )}
    </section>
  );
}
