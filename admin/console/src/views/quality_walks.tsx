import { Footprints, Upload } from 'lucide-preact';
import { useRef, useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Confirm, Empty, Fault, Loading, useDeed } from '../parts/parts';
import { bytes, when } from '../parts/words';
import { ask } from '../wire/api';
import type { QualityWalk } from '../wire/map_shapes';
import { useAnswer } from '../wire/use_answer';

/// Recorded walks with known truth: what every version is measured by.
export function QualityWalks({ onChange }: { onChange: () => void }) {
  const { building, say } = useBuilding();
  const base = `/v1/buildings/${building.id}/quality-walks`;
  const { data, fault, loading, again } = useAnswer<{ items: QualityWalk[] }>(`${base}?most=1000`);
  const [removing, setRemoving] = useState<QualityWalk | null>(null);
  const { busy, fault: refused, run } = useDeed();
  const picker = useRef<HTMLInputElement>(null);
  const add = (files: File[]) => run(async () => {
    try {
      for (const file of files) await ask(`${base}?name=${encodeURIComponent(file.name.replace(/\.[^.]*$/, ''))}`, { method: 'POST', raw: file, type: 'application/x-ndjson' });
      say('good', files.length === 1 ? 'The walk is added.' : `${files.length} walks are added.`);
    } finally {
      again();
      onChange();
    }
  });
  return (
    <div class="card">
      <div class="card-head"><h2>Quality walks</h2>
        <input ref={picker} type="file" multiple hidden aria-label="Recordings" onChange={(event) => { void add([...(event.currentTarget.files ?? [])]); event.currentTarget.value = ''; }} />
        <button disabled={busy} onClick={() => picker.current?.click()}><Upload />{busy ? 'Adding …' : 'Add recordings'}</button>
      </div>
      {refused && <div class="card-body"><Fault fault={refused} /></div>}
      {fault && !data ? <div class="card-body"><Fault fault={fault} again={again} /></div> : loading ? <Loading what="the quality walks" />
        : data?.items.length === 0 ? <Empty icon={<Footprints />} title="No quality walk">Record a walk with marked way points (the SDK’s recording), and add it here. It is never used for the map itself.</Empty> : (
        <table class="dense">
          <thead><tr><th>Name</th><th>Recorded</th><th class="number">Size</th><th><span class="visually-hidden">Actions</span></th></tr></thead>
          <tbody>{data?.items.map((walk) => (
            <tr key={walk.id}><td>{walk.name}<span class="sub">{walk.device_model || 'model not said'}</span></td><td>{when(walk.recorded_at_us)}</td><td class="number">{bytes(walk.bytes)}</td>
              <td class="actions"><button class="danger" aria-label={`Remove ${walk.name}`} onClick={() => setRemoving(walk)}>Remove</button></td></tr>
          ))}</tbody>
        </table>
      )}
      {removing && (
        <Confirm title={`Remove “${removing.name}”?`} act="Remove" danger onClose={() => setRemoving(null)}
          onConfirm={async () => { await ask(`${base}/${removing.id}`, { method: 'DELETE' }); again(); onChange(); }}>
          What was measured by it goes too.
        </Confirm>
      )}
    </div>
  );
}
