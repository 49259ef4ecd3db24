import { History } from 'lucide-preact';
import { useBuilding } from '../context';
import { Badge, Empty, Fault, Loading } from '../parts/parts';
import { when } from '../parts/words';
import type { Key } from '../wire/shapes';
import type { Publication } from '../wire/map_shapes';
import { useAnswer } from '../wire/use_answer';

/// Who put which version in force when, and why.
export function Publications({ round }: { round: number }) {
  const { building } = useBuilding();
  const { data, fault, loading, again } = useAnswer<{ items: Publication[] }>(`/v1/buildings/${building.id}/maps/publications?most=1000&round=${round}`);
  const keys = useAnswer<{ keys: Key[] }>('/v1/keys');
  const who = (id: number) => (id === 0 ? 'the server' : keys.data?.keys.find((key) => key.id === id)?.name ?? `key ${id}`);
  const newest = [...(data?.items ?? [])].sort((a, b) => b.id - a.id);
  return (
    <div class="card">
      <div class="card-head"><h2>History</h2></div>
      {fault && !data ? <div class="card-body"><Fault fault={fault} again={again} /></div> : loading ? <Loading what="the history" />
        : newest.length === 0 ? <Empty icon={<History />} title="Nothing was put in force yet" /> : (
        <ol class="list">
          {newest.slice(0, 50).map((entry) => (
            <li key={entry.id}>
              <span class="row"><strong>Version {entry.version}</strong><Badge tone={entry.act === 'promoted' ? 'good' : 'warn'}>{entry.act === 'promoted' ? 'promoted' : 'rolled back to'}</Badge></span>
              <span class="hint">{when(entry.at_us)} by {who(entry.by_key)}</span>
              {entry.reason && <span>{entry.reason}</span>}
            </li>
          ))}
        </ol>
      )}
    </div>
  );
}
