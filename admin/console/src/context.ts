import { createContext } from 'preact';
import { useContext } from 'preact/hooks';
import type { Phones } from './live/phones';
import type { Tone } from './parts/parts';
import type { LinkState } from './wire/observer';
import type { Building, BuildingSummary, ZoneEvent } from './wire/shapes';

/// What every view stands on. `buildings` is null where the key is for one building and may not list them.
export interface Standing {
  buildings: BuildingSummary[] | null;
  building: Building | null;
  floor: number | null;
  setFloor: (ordinal: number) => void;
  reload: () => void;
  forget: (building: number) => void;  // it was removed
  phones: Phones;
  link: LinkState;
  zoneEvents: ZoneEvent[];             // newest first
  say: (tone: Tone, text: string) => void;
}

export const StandingContext = createContext<Standing | null>(null);

export const useStanding = (): Standing => useContext(StandingContext)!;

/// For the views that need an open building.
export function useBuilding(): Standing & { building: Building } {
  return useStanding() as Standing & { building: Building };
}
