import type L from 'leaflet';
import { ChevronLeft, Pause, Play, Waypoints } from 'lucide-preact';
import { useEffect, useRef, useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { FloorMap, toLatLng } from '../map/floor_map';
import { nearestPhone } from '../live/phones';
import { useFloorImage } from '../map/image_layer';
import { kLevels } from '../map/scale_colours';
import { PhoneLayer } from '../map/phone_layer';
import { useLayer } from '../map/use_layer';
import { Legend } from '../parts/legend';
import { Badge, Empty, Fault, Loading, Notice } from '../parts/parts';
import { ago } from '../parts/words';
import { go, hashOf, useRoute } from '../route';
import { ExplanationLayer } from '../why/explanation_layer';
import { ExplanationPanel } from '../why/explanation_panel';
import { useSurveyOf } from '../why/heard_where';
import { MapKey } from '../why/map_key';
import type { Refusal } from '../wire/api';
import type { Explanation } from '../wire/explanation_shapes';
import type { Point, Session } from '../wire/shapes';
import { useAnswer } from '../wire/use_answer';

const kTrail = 60;

/// The building's sessions, and for one of them: why is it here?
export function Sessions() {
  const { building, floor, setFloor, phones } = useBuilding();
  const tracked = useRoute().detail;
  const [map, setMap] = useState<L.Map | null>(null);
  const [held, setHeld] = useState(false);
  const [bssid, setBssid] = useState<string | null>(null);
  const path = tracked && `/v1/buildings/${building.id}/sessions/${encodeURIComponent(tracked)}/explain`;
  const why = useAnswer<Explanation>(path, held ? 0 : 1000);
  const trail = useTrail(why.data);
  const layer = useLayer(map, (made) => new ExplanationLayer(made));
  const crowd = useLayer(map, (made) => new PhoneLayer(made, phones));
  useFloorImage(map, building.id, floor);
  useEffect(() => crowd?.show({ floor: tracked ? null : floor, outer: false }), [crowd, floor, tracked]);
  useEffect(() => layer?.show({ explanation: why.data, trail, floor }), [layer, why.data, floor]);
  useSurveyOf(map, bssid);
  useEffect(() => { setHeld(false); setBssid(null); }, [tracked]);

  const there = why.data?.position;
  useEffect(() => { if (there) setFloor(there.floor); }, [tracked, there?.floor]);
  useEffect(() => {
    if (map && there) map.panInside(toLatLng([there.x_m, there.y_m]), { padding: [60, 60] });
  }, [map, there?.x_m, there?.y_m]);

  return (
    <div class="split">
      <FloorMap floors={building.floors} floor={floor} onFloor={setFloor} onMap={setMap} label={tracked ? `Why ${tracked} is where it is.` : 'Floor plan with the phones of all sessions.'}
        onPick={(x, y, reach) => { const near = tracked ? null : nearestPhone(phones.present(), floor, x, y, reach); if (near) go(building.id, 'sessions', near); }}>
        {bssid ? <div class="map-panel"><Legend scale={kLevels} title={`${bssid} in the survey`} /></div> : why.data && <MapKey truth={false} />}
      </FloorMap>
      <aside class="side" aria-label="Sessions">
        {tracked ? (
          <>
            <section>
              <div class="side-head">
                <button class="quiet" aria-label="All sessions" onClick={() => go(building.id, 'sessions')}><ChevronLeft /></button>
                <h2>Why is <span class="mono">{tracked}</span> here?</h2>
                <button aria-pressed={held} class={held ? 'primary' : ''} onClick={() => setHeld(!held)}>{held ? <Play /> : <Pause />}{held ? 'Go on' : 'Hold'}</button>
              </div>
              {why.fault && <Unexplained fault={why.fault} again={why.again} known={Boolean(why.data)} />}
            </section>
            {why.data ? <ExplanationPanel explanation={why.data} floors={building.floors} chosen={bssid} choose={setBssid} />
              : why.loading && <Loading what="the explanation" />}
          </>
        ) : <SessionList />}
      </aside>
    </div>
  );
}

function Unexplained({ fault, again, known }: { fault: Refusal; again: () => void; known: boolean }) {
  if (fault.status === 404) return <Notice tone="warn">The session has ended.{known ? ' What follows was its last position.' : ''}</Notice>;
  if (fault.status === 409) return <Notice>{fault.message}</Notice>;
  return <Fault fault={fault} again={again} />;
}

/// The way there on this floor, as far as it was explained here.
function useTrail(explanation: Explanation | null): Point[] {
  const trail = useRef<{ of: string; floor: number; points: Point[] }>({ of: '', floor: 0, points: [] });
  const seen = useRef<Explanation | null>(null);
  if (!explanation) trail.current = { of: '', floor: 0, points: [] };
  else if (explanation !== seen.current) {
    const { x_m, y_m, floor } = explanation.position;
    const same = trail.current.of === explanation.tracked && trail.current.floor === floor;
    trail.current = { of: explanation.tracked, floor, points: [...(same ? trail.current.points : []), [x_m, y_m] as Point].slice(-kTrail) };
  }
  seen.current = explanation;
  return trail.current.points;
}

function SessionList() {
  const { building } = useBuilding();
  const { data, fault, loading, again } = useAnswer<{ sessions: Session[] }>(`/v1/buildings/${building.id}/sessions`, 3000);
  const [wanted, setWanted] = useState('');
  const sessions = data?.sessions ?? [];
  const found = sessions.filter((one) => `${one.tracked} ${one.device_model}`.toLowerCase().includes(wanted.trim().toLowerCase()));
  return (
    <section class="flush">
      <div class="side-head"><h2>Sessions <span class="badge">{sessions.length}</span></h2>
        {sessions.length > 8 && <input type="search" placeholder="Find" aria-label="Find a session" value={wanted} onInput={(event) => setWanted(event.currentTarget.value)} />}</div>
      {fault && !data ? <div class="card-body"><Fault fault={fault} again={again} /></div> : loading ? <Loading what="the sessions" />
        : sessions.length === 0 ? <Empty icon={<Waypoints />} title="No session">A session begins when a phone connects with a key or token of scope “track”.</Empty> : (
        <table class="dense">
          <thead><tr><th>Phone</th><th>Zones</th><th>Since</th></tr></thead>
          <tbody id="sessions">
            {found.slice(0, 200).map((one) => (
              <tr key={one.tracked} data-name={one.tracked} onClick={() => go(building.id, 'sessions', one.tracked)}>
                <td><a class="mono" href={hashOf(building.id, 'sessions', one.tracked)}>{one.tracked}</a><span class="sub">{one.device_model || 'model not said'}, {one.pipeline}</span></td>
                <td>{one.zones?.join(', ') || '–'}</td>
                <td>{one.connected ? ago(one.since_us) : <Badge tone="warn">away</Badge>}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      {found.length > 200 && <p class="hint">The first 200 of {found.length}. Find narrows the list.</p>}
    </section>
  );
}
