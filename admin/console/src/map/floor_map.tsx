import L from 'leaflet';
import { Maximize, Minus, Plus } from 'lucide-preact';
import type { ComponentChildren } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';
import type { Floor, Ring } from '../wire/shapes';

export const toLatLng = ([x, y]: [number, number]): L.LatLngTuple => [y, x];
export const toPoint = ({ lat, lng }: L.LatLng): [number, number] => [lng, lat];
export const toLatLngs = (rings: Ring[]): L.LatLngTuple[][] => rings.map((ring) => ring.map(toLatLng));

// Back to front; what is painted later lies on top.
const kPanes = { image: 210, plan: 230, heat: 235, zones: 240, points: 250, walks: 260, tracks: 430, phones: 440, marks: 650 } as const;
export type Pane = keyof typeof kPanes;

interface FloorMapProps {
  floors: Floor[];
  floor: number | null;
  onFloor: (ordinal: number) => void;
  onMap: (map: L.Map | null) => void;
  onPick?: (x: number, y: number, reach: number) => void;   // metres; reach: how far a finger may miss
  counts?: Map<number, number>;                             // phones on each floor
  label: string;
  children?: ComponentChildren;                             // over the map
}

export function boundsOf(floor: Floor | undefined): L.LatLngBounds | null {
  const corners = floor?.outline.flat() ?? [];
  return corners.length ? L.latLngBounds(corners.map(toLatLng)) : null;
}

/// Leaflet over the floor's own metres (CRS.Simple): no projection, no tiles, nothing from elsewhere.
export function FloorMap({ floors, floor, onFloor, onMap, onPick, counts, label, children }: FloorMapProps) {
  const box = useRef<HTMLDivElement>(null);
  const [map, setMap] = useState<L.Map | null>(null);
  const pick = useRef(onPick);
  pick.current = onPick;
  const untouched = useRef(true);
  const refit = useRef(() => {});
  const shown = floors.find((one) => one.ordinal === floor);

  useEffect(() => {
    const made = L.map(box.current!, {
      crs: L.CRS.Simple, zoomControl: false, attributionControl: false, minZoom: -4, maxZoom: 8, zoomSnap: 0.25, zoomDelta: 0.5,
      wheelPxPerZoomLevel: 120, maxBoundsViscosity: 0.6, editable: true, doubleClickZoom: false,
    } as L.MapOptions);
    for (const [name, order] of Object.entries(kPanes)) {
      const pane = made.createPane(name);
      pane.style.zIndex = String(order);
      if (['heat', 'plan', 'image', 'points', 'tracks', 'phones'].includes(name)) pane.style.pointerEvents = 'none';
    }
    L.control.scale({ imperial: false, position: 'bottomright', maxWidth: 120 }).addTo(made);
    made.setView([0, 0], 2);
    made.on('click', ({ latlng }) => pick.current?.(latlng.lng, latlng.lat, 18 / 2 ** made.getZoom()));
    const watch = new ResizeObserver(() => {
      made.invalidateSize({ pan: false });
      refit.current();
    });
    watch.observe(box.current!);
    setMap(made);
    onMap(made);
    return () => {
      watch.disconnect();
      onMap(null);
      made.remove();
    };
  }, []);

  const fit = (animate: boolean) => {
    const bounds = boundsOf(shown);
    if (map && bounds) map.fitBounds(bounds, { animate, padding: [28, 28] });
    untouched.current = true;
  };
  // A whole floor stays whole when the screen is turned or resized.
  refit.current = () => { if (untouched.current) fit(false); };
  useEffect(() => {
    const touch = () => { untouched.current = false; };
    const frame = box.current!;
    const kTouches = ['pointerdown', 'wheel', 'keydown'] as const;
    for (const name of kTouches) frame.addEventListener(name, touch);
    return () => kTouches.forEach((name) => frame.removeEventListener(name, touch));
  }, []);
  const zoom = (way: 1 | -1) => { untouched.current = false; if (way > 0) map?.zoomIn(); else map?.zoomOut(); };
  useEffect(() => drawPlan(map, shown), [map, shown]);
  // Another building, another extent: the view moves only when what is shown lies elsewhere.
  const extent = boundsOf(shown)?.toBBoxString();
  useEffect(() => fit(false), [map, extent]);

  return (
    <div class="map">
      <div class="map-box" ref={box} tabIndex={0} role="application" aria-label={`${label} Arrow keys move, plus and minus zoom.`} />
      <div class="map-tools" role="group" aria-label="Map view">
        <button class="tool" title="Zoom in" aria-label="Zoom in" onClick={() => zoom(1)}><Plus /></button>
        <button class="tool" title="Zoom out" aria-label="Zoom out" onClick={() => zoom(-1)}><Minus /></button>
        <button class="tool" title="Show the whole floor" aria-label="Show the whole floor" onClick={() => fit(true)}><Maximize /></button>
      </div>
      {floors.length > 0 && <FloorSwitch floors={floors} floor={floor} onFloor={onFloor} counts={counts} />}
      {children}
    </div>
  );
}

function FloorSwitch({ floors, floor, onFloor, counts }: Pick<FloorMapProps, 'floors' | 'floor' | 'onFloor' | 'counts'>) {
  const upFirst = [...floors].sort((a, b) => b.ordinal - a.ordinal);
  return (
    <div class="floor-switch" role="radiogroup" aria-label="Floor">
      {upFirst.map((one) => (
        <label class={one.ordinal === floor ? 'on' : ''} key={one.ordinal} title={`Floor ${one.ordinal}`}>
          <input type="radio" name="floor" value={one.ordinal} checked={one.ordinal === floor} onChange={() => onFloor(one.ordinal)} />
          <span>{one.label || one.ordinal}</span>
          {counts && <small>{counts.get(one.ordinal) ?? 0}</small>}
        </label>
      ))}
    </div>
  );
}

// Everything inside the outline is closed unless a walkable area opens it; a floor without walkable areas is open throughout.
function drawPlan(map: L.Map | null, floor: Floor | undefined): (() => void) | undefined {
  if (!map || !floor) return undefined;
  const shape = (rings: Ring[], className: string) => L.polygon(toLatLngs(rings), { pane: 'plan', className, interactive: false });
  const plan = L.layerGroup();
  if (floor.outline.length) plan.addLayer(shape(floor.outline, floor.walkable.length ? 'plan-closed' : 'plan-open'));
  for (const polygon of floor.walkable) plan.addLayer(shape(polygon, 'plan-open'));
  for (const wall of floor.walls ?? []) plan.addLayer(L.polyline(wall.map(toLatLng), { pane: 'plan', className: 'plan-wall', interactive: false }));
  if (floor.outline.length) plan.addLayer(shape(floor.outline, 'plan-outline'));
  plan.addTo(map);
  return () => plan.remove();
}
