// Recorded sessions and their replay (admin/README.md).

import type { Explanation } from './explanation_shapes';

export interface RecordingState {
  on: boolean;
  until_us?: number;
  bytes: number;                     // that it may take
  kept_s: number;
  tracked: string[];                 // none: every phone
  recordings: number;
  bytes_used: number;
  pieces_dropped: number;
  not_recorded: number;
}

export interface Recording {
  id: number;
  tracked: string;
  device_model: string;
  app: string;
  pipeline: string;
  begun_at_us: number;
  ended_at_us: number;
  growing: boolean;
  from_the_start: boolean;
  samples: number;
  steps: number;
  bytes: number;
}

export interface ReplayStep {
  step: number;                      // 1, 2, ..
  time_us: number;                   // the phone's clock
  applied_through: number;
  radio_map_version: number;
  said: boolean;                     // the phone was told a position then
  as_live: boolean | null;           // the same bits; null: none was told, or this is another pipeline or map
  no_position?: string;              // why
  explanation?: Explanation;
}

export interface Replay {
  pipeline: string;
  as_it_was: boolean;
  steps_in_all: number;
  differing: number;
  remarks: string[];
  steps: ReplayStep[];
}
