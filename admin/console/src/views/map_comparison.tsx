import { useBuilding } from '../context';
import { CdfChart, type Curve } from '../parts/cdf_chart';
import { Badge, Empty, Fault, Loading, type Tone } from '../parts/parts';
import { metres, percent } from '../parts/words';
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
  return <div class="field">{[...comparison.reasons, ...comparison.remarks].map((text) => <p class="hint" key={text}>{text[0]?.toUpperCase()}{text.slice(1)}.</p>)}</div>;
}

const kFigures: [string, (quality: Quality) => string][] = [
  ['Mean error', (quality) => metres(quality.mean_m, 2)],
  ['90 % within', (quality) => metres(quality.p90_m, 2)],
  ['Floor right', (quality) => percent(quality.floor_hit, 1)],
  ['In the 68 % circle', (quality) => percent(quality.in68)],
  ['In the 95 % circle', (quality) => percent(quality.in95)],
];

/// Error, floor and calibration, the live version's first: all walks together, then each.
function Walks({ comparison }: { comparison: Comparison }) {
  const all = { id: 0, name: 'All walks', candidate: comparison.candidate_quality, live: comparison.live_quality };
  return (
    <div class="scroll"><table class="dense stack">
      <thead><tr><th>Live → version {comparison.version}</th>{kFigures.map(([name]) => <th class="number" key={name}>{name}</th>)}</tr></thead>
      <tbody>
        {[all, ...comparison.walks].map((walk) => (
          <tr key={walk.id}>
            <td>{walk.id ? walk.name : <strong>{walk.name}</strong>}</td>
            {kFigures.map(([name, shown]) => (
              <td class="number" key={name} data-label={name}>{walk.live ? shown(walk.live) : '–'} → <strong>{walk.candidate ? shown(walk.candidate) : '–'}</strong></td>
            ))}
          </tr>
        ))}
      </tbody>
    </table></div>
  );
}
