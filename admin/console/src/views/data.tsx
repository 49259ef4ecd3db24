import { Archive, Download, ShieldCheck } from 'lucide-preact';
import { useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Badge, Confirm, Facts, Fault, Loading, Notice, useDeed } from '../parts/parts';
import { saveFile } from '../parts/save_file';
import { count, when } from '../parts/words';
import { ask } from '../wire/api';
import { useAnswer } from '../wire/use_answer';
import { EraseForm } from './erase_form';

interface Verification { sound: boolean; uploads: number; uploads_proven: number; points: number; scans: number; readings: number; transmitters: number; wrong: string[] }

interface Kept {
  survey_version: number;
  backups: { at_us: number; by_key: number; survey_version: number; bytes: number }[];
  verifications: { at_us: number; by_key: number; survey_version: number; sound: boolean; finding: string | null }[];
}

/// What the server holds of a building: take it out, check it, erase it.
export function Data() {
  const { building, forget, say } = useBuilding();
  const [removing, setRemoving] = useState(false);
  const path = `/v1/buildings/${building.id}`;
  const kept = useAnswer<Kept>(`${path}/backups`);
  return (
    <div class="sheet">
      <div class="sheet-head">
        <div><h1>Data and privacy</h1><p>Everything an operator put in can be taken out, checked and erased.</p></div>
      </div>
      <div class="pair">
        <TakeOut onTaken={kept.again} />
        <Verify onVerified={kept.again} />
      </div>
      <History kept={kept.data} fault={kept.fault} again={kept.again} />
      <div class="pair">
        <EraseForm />
        <div class="card">
          <div class="card-head"><h2>What is kept, and where</h2></div>
          <ul class="list">
            <li><strong>Positions</strong><span class="hint">In memory while a phone’s session lasts. They are not written to disk.</span></li>
            <li><strong>The survey</strong><span class="hint">In the building’s file until it is erased here: levels of access points, places, times, and the phone model and walk the surveyor named.</span></li>
            <li><strong>Who looked</strong><span class="hint">Every reading of positions and every change is in the audit, with the key that made it, never with a position.</span></li>
            <li><strong>Undelivered zone events</strong><span class="hint">In memory, bounded; a restart forgets them.</span></li>
            <li><strong>Less for those who need less</strong><span class="hint">A key “zones only” learns which zone a phone is in, and never a coordinate.</span></li>
          </ul>
        </div>
      </div>
      <div class="card">
        <div class="card-head"><h2>Remove the building</h2><button class="danger" onClick={() => setRemoving(true)}>Remove</button></div>
        <div class="card-body"><p class="hint">With its survey, radio maps, zones, webhooks and quality walks. Its number is never given again. A backup taken before can be restored.</p></div>
      </div>
      {removing && (
        <Confirm title={`Remove “${building.name}” for good?`} act="Remove for good" danger typed={building.name} onClose={() => setRemoving(false)}
          onConfirm={async () => { await ask(path, { method: 'DELETE' }); say('good', `“${building.name}” is removed.`); forget(building.id); }}>
          Everything the server holds of it is deleted. Phones in it are told that it is gone.
        </Confirm>
      )}
    </div>
  );
}

/// Backups taken and verifications run, newest first; a building that was never backed up says so.
function History({ kept, fault, again }: { kept: Kept | null; fault: unknown; again: () => void }) {
  if (!kept) return fault ? <div class="card"><div class="card-body"><Notice tone="bad">When it was backed up is not known just now.<button onClick={again}>Ask again</button></Notice></div></div> : null;
  const behind = kept.backups.length > 0 && kept.backups[0]!.survey_version !== kept.survey_version;
  const done = [...kept.backups.map((one) => ({ ...one, what: 'Backup' })), ...kept.verifications.map((one) => ({ ...one, what: 'Verification' }))]
    .sort((a, b) => b.at_us - a.at_us).slice(0, 20);
  return (
    <div class="card" data-part="backups">
      <div class="card-head"><h2>Backups and verifications</h2>
        {kept.backups.length === 0 ? <Badge tone="warn">never backed up</Badge> : behind && <Badge tone="warn">survey grew since the newest backup</Badge>}</div>
      {done.length === 0 ? <div class="card-body"><p class="hint">None yet. A backup taken here or by <span class="mono">wayfuse backup</span> stands here with its time and size.</p></div> : (
        <div class="scroll"><table class="stack">
          <thead><tr><th>What</th><th>When</th><th class="number">By key</th><th class="number">Survey</th><th>Result</th></tr></thead>
          <tbody>{done.map((one) => (
            <tr key={`${one.what} ${one.at_us}`} data-upkeep={one.what}>
              <td><strong>{one.what}</strong></td><td data-label="When" class="whole date">{when(one.at_us)}</td>
              <td class="number" data-label="By key">{one.by_key}</td><td class="number" data-label="Survey">{one.survey_version}</td>
              <td data-label="Result">{'bytes' in one ? `${count(Math.ceil(one.bytes / 1024))} kB taken` : one.sound ? <Badge tone="good">sound</Badge> : <><Badge tone="bad">damaged</Badge><span class="sub">{one.finding}</span></>}</td>
            </tr>
          ))}</tbody>
        </table></div>
      )}
    </div>
  );
}

function TakeOut({ onTaken }: { onTaken: () => void }) {
  const { building } = useBuilding();
  const { busy, fault, run } = useDeed();
  const save = (what: string, end: string) => run(async () => {
    await saveFile(`/v1/buildings/${building.id}/${what}`, `building-${building.id}${end}`);
    onTaken();
  });
  return (
    <div class="card">
      <div class="card-head"><h2>Take it out</h2></div>
      <div class="card-body">
        <div class="deed"><button class="primary" disabled={busy} onClick={() => save('backup', '.sqlite')}><Archive />Backup</button>
          <p class="hint">One SQLite file, consistent while the server runs. “Restore” on the page Buildings puts it back.</p></div>
        <div class="deed"><button disabled={busy} onClick={() => save('export.zip', '.zip')}><Download />Export</button>
          <p class="hint">Plan, zones, points, walks, pictures and webhooks as GeoJSON, CSV and JSON, in one zip.</p></div>
        <div class="deed"><button disabled={busy} onClick={() => save('points.csv', '-points.csv')}><Download />Points</button>
          <p class="hint">The reference points alone, a row a reading.</p></div>
        {fault && <Fault fault={fault} />}
      </div>
    </div>
  );
}

function Verify({ onVerified }: { onVerified: () => void }) {
  const { building } = useBuilding();
  const { busy, fault, run } = useDeed();
  const [report, setReport] = useState<Verification | null>(null);
  const verify = () => run(async () => { setReport(null); setReport(await ask<Verification>(`/v1/buildings/${building.id}/verification`)); onVerified(); });
  return (
    <div class="card">
      <div class="card-head"><h2>Is it sound?</h2>{report && <Badge tone={report.sound ? 'good' : 'bad'}>{report.sound ? 'sound' : 'damaged'}</Badge>}
        <button disabled={busy} onClick={verify}><ShieldCheck />{busy ? 'Reading …' : 'Verify'}</button></div>
      <div class="card-body">
        {busy ? <Loading what="the verification" /> : !report && <p class="hint">Reads everything the building’s file holds and compares it with its hashes.</p>}
        {fault && <Fault fault={fault} again={verify} />}
        {report && (
          <Facts facts={[
            ['Uploads', count(report.uploads)], ['Of them proven by hash', count(report.uploads_proven)], ['Points', count(report.points)],
            ['Scans', count(report.scans)], ['Readings', count(report.readings)], ['Access points', count(report.transmitters)],
          ]} />
        )}
        {report?.wrong.map((text) => <Notice tone="bad" key={text}>{text}</Notice>)}
      </div>
    </div>
  );
}
