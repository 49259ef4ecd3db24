import { ScrollText } from 'lucide-preact';
import { useEffect, useState } from 'preact/hooks';
import { useStanding } from '../context';
import { Empty, Fault, Loading } from '../parts/parts';
import { count, when } from '../parts/words';
import { askPages, Refusal } from '../wire/api';
import type { Key } from '../wire/shapes';
import { useAnswer } from '../wire/use_answer';

interface Line { id: number; at_us: number; key: number; building: number; action: string; subject: string }

const kKept = 5000;
const kRows = 200;

/// Who changed or saw what, newest first. The server tells it oldest first, in pages.
export function Audit() {
  const { buildings } = useStanding();
  const keys = useAnswer<{ keys: Key[] }>('/v1/keys');
  const [building, setBuilding] = useState('');
  const [wanted, setWanted] = useState('');
  const [round, setRound] = useState(0);
  const { lines, complete, fault } = useLines(building, round);
  const who = (id: number) => (id === 0 ? 'the server' : keys.data?.keys.find((key) => key.id === id)?.name ?? `key ${id}`);
  const where = (id: number) => (id === 0 ? 'the server' : buildings?.find((one) => one.id === id)?.name ?? `building ${id}`);
  const sought = wanted.trim().toLowerCase();
  const found = lines.filter((line) => `${line.action} ${line.subject} ${who(line.key)}`.toLowerCase().includes(sought));
  return (
    <div class="sheet">
      <div class="sheet-head">
        <div><h1>Audit</h1><p>Who changed what, and who looked at positions. It holds no positions and no secrets.</p></div>
        <button onClick={() => setRound(round + 1)}>Read again</button>
      </div>
      <div class="card">
        <div class="card-head">
          <input type="search" placeholder="Find" aria-label="Find in the audit" value={wanted} onInput={(event) => setWanted(event.currentTarget.value)} />
          <span class="spring" />
          <select aria-label="Of building" value={building} onChange={(event) => setBuilding(event.currentTarget.value)}>
            <option value="">Everywhere</option>
            {buildings?.map((one) => <option key={one.id} value={one.id}>{one.name}</option>)}
          </select>
        </div>
        {fault && lines.length === 0 ? <div class="card-body"><Fault fault={fault} again={() => setRound(round + 1)} /></div>
          : found.length === 0 ? (complete ? <Empty icon={<ScrollText />} title={sought ? 'Nothing like this' : 'Nothing happened yet'} /> : <Loading what="the audit" />) : (
          <div class="scroll"><table class="stack">
            <thead><tr><th>When</th><th>Key</th><th>Action</th><th>On</th><th>Building</th></tr></thead>
            <tbody>
              {found.slice(0, kRows).map((line) => (
                <tr key={line.id}>
                  <td>{when(line.at_us)}</td>
                  <td data-label="Key"><strong>{who(line.key)}</strong></td>
                  <td data-label="Action" class="whole">{line.action}</td>
                  <td data-label="On" class="whole mono">{line.subject || '–'}</td>
                  <td data-label="Building">{where(line.building)}</td>
                </tr>
              ))}
            </tbody>
          </table></div>
        )}
        {found.length > kRows && <div class="card-body"><p class="hint">The newest {kRows} of {count(found.length)}. The search narrows the list.</p></div>}
      </div>
    </div>
  );
}

function useLines(building: string, round: number) {
  const [state, setState] = useState<{ lines: Line[]; complete: boolean; fault: Refusal | null }>({ lines: [], complete: false, fault: null });
  useEffect(() => {
    const stop = new AbortController();
    void (async () => {
      let lines: Line[] = [];
      try {
        for await (const page of askPages<Line>(`/v1/audit${building ? `?building=${building}` : ''}`, 'audit', stop.signal)) lines = [...lines, ...page].slice(-kKept);
        setState({ lines: lines.reverse(), complete: true, fault: null });
      } catch (error) {
        if (error instanceof Refusal) setState({ lines: [], complete: true, fault: error });
      }
    })();
    return () => stop.abort();
  }, [building, round]);
  return state;
}
