import { useCallback, useEffect, useRef, useState } from 'preact/hooks';
import { Refusal, request } from './api';

export interface Asked<T> { data: T | null; etag: string | null; fault: Refusal | null; loading: boolean; again: () => void }

/// Asks for `path` when it changes, on again(), and every `everyMs` while the tab is looked at; null asks nothing. What was answered
/// before stays on screen while it is asked again.
export function useAnswer<T>(path: string | null, everyMs = 0): Asked<T> {
  const [state, setState] = useState<{ path: string | null; data: T | null; etag: string | null; fault: Refusal | null }>({ path: null, data: null, etag: null, fault: null });
  const [round, setRound] = useState(0);
  const running = useRef<AbortController | null>(null);
  useEffect(() => {
    if (!path) return;
    const stop = new AbortController();
    running.current = stop;
    request<T>(path, { signal: stop.signal })
      .then(({ body, etag }) => setState({ path, data: body, etag, fault: null }))
      .catch((fault: Error) => {
        if (fault instanceof Refusal) setState((old) => (old.path === path ? { ...old, fault } : { path, data: null, etag: null, fault }));
      });
    return () => stop.abort();
  }, [path, round]);
  useEffect(() => {
    if (!path || !everyMs) return;
    const timer = setInterval(() => document.visibilityState === 'visible' && setRound((n) => n + 1), everyMs);
    return () => clearInterval(timer);
  }, [path, everyMs]);
  const again = useCallback(() => setRound((n) => n + 1), []);
  const current = state.path === path;
  return { data: current ? state.data : null, etag: current ? state.etag : null, fault: current ? state.fault : null, loading: Boolean(path) && !current, again };
}
