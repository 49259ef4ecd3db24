import { Pencil, Trash2, X } from 'lucide-preact';
import { useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Confirm, Facts, Fault } from '../parts/parts';
import { ago, metres, percent, span } from '../parts/words';
import { ask } from '../wire/api';
import type { Occupant, Zone } from '../wire/zone_shapes';
import { useAnswer } from '../wire/use_answer';

export const lasting = (us: number | null) => (us === null ? 'for ever' : span(us / 1e6));

/// One zone: its tolerances, and who is inside.
export function ZoneCard({ zone, onEdit, onClose, onRemoved }: { zone: Zone; onEdit: () => void; onClose: () => void; onRemoved: () => void }) {
  const { building } = useBuilding();
  const path = `/v1/buildings/${building.id}/zones/${zone.id}`;
  const inside = useAnswer<{ occupants: Occupant[] }>(`${path}/occupants`, 3000);
  const [removing, setRemoving] = useState(false);
  const occupants = inside.data?.occupants ?? [];
  return (
    <section>
      <div class="side-head"><h2>{zone.name}</h2>
        <button onClick={onEdit}><Pencil />Edit</button>
        <button class="danger" aria-label={`Remove ${zone.name}`} onClick={() => setRemoving(true)}><Trash2 /></button>
        <button class="quiet" aria-label="Close" onClick={onClose}><X /></button></div>
      <Facts big facts={[['Phones inside', inside.data ? occupants.length : '–']]} />
      {inside.fault && <Fault fault={inside.fault} again={inside.again} />}
      {occupants.length > 0 && (
        <div class="bars">
          {occupants.slice(0, 20).map((one) => (
            <div class="bar level" key={one.tracked}>
              <span class="mono clip" title={`since ${ago(one.since_us)}`}>{one.tracked}</span>
              <meter min={0} max={1} value={one.probability} aria-label={`${one.tracked} is inside`} />
              <span>{percent(one.probability)}</span>
            </div>
          ))}
        </div>
      )}
      <Facts facts={[
        ['Exit tolerance', metres(zone.exit_tolerance_m)],
        ['Tolerated', lasting(zone.tolerance_timeout_us)],
        ['Exit delay', lasting(zone.exit_delay_us)],
        ['Left when unheard', zone.timeout_us === null ? 'never' : `after ${lasting(zone.timeout_us)}`],
      ]} />
      {removing && (
        <Confirm title={`Remove “${zone.name}”?`} act="Remove" danger onClose={() => setRemoving(false)}
          onConfirm={async () => { await ask(path, { method: 'DELETE' }); onRemoved(); }}>
          Nobody is told of entries and exits here any more.
        </Confirm>
      )}
    </section>
  );
}
