import { useEffect, useState } from 'preact/hooks';
import { ask, Refusal } from '../wire/api';
import type { Replay, ReplayStep } from '../wire/replay_shapes';

const kPage = 100;
const kAhead = 40;       // the next page is asked for so many steps before it is needed

export interface Question { pipeline: string; map: string }   // empty: as it was

interface Played { of: string; summary: Replay | null; pages: Map<number, ReplayStep[]>; fault: Refusal | null }

const pageOf = (step: number) => Math.floor((step - 1) / kPage);

/// The steps of a replay around step `at` (1, 2, ..), asked for in pages as they are looked at. A page once answered stays.
export function useReplay(path: string, { pipeline, map }: Question, at: number) {
  const of = JSON.stringify([path, pipeline, map]);
  const [state, setState] = useState<Played>({ of, summary: null, pages: new Map(), fault: null });
  const [round, setRound] = useState(0);
  const played = state.of === of ? state : { of, summary: null, pages: new Map<number, ReplayStep[]>(), fault: null };
  const last = played.summary ? Math.max(played.summary.steps_in_all, 1) : at;
  const missing = [at, Math.min(at + kAhead, last)].map(pageOf).find((page) => !played.pages.has(page)) ?? null;
  useEffect(() => {
    if (missing === null) return;
    const stop = new AbortController();
    const body = { ...(pipeline && { pipeline }), ...(map && { radio_map_version: Number(map) }), after: missing * kPage, most: kPage, particles: 200 };
    ask<Replay>(path, { method: 'POST', body, signal: stop.signal })
      .then((answer) => setState((old) => ({ of, summary: answer, pages: new Map(old.of === of ? old.pages : []).set(missing, answer.steps), fault: null })))
      .catch((fault: Error) => { if (fault instanceof Refusal) setState({ ...played, of, fault }); });
    return () => stop.abort();
  }, [of, missing, round]);
  return {
    summary: played.summary,
    fault: played.fault,
    again: () => setRound(round + 1),
    step: (number: number): ReplayStep | null => played.pages.get(pageOf(number))?.[(number - 1) % kPage] ?? null,
  };
}
