import type L from 'leaflet';
import { ChevronLeft, Download } from 'lucide-preact';
import { useEffect, useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { FloorMap, toLatLng } from '../map/floor_map';
import { useFloorImage } from '../map/image_layer';
import { kLevels } from '../map/scale_colours';
import { useLayer } from '../map/use_layer';
import { Legend } from '../parts/legend';
import { Badge, Fault, Loading, Notice, useDeed } from '../parts/parts';
import { saveFile } from '../parts/save_file';
import { count, plural } from '../parts/words';
import { Player } from '../replay/player';
import { RecordingList } from '../replay/recording_list';
import { useReplay, type Question } from '../replay/use_replay';
import { go, useRoute } from '../route';
import { ExplanationLayer } from '../why/explanation_layer';
import { ExplanationPanel } from '../why/explanation_panel';
import { useSurveyOf } from '../why/heard_where';
import { MapKey } from '../why/map_key';
import type { RadioMap } from '../wire/map_shapes';
import type { Replay, Recording, ReplayStep } from '../wire/replay_shapes';
import type { Point } from '../wire/shapes';
import { useAnswer } from '../wire/use_answer';

const kTrail = 60;
const kAsItWas: Question = { pipeline: '', map: '' };

/// Recorded sessions, lived through again step by step.
export function TimeMachine() {
  const { building, floor, setFloor } = useBuilding();
  const recording = useRoute().detail;
  const [map, setMap] = useState<L.Map | null>(null);
  const [bssid, setBssid] = useState<string | null>(null);
  const [shown, setShown] = useState<{ step: ReplayStep | null; trail: Point[] }>({ step: null, trail: [] });
  const layer = useLayer(map, (made) => new ExplanationLayer(made));
  const explanation = recording ? shown.step?.explanation ?? null : null;
  useFloorImage(map, building.id, floor);
  useSurveyOf(map, bssid);
  useEffect(() => layer?.show({ explanation, trail: shown.trail, floor }), [layer, explanation, floor]);
  useEffect(() => setBssid(null), [recording]);
  const there = explanation?.position;
  useEffect(() => { if (there) setFloor(there.floor); }, [there?.floor]);
  useEffect(() => {
    if (map && there) map.panInside(toLatLng([there.x_m, there.y_m]), { padding: [60, 60] });
  }, [map, there?.x_m, there?.y_m]);
  return (
    <div class="split">
      <FloorMap floors={building.floors} floor={floor} onFloor={setFloor} onMap={setMap} label={recording ? 'A recorded session, step by step.' : 'Floor plan.'}>
        {bssid ? <div class="map-panel"><Legend scale={kLevels} title={`${bssid} in the survey`} /></div> : explanation && <MapKey truth={false} />}
      </FloorMap>
      <aside class="side" aria-label="Time machine">
        {recording ? <Playing key={recording} recording={recording} bssid={bssid} setBssid={setBssid} onShown={(step, trail) => setShown({ step, trail })} /> : <RecordingList />}
      </aside>
    </div>
  );
}

interface PlayingProps { recording: string; bssid: string | null; setBssid: (bssid: string | null) => void; onShown: (step: ReplayStep | null, trail: Point[]) => void }

function Playing({ recording, bssid, setBssid, onShown }: PlayingProps) {
  const { building } = useBuilding();
  const base = `/v1/buildings/${building.id}/recordings`;
  const list = useAnswer<{ recordings: Recording[] }>(`${base}?most=1&after=${Number(recording) - 1}`);
  const about = list.data?.recordings[0];
  const download = useDeed();
  const [question, setQuestion] = useState<Question>(kAsItWas);
  const [at, setAt] = useState(1);
  const { summary, fault, again, step } = useReplay(`${base}/${recording}/replay`, question, at);
  const shown = step(at);
  useEffect(() => { if (shown) onShown(shown, trailTo(at, step)); }, [shown]);
  return (
    <>
      <section>
        <div class="side-head">
          <button class="quiet" aria-label="All recordings" onClick={() => go(building.id, 'replay')}><ChevronLeft /></button>
          <h2>{about ? <span class="mono">{about.tracked}</span> : `Recording ${recording}`}</h2>
          {shown && <AsLive step={shown} />}
          <button disabled={download.busy} aria-label="Download" title="Download the recording" onClick={() => download.run(() => saveFile(`${base}/${recording}`, `recording-${recording}.jsonl`))}><Download /></button>
        </div>
        {summary && summary.steps_in_all > 0 && <Player at={at} steps={summary.steps_in_all} step={step} onStep={setAt} />}
        {(fault ?? download.fault) && <Fault fault={(fault ?? download.fault)!} again={again} />}
        {summary?.steps_in_all === 0 && <Notice>Nothing was heard of this session yet.</Notice>}
        <WhatIf question={question} onChange={(changed) => { setQuestion(changed); setAt(1); }} />
        {summary && <Verdict summary={summary} />}
      </section>
      {shown?.no_position && <section><Notice>No position at this step: {shown.no_position}</Notice></section>}
      {shown?.explanation ? <ExplanationPanel explanation={shown.explanation} floors={building.floors} chosen={bssid} choose={setBssid} />
        : !shown && !fault && summary?.steps_in_all !== 0 && <Loading what="the steps" />}
    </>
  );
}

function AsLive({ step }: { step: ReplayStep }) {
  if (step.as_live === true) return <Badge tone="good">as live</Badge>;
  if (step.as_live === false) return <Badge tone="bad">not as live</Badge>;
  return step.said ? null : <Badge>not told</Badge>;
}

function Verdict({ summary }: { summary: Replay }) {
  return (
    <>
      {summary.as_it_was && (summary.differing === 0 ? <p class="hint">Every position that the phone was told comes out the same, bit for bit.</p>
        : <Notice tone="warn">{plural(summary.differing, 'step')} of {count(summary.steps_in_all)} come out otherwise than live.</Notice>)}
      {summary.remarks.map((remark) => <Notice key={remark}>{remark}</Notice>)}
    </>
  );
}

/// The same session through another pipeline or on another radio map.
function WhatIf({ question, onChange }: { question: Question; onChange: (question: Question) => void }) {
  const { building } = useBuilding();
  const pipelines = useAnswer<{ pipelines: string[] }>('/v1/pipelines');
  const maps = useAnswer<{ items: RadioMap[] }>(`/v1/buildings/${building.id}/maps?most=1000`);
  return (
    <div class="fields">
      <label class="field"><span>Pipeline</span>
        <select value={question.pipeline} onChange={(event) => onChange({ ...question, pipeline: event.currentTarget.value })}>
          <option value="">As it was</option>{pipelines.data?.pipelines.map((name) => <option key={name} value={name}>{name}</option>)}
        </select></label>
      <label class="field"><span>Radio map</span>
        <select value={question.map} onChange={(event) => onChange({ ...question, map: event.currentTarget.value })}>
          <option value="">As it was</option>{maps.data?.items.map((one) => <option key={one.version} value={one.version}>Version {one.version}{one.live ? ', live' : ''}</option>)}
        </select></label>
    </div>
  );
}

/// The way to a step on its floor, as far as it is loaded.
function trailTo(at: number, step: (number: number) => ReplayStep | null): Point[] {
  const floor = step(at)?.explanation?.position.floor;
  const trail: Point[] = [];
  for (let number = at; number > Math.max(at - kTrail, 0); --number) {
    const position = step(number)?.explanation?.position;
    if (!position || position.floor !== floor) break;
    trail.unshift([position.x_m, position.y_m]);
  }
  return trail;
}
