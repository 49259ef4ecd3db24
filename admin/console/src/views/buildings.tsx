import { ArchiveRestore, Building2, Plus } from 'lucide-preact';
import { useRef, useState } from 'preact/hooks';
import { useStanding } from '../context';
import { Badge, Dialog, DialogHead, Empty, Fault, Loading, useDeed } from '../parts/parts';
import { count, plural } from '../parts/words';
import { hashOf } from '../route';
import { ask } from '../wire/api';
import type { Building } from '../wire/shapes';
import { useAnswer } from '../wire/use_answer';
import { BuildingForm } from './building_form';

/// All buildings of the server; create and edit.
export function Buildings() {
  const { buildings, building, reload, say } = useStanding();
  const [editing, setEditing] = useState<number | 'new' | null>(null);
  const { busy, fault, run } = useDeed();
  const picker = useRef<HTMLInputElement>(null);
  const restore = (file: File | undefined) => file && run(async () => {
    const restored = await ask<Building>('/v1/restore', { method: 'POST', raw: file, type: 'application/vnd.sqlite3' });
    say('good', `“${restored.name}” is restored, number ${restored.id}.`);
    reload();
  });
  const list = buildings ?? (building ? [building] : []);
  return (
    <div class="sheet">
      <div class="sheet-head">
        <div><h1>Buildings</h1><p>Each has its floors, its own radio map and one database file on the server.</p></div>
        {buildings && (
          <div class="row">
            <input ref={picker} id="backup-file" type="file" hidden aria-label="Backup" onChange={(event) => { void restore(event.currentTarget.files?.[0]); event.currentTarget.value = ''; }} />
            <button disabled={busy} onClick={() => picker.current?.click()}><ArchiveRestore />{busy ? 'Restoring …' : 'Restore'}</button>
            <button class="primary" onClick={() => setEditing('new')}><Plus />New building</button>
          </div>
        )}
      </div>
      {fault && <Fault fault={fault} />}
      <div class="card">
        {list.length === 0 ? (
          <Empty icon={<Building2 />} title="No building yet">Create one with a name and its floors. Then survey it.</Empty>
        ) : (
          <div class="scroll"><table class="stack">
            <thead><tr><th>Name</th><th>Floors</th><th class="number">Points</th><th>Pipeline</th><th class="number">Radio map</th><th><span class="visually-hidden">Actions</span></th></tr></thead>
            <tbody>{list.map((one) => <Row key={one.id} id={one.id} open={one.id === building?.id} onEdit={() => setEditing(one.id)} />)}</tbody>
          </table></div>
        )}
      </div>
      {editing !== null && <Editing id={editing} onClose={() => setEditing(null)} onDone={() => { setEditing(null); reload(); }} />}
    </div>
  );
}

function Row({ id, open, onEdit }: { id: number; open: boolean; onEdit: () => void }) {
  const { building: current } = useStanding();
  // The description changes with the survey; what the standing reloads is read here again too.
  const { data, fault } = useAnswer<Building>(`/v1/buildings/${id}?seen=${current?.survey_version ?? 0}`);
  const shown = open && current ? current : data;
  if (fault) return <tr><td colSpan={6}>{fault.message}</td></tr>;
  if (!shown) return <tr><td colSpan={6}><Loading what={`building ${id}`} /></td></tr>;
  return (
    <tr data-building={id}>
      <td><a href={hashOf(id, 'live')}><strong>{shown.name}</strong></a><span class="sub">Number {id}{shown.georeference ? '' : ', not georeferenced'}</span></td>
      <td data-label="Floors">{plural(shown.floors.length, 'floor')}<span class="sub">{shown.floors.map((floor) => floor.label || floor.ordinal).join(', ')}</span></td>
      <td class="number" data-label="Points">{count(shown.points)}</td>
      <td data-label="Pipeline"><Badge>{shown.pipeline}</Badge></td>
      <td class="number" data-label="Radio map">{shown.radio_map_version || '–'}</td>
      <td class="actions"><button onClick={onEdit}>Edit</button></td>
    </tr>
  );
}

function Editing({ id, onClose, onDone }: { id: number | 'new'; onClose: () => void; onDone: () => void }) {
  const { data, etag, fault, again } = useAnswer<Building>(id === 'new' ? null : `/v1/buildings/${id}`);
  const title = id === 'new' ? 'New building' : `Edit “${data?.name ?? '…'}”`;
  return (
    <Dialog title={title} wide onClose={onClose}>
      {id === 'new' || data ? <BuildingForm building={data} etag={etag} title={title} onClose={onClose} onDone={onDone} /> : (
        <div class="dialog-body"><DialogHead title={title} onClose={onClose} />{fault ? <Fault fault={fault} again={again} /> : <Loading what="the building" />}</div>
      )}
    </Dialog>
  );
}
