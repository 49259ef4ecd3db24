import { useBuilding } from '../context';
import { CdfChart, type Curve } from '../parts/cdf_chart';
import { Badge, Empty, Fault, Loading, type Tone } from '../parts/parts';
import { metres } from '../parts/words';
import type { Comparison, Quality, RadioMap } from '../wire/map_shapes';
import { useAnswer } from '../wire/use_answer';

const kTones: Record<Comparison['verdict'], Tone> = { better: 'good', same: 'info', worse: 'bad', unknown: 'warn' };

/// The live version's errors, and beside them those of the one picked.
export function MapComparison({ maps, version, round }: { maps: RadioMap[]; version: number | null; round: number }) {
  const { building } = useBuilding();
  const live = maps.find((map) => map.live);
  const path = version === null ? null : `/v1/buildings/${building.id}/maps/${version}/comparison?round=${round}`;
  const { data, fault, loading, again } = useAnswer<Comparison>(path);
  const curves = [
    curveOf(live && `Version ${live.version}, live`, data?.live_quality ?? live?.quality ?? null, 'live'),
    curveOf(version !== null && `Version ${version}`, data?.candidate_quality ?? maps.find((map) => map.version === version)?.quality ?? null, 'other'),
  ].filter((curve): curve is Curve => curve !== null);
  return (
    <div class="card">
      <div class="card-head">
        <h2>{version === null ? 'Measured error' : `Version ${version} against ${live ? `version ${live.version}, live` : 'nothing: no version is live'}`}</h2>
        {data && <Badge tone={kTones[data.verdict]}>{data.verdict}</Badge>}
      </div>
      <div class="card-body">
        {curves.length > 0 ? <CdfChart curves={curves} /> : !loading && (
          <Empty title="Not measured yet">Add quality walks (recordings with known truth) below: every version is then replayed against them.</Empty>
        )}
        {loading && <><p class="hint">Replaying the quality walks …</p><Loading what="the comparison" /></>}
        {fault && <Fault fault={fault} again={again} />}
        {data && <Verdict comparison={data} />}
      </div>
      {data && data.walks.length > 0 && <Walks comparison={data} />}
    </div>
  );
}

function curveOf(name: string | false | undefined, quality: Quality | null, tone: Curve['tone']): Curve | null {
  return name && quality?.error_quantiles_m?.length === 101 ? { name, quantiles: quality.error_quantiles_m, tone } : null;
}

function Verdict({ comparison }: { comparison: Comparison }) {
  const { mean_difference_m: mean, mean_difference_low_m: low, mean_difference_high_m: high } = comparison;
  return (
    <div class="field">
      {mean !== null && (
        <p>Mean error {mean < 0 ? 'falls' : 'grows'} by <strong>{metres(Math.abs(mean), 2)}</strong>
          {low !== null && high !== null && <span class="hint"> (95 % interval of the difference {low.toFixed(2)} to {high.toFixed(2)} m)</span>}</p>
      )}
      {[...comparison.reasons, ...comparison.remarks].map((text) => <p class="hint" key={text}>{text}</p>)}
    </div>
  );
}

function Walks({ comparison }: { comparison: Comparison }) {
  return (
    <div class="scroll"><table class="dense">
      <thead><tr><th>Quality walk</th><th class="number">Live mean</th><th class="number">This mean</th><th class="number">Difference</th></tr></thead>
      <tbody>
        {comparison.walks.map((walk) => {
          const difference = walk.candidate && walk.live ? walk.candidate.mean_m - walk.live.mean_m : null;
          return (
            <tr key={walk.id}>
              <td>{walk.name}</td>
              <td class="number">{metres(walk.live?.mean_m, 2)}</td>
              <td class="number">{metres(walk.candidate?.mean_m, 2)}</td>
              <td class="number">{difference === null ? '–' : `${difference > 0 ? '+' : ''}${difference.toFixed(2)} m`}</td>
            </tr>
          );
        })}
      </tbody>
    </table></div>
  );
}
