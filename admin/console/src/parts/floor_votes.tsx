import { percent } from './words';
import type { Floor } from '../wire/shapes';

/// How probable each floor is, at most four.
export function FloorVotes({ votes, floors }: { votes: { floor: number; probability: number }[]; floors: Floor[] }) {
  const label = (ordinal: number) => floors.find((one) => one.ordinal === ordinal)?.label || String(ordinal);
  return (
    <div class="bars">
      {votes.slice(0, 4).map(({ floor, probability }) => (
        <div class="bar" key={floor}>
          <span>{label(floor)}</span>
          <meter min={0} max={1} value={probability} aria-label={`Floor ${label(floor)}`} />
          <span>{percent(probability)}</span>
        </div>
      ))}
    </div>
  );
}
