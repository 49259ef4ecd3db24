import { Badge, Facts, Notice } from '../parts/parts';
import { FloorVotes } from '../parts/floor_votes';
import { metres, plural } from '../parts/words';
import type { Explanation } from '../wire/explanation_shapes';
import type { Floor } from '../wire/shapes';
import { toneOf } from '../parts/tones';
import { ReadingsTable } from './readings_table';

interface PanelProps { explanation: Explanation; floors: Floor[]; chosen: string | null; choose: (bssid: string | null) => void }

/// What a position rests on, in words: how sure and why not surer, floor votes, every reading.
export function ExplanationPanel({ explanation, floors, chosen, choose }: PanelProps) {
  const { position, integrity, used, rejected } = explanation;
  return (
    <>
      <section>
        <Facts big facts={[['68 % within', metres(position.radius68_m)], ['95 % within', metres(position.radius95_m)]]} />
        <Facts facts={[
          ['Radio evidence', <Badge tone={toneOf(integrity.state)}>{integrity.state}</Badge>],
          ['Newest scan', `${(explanation.scan_age_us / 1e6).toFixed(1)} s old`],
          ['Since then', plural(explanation.steps_since_scan, 'step')],
          ['Surveyed near', plural(explanation.surveyed_points_near, 'point')],
          ['Pipeline', explanation.pipeline],
          ['Radio map', `version ${position.radio_map_version}`],
          ...(explanation.gnss ? [['Satellites', 'took part'] as [string, string]] : []),
        ]} />
        {integrity.reasons.map((reason) => <Notice tone={integrity.state === 'ok' ? '' : 'warn'} key={reason}>{reason}</Notice>)}
        {explanation.remarks?.map((remark) => <Notice key={remark}>{remark}</Notice>)}
        <h3>Floor votes</h3>
        <FloorVotes votes={explanation.floor_votes} floors={floors} />
      </section>
      <section class="flush">
        <div class="side-head"><h2>Access points used <span class="badge">{used.length}</span></h2></div>
        {used.length ? <ReadingsTable readings={used} chosen={chosen} choose={choose} /> : <p class="hint">None: the position rests on steps and heading alone.</p>}
      </section>
      {rejected.length > 0 && (
        <section class="flush">
          <div class="side-head"><h2>Heard, left out <span class="badge">{rejected.length}</span></h2></div>
          <ReadingsTable readings={rejected} chosen={chosen} choose={choose} />
        </section>
      )}
    </>
  );
}
