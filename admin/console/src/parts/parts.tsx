import { CircleAlert, CircleCheck, Info, X } from 'lucide-preact';
import type { ComponentChildren } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';
import { Refusal } from '../wire/api';

export type Tone = 'good' | 'warn' | 'bad' | 'info' | '';

export const Badge = ({ tone = '', children }: { tone?: Tone; children: ComponentChildren }) => <span class={`badge ${tone}`}>{children}</span>;

export function Notice({ tone = '', children }: { tone?: Tone; children: ComponentChildren }) {
  const Icon = tone === 'good' ? CircleCheck : tone === 'bad' || tone === 'warn' ? CircleAlert : Info;
  return <div class={`notice ${tone}`} role={tone === 'bad' ? 'alert' : undefined}><Icon aria-hidden="true" /><div>{children}</div></div>;
}

export const Loading = ({ what }: { what: string }) => <div class="loading" role="status" aria-label={`Loading ${what}`}><i /><i /><i /></div>;

export function Empty({ icon, title, children }: { icon?: ComponentChildren; title: string; children?: ComponentChildren }) {
  return <div class="empty">{icon}<strong>{title}</strong>{children && <p>{children}</p>}</div>;
}

/// What stands where an answer should be: why it could not be had, and what to do.
export function Fault({ fault, again }: { fault: Refusal; again?: () => void }) {
  const said = fault.status === 403 ? 'This key is not allowed to see this. Sign in with a key that has the scope “admin”.' : fault.message;
  return (
    <Notice tone="bad">
      <div class="row"><span>{said}</span>{again && fault.status !== 403 && <button onClick={again}>Try again</button>}</div>
    </Notice>
  );
}

export function Dialog({ title, onClose, wide, children }: { title: string; onClose: () => void; wide?: boolean; children: ComponentChildren }) {
  const box = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    const dialog = box.current!;
    const before = document.activeElement as HTMLElement | null;
    dialog.showModal();
    return () => {
      dialog.close();
      before?.focus();
    };
  }, []);
  return (
    <dialog ref={box} class={wide ? 'wide' : ''} aria-label={title} onCancel={(event) => { event.preventDefault(); onClose(); }}>
      {children}
    </dialog>
  );
}

export function DialogHead({ title, onClose }: { title: string; onClose: () => void }) {
  return <div class="side-head"><h2>{title}</h2><button type="button" class="quiet" aria-label="Close" onClick={onClose}><X /></button></div>;
}

interface ConfirmProps {
  title: string;
  act: string;
  danger?: boolean;
  reason?: boolean;                       // ask for one, for the audit
  typed?: string;                         // to be typed before the deed
  children: ComponentChildren;
  onClose: () => void;
  onConfirm: (reason: string) => Promise<unknown>;
}

/// Says what will happen, asks, does it, and stays open with the cause if it was refused.
export function Confirm({ title, act, danger, reason, typed, children, onClose, onConfirm }: ConfirmProps) {
  const [why, setWhy] = useState('');
  const [repeated, setRepeated] = useState('');
  const { busy, fault, run } = useDeed();
  const submit = (event: Event) => {
    event.preventDefault();
    void run(async () => { await onConfirm(why.trim()); onClose(); });
  };
  return (
    <Dialog title={title} onClose={onClose}>
      <form onSubmit={submit}>
        <DialogHead title={title} onClose={onClose} />
        <div class="hint">{children}</div>
        {reason && (
          <label class="field"><span>Reason</span>
            <textarea required maxLength={256} value={why} onInput={(event) => setWhy(event.currentTarget.value)} placeholder="For whoever asks later" />
          </label>
        )}
        {typed && (
          <label class="field"><span>Type “{typed}” to go on</span>
            <input autocomplete="off" value={repeated} onInput={(event) => setRepeated(event.currentTarget.value)} />
          </label>
        )}
        {fault && <Fault fault={fault} />}
        <div class="row end">
          <button type="button" onClick={onClose}>Cancel</button>
          <button class={`primary ${danger ? 'danger' : ''}`} disabled={busy || (typed !== undefined && repeated.trim() !== typed)}>{busy ? 'Working …' : act}</button>
        </div>
      </form>
    </Dialog>
  );
}

/// Runs one thing at a time and keeps what it was refused with.
export function useDeed() {
  const [busy, setBusy] = useState(false);
  const [fault, setFault] = useState<Refusal | null>(null);
  const run = async (deed: () => Promise<unknown>) => {
    setBusy(true);
    setFault(null);
    try {
      await deed();
    } catch (error) {
      setFault(error instanceof Refusal ? error : new Refusal(0, '', String(error)));
    } finally {
      setBusy(false);
    }
  };
  return { busy, fault, run, setFault };
}

export const Facts = ({ facts, big }: { facts: [string, ComponentChildren][]; big?: boolean }) => (
  <dl class={`facts ${big ? 'big-fact' : ''}`}>
    {facts.map(([name, value]) => <div key={name}><dt>{name}</dt><dd>{value}</dd></div>)}
  </dl>
);
