import type L from 'leaflet';
import { useEffect, useRef, useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { PolygonEditor } from '../map/polygon_editor';
import { Fault, Loading, useDeed } from '../parts/parts';
import { request } from '../wire/api';
import type { Point, Ring } from '../wire/shapes';
import { useAnswer } from '../wire/use_answer';
import type { Zone } from '../wire/zone_shapes';

const textOf = (rings: Ring[]) => rings.map((ring) => ring.map(([x, y]) => `${x}, ${y}`).join('\n')).join('\n\n');

/// Corners as people write them: `x, y` a line, an empty line before each hole. Null: a line is no corner.
export function ringsOf(text: string): Ring[] | null {
  const rings: Ring[] = [];
  for (const block of text.trim().split(/\n\s*\n/)) {
    const ring: Ring = [];
    for (const line of block.split('\n')) {
      const match = /^\s*(-?\d+(?:\.\d+)?)\s*[,; ]\s*(-?\d+(?:\.\d+)?)\s*$/.exec(line);
      if (!match) return null;
      ring.push([Number(match[1]), Number(match[2])] as Point);
    }
    if (ring.length < 3) return null;
    rings.push(ring);
  }
  return rings;
}

const seconds = (us: number | null) => (us === null ? '' : String(us / 1e6));
const micros = (text: string) => (text === '' ? null : Math.round(Number(text) * 1e6));

interface FormProps { map: L.Map | null; zone: Zone | null; onClose: () => void; onDone: (id: number) => void }

/// Draws a new zone or edits one; the map and the written corners say the same.
export function ZoneForm({ map, zone, onClose, onDone }: FormProps) {
  const { building, floor, say } = useBuilding();
  const path = `/v1/buildings/${building.id}/zones`;
  const [name, setName] = useState(zone?.name ?? '');
  const [corners, setCorners] = useState(textOf(zone?.region ?? []));
  const [exit, setExit] = useState(String(zone?.exit_tolerance_m ?? 1));
  const [tolerated, setTolerated] = useState(zone ? seconds(zone.tolerance_timeout_us) : '10');
  const [delay, setDelay] = useState(zone ? seconds(zone.exit_delay_us) : '5');
  const [timeout, setTimeout_] = useState(zone ? seconds(zone.timeout_us) : '120');
  const { etag, fault: unread } = useAnswer<Zone>(zone && `${path}/${zone.id}`);
  const { busy, fault, run } = useDeed();
  const editor = useRef<PolygonEditor | null>(null);

  useEffect(() => {
    if (!map) return;
    editor.current = new PolygonEditor(map, zone?.region ?? [], (rings) => setCorners(textOf(rings)));
    return () => editor.current?.remove();
  }, [map]);

  const rings = ringsOf(corners);
  const write = (text: string) => {
    setCorners(text);
    const written = ringsOf(text);
    if (written) editor.current?.show(written);
  };
  const save = async () => {
    const body = {
      name: name.trim(), floor: zone?.floor ?? floor, region: rings, exit_tolerance_m: Number(exit || 0),
      tolerance_timeout_us: micros(tolerated), exit_delay_us: micros(delay), timeout_us: micros(timeout),
    };
    const { body: saved } = await request<Zone>(zone ? `${path}/${zone.id}` : path, {
      method: zone ? 'PUT' : 'POST', body, headers: zone && etag ? { 'if-match': etag } : {},
    });
    say('good', `“${saved.name}” is ${zone ? 'changed' : 'watched from now on'}.`);
    onDone(saved.id);
  };
  if (zone && !etag && !unread) return <section><Loading what="the zone" /></section>;
  return (
    <section>
      <form class="field" onSubmit={(event) => { event.preventDefault(); void run(save); }}>
        <h2>{zone ? `Edit “${zone.name}”` : 'New zone'}</h2>
        <label class="field"><span>Name</span><input id="zone-name" required maxLength={256} autofocus value={name} onInput={(event) => setName(event.currentTarget.value)} /></label>
        <label class="field"><span>Corners, m</span>
          <textarea id="zone-corners" required rows={6} class="mono" aria-invalid={corners !== '' && !rings} placeholder={'0, 0\n12.5, 0\n12.5, 8'} value={corners} onInput={(event) => write(event.currentTarget.value)} />
          <small>{corners !== '' && !rings ? 'One corner a line, x and y, at least three.' : 'Drag them on the map, or write x, y a line.'}</small>
        </label>
        <div class="fields">
          <NumberField label="Exit tolerance, m" value={exit} onInput={setExit} />
          <NumberField label="Tolerated for, s" value={tolerated} onInput={setTolerated} />
          <NumberField label="Exit delay, s" value={delay} onInput={setDelay} />
          <NumberField label="Left when unheard, s" value={timeout} onInput={setTimeout_} />
        </div>
        <p class="hint">A phone leaves when it is farther than the tolerance from the zone, or was outside for longer than tolerated, and stays out for the delay. An empty time means for ever.</p>
        {(fault ?? unread) && <Fault fault={(fault ?? unread)!} />}
        <div class="row end"><button type="button" onClick={onClose}>Cancel</button><button class="primary" disabled={busy || !rings}>{zone ? 'Save' : 'Create zone'}</button></div>
      </form>
    </section>
  );
}

function NumberField({ label, value, onInput }: { label: string; value: string; onInput: (value: string) => void }) {
  return (
    <label class="field"><span>{label}</span>
      <input inputMode="decimal" pattern="[0-9]*\.?[0-9]*" title="A number, not negative" value={value} onInput={(event) => onInput(event.currentTarget.value.trim())} />
    </label>
  );
}
