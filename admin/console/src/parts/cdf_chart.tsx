import { metres } from './words';

export interface Curve { name: string; quantiles: number[]; tone: 'live' | 'other' }   // 101 numbers: the error at 0..100 %

const [kWidth, kHeight] = [640, 300];
const kFrame = { left: 44, right: 16, top: 12, bottom: 34 };
const kGridShares = [0, 25, 50, 68, 90, 95, 100];

function stepFor(most: number): number {
  return [0.5, 1, 2, 5, 10, 20, 50, 100].find((step) => most / step <= 8) ?? 200;
}

/// Cumulative distributions of the error: what share of all instants lies within so many metres.
export function CdfChart({ curves }: { curves: Curve[] }) {
  const furthest = Math.max(1, ...curves.map((curve) => curve.quantiles[98] ?? 0));
  const step = stepFor(furthest);
  const most = Math.ceil(furthest / step) * step;
  const x = (error: number) => kFrame.left + (Math.min(error, most) / most) * (kWidth - kFrame.left - kFrame.right);
  const y = (share: number) => kHeight - kFrame.bottom - (share / 100) * (kHeight - kFrame.top - kFrame.bottom);
  const marks = Array.from({ length: Math.round(most / step) + 1 }, (_, i) => i * step);
  const line = (curve: Curve) => curve.quantiles.map((error, share) => `${x(error).toFixed(1)},${y(share).toFixed(1)}`).join(' ');
  const said = curves.map((curve) => `${curve.name}: half within ${metres(curve.quantiles[50])}, 90 % within ${metres(curve.quantiles[90])}`).join('; ');
  return (
    <figure class="chart">
      <svg viewBox={`0 0 ${kWidth} ${kHeight}`} role="img" aria-label={`Error distribution. ${said}`}>
        {kGridShares.map((share) => (
          <g key={share}>
            <line class="grid" x1={kFrame.left} x2={kWidth - kFrame.right} y1={y(share)} y2={y(share)} />
            {share !== 95 && share !== 68 && <text class="axis" x={kFrame.left - 8} y={y(share) + 4} text-anchor="end">{share} %</text>}
          </g>
        ))}
        {marks.map((error) => <text class="axis" key={error} x={x(error)} y={kHeight - 14} text-anchor="middle">{error} m</text>)}
        {curves.map((curve) => <polyline class={`curve ${curve.tone}`} key={curve.name} points={line(curve)} />)}
      </svg>
      <figcaption class="row">
        {curves.map((curve) => (
          <span class="row tight" key={curve.name}>
            <svg width="22" height="8" aria-hidden="true"><line class={`curve ${curve.tone}`} x1="0" x2="22" y1="4" y2="4" /></svg>{curve.name}
          </span>
        ))}
        <span class="hint">Share of all instants of the quality walks within an error</span>
      </figcaption>
    </figure>
  );
}
