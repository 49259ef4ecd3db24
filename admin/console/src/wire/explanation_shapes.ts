// Why a position is where it is (admin/README.md).

import type { Integrity } from './shapes';

export interface ReadingExplained {
  bssid: string;
  heard_dbm: number;
  expected_dbm: number | null;       // mean over the survey around the position
  residual_db: number | null;
  surveyed_scans: number;
  age_us: number;
  why?: string;                      // why it said nothing about the place
}

export interface ExplainedPosition {
  x_m: number;
  y_m: number;
  floor: number;
  radius68_m: number;
  radius95_m: number;
  covariance_m2: [number, number, number];   // xx, xy, yy
  azimuth_deg: number;
  speed_mps: number;
  radio_map_version: number;
  integrity: Integrity;
}

export interface Explanation {
  tracked: string;
  building: number;
  pipeline: string;
  position: ExplainedPosition;
  scan_age_us: number;
  steps_since_scan: number;
  gnss: boolean;
  surveyed_points_near: number;
  used: ReadingExplained[];
  rejected: ReadingExplained[];
  floor_votes: { floor: number; probability: number }[];
  integrity: { state: Integrity; reasons: string[] };
  remarks?: string[];                        // what the pipeline could not prepare here
  particles: [number, number, number][];     // x_m, y_m, weight
}
