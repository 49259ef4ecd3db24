import type { Ring } from './shapes';

export interface Zone {
  id: number;
  name: string;
  floor: number;
  region: Ring[];
  exit_tolerance_m: number;
  tolerance_timeout_us: number | null;   // null: for ever
  exit_delay_us: number | null;
  timeout_us: number | null;
}

export interface Occupant { tracked: string; since_us: number; probability: number }
