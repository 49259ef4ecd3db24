import { useEffect, useState } from 'preact/hooks';

/// Where the operator is: `#/7/survey` is the survey of building 7. The address can be kept and sent; it holds no key.
export interface Route { building: number | null; view: string }

export function routeOf(hash: string): Route {
  const [, building = '', view = ''] = hash.split('/');
  return { building: /^\d+$/.test(building) ? Number(building) : null, view };
}

export const hashOf = (building: number | null, view: string) => `#/${building ?? '-'}/${view}`;

export function go(building: number | null, view: string): void {
  location.hash = hashOf(building, view);
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
