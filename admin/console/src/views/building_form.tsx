import { Plus, Trash2 } from 'lucide-preact';
import { useState } from 'preact/hooks';
import { useStanding } from '../context';
import { DialogHead, Fault, useDeed } from '../parts/parts';
import { plural } from '../parts/words';
import { go } from '../route';
import { request } from '../wire/api';
import type { Building, Floor } from '../wire/shapes';
import { useAnswer } from '../wire/use_answer';

interface Storey { ordinal: string; label: string; width: string; depth: string; known: Floor | null }
interface Draft {
  name: string; pipeline: string; publication: string;
  latitude: string; longitude: string; azimuth: string;
  declination: string; dip: string; norm: string;
  storeys: Storey[];
}

// In full: what the operator does not touch must come back as it was.
const text = (value: number | undefined) => (value === undefined ? '' : String(value));

function draftOf(building: Building | null): Draft {
  const geo = building?.georeference;
  return {
    name: building?.name ?? '', pipeline: building?.pipeline ?? 'default', publication: building?.publication ?? '',
    latitude: text(geo?.origin.latitude_deg), longitude: text(geo?.origin.longitude_deg), azimuth: text(geo?.y_axis_azimuth_deg),
    declination: text(building?.magnetic_field.declination_deg), dip: text(building?.magnetic_field.dip_deg), norm: text(building?.magnetic_field.norm_ut),
    storeys: building
      ? building.floors.map((floor) => ({ ordinal: String(floor.ordinal), label: floor.label, width: '', depth: '', known: floor }))
      : [{ ordinal: '0', label: 'Ground', width: '60', depth: '30', known: null }],
  };
}

function floorOf({ ordinal, label, width, depth, known }: Storey): Floor {
  const [w, d] = [Number(width), Number(depth)];
  const outline: Floor['outline'] = known ? known.outline : w > 0 && d > 0 ? [[[0, 0], [w, 0], [w, d], [0, d]]] : [];
  // What this form does not show (walls, ..) stays as it was.
  return { walkable: [], ...known, ordinal: Number(ordinal), label: label.trim(), outline };
}

/// The document POST and PUT take (admin/README.md); what is empty is left out.
export function documentOf(draft: Draft): object {
  const georeferenced = draft.latitude !== '' && draft.longitude !== '';
  return {
    name: draft.name.trim(),
    pipeline: draft.pipeline,
    ...(draft.publication && { publication: draft.publication }),
    ...(georeferenced && {
      georeference: {
        origin: { latitude_deg: Number(draft.latitude), longitude_deg: Number(draft.longitude) },
        y_axis_azimuth_deg: Number(draft.azimuth || 0),
      },
    }),
    ...(draft.norm !== '' && {
      magnetic_field: { declination_deg: Number(draft.declination || 0), dip_deg: Number(draft.dip || 0), norm_ut: Number(draft.norm) },
    }),
    floors: draft.storeys.map(floorOf),
  };
}

interface FormProps { building: Building | null; etag: string | null; title: string; onClose: () => void; onDone: () => void }

export function BuildingForm({ building, etag, title, onClose, onDone }: FormProps) {
  const { say } = useStanding();
  const [draft, setDraft] = useState(draftOf(building));
  const pipelines = useAnswer<{ pipelines: string[] }>('/v1/pipelines');
  const { busy, fault, run } = useDeed();
  const set = (change: Partial<Draft>) => setDraft((old) => ({ ...old, ...change }));
  const save = async () => {
    const path = building ? `/v1/buildings/${building.id}` : '/v1/buildings';
    const { body } = await request<Building>(path, {
      method: building ? 'PUT' : 'POST', body: documentOf(draft), headers: building && etag ? { 'if-match': etag } : {},
    });
    say('good', building ? `“${body.name}” is changed.` : `“${body.name}” is created.`);
    onDone();
    if (!building) go(body.id, body.floors.length ? 'survey' : 'plans');
  };
  return (
    <form onSubmit={(event) => { event.preventDefault(); void run(save); }}>
      <DialogHead title={title} onClose={onClose} />
      <div class="fields">
        <label class="field"><span>Name</span>
          <input id="building-name" required maxLength={256} autofocus value={draft.name} onInput={(event) => set({ name: event.currentTarget.value })} />
        </label>
        <label class="field"><span>Pipeline</span>
          <select value={draft.pipeline} onChange={(event) => set({ pipeline: event.currentTarget.value })}>
            {(pipelines.data?.pipelines ?? [draft.pipeline]).map((name) => <option key={name} value={name}>{name}</option>)}
          </select>
        </label>
        {draft.publication && (
          <label class="field"><span>New radio maps</span>
            <select value={draft.publication} onChange={(event) => set({ publication: event.currentTarget.value })}>
              <option value="automatic">In force at once</option><option value="reviewed">After review</option>
            </select>
          </label>
        )}
      </div>
      <Storeys storeys={draft.storeys} onChange={(storeys) => set({ storeys })} />
      <div class="field">
        <h3>On the earth</h3>
        <div class="fields">
          <NumberField label="Latitude of the origin, °" value={draft.latitude} onInput={(latitude) => set({ latitude })} />
          <NumberField label="Longitude of the origin, °" value={draft.longitude} onInput={(longitude) => set({ longitude })} />
          <NumberField label="Azimuth of the y axis, °" value={draft.azimuth} onInput={(azimuth) => set({ azimuth })} />
        </div>
        <small class="hint">Leave latitude and longitude empty while the building is not georeferenced.</small>
      </div>
      <div class="field">
        <h3>Magnetic field, for the phones’ compasses</h3>
        <div class="fields">
          <NumberField label="Declination, °" value={draft.declination} onInput={(declination) => set({ declination })} />
          <NumberField label="Dip, °" value={draft.dip} onInput={(dip) => set({ dip })} />
          <NumberField label="Strength, µT" value={draft.norm} onInput={(norm) => set({ norm })} />
        </div>
      </div>
      {fault && <Fault fault={fault} />}
      <div class="row end">
        <button type="button" onClick={onClose}>Cancel</button>
        <button class="primary" disabled={busy}>{building ? 'Save' : 'Create building'}</button>
      </div>
    </form>
  );
}

function NumberField({ label, value, onInput }: { label: string; value: string; onInput: (value: string) => void }) {
  return (
    <label class="field"><span>{label}</span>
      <input inputMode="decimal" pattern="-?[0-9]*\.?[0-9]+" title="A number" value={value} onInput={(event) => onInput(event.currentTarget.value.trim())} />
    </label>
  );
}

function Storeys({ storeys, onChange }: { storeys: Storey[]; onChange: (storeys: Storey[]) => void }) {
  const change = (i: number, part: Partial<Storey>) => onChange(storeys.map((one, j) => (j === i ? { ...one, ...part } : one)));
  const add = () => {
    const ordinal = storeys.length ? Math.max(...storeys.map((one) => Number(one.ordinal))) + 1 : 0;
    const like = storeys.at(-1);
    onChange([...storeys, { ordinal: String(ordinal), label: ordinal === 0 ? 'Ground' : `Level ${ordinal}`, width: like?.width || '60', depth: like?.depth || '30', known: null }]);
  };
  return (
    <div class="field">
      <h3>Floors</h3>
      {storeys.map((one, i) => (
        <div class="storey" key={i}>
          <label class="field"><span>Ordinal</span>
            <input required inputMode="numeric" pattern="-?[0-9]+" title="A whole number, 0 is the ground floor" value={one.ordinal} onInput={(event) => change(i, { ordinal: event.currentTarget.value })} />
          </label>
          <label class="field"><span>Label</span>
            <input maxLength={256} value={one.label} onInput={(event) => change(i, { label: event.currentTarget.value })} />
          </label>
          {one.known ? <p class="hint">{plural(one.known.outline[0]?.length ?? 0, 'corner')}, {plural(one.known.walkable.length, 'walkable area')}</p> : (
            <>
              <NumberField label="Width, m" value={one.width} onInput={(width) => change(i, { width })} />
              <NumberField label="Depth, m" value={one.depth} onInput={(depth) => change(i, { depth })} />
            </>
          )}
          <button type="button" class="quiet danger" aria-label={`Remove floor ${one.label || one.ordinal}`} onClick={() => onChange(storeys.filter((_, j) => j !== i))}><Trash2 /></button>
        </div>
      ))}
      <div><button type="button" onClick={add}><Plus />Add a floor</button></div>
      {!storeys.some((one) => one.known) && <small class="hint">A plan brings its own floors: with a GeoJSON or IMDF file, remove these and import it next.</small>}
    </div>
  );
}
