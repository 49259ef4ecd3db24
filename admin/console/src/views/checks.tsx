import { Badge, type Tone } from '../parts/parts';
import type { Check } from '../wire/plan_shapes';

const kTones: Record<Check['severity'], Tone> = { error: 'bad', warning: 'warn', note: '' };

/// What the server found in a file, the worst first.
export function Checks({ checks }: { checks: Check[] }) {
  if (checks.length === 0) return <p class="hint">Nothing to complain of.</p>;
  return (
    <ul class="checks">
      {checks.slice(0, 100).map((check, i) => (
        <li key={i}><Badge tone={kTones[check.severity]}>{check.severity}</Badge><span>{check.detail}{check.feature && <span class="hint"> ({check.feature})</span>}</span></li>
      ))}
      {checks.length > 100 && <li class="hint">and {checks.length - 100} more</li>}
    </ul>
  );
}
