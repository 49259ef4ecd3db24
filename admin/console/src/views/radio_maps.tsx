import { Hammer, Layers, Undo2 } from 'lucide-preact';
import { useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Badge, Confirm, Empty, Fault, Loading, Notice, useDeed } from '../parts/parts';
import { count, metres, percent, when } from '../parts/words';
import { ask } from '../wire/api';
import type { RadioMap } from '../wire/map_shapes';
import { useAnswer } from '../wire/use_answer';
import { MapComparison } from './map_comparison';
import { PromoteDialog } from './promote_dialog';
import { Publications } from './publications';
import { QualityWalks } from './quality_walks';
import { SurveyDevices } from './survey_devices';

/// Radio maps as versions: build, measure, compare, promote, roll back.
export function RadioMaps() {
  const { building, reload, say } = useBuilding();
  const base = `/v1/buildings/${building.id}/maps`;
  const { data, fault, loading, again } = useAnswer<{ items: RadioMap[] }>(`${base}?most=1000`, 15_000);
  const [compared, setCompared] = useState<number | null>(null);
  const [promoting, setPromoting] = useState<RadioMap | null>(null);
  const [rolling, setRolling] = useState(false);
  const [round, setRound] = useState(0);
  const { busy, fault: refused, run } = useDeed();
  const maps = [...(data?.items ?? [])].sort((a, b) => b.version - a.version);
  const live = maps.find((map) => map.live);
  const stale = live && building.survey_version > live.survey_version && !maps.some((map) => map.survey_version === building.survey_version);
  const shown = maps.find((map) => map.version === compared) ?? live;
  const changed = () => { again(); reload(); setRound((n) => n + 1); };
  const build = () => run(async () => {
    const made = await ask<RadioMap>(base, { method: 'POST', body: {} });
    say('good', `Version ${made.version} is built and measured.`);
    setCompared(made.live ? null : made.version);
    changed();
  });
  return (
    <div class="sheet">
      <div class="sheet-head">
        <div><h1>Radio maps</h1><p>Each version is built from the survey as it stood, measured against the recorded quality walks, and put in force only if it is not worse.</p></div>
        <div class="row">
          <button onClick={() => setRolling(true)} disabled={!live || maps.length < 2}><Undo2 />Roll back</button>
          <button class="primary" onClick={build} disabled={busy}><Hammer />{busy ? 'Building …' : 'Build from the survey'}</button>
        </div>
      </div>
      {refused && <Fault fault={refused} />}
      {stale && <Notice tone="warn">The survey has grown since version {live.version} was built. Build a version to see whether it helps.</Notice>}
      <div class="card">
        {fault && !data ? <div class="card-body"><Fault fault={fault} again={again} /></div> : loading ? <Loading what="the radio maps" />
          : maps.length === 0 ? <Empty icon={<Layers />} title="No radio map yet">Survey the building, then build the first version.</Empty>
          : <Versions maps={maps} compared={compared} onCompare={setCompared} onPromote={setPromoting} />}
      </div>
      {maps.length > 0 && <MapComparison maps={maps} version={compared} round={round} />}
      {shown && <SurveyDevices map={shown} />}
      <div class="pair">
        <QualityWalks onChange={changed} />
        <Publications round={round} />
      </div>
      {promoting && <PromoteDialog map={promoting} live={live?.version ?? null} onClose={() => setPromoting(null)}
        onDone={() => { setPromoting(null); setCompared(null); say('good', `Version ${promoting.version} is in force.`); changed(); }} />}
      {rolling && (
        <Confirm title="Roll back?" act="Roll back" danger reason onClose={() => setRolling(false)}
          onConfirm={async (reason) => { await ask(`${base}/rollback`, { method: 'POST', body: { reason } }); say('good', 'The version before is in force again.'); changed(); }}>
          The version that was in force before {live ? `version ${live.version}` : ''} comes back at once. Sessions under way keep the map they began with.
        </Confirm>
      )}
    </div>
  );
}

interface VersionsProps { maps: RadioMap[]; compared: number | null; onCompare: (version: number | null) => void; onPromote: (map: RadioMap) => void }

function Versions({ maps, compared, onCompare, onPromote }: VersionsProps) {
  return (
    <div class="scroll"><table class="stack">
      <thead><tr>
        <th>Version</th><th>Built</th><th class="number">Points</th><th class="number">Median</th><th class="number">90 %</th>
        <th class="number">Floor right</th><th class="number" title="How often the truth lay inside the stated circles">In 68 / 95 %</th><th><span class="visually-hidden">Actions</span></th>
      </tr></thead>
      <tbody>
        {maps.map((map) => (
          <tr key={map.version} data-version={map.version} class={map.version === compared ? 'picked' : ''}>
            <td><span class="row"><strong>{map.version}</strong>{map.live && <Badge tone="good">live</Badge>}</span></td>
            <td data-label="Built" class="whole date">{when(map.built_at_us)}<span class="sub">survey {map.survey_version}</span></td>
            <td class="number" data-label="Points">{count(map.points)}</td>
            <td class="number" data-label="Median">{metres(map.quality?.median_m)}</td>
            <td class="number" data-label="90 %">{metres(map.quality?.p90_m)}</td>
            <td class="number" data-label="Floor right">{percent(map.quality?.floor_hit, 1)}</td>
            <td class="number" data-label="In 68 / 95 %">{map.quality ? `${percent(map.quality.in68)} / ${percent(map.quality.in95)}` : '–'}</td>
            <td class="actions">
              <span class="row end">
                {!map.live && <button aria-pressed={map.version === compared} onClick={() => onCompare(map.version === compared ? null : map.version)}>Compare</button>}
                {!map.live && <button class={map.version === compared ? 'primary' : ''} onClick={() => onPromote(map)}>Promote</button>}
              </span>
            </td>
          </tr>
        ))}
      </tbody>
    </table></div>
  );
}
