import { History } from 'lucide-preact';
import { useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Badge, Confirm, Empty, Fault, Loading } from '../parts/parts';
import { bytes, count, span, when } from '../parts/words';
import { go, hashOf } from '../route';
import { ask } from '../wire/api';
import type { Recording } from '../wire/replay_shapes';
import { useAnswer } from '../wire/use_answer';
import { RecordingOrder } from './recording_order';

/// What was recorded, the newest first.
export function RecordingList() {
  const { building, say } = useBuilding();
  const base = `/v1/buildings/${building.id}/recordings`;
  const { data, fault, loading, again } = useAnswer<{ recordings: Recording[] }>(`${base}?most=1000`, 3000);
  const [erasing, setErasing] = useState(false);
  const newest = [...(data?.recordings ?? [])].sort((a, b) => b.begun_at_us - a.begun_at_us);
  return (
    <>
      <RecordingOrder onChange={again} />
      <section class="flush">
        <div class="side-head"><h2>Recordings <span class="badge">{newest.length}</span></h2>
          {newest.length > 0 && <button class="danger" onClick={() => setErasing(true)}>Erase all</button>}</div>
        {fault && !data ? <div class="card-body"><Fault fault={fault} again={again} /></div> : loading ? <Loading what="the recordings" />
          : newest.length === 0 ? <Empty icon={<History />} title="Nothing is recorded">Switch the recorder on; sessions appear here as they are recorded.</Empty> : (
          <table class="dense">
            <thead><tr><th>Phone</th><th>Begun</th><th class="number">Length</th></tr></thead>
            <tbody id="recordings">
              {newest.slice(0, 200).map((one) => (
                <tr key={one.id} data-name={one.tracked} onClick={() => go(building.id, 'replay', String(one.id))}>
                  <td><a class="mono" href={hashOf(building.id, 'replay', String(one.id))}>{one.tracked}</a>
                    <span class="sub">{one.device_model || 'model not said'}, {count(one.samples)} samples, {bytes(one.bytes)}</span></td>
                  <td>{when(one.begun_at_us)}</td>
                  <td class="number">{span((one.ended_at_us - one.begun_at_us) / 1e6)}{one.growing && <span class="sub"><Badge tone="info">growing</Badge></span>}</td>
                </tr>
              ))}
            </tbody>
          </table>
        )}
      </section>
      {erasing && (
        <Confirm title="Erase all recordings?" act="Erase" danger onClose={() => setErasing(false)}
          onConfirm={async () => { await ask(base, { method: 'DELETE' }); say('good', 'The recordings are erased.'); again(); }}>
          For good. Sessions under way are not recorded any more until the recorder is switched on again.
        </Confirm>
      )}
    </>
  );
}
