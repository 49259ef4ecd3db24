// Viridis (Smith and van der Walt, matplotlib, CC0) at eight places: even steps look even, and it survives colour blindness and print.

const kStops = [[68, 1, 84], [70, 50, 127], [54, 92, 141], [39, 127, 142], [31, 161, 135], [74, 194, 109], [159, 218, 58], [253, 231, 37]] as const;

/// The colour at 0..1.
export function colourAt(part: number): [number, number, number] {
  const at = Math.min(Math.max(part, 0), 1) * (kStops.length - 1);
  const i = Math.min(Math.floor(at), kStops.length - 2);
  const [from, to] = [kStops[i]!, kStops[i + 1]!];
  const mix = (k: 0 | 1 | 2) => Math.round(from[k] + (to[k] - from[k]) * (at - i));
  return [mix(0), mix(1), mix(2)];
}

export const cssColourAt = (part: number) => `rgb(${colourAt(part).join(' ')})`;

export interface Scale { least: number; most: number; unit: string }

/// From hardly heard to beside the access point.
export const kLevels: Scale = { least: -90, most: -40, unit: 'dBm' };

/// 0..1 on a scale; `least` may be the larger number.
export const partOf = (scale: Scale, value: number) => (value - scale.least) / (scale.most - scale.least);
