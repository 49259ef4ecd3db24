import { Waypoints } from 'lucide-preact';
import type { Phone } from '../live/phones';
import { Badge, Facts } from '../parts/parts';
import { FloorVotes } from '../parts/floor_votes';
import { toneOf } from '../parts/tones';
import { ago, metres, plural } from '../parts/words';
import { hashOf } from '../route';
import type { Floor, Session } from '../wire/shapes';

/// One phone: where, how sure, and on what grounds.
export function PhoneCard({ phone, session, floors }: { phone: Phone; session: Session | null; floors: Floor[] }) {
  const { position } = phone;
  const { from } = position;
  return (
    <>
      <Facts big facts={[
        ['68 % within', metres(position.radius68_m)],
        ['95 % within', metres(position.radius95_m)],
      ]} />
      <Trend values={phone.radii} />
      <Facts facts={[
        ['Radio evidence', <Badge tone={phone.gone ? '' : toneOf(position.integrity)}>{phone.gone ? 'gone' : position.integrity}</Badge>],
        ['Heard', ago(phone.receivedUs)],
        ['Place', `${position.place.x_m.toFixed(1)}, ${position.place.y_m.toFixed(1)} m`],
        ['Speed', `${position.speed_mps.toFixed(1)} m/s`],
        ['Heading', `${position.azimuth_deg.toFixed(0)}° ± ${position.azimuth_sigma_deg.toFixed(0)}°`],
        ['Radio map', `version ${position.radio_map_version}`],
      ]} />
      <h3>Floor votes</h3>
      <FloorVotes votes={position.floors} floors={floors} />
      <h3>What the fix rests on</h3>
      <Facts facts={[
        ['Access points used', from.transmitters_used],
        ['Heard, not on the map', from.transmitters_unknown],
        ['Newest reading', `${(from.scan_age_us / 1e6).toFixed(1)} s old`],
        ['Since then', plural(from.steps_since_scan, 'step')],
        ...(from.gnss ? [['Satellites', 'took part'] as [string, string]] : []),
      ]} />
      <div><a class="button" href={hashOf(position.building, 'sessions', phone.name)}><Waypoints />Why is it here?</a></div>
      {session && (
        <>
          <h3>Session</h3>
          <Facts facts={[
            ['Model', session.device_model || 'not said'],
            ['App', session.app || 'not said'],
            ['Pipeline', session.pipeline],
            ['Since', ago(session.since_us)],
          ]} />
        </>
      )}
    </>
  );
}

/// The 68 % radius over the last positions.
function Trend({ values }: { values: number[] }) {
  if (values.length < 3) return null;
  const [width, height] = [320, 40];
  const most = Math.max(...values, 1);
  const path = values.map((value, i) => `${((i / (values.length - 1)) * width).toFixed(1)},${(height - 2 - (value / most) * (height - 6)).toFixed(1)}`).join(' ');
  return (
    <figure>
      <svg viewBox={`0 0 ${width} ${height}`} width="100%" height={height} preserveAspectRatio="none" role="img"
        aria-label={`68 % radius over the last ${values.length} positions: ${Math.min(...values).toFixed(1)} to ${most.toFixed(1)} metres`}>
        <polyline points={`0,${height} ${path} ${width},${height}`} fill="var(--accent)" opacity=".12" />
        <polyline points={path} fill="none" stroke="var(--accent)" stroke-width="1.75" vector-effect="non-scaling-stroke" />
      </svg>
    </figure>
  );
}
