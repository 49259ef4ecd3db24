import { Send } from 'lucide-preact';
import { useBuilding } from '../context';
import { Badge, Dialog, DialogHead, Empty, Fault, Loading } from '../parts/parts';
import { when } from '../parts/words';
import type { Delivery, Webhook } from '../wire/webhook_shapes';
import { useAnswer } from '../wire/use_answer';

const outcomes = { delivered: { tone: 'good', word: 'delivered' }, waits: { tone: 'warn', word: 'tried again' }, dead: { tone: 'bad', word: 'dead letter' } } as const;

/// The newest attempts at one webhook, and what came of each.
export function Deliveries({ webhook, onClose }: { webhook: Webhook; onClose: () => void }) {
  const { building } = useBuilding();
  const { data, fault, loading, again } = useAnswer<{ deliveries: Delivery[] }>(`/v1/buildings/${building.id}/webhooks/${webhook.id}/deliveries`, 3000);
  return (
    <Dialog title="Deliveries" wide onClose={onClose}>
      <div class="dialog-body">
        <DialogHead title="Deliveries" onClose={onClose} />
        <p class="hint">The newest 200 attempts at <span class="mono">{webhook.url}</span>, kept in the server’s memory only.</p>
        {fault && !data ? <Fault fault={fault} again={again} /> : loading ? <Loading what="the deliveries" />
          : data?.deliveries.length === 0 ? <Empty icon={<Send />} title="Nothing sent yet">An attempt stands here once a phone enters or leaves a zone.</Empty> : (
          <div class="scroll letters"><table class="dense">
            <thead><tr><th>Sent</th><th>Event</th><th class="number">Attempt</th><th class="number">Answer</th><th class="number">Took</th><th>Outcome</th></tr></thead>
            <tbody>{data?.deliveries.map((one) => (
              <tr key={`${one.event} ${one.attempt} ${one.at_us}`} data-delivery={one.event}>
                <td>{when(one.at_us)}</td><td class="mono">{one.event}</td><td class="number">{one.attempt}</td>
                <td class="number">{one.status ?? 'none'}</td><td class="number">{Math.round(one.took_us / 1000)} ms</td>
                <td><Badge tone={outcomes[one.outcome].tone}>{outcomes[one.outcome].word}</Badge>{one.failure && <span class="sub">{one.failure}</span>}</td>
              </tr>
            ))}</tbody>
          </table></div>
        )}
        <div class="row end"><button onClick={onClose}>Close</button></div>
      </div>
    </Dialog>
  );
}
