import { Plus, Webhook as WebhookIcon } from 'lucide-preact';
import { useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Badge, Confirm, Empty, Fault, Loading } from '../parts/parts';
import { ShownOnce } from '../parts/shown_once';
import { count, when } from '../parts/words';
import { ask } from '../wire/api';
import type { Webhook } from '../wire/webhook_shapes';
import type { Zone } from '../wire/zone_shapes';
import { useAnswer } from '../wire/use_answer';
import { DeadLetters } from './dead_letters';
import { Deliveries } from './deliveries';
import { WebhookForm } from './webhook_form';

type Open = { kind: 'form'; webhook: Webhook | null } | { kind: 'letters' | 'deliveries' | 'remove'; webhook: Webhook } | { kind: 'secret'; secret: string } | null;

/// Where zone events are posted to, and how that goes.
export function Webhooks() {
  const { building, say } = useBuilding();
  const base = `/v1/buildings/${building.id}/webhooks`;
  const { data, fault, loading, again } = useAnswer<{ webhooks: Webhook[] }>(`${base}?most=1000`, 3000);
  const zones = useAnswer<{ zones: Zone[] }>(`/v1/buildings/${building.id}/zones?most=1000`);
  const [open, setOpen] = useState<Open>(null);
  const close = () => { setOpen(null); again(); };
  const nameOf = (id: number) => zones.data?.zones.find((zone) => zone.id === id)?.name ?? `zone ${id}`;
  return (
    <div class="sheet">
      <div class="sheet-head">
        <div><h1>Webhooks</h1><p>Entries into zones and exits are posted to these addresses, signed. What is not taken is tried again for a while, then kept as a dead letter.</p></div>
        <button class="primary" onClick={() => setOpen({ kind: 'form', webhook: null })}><Plus />New webhook</button>
      </div>
      <div class="card">
        {fault && !data ? <div class="card-body"><Fault fault={fault} again={again} /></div> : loading ? <Loading what="the webhooks" />
          : data?.webhooks.length === 0 ? <Empty icon={<WebhookIcon />} title="No webhook yet">Add the address of a service that is to hear who enters and leaves zones.</Empty> : (
          <div class="scroll"><table class="stack">
            <thead><tr><th>Address</th><th>Zones</th><th class="number">Delivered</th><th class="number">Waiting</th><th class="number">Failed attempts</th><th class="number">Dead letters</th><th><span class="visually-hidden">Actions</span></th></tr></thead>
            <tbody>{data?.webhooks.map((one) => <Row key={one.id} one={one} nameOf={nameOf} open={setOpen} />)}</tbody>
          </table></div>
        )}
      </div>
      {open?.kind === 'form' && (
        <WebhookForm webhook={open.webhook} zones={zones.data?.zones ?? []} onClose={close}
          onDone={(made) => { if (made.secret) { setOpen({ kind: 'secret', secret: made.secret }); again(); } else { say('good', 'The webhook is changed.'); close(); } }} />
      )}
      {open?.kind === 'secret' && (
        <ShownOnce title="Webhook created" secret={open.secret} onClose={close}
          notice="This is the only time the secret is shown. The receiver verifies each message with it (Standard Webhooks)." />
      )}
      {open?.kind === 'letters' && <DeadLetters webhook={open.webhook} onClose={close} />}
      {open?.kind === 'deliveries' && <Deliveries webhook={open.webhook} onClose={close} />}
      {open?.kind === 'remove' && (
        <Confirm title="Remove this webhook?" act="Remove" danger onClose={close}
          onConfirm={async () => { await ask(`${base}/${open.webhook.id}`, { method: 'DELETE' }); say('good', 'The webhook is removed.'); }}>
          <span class="mono">{open.webhook.url}</span> hears of nothing any more. What waits for it and its dead letters are dropped.
        </Confirm>
      )}
    </div>
  );
}

function Row({ one, nameOf, open }: { one: Webhook; nameOf: (id: number) => string; open: (what: Open) => void }) {
  return (
    <tr data-webhook={one.id}>
      <td><span class="mono address">{one.url}</span>
        <span class="sub">{one.enabled ? `since ${when(one.created_at_us)}` : <Badge>switched off</Badge>}</span>
        {one.last_failure && <span class="sub">Last failure: {one.last_failure}</span>}</td>
      <td data-label="Zones" class="whole">{one.zones.length ? one.zones.map(nameOf).join(', ') : 'All zones'}</td>
      <td class="number" data-label="Delivered">{count(one.delivered)}</td>
      <td class="number" data-label="Waiting">{count(one.waiting)}</td>
      <td class="number" data-label="Failed attempts">{count(one.failed_attempts)}</td>
      <td class="number" data-label="Dead letters">{one.dead_letters ? <Badge tone="bad">{count(one.dead_letters)}</Badge> : 0}
        {one.dropped > 0 && <span class="sub">{count(one.dropped)} more dropped</span>}</td>
      <td class="actions"><span class="row end">
        {one.dead_letters > 0 && <button onClick={() => open({ kind: 'letters', webhook: one })}>Dead letters</button>}
        <button onClick={() => open({ kind: 'deliveries', webhook: one })}>Deliveries</button>
        <button onClick={() => open({ kind: 'form', webhook: one })}>Edit</button>
        <button class="danger" onClick={() => open({ kind: 'remove', webhook: one })}>Remove</button>
      </span></td>
    </tr>
  );
}
