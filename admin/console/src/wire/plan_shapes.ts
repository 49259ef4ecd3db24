export interface Check { severity: 'error' | 'warning' | 'note'; code: string; feature: string; detail: string }

export interface PlanReport {
  format: string;
  stored: boolean;
  floors: { ordinal: number; label: string; outline_m2: number; walkable_m2: number; rooms: number; doors: number; walls: number }[];
  checks: Check[];
  zones: { name: string }[];
}

export interface FloorImage {
  floor: number;
  media_type: string;
  width_px: number;
  height_px: number;
  origin_x_m: number;
  origin_y_m: number;
  width_m: number;
  height_m: number;
  azimuth_deg: number;
  bytes: number;
}

export interface GeoreferenceFit {
  stored: boolean;
  georeference: { origin: { latitude_deg: number; longitude_deg: number }; y_axis_azimuth_deg: number };
  rms_m: number;
  scale: number;
  shear_deg: number | null;
  control_points: { residual_m: number; without_it_m: number | null }[];
  checks: Check[];
}
