import { Router as RouterIcon } from 'lucide-preact';
import { useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Choice } from '../parts/choice';
import { Badge, Empty, Fault, Loading, useDeed, type Tone } from '../parts/parts';
import { ago, count, metres, plural } from '../parts/words';
import { hashOf } from '../route';
import { ask } from '../wire/api';
import type { AccessPoint } from '../wire/map_shapes';
import { useAnswer } from '../wire/use_answer';

const kRows = 200;
const kStates: Record<AccessPoint['state'], [Tone, string]> = {
  ok: ['good', 'ok'], vanished: ['bad', 'vanished'], moved: ['bad', 'moved'], power_changed: ['warn', 'power changed'], new: ['info', 'new'],
};

/// What live traffic tells about each access point, and whether it may speak for a position.
export function AccessPoints() {
  const { building } = useBuilding();
  const path = `/v1/buildings/${building.id}/access-points?most=1000`;
  const { data, fault, loading, again } = useAnswer<{ items: AccessPoint[] }>(path, 15_000);
  const [shown, setShown] = useState<'attention' | 'all'>('attention');
  const [wanted, setWanted] = useState('');
  const all = data?.items ?? [];
  const attention = all.filter((one) => one.state !== 'ok' || one.quarantined || one.trust !== 'auto');
  const found = (shown === 'all' ? all : attention).filter((one) => one.bssid.includes(wanted.trim().toLowerCase()));
  return (
    <div class="sheet">
      <div class="sheet-head">
        <div><h1>Access points</h1><p>Live traffic shows which access points vanished, moved, changed their power or appeared. One that cannot be believed is left out of positions until it is surveyed again.</p></div>
      </div>
      <div class="card">
        <div class="card-head">
          <Choice name="Shown" value={shown} onChange={setShown} of={[['attention', `Need attention (${attention.length})`], ['all', `All (${all.length})`]]} />
          <span class="spring" />
          <input type="search" placeholder="Address" aria-label="Find by address" value={wanted} onInput={(event) => setWanted(event.currentTarget.value)} />
        </div>
        {fault && !data ? <div class="card-body"><Fault fault={fault} again={again} /></div> : loading ? <Loading what="the access points" />
          : found.length === 0 ? (
            <Empty icon={<RouterIcon />} title={all.length === 0 ? 'No access point yet' : wanted ? 'None with this address' : 'All access points are as surveyed'}>
              {all.length === 0 ? 'They come with the survey and with live traffic.' : ''}
            </Empty>
          ) : (
          <div class="scroll"><table class="stack">
            <thead><tr><th>Access point</th><th>Reason</th><th class="number">Heard by</th><th>Last heard</th><th>Trust</th><th>Survey again</th></tr></thead>
            <tbody>{found.slice(0, kRows).map((one) => <Row key={one.bssid} one={one} onChange={again} />)}</tbody>
          </table></div>
        )}
        {found.length > kRows && <div class="card-body"><p class="hint">The first {kRows} of {count(found.length)}. The search narrows the list.</p></div>}
      </div>
    </div>
  );
}

function Row({ one, onChange }: { one: AccessPoint; onChange: () => void }) {
  const { building, setFloor, say } = useBuilding();
  const { busy, run } = useDeed();
  const [tone, text] = kStates[one.state];
  const trust = (value: string) => run(async () => {
    try {
      await ask(`/v1/buildings/${building.id}/access-points/${one.bssid}`, { method: 'PUT', body: { trust: value } });
    } catch (error) {
      say('bad', (error as Error).message);
    }
    onChange();
  });
  const floors = [...new Set(one.resurvey.map((place) => place.floor))];
  return (
    <tr data-bssid={one.bssid}>
      <td>{one.on_map ? <a class="mono" href={hashOf(building.id, 'survey', one.bssid)} title="Where the survey heard it">{one.bssid}</a> : <span class="mono">{one.bssid}</span>}
        <span class="row tight"><Badge tone={tone}>{text}</Badge>{one.quarantined && <Badge tone="warn">left out</Badge>}{!one.on_map && <Badge>not surveyed</Badge>}</span></td>
      <td data-label="Reason" class="whole">{one.reason || '–'}
        {(one.distance_m !== null || one.change_db !== null) && (
          <span class="sub">{[one.distance_m !== null && `${metres(one.distance_m)} away`, one.change_db !== null && `${one.change_db > 0 ? '+' : ''}${one.change_db.toFixed(1)} dB`].filter(Boolean).join(', ')}</span>
        )}</td>
      <td class="number" data-label="Heard by">{count(one.heard_sessions)}</td>
      <td data-label="Last heard">{one.last_heard_us ? ago(one.last_heard_us) : 'never'}</td>
      <td data-label="Trust">
        <select aria-label={`Trust ${one.bssid}`} value={one.trust} disabled={busy} onChange={(event) => void trust(event.currentTarget.value)}>
          <option value="auto">As found</option><option value="always">Always</option><option value="never">Never</option>
        </select>
      </td>
      <td data-label="Survey again">{one.resurvey.length === 0 ? '–' : (
        <a href={hashOf(building.id, 'survey', one.bssid)} onClick={() => setFloor(floors[0]!)}>{plural(one.resurvey.length, 'place')}</a>
      )}</td>
    </tr>
  );
}
