import type L from 'leaflet';
import { useEffect, useMemo } from 'preact/hooks';
import { listenToInks } from './inks';

interface CanvasDrawn { show(change: object): void; remove(): void }

/// A layer of canvases for as long as the map is there, painted anew when the theme changes.
export function useLayer<T extends CanvasDrawn>(map: L.Map | null, make: (map: L.Map) => T): T | null {
  const layer = useMemo(() => (map ? make(map) : null), [map]);
  useEffect(() => {
    if (!layer) return;
    const deaf = listenToInks(() => layer.show({}));
    return () => { deaf(); layer.remove(); };
  }, [layer]);
  return layer;
}
