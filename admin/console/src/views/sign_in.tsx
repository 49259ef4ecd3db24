import { useState } from 'preact/hooks';
import { Mark } from '../console';
import { useDeed, Fault } from '../parts/parts';
import { go } from '../route';
import { ask, Refusal } from '../wire/api';

/// Takes a key and tries it. A key for one building may not list buildings: then its number is asked for.
export function SignIn({ onKey }: { onKey: (key: string) => void }) {
  const [key, setKey] = useState('');
  const [building, setBuilding] = useState('');
  const [limited, setLimited] = useState(false);
  const { busy, fault, run } = useDeed();

  const open = async () => {
    const tried = key.trim();
    if (limited && building) {
      await ask(`/v1/buildings/${building}`, { key: tried });
      go(Number(building), 'live');
      return onKey(tried);
    }
    try {
      await ask('/v1/buildings', { key: tried });
    } catch (error) {
      if (!(error instanceof Refusal) || error.status !== 403) throw error;
      setLimited(true);
      throw new Refusal(403, '', 'This key may not list the buildings. Say the number of the one it is for.');
    }
    onKey(tried);
  };

  return (
    <main class="sign-in">
      <form id="sign-in" onSubmit={(event) => { event.preventDefault(); void run(open); }}>
        <div class="brand"><Mark /><span>wayfuse</span></div>
        <div>
          <h1>Sign in</h1>
          <p class="hint">With an API key. The server printed the first one when it first started.</p>
        </div>
        <label class="field"><span>API key</span>
          <input id="key" type="password" autocomplete="off" spellcheck={false} required autofocus placeholder="wf_…" value={key}
            aria-invalid={Boolean(fault)} onInput={(event) => setKey(event.currentTarget.value)} />
          <small>It stays in this browser tab and is gone when the tab closes.</small>
        </label>
        {limited && (
          <label class="field"><span>Building number</span>
            <input id="limited-building" inputMode="numeric" pattern="[0-9]+" required value={building}
              onInput={(event) => setBuilding(event.currentTarget.value)} />
          </label>
        )}
        <div id="sign-in-fault">{fault && (fault.status === 401 ? <Fault fault={new Refusal(401, '', 'The server does not know this key.')} />
          : fault.status === 403 ? <p class="hint">{fault.message}</p> : <Fault fault={fault} />)}</div>
        <button class="primary" disabled={busy}>{busy ? 'Signing in …' : 'Sign in'}</button>
      </form>
    </main>
  );
}
