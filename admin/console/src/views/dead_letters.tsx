import { MailX } from 'lucide-preact';
import { useBuilding } from '../context';
import { Dialog, DialogHead, Empty, Fault, Loading, useDeed } from '../parts/parts';
import { plural, when } from '../parts/words';
import { ask } from '../wire/api';
import type { DeadLetter, Webhook } from '../wire/webhook_shapes';
import { useAnswer } from '../wire/use_answer';

const kRows = 200;

/// Events nobody took, the newest first, and another try.
export function DeadLetters({ webhook, onClose }: { webhook: Webhook; onClose: () => void }) {
  const { building, say } = useBuilding();
  const path = `/v1/buildings/${building.id}/webhooks/${webhook.id}/dead-letters`;
  const { data, fault, loading, again } = useAnswer<{ dead_letters: DeadLetter[] }>(path);
  const { busy, fault: refused, run } = useDeed();
  const letters = [...(data?.dead_letters ?? [])].reverse();
  const retry = (event?: string) => run(async () => {
    const { retried } = await ask<{ retried: number }>(`${path}/retry${event ? `?event=${encodeURIComponent(event)}` : ''}`, { method: 'POST' });
    say('good', `${plural(retried, 'event')} on the way again.`);
    event ? again() : onClose();
  });
  return (
    <Dialog title="Dead letters" wide onClose={onClose}>
      <div class="dialog-body">
        <DialogHead title="Dead letters" onClose={onClose} />
        <p class="hint">Events that <span class="mono">{webhook.url}</span> did not take. They are kept in the server’s memory only: they say who was where.</p>
        {fault && !data ? <Fault fault={fault} again={again} /> : loading ? <Loading what="the dead letters" />
          : letters.length === 0 ? <Empty icon={<MailX />} title="None any more" /> : (
          <div class="scroll letters"><table class="dense">
            <thead><tr><th>Event of</th><th class="number">Attempts</th><th>Failure</th><th><span class="visually-hidden">Actions</span></th></tr></thead>
            <tbody>{letters.slice(0, kRows).map((one) => (
              <tr key={one.event} data-event={one.event}><td>{when(one.at_us)}</td><td class="number">{one.attempts}</td><td>{one.failure}</td><td class="actions"><button disabled={busy} onClick={() => retry(one.event)}>Try again</button></td></tr>
            ))}</tbody>
          </table></div>
        )}
        {refused && <Fault fault={refused} />}
        <div class="row end"><button onClick={onClose}>Close</button><button class="primary" disabled={busy || letters.length === 0} onClick={() => retry()}>Try all again</button></div>
      </div>
    </Dialog>
  );
}
