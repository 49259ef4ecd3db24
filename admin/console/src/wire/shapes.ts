// What the server says, as its API spells it (admin/README.md, proto/README.md). Metres in the building's own frame; azimuths in
// degrees clockwise from its y axis.

export type Point = [number, number];
export type Ring = Point[];

export interface Floor { ordinal: number; label: string; outline: Ring[]; walkable: Ring[][]; walls?: Point[][] }

export interface BuildingSummary { id: number; name: string; pipeline: string; survey_version: number }

export interface Building extends BuildingSummary {
  radio_map_version: number;
  points: number;
  georeference?: { origin: { latitude_deg: number; longitude_deg: number }; y_axis_azimuth_deg: number };
  magnetic_field: { declination_deg: number; dip_deg: number; norm_ut: number };
  publication?: 'automatic' | 'reviewed';   // whether a new radio map comes into force by itself
  floors: Floor[];
}

export interface Place { x_m: number; y_m: number; floor: number }

export interface Reading { bssid: string; rss_dbm: number; age_us: number; frequency_mhz?: number }

export interface ReferencePoint {
  id: number;
  place: Place;
  sigma_m: number;
  device_model: string;
  walk: string;
  surveyed_at_us: number;
  scans: { time_us: number; readings: Reading[] }[];
}

export interface Transmitter { bssid: string; frequency_mhz: number; readings: number; strongest_dbm: number }

export type Integrity = 'ok' | 'degraded' | 'suspect';

export interface FusedPosition {
  valid_at_us: number;
  building: number;
  place: Place;
  floors: { floor: number; probability: number }[];
  covariance: { xx_m2: number; xy_m2: number; yy_m2: number };
  radius68_m: number;
  radius95_m: number;
  azimuth_deg: number;
  azimuth_sigma_deg: number;
  speed_mps: number;
  radio_map_version: number;
  integrity: Integrity;
  from: { transmitters_used: number; transmitters_unknown: number; scan_age_us: number; steps_since_scan: number; gnss?: boolean };
}

export interface Observed { tracked: string; position: FusedPosition; received_at_us: number; gone?: boolean }

export interface ZoneEvent {
  tracked: string;
  zone: string;
  zone_name?: string;
  transition: 'entered' | 'left';
  at_us: number;
  floor: number;
  probability: number;
  id?: string;
  retracts?: string;       // the earlier event that this one takes back
}

export interface Session {
  tracked: string;
  building: number;
  device_model: string;
  app: string;
  pipeline: string;
  since_us: number;
  connected: boolean;
  applied_through: number;
  zones?: string[];
}

export interface Key {
  id: number;
  name: string;
  scopes: string[];
  building: number;
  created_at_us: number;
  expires_at_us?: number;
  revoked: boolean;
  coarse: boolean;                   // sees zones, never coordinates
}
