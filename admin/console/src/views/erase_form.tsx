import { Eraser } from 'lucide-preact';
import { useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Confirm, Notice } from '../parts/parts';
import { plural } from '../parts/words';
import { ask } from '../wire/api';

interface Erasure { erased: number; log_emptied: boolean; radio_maps_built_before: number[] }

const kFields = [
  ['walk', 'Of walk', 'east wing'],
  ['device_model', 'By phone model', 'Pixel 8'],
  ['upload', 'Of upload', 'its idempotency key'],
  ['point', 'Point', 'number'],
] as const;

/// Erases the reference points that fit everything that is given.
export function EraseForm() {
  const { building, reload } = useBuilding();
  const [values, setValues] = useState<Record<string, string>>({});
  const [before, setBefore] = useState('');
  const [asking, setAsking] = useState(false);
  const [erasure, setErasure] = useState<Erasure | null>(null);
  const query = new URLSearchParams(Object.entries(values).filter(([, value]) => value.trim() !== ''));
  if (before) query.set('before_us', String(Date.parse(`${before}T00:00`) * 1000));
  const said = [...kFields.filter(([name]) => query.has(name)).map(([name, label]) => `${label.toLowerCase()} “${query.get(name)}”`), ...(before ? [`surveyed before ${before}`] : [])];
  return (
    <div class="card">
      <div class="card-head"><h2>Erase from the survey</h2></div>
      <form class="card-body" onSubmit={(event) => { event.preventDefault(); setErasure(null); setAsking(true); }}>
        <p class="hint">What fits everything that is filled in. A date alone keeps the survey to a retention of your choice.</p>
        <div class="fields">
          {kFields.map(([name, label, example]) => (
            <label class="field" key={name}><span>{label}</span>
              <input id={`erase-${name}`} maxLength={256} placeholder={example} value={values[name] ?? ''} {...(name === 'point' && { pattern: '[0-9]+', inputMode: 'numeric', title: 'A number' })}
                onInput={(event) => setValues({ ...values, [name]: event.currentTarget.value })} />
            </label>
          ))}
          <label class="field"><span>Surveyed before</span><input id="erase-before" type="date" value={before} onInput={(event) => setBefore(event.currentTarget.value)} /></label>
        </div>
        {erasure && (
          <Notice tone={erasure.erased ? 'good' : ''}>
            {erasure.erased === 0 ? 'No point fits.' : `${plural(erasure.erased, 'point')} erased${erasure.log_emptied ? ', also from the file’s log' : ''}.`}
            {erasure.radio_maps_built_before.length > 0 && ` Radio maps ${erasure.radio_maps_built_before.join(', ')} were built before and still know what they learnt.`}
          </Notice>
        )}
        <div class="row end"><button class="danger" disabled={said.length === 0}><Eraser />Erase</button></div>
      </form>
      {asking && (
        <Confirm title="Erase these points?" act="Erase" danger onClose={() => setAsking(false)}
          onConfirm={async () => { setErasure(await ask<Erasure>(`/v1/buildings/${building.id}/points?${query}`, { method: 'DELETE' })); reload(); }}>
          All reference points of “{building.name}” {said.join(' and ')}. This cannot be undone.
        </Confirm>
      )}
    </div>
  );
}
