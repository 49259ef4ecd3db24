import { CircleStop, Disc } from 'lucide-preact';
import { useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { Facts, Fault, Loading, Notice, useDeed } from '../parts/parts';
import { bytes, clock, count, span } from '../parts/words';
import { ask } from '../wire/api';
import type { RecordingState } from '../wire/replay_shapes';
import { useAnswer } from '../wire/use_answer';

const kLengths = [['600', 'For 10 minutes'], ['3600', 'For an hour'], ['86400', 'For a day']] as const;

/// Switches recording on and off: off unless an operator orders it, and then for a while only.
export function RecordingOrder({ onChange }: { onChange: () => void }) {
  const { building } = useBuilding();
  const path = `/v1/buildings/${building.id}/recording`;
  const { data, fault, loading, again } = useAnswer<RecordingState>(path, 5000);
  const [length, setLength] = useState('3600');
  const [tracked, setTracked] = useState('');
  const { busy, fault: refused, run } = useDeed();
  const order = (seconds: number) => run(async () => {
    await ask(path, { method: 'PUT', body: { on_for_s: seconds, ...(tracked.trim() && { tracked: [tracked.trim()] }) } });
    again();
    onChange();
  });
  if (loading) return <section><Loading what="the recorder" /></section>;
  if (!data) return <section>{fault && <Fault fault={fault} again={again} />}</section>;
  return (
    <section>
      <div class="side-head"><h2>Recorder</h2>
        {data.on && <button class="danger" disabled={busy} onClick={() => order(0)}><CircleStop />Stop</button>}</div>
      {data.on ? <Notice tone="warn">Recording {data.tracked.length ? <span class="mono">{data.tracked.join(', ')}</span> : 'every phone'} until {data.until_us ? clock(data.until_us) : 'it is stopped'}.</Notice> : (
        <>
          <p class="hint">Off. While it is on, what phones send is kept in the server’s memory, so that a session can be lived through again. It is never written to disk and is in the audit.</p>
          <div class="fields">
            <label class="field"><span>How long</span>
              <select value={length} onChange={(event) => setLength(event.currentTarget.value)}>{kLengths.map(([value, text]) => <option key={value} value={value}>{text}</option>)}</select></label>
            <label class="field"><span>Only phone</span><input class="mono" placeholder="every phone" value={tracked} onInput={(event) => setTracked(event.currentTarget.value)} /></label>
          </div>
          <div class="row end"><button class="primary" disabled={busy} onClick={() => order(Number(length))}><Disc />Record</button></div>
        </>
      )}
      {data.recordings > 0 && (
        <Facts facts={[['Recordings', count(data.recordings)], ['Memory', `${bytes(data.bytes_used)} of ${bytes(data.bytes)}`], ['Kept for', span(data.kept_s)],
          ...(data.not_recorded ? [['No room for', `${count(data.not_recorded)} sessions`] as [string, string]] : [])]} />
      )}
      {refused && <Fault fault={refused} />}
    </section>
  );
}
