import { ImageUp, Trash2 } from 'lucide-preact';
import { useEffect, useRef, useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Fault, Notice, useDeed } from '../parts/parts';
import { bytes } from '../parts/words';
import { ask } from '../wire/api';
import type { FloorImage } from '../wire/plan_shapes';
import { useAnswer } from '../wire/use_answer';

const kPlacement = [['origin_x_m', 'Left edge, x, m'], ['origin_y_m', 'Lower edge, y, m'], ['width_m', 'Width, m'], ['height_m', 'Height, m'], ['azimuth_deg', 'Turned clockwise, °']] as const;
type Placement = Record<(typeof kPlacement)[number][0], string>;
const kNowhere: Placement = { origin_x_m: '', origin_y_m: '', width_m: '', height_m: '', azimuth_deg: '' };

/// A floor's picture and where it lies.
export function FloorPicture({ onChange }: { onChange: () => void }) {
  const { building, floor, say } = useBuilding();
  const path = floor === null ? null : `/v1/buildings/${building.id}/floors/${floor}/image`;
  const placed = useAnswer<FloorImage>(path && `${path}/placement`);
  const [place, setPlace] = useState<Placement>(kNowhere);
  const [file, setFile] = useState<File | null>(null);
  const { busy, fault, run } = useDeed();
  const picker = useRef<HTMLInputElement>(null);
  useEffect(() => {
    const known = placed.data;
    setPlace(known ? (Object.fromEntries(kPlacement.map(([name]) => [name, String(known[name])])) as Placement) : kNowhere);
    setFile(null);
  }, [placed.data, floor]);
  const changed = (text: string) => { say('good', text); placed.again(); onChange(); };
  const put = () => run(async () => {
    const query = new URLSearchParams(Object.entries(place).filter(([name, value]) => value !== '' && (place.width_m !== '' || name === 'width_m')));
    await ask(`${path}?${query}`, { method: 'PUT', raw: file!, type: file!.type });
    changed('The picture is stored.');
  });
  const remove = () => run(async () => { await ask(path!, { method: 'DELETE' }); changed('The picture is removed.'); });
  if (!path) return <section><p class="hint">The building has no floor yet.</p></section>;
  return (
    <section>
      <form class="field" onSubmit={(event) => { event.preventDefault(); void put(); }}>
        <p class="hint">PNG or JPEG, shown under the floor. Without a place it is laid over the box around the outline.</p>
        {placed.data && <Notice>{placed.data.width_px} × {placed.data.height_px} pixels, {bytes(placed.data.bytes)}. A new place needs the file once more.</Notice>}
        <input ref={picker} type="file" hidden aria-label="Picture" accept="image/png,image/jpeg" onChange={(event) => setFile(event.currentTarget.files?.[0] ?? null)} />
        <div class="row"><button type="button" onClick={() => picker.current?.click()}><ImageUp />{file ? 'Another file' : 'Choose a file'}</button>{file && <span class="mono">{file.name}</span>}</div>
        <div class="fields">
          {kPlacement.map(([name, label]) => (
            <label class="field" key={name}><span>{label}</span>
              <input inputMode="decimal" pattern="-?[0-9]*\.?[0-9]+" title="A number" value={place[name]} onInput={(event) => setPlace({ ...place, [name]: event.currentTarget.value.trim() })} />
            </label>
          ))}
        </div>
        {fault && <Fault fault={fault} />}
        {placed.fault && placed.fault.status !== 404 && <Fault fault={placed.fault} again={placed.again} />}
        <div class="row end">
          {placed.data && <button type="button" class="danger" disabled={busy} onClick={remove}><Trash2 />Remove</button>}
          <button class="primary" disabled={busy || !file}>Store</button>
        </div>
      </form>
    </section>
  );
}
