// The style sheet's colours for what is painted on a canvas; read again when the theme changes.

const kNames = { phone: '--phone', warn: '--warn-ink', bad: '--bad-ink', halo: '--halo', point: '--point', muted: '--muted', ink: '--ink', zone: '--zone' } as const;
export type Inks = Record<keyof typeof kNames, string>;

let known: Inks | null = null;
const listeners = new Set<() => void>();

export function inks(): Inks {
  if (!known) {
    const style = getComputedStyle(document.documentElement);
    known = Object.fromEntries(Object.entries(kNames).map(([name, variable]) => [name, style.getPropertyValue(variable).trim()])) as Inks;
  }
  return known;
}

export function listenToInks(listener: () => void): () => void {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

export function forgetInks(): void {
  known = null;
  for (const listener of listeners) listener();
}

