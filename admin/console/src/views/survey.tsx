import type L from 'leaflet';
import { Download, MapPinned, X } from 'lucide-preact';
import { useEffect, useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { FloorMap } from '../map/floor_map';
import { kLevels } from '../map/scale_colours';
import { useLayer } from '../map/use_layer';
import { Choice } from '../parts/choice';
import { Legend } from '../parts/legend';
import { Empty, Facts, Fault, Loading, useDeed } from '../parts/parts';
import { ago, count, metres } from '../parts/words';
import { saveFile } from '../parts/save_file';
import { useRoute } from '../route';
import { errorScale, PlanPanel, useAccuracy, useHeat } from '../survey/accuracy_panel';
import { nearestPoint, PointLayer } from '../survey/point_layer';
import { usePoints, type SurveyedPoint } from '../survey/points';
import { useResurvey } from '../survey/resurvey';
import type { Transmitter } from '../wire/shapes';
import type { Accuracy } from '../wire/map_shapes';
import { useAnswer, type Asked } from '../wire/use_answer';

type Colouring = 'error' | 'heard' | 'level' | 'plain';

const kTitles: Record<Colouring, string> = { error: 'Expected median error', heard: 'Heard', level: 'Level', plain: '' };

export function Survey() {
  const { building, floor, setFloor } = useBuilding();
  const { points, complete, fault } = usePoints(building.id, floor, building.survey_version);
  const [map, setMap] = useState<L.Map | null>(null);
  const wanted = useRoute().detail;                 // an access point's address
  const [colouring, setColouring] = useState<Colouring>(wanted ? 'level' : 'error');
  const [bssid, setBssid] = useState(wanted ?? '');
  const [chosen, setChosen] = useState<SurveyedPoint | null>(null);
  const layer = useLayer(map, (made) => new PointLayer(made));
  useEffect(() => setChosen(null), [floor]);

  useResurvey(map, colouring === 'level' ? wanted : null);

  const most = Math.max(10, ...points.map((point) => point.heard.size));
  const accuracy = useAccuracy(colouring === 'error');
  useHeat(map, colouring === 'error' ? accuracy.data : null);
  const scale = colouring === 'level' ? kLevels : colouring === 'error' ? errorScale(accuracy.data) : { least: 0, most, unit: 'access points' };
  useEffect(() => {
    const valueOf = colouring === 'plain' || colouring === 'error' ? null
      : colouring === 'heard' ? (point: SurveyedPoint) => point.heard.size
      : (point: SurveyedPoint) => point.heard.get(bssid) ?? null;
    layer?.show({ points, valueOf, scale, chosen: chosen?.id ?? null });
  }, [layer, points, colouring, bssid, chosen, most]);

  return (
    <div class="split">
      <FloorMap floors={building.floors} floor={floor} onFloor={setFloor} onMap={setMap}
        onPick={(x, y, reach) => setChosen(nearestPoint(points, x, y, reach))} label={`Survey: ${points.length} reference points on this floor.`}>
        {colouring !== 'plain' && points.length > 0 && (
          <div class="map-panel"><Legend scale={scale} title={kTitles[colouring]} /></div>
        )}
        {complete && points.length === 0 && building.floors.length > 0 && (
          <div class="map-message"><Empty icon={<MapPinned />} title="This floor is not surveyed">
            Walk it with a surveyor’s phone (the SDK’s Surveyor), or upload points with <code>wayfuse</code>. Until then nobody is positioned here.
          </Empty></div>
        )}
      </FloorMap>
      <aside class="side" aria-label="Survey">
        {fault && <section><Fault fault={fault} /></section>}
        {!complete && !fault && <section><Loading what="the reference points" /></section>}
        {chosen && <PointCard point={chosen} onClose={() => setChosen(null)} />}
        {points.length > 0 && <PlanPanel map={map} accuracy={accuracy.data} />}
        <section>
          <h2>Reference points</h2>
          <Summary points={points} total={building.points} />
        </section>
        <section>
          <h2>Colours</h2>
          <Choice name="Colour by" value={colouring} onChange={setColouring}
            of={[['error', 'Accuracy'], ['heard', 'Heard'], ['level', 'Level'], ['plain', 'Plain']]} />
          {colouring === 'error' && <AccuracyState asked={accuracy} />}
          {colouring === 'level' && <TransmitterChoice value={bssid} onChange={setBssid} />}
        </section>
        <Exports />
      </aside>
    </div>
  );
}

function AccuracyState({ asked }: { asked: Asked<Accuracy> }) {
  if (asked.fault) return <Fault fault={asked.fault} again={asked.again} />;
  if (asked.loading) return <p class="hint" role="status">Working out the expected accuracy …</p>;
  return <p class="hint">From the radio field’s own uncertainty: no test walk is needed.</p>;
}

function Summary({ points, total }: { points: SurveyedPoint[]; total: number }) {
  const walks = new Set(points.map((point) => point.walk).filter(Boolean)).size;
  const models = new Set(points.map((point) => point.model).filter(Boolean)).size;
  const newest = points.reduce((last, point) => Math.max(last, point.surveyedUs), 0);
  const heard = points.map((point) => point.heard.size).sort((a, b) => a - b);
  return (
    <Facts facts={[
      ['On this floor', count(points.length)],
      ['In the building', count(total)],
      ['Heard at a point, median', heard.length ? heard[heard.length >> 1]! : '–'],
      ['Walks', walks || '–'],
      ['Phone models', models || '–'],
      ['Newest', newest ? ago(newest) : '–'],
    ]} />
  );
}

function TransmitterChoice({ value, onChange }: { value: string; onChange: (bssid: string) => void }) {
  const { building } = useBuilding();
  const { data, fault } = useAnswer<{ transmitters: Transmitter[] }>(`/v1/buildings/${building.id}/transmitters`);
  const transmitters = [...(data?.transmitters ?? [])].sort((a, b) => b.readings - a.readings);
  useEffect(() => { if (!value && transmitters[0]) onChange(transmitters[0].bssid); }, [data]);
  if (fault) return <Fault fault={fault} />;
  return (
    <label class="field"><span>Access point</span>
      <select value={value} onChange={(event) => onChange(event.currentTarget.value)}>
        {transmitters.map((one) => (
          <option key={one.bssid} value={one.bssid}>{one.bssid} · {count(one.readings)} readings, best {one.strongest_dbm.toFixed(0)} dBm</option>
        ))}
      </select>
    </label>
  );
}

function PointCard({ point, onClose }: { point: SurveyedPoint; onClose: () => void }) {
  const strongest = [...point.heard].sort((a, b) => b[1] - a[1]).slice(0, 8);
  return (
    <section>
      <div class="side-head"><h2>Point {point.id}</h2><button class="quiet" aria-label="Close" onClick={onClose}><X /></button></div>
      <Facts facts={[
        ['Place', `${point.place.x_m.toFixed(1)}, ${point.place.y_m.toFixed(1)} m`],
        ['Placed within', point.sigma ? metres(point.sigma) : 'not said'],
        ['Surveyed', ago(point.surveyedUs)],
        ['Scans', point.scans],
        ['Model', point.model || 'not said'],
        ['Walk', point.walk || '–'],
      ]} />
      <h3>{point.heard.size} access points heard, the strongest</h3>
      <div class="bars">
        {strongest.map(([bssid, level]) => (
          <div class="bar level" key={bssid}>
            <span class="mono">{bssid}</span>
            <meter min={-100} max={-30} value={level} aria-label={`Level of ${bssid}`} />
            <span>{level.toFixed(0)}</span>
          </div>
        ))}
      </div>
    </section>
  );
}

function Exports() {
  const { building } = useBuilding();
  const { busy, fault, run } = useDeed();
  const save = (kind: 'csv' | 'geojson') =>
    run(() => saveFile(`/v1/buildings/${building.id}/points.${kind}`, `building-${building.id}-points.${kind}`));
  return (
    <section>
      <h2>Take it out</h2>
      <div class="row">
        <button disabled={busy} onClick={() => save('csv')}><Download />CSV</button>
        <button disabled={busy} onClick={() => save('geojson')}><Download />GeoJSON</button>
      </div>
      {fault && <Fault fault={fault} />}
    </section>
  );
}
