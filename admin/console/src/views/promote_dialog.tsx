import { useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Dialog, DialogHead, Fault, useDeed } from '../parts/parts';
import { ask } from '../wire/api';
import type { RadioMap } from '../wire/map_shapes';

interface PromoteProps { map: RadioMap; live: number | null; onClose: () => void; onDone: () => void }

/// Puts a version in force. The server refuses one that is worse; then the operator may override, with a reason.
export function PromoteDialog({ map, live, onClose, onDone }: PromoteProps) {
  const { building } = useBuilding();
  const [reason, setReason] = useState('');
  const [override, setOverride] = useState(false);
  const { busy, fault, run } = useDeed();
  const worse = fault?.status === 409;
  const promote = async () => {
    await ask(`/v1/buildings/${building.id}/maps/${map.version}/promotion`, { method: 'POST', body: { expected_live: live, override, reason: reason.trim() } });
    onDone();
  };
  const title = `Put version ${map.version} in force?`;
  return (
    <Dialog title={title} onClose={onClose}>
      <form onSubmit={(event) => { event.preventDefault(); void run(promote); }}>
        <DialogHead title={title} onClose={onClose} />
        <p class="hint">The server replays the quality walks first and refuses a version that is worse than {live ? `version ${live}` : 'what is in force'}. New sessions
          are positioned by it at once; sessions under way keep the map they began with.</p>
        <label class="field"><span>Reason</span>
          <textarea id="promotion-reason" required maxLength={1024} placeholder="Second survey of the east wing" value={reason} onInput={(event) => setReason(event.currentTarget.value)} />
        </label>
        {fault && <Fault fault={fault} />}
        {worse && (
          <label class="check"><input type="checkbox" checked={override} onChange={() => setOverride(!override)} />Put it in force all the same. The reason goes into the history.</label>
        )}
        <div class="row end">
          <button type="button" onClick={onClose}>Cancel</button>
          <button class={`primary ${override ? 'danger' : ''}`} disabled={busy || (worse && !override)}>{busy ? 'Replaying …' : override ? 'Override and promote' : 'Promote'}</button>
        </div>
      </form>
    </Dialog>
  );
}
