import { Check, Copy } from 'lucide-preact';
import { useState } from 'preact/hooks';
import { Dialog, DialogHead, Notice } from './parts';

/// A secret the server tells once: shown, copied, then gone from the page.
export function ShownOnce({ title, notice, secret, onClose }: { title: string; notice: string; secret: string; onClose: () => void }) {
  const [copied, setCopied] = useState(false);
  const copy = () => navigator.clipboard?.writeText(secret).then(() => setCopied(true), () => setCopied(false));
  return (
    <Dialog title={title} onClose={onClose}>
      <div class="dialog-body">
        <DialogHead title={title} onClose={onClose} />
        <Notice tone="warn">{notice}</Notice>
        <div class="secret"><code id="secret">{secret}</code>
          <button type="button" onClick={copy}>{copied ? <Check /> : <Copy />}{copied ? 'Copied' : 'Copy'}</button></div>
        <div class="row end"><button class="primary" autofocus onClick={onClose}>I have kept it</button></div>
      </div>
    </Dialog>
  );
}
