import { Badge, type Tone } from '../parts/parts';
import { count } from '../parts/words';
import type { RadioMap, SurveyDevice } from '../wire/map_shapes';

const standings: Record<SurveyDevice['standing'], { tone?: Tone; word: string; why: string }> = {
  reference: { word: 'reference', why: 'Surveyed most: the others are brought to its level.' },
  learnt: { tone: 'good', word: 'levelled', why: 'Its offset is taken out of its readings.' },
  agrees: { word: 'hears alike', why: 'Within 1 dB: its readings stay as they are.' },
  unknown: { tone: 'warn', word: 'not levelled', why: 'Too little ground shared with the others: its readings stay as they are. Survey some 20 m that another model surveyed with it as well.' },
};

const decibel = (value: number) => `${value > 0 ? '+' : value < 0 ? '−' : ''}${Math.abs(value).toFixed(1)} dB`;

/// The phone models that surveyed a version, and what the map takes out of their readings; nothing to say of a single one.
export function SurveyDevices({ map }: { map: RadioMap }) {
  if (map.devices.length < 2) return null;
  return (
    <div class="card" data-part="devices">
      <div class="card-head"><h2>Phones that surveyed version {map.version}</h2></div>
      <div class="scroll"><table class="stack">
        <thead><tr><th>Model</th><th class="number">Points</th><th>Standing</th><th class="number" title="Louder than the reference">Offset</th><th class="number">Shared ground</th></tr></thead>
        <tbody>{map.devices.map((device) => <Device key={device.model} device={device} />)}</tbody>
      </table></div>
    </div>
  );
}

function Device({ device }: { device: SurveyDevice }) {
  const standing = standings[device.standing];
  return (
    <tr data-device={device.model}>
      <td><strong>{device.model || 'not named'}</strong></td>
      <td class="number" data-label="Points">{count(device.points)}</td>
      <td data-label="Standing"><Badge tone={standing.tone}>{standing.word}</Badge><span class="sub">{standing.why}</span></td>
      <td class="number" data-label="Offset">{device.standing === 'learnt' || device.standing === 'agrees' ? decibel(device.offset_db) : '–'}</td>
      <td class="number" data-label="Shared ground">{device.standing === 'reference' ? '–' : <>{count(device.places)} places<span class="sub">{count(device.transmitters)} access points</span></>}</td>
    </tr>
  );
}
