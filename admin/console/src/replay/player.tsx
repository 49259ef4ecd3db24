import { Pause, Play, SkipBack, SkipForward } from 'lucide-preact';
import { useEffect, useLayoutEffect, useState } from 'preact/hooks';
import { Choice } from '../parts/choice';
import { count } from '../parts/words';
import type { ReplayStep } from '../wire/replay_shapes';

const kLongestMs = 2000;   // a pause of the phone's is shown no longer

interface PlayerProps { at: number; steps: number; step: (number: number) => ReplayStep | null; onStep: (number: number) => void }

const clockOf = (us: number) => `${Math.floor(us / 60e6)}:${String(Math.floor(us / 1e6) % 60).padStart(2, '0')}.${Math.floor(us / 1e5) % 10}`;

/// Steps through a replay: slider, buttons, and from the keyboard: left and right a step (with shift ten), space plays, Home and End.
export function Player({ at, steps, step, onStep }: PlayerProps) {
  const [playing, setPlaying] = useState(false);
  const [speed, setSpeed] = useState<'1' | '4' | '16'>('4');
  const [shown, next, first] = [step(at), step(at + 1), step(1)];
  const go = (number: number) => onStep(Math.min(Math.max(number, 1), steps));

  useEffect(() => {
    if (!playing) return;
    if (at >= steps) { setPlaying(false); return; }
    if (!next) return;   // on its way
    const wait = shown ? Math.min(Math.max((next.time_us - shown.time_us) / 1000 / Number(speed), 16), kLongestMs) : 16;
    const timer = setTimeout(() => go(at + 1), wait);
    return () => clearTimeout(timer);
  }, [playing, at, next, speed, steps]);

  useLayoutEffect(() => {   // with the drawing, not after it: the next key must not find the step before
    const press = (event: KeyboardEvent) => {
      const target = event.target as HTMLElement;
      if (target.closest('select, textarea, input:not([type=range]), .map-box, dialog')) return;
      const ranged = target.matches('input[type=range]');
      const far = event.shiftKey ? 10 : 1;
      if (event.key === ' ' && !target.closest('button, a')) setPlaying((on) => !on);
      else if (event.key === 'ArrowRight' && !ranged) go(at + far);
      else if (event.key === 'ArrowLeft' && !ranged) go(at - far);
      else if (event.key === 'Home' && !ranged) go(1);
      else if (event.key === 'End' && !ranged) go(steps);
      else return;
      event.preventDefault();
    };
    document.addEventListener('keydown', press);
    return () => document.removeEventListener('keydown', press);
  }, [at, steps]);

  return (
    <div class="player" role="group" aria-label="Replay">
      <input type="range" min={1} max={steps} value={at} aria-label="Step" aria-valuetext={`Step ${at} of ${steps}`} onInput={(event) => go(Number(event.currentTarget.value))} />
      <div class="row">
        <button aria-label="A step back" title="A step back (left)" onClick={() => go(at - 1)} disabled={at <= 1}><SkipBack /></button>
        <button class="primary" aria-pressed={playing} title="Space" onClick={() => setPlaying(!playing)} disabled={at >= steps && !playing}>{playing ? <Pause /> : <Play />}{playing ? 'Pause' : 'Play'}</button>
        <button aria-label="A step on" title="A step on (right)" onClick={() => go(at + 1)} disabled={at >= steps}><SkipForward /></button>
        <span class="spring" />
        <Choice name="Speed" value={speed} onChange={setSpeed} of={[['1', '1 ×'], ['4', '4 ×'], ['16', '16 ×']]} />
      </div>
      <div class="row"><span>Step <strong id="step">{count(at)}</strong> of {count(steps)}</span><span class="spring" />
        {shown && first && <span class="hint">{clockOf(Math.max(shown.time_us - first.time_us, 0))} from the start</span>}</div>
    </div>
  );
}
