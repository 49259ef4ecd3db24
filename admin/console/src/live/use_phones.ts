import { useEffect, useState } from 'preact/hooks';
import type { Phones } from './phones';

/// Re-renders once a second while phones change: people cannot read faster, and 500 phones change 2,500 times a second.
export function usePhones(phones: Phones, everyMs = 1000): number {
  const [seen, setSeen] = useState(0);
  useEffect(() => {
    let timer = 0;
    const show = () => { timer = 0; setSeen(phones.changes); };
    const deaf = phones.listen(() => { if (!timer) timer = window.setTimeout(show, seen === 0 ? 0 : everyMs); });
    return () => { deaf(); clearTimeout(timer); };
  }, [phones, seen === 0]);
  useEffect(() => {
    // Ages grow without anything being heard.
    const tick = setInterval(() => setSeen((n) => n + 1e-6), 2000);
    return () => clearInterval(tick);
  }, []);
  return seen;
}
