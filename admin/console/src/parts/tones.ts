import type { Integrity } from '../wire/shapes';

export const toneOf = (integrity: Integrity) => (({ ok: 'good', degraded: 'warn', suspect: 'bad' }) as const)[integrity];
