/// What the marks of an explained position mean.
export function MapKey({ truth }: { truth: boolean }) {
  return (
    <div class="map-panel why-key">
      <span class="row tight"><svg width="10" height="10" aria-hidden="true"><circle class="particle" cx="5" cy="5" r="3" /></svg>Particles, larger = heavier</span>
      <span class="row tight"><svg width="20" height="10" aria-hidden="true"><line x1="0" x2="20" y1="5" y2="5" /></svg>68 %</span>
      <span class="row tight"><svg width="20" height="10" aria-hidden="true"><line class="dashed" x1="0" x2="20" y1="5" y2="5" /></svg>95 %</span>
      {truth && <span class="row tight"><svg width="12" height="12" aria-hidden="true"><rect x="1.5" y="1.5" width="9" height="9" /></svg>Truth</span>}
    </div>
  );
}
