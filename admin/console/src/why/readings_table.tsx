import { plural } from '../parts/words';
import type { ReadingExplained } from '../wire/explanation_shapes';

const kMostDb = 30;

interface ReadingsProps { readings: ReadingExplained[]; chosen: string | null; choose: (bssid: string | null) => void }

/// What was heard against what the survey holds around the position, the largest disagreement first. A press on an access point shows
/// where the survey heard it.
export function ReadingsTable({ readings, chosen, choose }: ReadingsProps) {
  return (
    <table class="dense">
      <thead><tr><th>Access point</th><th class="number">Heard, dBm</th><th class="number" title="Heard less what the survey holds around the position">Off by, dB</th></tr></thead>
      <tbody>
        {readings.map((one) => {
          const on = one.bssid === chosen;
          return (
            <tr key={one.bssid} data-name={one.bssid} class={on ? 'picked' : ''} onClick={() => choose(on ? null : one.bssid)}>
              <td><button class="link mono" aria-pressed={on} title="Show where the survey heard it">{one.bssid}</button>
                <span class="sub">{one.why ?? `${(one.age_us / 1e6).toFixed(1)} s old, ${one.surveyed_scans ? `${plural(one.surveyed_scans, 'scan')} near` : 'not near here'}`}</span></td>
              <td class="number">{one.heard_dbm.toFixed(0)}<span class="sub">{one.expected_dbm === null ? '–' : `of ${one.expected_dbm.toFixed(0)}`}</span></td>
              <td class="number">{one.residual_db === null ? '–' : <Residual db={one.residual_db} />}</td>
            </tr>
          );
        })}
      </tbody>
    </table>
  );
}

/// To the left: fainter than surveyed, to the right: louder.
function Residual({ db }: { db: number }) {
  const width = (Math.min(Math.abs(db), kMostDb) / kMostDb) * 30;
  return (
    <span class="residual">{db > 0 ? '+' : ''}{db.toFixed(1)}
      <svg width="62" height="8" viewBox="0 0 62 8" aria-hidden="true">
        <rect class={Math.abs(db) > 15 ? 'far' : ''} x={db < 0 ? 31 - width : 31} y="0" width={width} height="8" rx="2" /><line x1="31" x2="31" y1="0" y2="8" />
      </svg></span>
  );
}
