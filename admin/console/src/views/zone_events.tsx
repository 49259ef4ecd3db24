import { Bell, LogIn, LogOut } from 'lucide-preact';
import { useStanding } from '../context';
import { Empty } from '../parts/parts';
import { clock, percent } from '../parts/words';

const kRows = 60;

/// Entries and exits as they happen, newest first. One that was taken back stays, struck out.
export function ZoneEvents() {
  const { zoneEvents } = useStanding();
  const takenBack = new Set(zoneEvents.map((event) => event.retracts).filter(Boolean));
  return (
    <section class="flush">
      <div class="side-head"><h2>Entries and exits</h2></div>
      {zoneEvents.length === 0 ? <Empty icon={<Bell />} title="Nothing happened yet">Events appear here while the console is open.</Empty> : (
        <ol class="list events" id="zone-events">
          {zoneEvents.slice(0, kRows).map((event) => (
            <li key={event.id ?? `${event.at_us} ${event.tracked} ${event.zone}`} class={event.id && takenBack.has(event.id) ? 'taken-back' : ''}>
              <span class="row">
                {event.transition === 'entered' ? <LogIn aria-label="entered" /> : <LogOut aria-label="left" />}
                <strong>{event.zone_name || event.zone}</strong>
                <span class="spring" /><time class="hint">{clock(event.at_us)}</time>
              </span>
              <span class="hint"><span class="mono">{event.tracked}</span> {event.transition}, {percent(event.probability)} inside
                {event.id && takenBack.has(event.id) ? ', taken back' : event.retracts ? ', takes an earlier event back' : ''}</span>
            </li>
          ))}
        </ol>
      )}
    </section>
  );
}
