import { Plus, Trash2 } from 'lucide-preact';
import { useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Facts, Fault, Notice, useDeed } from '../parts/parts';
import { metres } from '../parts/words';
import { ask, Refusal } from '../wire/api';
import type { GeoreferenceFit } from '../wire/plan_shapes';
import { Checks } from './checks';

interface Control { x: string; y: string; latitude: string; longitude: string }
const kEmpty: Control = { x: '', y: '', latitude: '', longitude: '' };
const kColumns = [['x', 'x, m'], ['y', 'y, m'], ['latitude', 'Latitude, °'], ['longitude', 'Longitude, °']] as const;

/// Lays the building on the earth by points known in both: first the fit with its residuals, then, if it is good, in force.
export function GeoreferencePanel() {
  const { building, reload, say } = useBuilding();
  const [controls, setControls] = useState<Control[]>([kEmpty, kEmpty, kEmpty]);
  const [fit, setFit] = useState<GeoreferenceFit | null>(null);
  const { busy, fault, run } = useDeed();
  const now = building.georeference;
  const change = (i: number, part: Partial<Control>) => { setControls(controls.map((one, j) => (j === i ? { ...one, ...part } : one))); setFit(null); };
  const put = async (dryRun: boolean) => {
    const control_points = controls.filter((one) => Object.values(one).some((value) => value !== '')).map((one) => ({
      x_m: Number(one.x), y_m: Number(one.y), latitude_deg: Number(one.latitude), longitude_deg: Number(one.longitude),
    }));
    try {
      setFit(await ask<GeoreferenceFit>(`/v1/buildings/${building.id}/georeference${dryRun ? '?dry_run=1' : ''}`, { method: 'PUT', body: { control_points } }));
    } catch (error) {
      const refused = error instanceof Refusal ? (error.document as GeoreferenceFit | null) : null;
      if (!refused?.checks) throw error;
      setFit(refused);
      return;
    }
    if (dryRun) return;
    say('good', 'The building lies on the earth.');
    reload();
  };
  const errors = fit?.checks.some((check) => check.severity === 'error');
  return (
    <section>
      <form class="field" onSubmit={(event) => { event.preventDefault(); void run(() => put(true)); }}>
        {now ? <Facts facts={[['Origin', `${now.origin.latitude_deg.toFixed(6)}, ${now.origin.longitude_deg.toFixed(6)}`], ['y axis', `${now.y_axis_azimuth_deg.toFixed(2)}° from north`]]} />
          : <Notice>The building is not georeferenced yet.</Notice>}
        <h3>Points known in the building and on the earth, at least two</h3>
        {controls.map((one, i) => (
          <div class="control-point" key={i}>
            {kColumns.map(([name, label]) => (
              <input key={name} aria-label={`${label} of point ${i + 1}`} placeholder={label} inputMode="decimal" pattern="-?[0-9]*\.?[0-9]+" title="A number"
                value={one[name]} onInput={(event) => change(i, { [name]: event.currentTarget.value.trim() })} />
            ))}
            <button type="button" class="quiet" aria-label={`Remove point ${i + 1}`} onClick={() => { setControls(controls.filter((_, j) => j !== i)); setFit(null); }}><Trash2 /></button>
            {fit?.control_points[i] && <small class="hint">off by {metres(fit.control_points[i]!.residual_m, 2)}</small>}
          </div>
        ))}
        <div><button type="button" onClick={() => setControls([...controls, kEmpty])}><Plus />Add a point</button></div>
        {fault && <Fault fault={fault} />}
        {fit && (
          <>
            <Facts facts={[['Off by, root mean square', metres(fit.rms_m, 2)], ['Scale of the plan', fit.scale.toFixed(4)], ['Shear', fit.shear_deg === null ? '–' : `${fit.shear_deg.toFixed(2)}°`]]} />
            <Checks checks={fit.checks} />
          </>
        )}
        <div class="row end">
          <button class={fit ? '' : 'primary'} disabled={busy}>Fit</button>
          {fit && !fit.stored && <button type="button" class="primary" disabled={busy || errors} onClick={() => run(() => put(false))}>Put in force</button>}
        </div>
      </form>
    </section>
  );
}
