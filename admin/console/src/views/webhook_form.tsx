import { useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Choice } from '../parts/choice';
import { Dialog, DialogHead, Fault, Loading, useDeed } from '../parts/parts';
import { request } from '../wire/api';
import type { Webhook } from '../wire/webhook_shapes';
import { useAnswer } from '../wire/use_answer';
import type { Zone } from '../wire/zone_shapes';

interface FormProps { webhook: Webhook | null; zones: Zone[]; onClose: () => void; onDone: (webhook: Webhook) => void }

export function WebhookForm({ webhook, zones, onClose, onDone }: FormProps) {
  const { building } = useBuilding();
  const base = `/v1/buildings/${building.id}/webhooks`;
  const [url, setUrl] = useState(webhook?.url ?? '');
  const [of, setOf] = useState<'all' | 'some'>(webhook?.zones.length ? 'some' : 'all');
  const [chosen, setChosen] = useState<number[]>(webhook?.zones ?? []);
  const [enabled, setEnabled] = useState(webhook?.enabled ?? true);
  const { busy, fault, run } = useDeed();
  const { etag, fault: unread } = useAnswer<Webhook>(webhook && `${base}/${webhook.id}`);
  const save = async () => {
    const body = { url: url.trim(), zones: of === 'all' ? [] : chosen, enabled };
    const { body: saved } = await request<Webhook>(webhook ? `${base}/${webhook.id}` : base, {
      method: webhook ? 'PUT' : 'POST', body, headers: etag ? { 'if-match': etag } : {},
    });
    onDone(saved);
  };
  const title = webhook ? 'Edit the webhook' : 'New webhook';
  return (
    <Dialog title={title} onClose={onClose}>
      <form onSubmit={(event) => { event.preventDefault(); void run(save); }}>
        <DialogHead title={title} onClose={onClose} />
        <label class="field"><span>Address</span>
          <input id="webhook-url" type="url" required maxLength={2048} autofocus placeholder="https://service.example/zones" value={url} onInput={(event) => setUrl(event.currentTarget.value)} />
          <small>HTTPS on a public address, unless the server’s configuration allows others (webhooks.private_targets).</small>
        </label>
        <Choice name="Zones" value={of} onChange={setOf} of={[['all', 'All zones'], ['some', 'Only these']]} />
        {of === 'some' && (
          <fieldset class="field"><legend>Zones</legend>
            {zones.length === 0 && <p class="hint">The building has no zone yet.</p>}
            {zones.map((zone) => (
              <label class="check" key={zone.id}>
                <input type="checkbox" checked={chosen.includes(zone.id)} onChange={() => setChosen(chosen.includes(zone.id) ? chosen.filter((one) => one !== zone.id) : [...chosen, zone.id])} />{zone.name}
              </label>
            ))}
          </fieldset>
        )}
        <label class="check"><input type="checkbox" checked={enabled} onChange={() => setEnabled(!enabled)} />Switched on</label>
        {webhook && !etag && !unread && <Loading what="the webhook" />}
        {(fault ?? unread) && <Fault fault={(fault ?? unread)!} />}
        <div class="row end">
          <button type="button" onClick={onClose}>Cancel</button>
          <button class="primary" disabled={busy || (webhook !== null && !etag) || (of === 'some' && chosen.length === 0)}>{webhook ? 'Save' : 'Create webhook'}</button>
        </div>
      </form>
    </Dialog>
  );
}
