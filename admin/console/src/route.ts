import { useEffect, useState } from 'preact/hooks';

/// Where the operator is: `#/7/survey` is the survey of building 7, `#/7/sessions/phone-1` one of its sessions. The address can be kept and
/// sent; it holds no key.
export interface Route { building: number | null; view: string; detail: string | null }

export function routeOf(hash: string): Route {
  const [, building = '', view = '', detail = ''] = hash.split('/');
  return { building: /^\d+$/.test(building) ? Number(building) : null, view, detail: detail ? decodeURIComponent(detail) : null };
}

export const hashOf = (building: number | null, view: string, detail?: string) =>
  `#/${building ?? '-'}/${view}${detail ? `/${encodeURIComponent(detail)}` : ''}`;

export function go(building: number | null, view: string, detail?: string): void {
  location.hash = hashOf(building, view, detail);
}

export function useRoute(): Route {
  const [route, setRoute] = useState(routeOf(location.hash));
  useEffect(() => {
    const follow = () => setRoute(routeOf(location.hash));
    addEventListener('hashchange', follow);
    return () => removeEventListener('hashchange', follow);
  }, []);
  return route;
}
