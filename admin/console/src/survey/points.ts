// The reference points of one floor, boiled down while they arrive: a floor may hold ten thousand points with fifty readings a scan,
// and the map needs one mean level an access point.

import { useEffect, useState } from 'preact/hooks';
import { askPages, Refusal } from '../wire/api';
import type { Place, ReferencePoint } from '../wire/shapes';

export interface SurveyedPoint {
  id: number;
  place: Place;
  sigma: number;
  model: string;
  walk: string;
  surveyedUs: number;
  scans: number;
  heard: Map<string, number>;     // bssid -> mean level, dBm
}

export function boil(point: ReferencePoint): SurveyedPoint {
  const sums = new Map<string, [number, number]>();
  for (const scan of point.scans) {
    for (const { bssid, rss_dbm } of scan.readings) {
      const [sum, n] = sums.get(bssid) ?? [0, 0];
      sums.set(bssid, [sum + rss_dbm, n + 1]);
    }
  }
  return {
    id: point.id, place: point.place, sigma: point.sigma_m, model: point.device_model, walk: point.walk,
    surveyedUs: point.surveyed_at_us, scans: point.scans.length,
    heard: new Map([...sums].map(([bssid, [sum, n]]) => [bssid, sum / n])),
  };
}

export interface Points { points: SurveyedPoint[]; complete: boolean; fault: Refusal | null }

/// `version` changes when the survey grew.
export function usePoints(building: number, floor: number | null, version: number): Points {
  const [state, setState] = useState<Points>({ points: [], complete: false, fault: null });
  useEffect(() => {
    setState({ points: [], complete: floor === null, fault: null });
    if (floor === null) return;
    const stop = new AbortController();
    void (async () => {
      const points: SurveyedPoint[] = [];
      try {
        for await (const page of askPages<ReferencePoint>(`/v1/buildings/${building}/points?floor=${floor}`, 'points', stop.signal)) {
          points.push(...page.map(boil));
          setState({ points: [...points], complete: false, fault: null });
        }
        setState({ points, complete: true, fault: null });
      } catch (error) {
        if (error instanceof Refusal) setState({ points, complete: false, fault: error });
      }
    })();
    return () => stop.abort();
  }, [building, floor, version]);
  return state;
}
