import { KeyRound, Plus } from 'lucide-preact';
import { useState } from 'preact/hooks';
import { useStanding } from '../context';
import { Badge, Confirm, Dialog, DialogHead, Empty, Fault, Loading, useDeed } from '../parts/parts';
import { ShownOnce } from '../parts/shown_once';
import { when } from '../parts/words';
import { ask } from '../wire/api';
import type { Key } from '../wire/shapes';
import { useAnswer } from '../wire/use_answer';

const kScopes = [
  ['track', 'Phones: be positioned'],
  ['survey', 'Surveyors: upload reference points'],
  ['observe', 'Dashboards: see positions'],
  ['admin', 'Operators: everything, keys too'],
] as const;
const kLifetimes = [['', 'Never'], ['86400', 'In a day'], ['604800', 'In a week'], ['2592000', 'In 30 days'], ['31536000', 'In a year']] as const;

export function Keys() {
  const { buildings, say } = useStanding();
  const { data, fault, loading, again } = useAnswer<{ keys: Key[] }>('/v1/keys');
  const [making, setMaking] = useState(false);
  const [revoking, setRevoking] = useState<Key | null>(null);
  const nameOf = (id: number) => (id === 0 ? 'All buildings' : buildings?.find((one) => one.id === id)?.name ?? `Building ${id}`);
  const expired = (key: Key) => key.expires_at_us !== undefined && key.expires_at_us < Date.now() * 1000;
  return (
    <div class="sheet">
      <div class="sheet-head">
        <div><h1>Keys</h1><p>Who may do what. Each phone app, surveyor, dashboard and script gets a key of its own, so that one can be revoked without the others.</p></div>
        <button class="primary" onClick={() => setMaking(true)}><Plus />New key</button>
      </div>
      <div class="card">
        {fault && !data ? <div class="card-body"><Fault fault={fault} again={again} /></div> : loading ? <Loading what="the keys" />
          : data && data.keys.length === 0 ? <Empty icon={<KeyRound />} title="No key">Nobody can sign in any more.</Empty> : (
          <div class="scroll"><table class="stack">
            <thead><tr><th>Name</th><th>Scopes</th><th>Building</th><th>Created</th><th>Expires</th><th><span class="visually-hidden">Actions</span></th></tr></thead>
            <tbody>
              {data?.keys.map((key) => (
                <tr key={key.id} data-key={key.id}>
                  <td><strong>{key.name}</strong></td>
                  <td data-label="Scopes" class="whole"><div class="row tight">{key.scopes.map((scope) => <Badge key={scope} tone={scope === 'admin' ? 'info' : ''}>{scope}</Badge>)}{key.coarse && <Badge tone="good">zones only</Badge>}</div></td>
                  <td data-label="Building">{nameOf(key.building)}</td>
                  <td data-label="Created">{when(key.created_at_us)}</td>
                  <td data-label="Expires">{key.expires_at_us === undefined ? 'Never' : expired(key) ? <Badge tone="bad">expired</Badge> : when(key.expires_at_us)}</td>
                  <td class="actions"><button class="danger" onClick={() => setRevoking(key)}>Revoke</button></td>
                </tr>
              ))}
            </tbody>
          </table></div>
        )}
      </div>
      {making && <NewKey onClose={() => { setMaking(false); again(); }} />}
      {revoking && (
        <Confirm title={`Revoke “${revoking.name}”?`} act="Revoke" danger onClose={() => setRevoking(null)}
          onConfirm={async () => { await ask(`/v1/keys/${revoking.id}`, { method: 'DELETE' }); say('good', `“${revoking.name}” is revoked.`); again(); }}>
          Whatever uses this key stops working at once. This cannot be undone.
        </Confirm>
      )}
    </div>
  );
}

function NewKey({ onClose }: { onClose: () => void }) {
  const { buildings } = useStanding();
  const [name, setName] = useState('');
  const [scopes, setScopes] = useState<string[]>(['track']);
  const [building, setBuilding] = useState('0');
  const [lifetime, setLifetime] = useState('');
  const [coarse, setCoarse] = useState(false);
  const [secret, setSecret] = useState('');
  const { busy, fault, run } = useDeed();
  const mayBeCoarse = scopes.includes('observe') && !scopes.includes('admin');
  const make = async () => {
    const body = { name: name.trim(), scopes, building: Number(building), ...(lifetime && { expires_in_s: Number(lifetime) }), ...(mayBeCoarse && coarse && { coarse }) };
    setSecret((await ask<{ key: string }>('/v1/keys', { method: 'POST', body })).key);
  };
  if (secret) {
    return <ShownOnce title={`“${name}” is created`} secret={secret} onClose={onClose}
      notice="This is the only time the key is shown. The server keeps a hash of it, nothing else." />;
  }
  return (
    <Dialog title="New key" onClose={onClose}>
      <form onSubmit={(event) => { event.preventDefault(); void run(make); }}>
        <DialogHead title="New key" onClose={onClose} />
        <label class="field"><span>Name</span>
          <input id="key-name" required maxLength={128} autofocus placeholder="Visitor app, spring release" value={name} onInput={(event) => setName(event.currentTarget.value)} />
        </label>
        <fieldset class="field">
          <legend>May be used by</legend>
          {kScopes.map(([scope, who]) => (
            <label class="check" key={scope}>
              <input type="checkbox" checked={scopes.includes(scope)}
                onChange={() => setScopes(scopes.includes(scope) ? scopes.filter((one) => one !== scope) : [...scopes, scope])} />
              <span>{who} <Badge>{scope}</Badge></span>
            </label>
          ))}
        </fieldset>
        <label class="check">
          <input id="key-coarse" type="checkbox" checked={mayBeCoarse && coarse} disabled={!mayBeCoarse} aria-describedby="coarse-hint" onChange={() => setCoarse(!coarse)} />
          <span>Zones only</span>
        </label>
        <p class="hint" id="coarse-hint">It learns which zone a phone is in and never a coordinate. For keys that observe and are not “admin”.</p>
        <div class="fields">
          <label class="field"><span>Building</span>
            <select value={building} onChange={(event) => setBuilding(event.currentTarget.value)}>
              <option value="0">All buildings</option>
              {buildings?.map((one) => <option key={one.id} value={one.id}>{one.name}</option>)}
            </select>
          </label>
          <label class="field"><span>Expires</span>
            <select value={lifetime} onChange={(event) => setLifetime(event.currentTarget.value)}>
              {kLifetimes.map(([value, text]) => <option key={value} value={value}>{text}</option>)}
            </select>
          </label>
        </div>
        {fault && <Fault fault={fault} />}
        <div class="row end">
          <button type="button" onClick={onClose}>Cancel</button>
          <button class="primary" disabled={busy || scopes.length === 0}>Create key</button>
        </div>
      </form>
    </Dialog>
  );
}
