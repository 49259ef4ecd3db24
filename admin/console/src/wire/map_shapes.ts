// Radio maps as versions, their measured quality, expected accuracy, access points (admin/README.md).

import type { Point } from './shapes';

export interface Quality {
  walks?: number;
  asked: number;
  instants: number;
  mean_m: number;
  median_m: number;
  p90_m: number;
  floor_hit: number;
  in68: number;
  in95: number;
  error_quantiles_m?: number[];      // 101 numbers, 0..100 % of all instants
}

export interface SurveyDevice {
  model: string;
  points: number;
  standing: 'reference' | 'learnt' | 'agrees' | 'unknown';
  offset_db: number;                 // louder than the reference, as found; taken out where learnt alone
  places: number;
  transmitters: number;
}

export interface RadioMap {
  version: number;
  live: boolean;
  survey_version: number;
  built_at_us: number;
  sha256: string;
  bytes: number;
  points: number;
  devices: SurveyDevice[];
  quality: Quality | null;
}

export interface Comparison {
  version: number;
  live: number | null;
  pipeline: string;
  verdict: 'better' | 'same' | 'worse' | 'unknown';
  reasons: string[];
  remarks: string[];
  mean_difference_m: number | null;
  mean_difference_low_m: number | null;
  mean_difference_high_m: number | null;
  candidate_quality: Quality | null;
  live_quality: Quality | null;
  walks: { id: number; name: string; candidate: Quality | null; live: Quality | null }[];
}

export interface Publication { id: number; version: number; act: 'promoted' | 'rolled_back'; at_us: number; by_key: number; reason: string }

export interface QualityWalk { id: number; name: string; device_model: string; recorded_at_us: number; sha256: string; bytes: number }

export interface Accuracy {
  floor: number;
  origin_x_m: number;
  origin_y_m: number;
  cell_m: number;
  columns: number;
  rows: number;
  median_m: number | null;
  points: number[];
  expected_m: (number | null)[];
}

export interface SurveyPlan {
  floor: number;
  median_now_m: number | null;
  walks: { path: Point[]; length_m: number; median_after_m: number; why: string }[];
}

export interface AccessPoint {
  bssid: string;
  state: 'ok' | 'vanished' | 'moved' | 'power_changed' | 'new';
  trust: 'auto' | 'always' | 'never';
  quarantined: boolean;
  on_map: boolean;
  reason: string;
  heard_sessions: number;
  last_heard_us: number | null;
  distance_m: number | null;
  change_db: number | null;
  resurvey: { x_m: number; y_m: number; floor: number }[];
}
