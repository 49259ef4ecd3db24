import { FileUp } from 'lucide-preact';
import { useRef, useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Badge, Fault, Notice, useDeed } from '../parts/parts';
import { plural } from '../parts/words';
import { ask, Refusal } from '../wire/api';
import type { PlanReport } from '../wire/plan_shapes';
import { Checks } from './checks';

/// Reads a GeoJSON or IMDF plan: first the report of what was found in it, then, if the operator agrees, the floors.
export function PlanImport() {
  const { building, floor, setFloor, reload, say } = useBuilding();
  const [file, setFile] = useState<File | null>(null);
  const [oneFloor, setOneFloor] = useState('');
  const [coordinates, setCoordinates] = useState('');
  const [rooms, setRooms] = useState('closed');
  const [zones, setZones] = useState(false);
  const [report, setReport] = useState<PlanReport | null>(null);
  const { busy, fault, run, setFault } = useDeed();
  const picker = useRef<HTMLInputElement>(null);

  const forget = () => { setReport(null); setFault(null); };
  const put = async (dryRun: boolean) => {
    const query = new URLSearchParams({ rooms, ...(dryRun && { dry_run: '1' }), ...(zones && { zones: '1' }), ...(oneFloor && { floor: oneFloor }), ...(coordinates && { coordinates }) });
    const type = file!.name.endsWith('.zip') ? 'application/zip' : 'application/geo+json';
    let stored: PlanReport;
    try {
      stored = await ask<PlanReport>(`/v1/buildings/${building.id}/plan?${query}`, { method: 'PUT', raw: file!, type });
      setReport(stored);
    } catch (error) {
      // A plan with errors is refused with the same report.
      const refused = error instanceof Refusal ? (error.document as PlanReport | null) : null;
      if (!refused?.checks) throw error;
      setReport(refused);
      return;
    }
    if (dryRun) return;
    say('good', 'The plan is stored.');
    reload();
    if (stored.floors[0]) setFloor(stored.floors[0].ordinal);
  };
  const errors = report?.checks.filter((check) => check.severity === 'error').length ?? 0;
  return (
    <section>
      <p class="hint">A GeoJSON FeatureCollection or an IMDF archive (.zip). It is checked first: open rings, rooms outside their level, scale, place on the earth.</p>
      <input ref={picker} id="plan-file" type="file" hidden aria-label="Plan" accept=".geojson,.json,.zip" onChange={(event) => { setFile(event.currentTarget.files?.[0] ?? null); forget(); }} />
      <div class="row"><button onClick={() => picker.current?.click()}><FileUp />{file ? 'Another file' : 'Choose a file'}</button>{file && <span class="mono">{file.name}</span>}</div>
      <div class="fields">
        <label class="field"><span>Floor</span>
          <select value={oneFloor} onChange={(event) => { setOneFloor(event.currentTarget.value); forget(); }}>
            <option value="">As the file says</option>
            {[...new Set([...building.floors.map((one) => one.ordinal), floor ?? 0])].map((ordinal) => <option key={ordinal} value={ordinal}>All is floor {ordinal}</option>)}
          </select></label>
        <label class="field"><span>Coordinates</span>
          <select value={coordinates} onChange={(event) => { setCoordinates(event.currentTarget.value); forget(); }}>
            <option value="">Found out</option><option value="wgs84">WGS84, degrees</option><option value="mercator">Web Mercator</option><option value="local">Metres of the building</option>
          </select></label>
        <label class="field"><span>Rooms</span>
          <select value={rooms} onChange={(event) => { setRooms(event.currentTarget.value); forget(); }}>
            <option value="closed">Closed to phones</option><option value="walkable">Walkable</option>
          </select></label>
      </div>
      <label class="check"><input type="checkbox" checked={zones} onChange={() => { setZones(!zones); forget(); }} />Make a zone of every named room</label>
      {fault && <Fault fault={fault} />}
      {report && <Report report={report} />}
      <div class="row end">
        <button disabled={!file || busy} class={report ? '' : 'primary'} onClick={() => run(() => put(true))}>{busy ? 'Reading …' : 'Check'}</button>
        {report && !report.stored && <button class="primary" disabled={busy || errors > 0} onClick={() => run(() => put(false))}>Store {plural(report.floors.length, 'floor')}</button>}
      </div>
    </section>
  );
}

function Report({ report }: { report: PlanReport }) {
  const errors = report.checks.filter((check) => check.severity === 'error').length;
  return (
    <div class="field" id="plan-report">
      {errors > 0 ? <Notice tone="bad">{plural(errors, 'error')}: nothing is stored until they are mended in the file.</Notice>
        : report.stored ? <Notice tone="good">Stored.</Notice> : <Notice>Nothing is stored yet.</Notice>}
      {report.floors.map((floor) => (
        <div class="row" key={floor.ordinal}><Badge tone="info">{floor.label || floor.ordinal}</Badge>
          <span>{floor.outline_m2.toFixed(0)} m², {floor.walkable_m2.toFixed(0)} m² walkable, {plural(floor.rooms, 'room')}, {plural(floor.doors, 'door')}, {plural(floor.walls, 'wall')}</span></div>
      ))}
      {report.zones.length > 0 && <p class="hint">{plural(report.zones.length, 'named room')}</p>}
      <Checks checks={report.checks} />
    </div>
  );
}
