import { cssColourAt, type Scale } from '../map/scale_colours';

/// The colours of a scale with their numbers.
export function Legend({ scale, title }: { scale: Scale; title: string }) {
  const steps = [0, 0.2, 0.4, 0.6, 0.8, 1];
  return (
    <figure class="legend" aria-label={`${title}: ${scale.least} to ${scale.most} ${scale.unit}`}>
      <svg width="100%" height="10" viewBox="0 0 100 10" preserveAspectRatio="none" aria-hidden="true">
        <defs><linearGradient id="scale-colours">{steps.map((at) => <stop key={at} offset={at} stop-color={cssColourAt(at)} />)}</linearGradient></defs>
        <rect width="100" height="10" rx="2" fill="url(#scale-colours)" />
      </svg>
      <figcaption><span>{scale.least}</span><span>{title}, {scale.unit}</span><span>{scale.most}</span></figcaption>
    </figure>
  );
}
