// The phones of the building on screen: newest position, the way there, the last minutes' track. Mutable and outside the page's
// state: 500 phones change five times a second, and only the canvas has to follow each change.

import type { FusedPosition, Observed, Place } from '../wire/shapes';

const kTrackMs = 60_000;
const kTrackStepM = 0.4;      // closer points than this are one on screen
const kGlideMs = 400;         // a jump between two positions is shown as a short glide
const kForgetGoneMs = 120_000;

export interface TrackPoint { x: number; y: number; floor: number; at: number }

export interface Phone {
  name: string;
  position: FusedPosition;
  gone: boolean;
  heardAt: number;            // performance.now()
  receivedUs: number;
  track: TrackPoint[];
  radii: number[];            // the 68 % radius of the last positions, oldest first
  from: Place;                // where it was drawn when the newest position came
}

export class Phones {
  readonly byName = new Map<string, Phone>();
  changes = 0;                // counts up at each change
  private readonly listeners = new Set<() => void>();

  listen(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  clear(): void {
    this.byName.clear();
    this.changed();
  }

  observe(all: Observed[], now = performance.now()): void {
    for (const { tracked, position, gone, received_at_us } of all) {
      const known = this.byName.get(tracked);
      const from = known ? shownAt(known, now) : position.place;
      const phone: Phone = known ?? { name: tracked, position, gone: false, heardAt: now, receivedUs: 0, track: [], radii: [], from };
      Object.assign(phone, { position, gone: Boolean(gone), heardAt: now, receivedUs: received_at_us, from });
      extend(phone, now);
      this.byName.set(tracked, phone);
    }
    for (const [name, phone] of this.byName) {
      if (phone.gone && now - phone.heardAt > kForgetGoneMs) this.byName.delete(name);
    }
    this.changed();
  }

  present(): Phone[] {
    return [...this.byName.values()].filter((phone) => !phone.gone);
  }

  private changed(): void {
    ++this.changes;
    for (const listener of this.listeners) listener();
  }
}

function extend(phone: Phone, now: number): void {
  const { x_m: x, y_m: y, floor } = phone.position.place;
  phone.radii.push(phone.position.radius68_m);
  if (phone.radii.length > 150) phone.radii.shift();
  const last = phone.track.at(-1);
  if (!last || last.floor !== floor || Math.hypot(x - last.x, y - last.y) >= kTrackStepM) phone.track.push({ x, y, floor, at: now });
  let old = 0;
  while (old < phone.track.length - 1 && now - phone.track[old]!.at > kTrackMs) ++old;
  if (old) phone.track.splice(0, old);
}

const still = matchMedia('(prefers-reduced-motion: reduce)');

/// Whether a phone is still gliding to its newest position.
export function isGliding(phone: Phone, now: number): boolean {
  return !still.matches && now - phone.heardAt < kGlideMs;
}

/// Where a phone is drawn at `now`.
export function shownAt(phone: Phone, now: number): Place {
  const to = phone.position.place;
  if (!isGliding(phone, now) || phone.from.floor !== to.floor) return to;
  const part = (now - phone.heardAt) / kGlideMs;
  return { x_m: phone.from.x_m + (to.x_m - phone.from.x_m) * part, y_m: phone.from.y_m + (to.y_m - phone.from.y_m) * part, floor: to.floor };
}

/// The phone nearest to a point of a floor, within `reach` metres.
export function nearestPhone(phones: Phone[], floor: number | null, x: number, y: number, reach: number): string | null {
  let best: string | null = null;
  let least = reach;
  const now = performance.now();
  for (const phone of phones) {
    const place = shownAt(phone, now);
    const distance = Math.hypot(place.x_m - x, place.y_m - y);
    if (place.floor === floor && distance < least) [best, least] = [phone.name, distance];
  }
  return best;
}
