// Numbers and times as people read them.

export const metres = (value: number | null | undefined, digits = 1) => (value === null || value === undefined ? '–' : `${value.toFixed(digits)} m`);

export const percent = (share: number | null | undefined, digits = 0) => (share === null || share === undefined ? '–' : `${(share * 100).toFixed(digits)} %`);

export const count = (value: number) => value.toLocaleString('en');

export const plural = (n: number, one: string, many = `${one}s`) => `${count(n)} ${n === 1 ? one : many}`;

export function ago(us: number, nowMs = Date.now()): string {
  const seconds = Math.round((nowMs - us / 1000) / 1000);
  if (seconds < 5) return 'now';
  return `${span(seconds)} ago`;
}

export function span(seconds: number): string {
  if (seconds < 60) return `${Math.round(seconds)} s`;
  if (seconds < 3600) return `${Math.round(seconds / 60)} min`;
  if (seconds < 48 * 3600) return `${Math.round(seconds / 3600)} h`;
  return `${Math.round(seconds / 86400)} days`;
}

export const when = (us: number) =>
  new Date(us / 1000).toLocaleString(undefined, { dateStyle: 'medium', timeStyle: 'short' });

export const clock = (us: number) => new Date(us / 1000).toLocaleTimeString(undefined, { hour: '2-digit', minute: '2-digit', second: '2-digit' });

export const bytes = (n: number) => (n < 1e6 ? `${(n / 1e3).toFixed(0)} kB` : `${(n / 1e6).toFixed(1)} MB`);
