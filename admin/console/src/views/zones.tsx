import type L from 'leaflet';
import { Plus, Shapes } from 'lucide-preact';
import { useEffect, useMemo, useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { FloorMap } from '../map/floor_map';
import { PhoneLayer } from '../map/phone_layer';
import { areaOf, zoneAt, zoneLayer } from '../map/zone_layer';
import { useLayer } from '../map/use_layer';
import { Empty, Fault, Loading } from '../parts/parts';
import type { Zone } from '../wire/zone_shapes';
import { useAnswer } from '../wire/use_answer';
import { ZoneEvents } from './zone_events';
import { ZoneForm } from './zone_form';
import { ZoneCard } from './zone_card';

/// Zones of the building: see, draw, edit; who is inside; entries and exits as they happen.
export function Zones() {
  const { building, floor, setFloor, phones } = useBuilding();
  const { data, fault, loading, again } = useAnswer<{ zones: Zone[] }>(`/v1/buildings/${building.id}/zones?most=1000`);
  const [map, setMap] = useState<L.Map | null>(null);
  const [chosen, setChosen] = useState<number | null>(null);
  const [editing, setEditing] = useState<Zone | 'new' | null>(null);
  const zones = data?.zones ?? [];
  const here = useMemo(() => zones.filter((zone) => zone.floor === floor), [data, floor]);
  const zone = zones.find((one) => one.id === chosen) ?? null;

  const layer = useLayer(map, (made) => new PhoneLayer(made, phones));
  useEffect(() => layer?.show({ floor, inner: false, outer: false, tracks: false }), [layer, floor]);
  useEffect(() => {
    if (!map) return;
    const shown = editing && editing !== 'new' ? here.filter((one) => one.id !== editing.id) : here;
    const group = zoneLayer(shown, editing ? null : chosen, Boolean(editing)).addTo(map);
    return () => { group.remove(); };
  }, [map, here, chosen, editing]);

  const choose = (one: Zone | null) => {
    setChosen(one?.id ?? null);
    if (one) setFloor(one.floor);
  };
  return (
    <div class="split">
      <FloorMap floors={building.floors} floor={floor} onFloor={setFloor} onMap={setMap} label={`Floor plan with ${here.length} zones.`}
        onPick={(x, y) => { if (!editing) choose(zoneAt(here, x, y)); }}>
        {editing === 'new' && <div class="map-panel" role="status">Click corner after corner, the first again to close. Or write the corners as numbers.</div>}
      </FloorMap>
      <aside class="side" aria-label="Zones">
        {editing ? (
          <ZoneForm key={editing === 'new' ? 0 : editing.id} map={map} zone={editing === 'new' ? null : editing} onClose={() => setEditing(null)}
            onDone={(done) => { setEditing(null); setChosen(done); again(); }} />
        ) : zone && <ZoneCard zone={zone} onEdit={() => setEditing(zone)} onClose={() => choose(null)} onRemoved={() => { choose(null); again(); }} />}
        {!editing && (
          <section class="flush">
            <div class="side-head"><h2>Zones <span class="badge">{zones.length}</span></h2>
              <button onClick={() => { setChosen(null); setEditing('new'); }} disabled={floor === null}><Plus />Draw a zone</button></div>
            {fault && !data ? <div class="card-body"><Fault fault={fault} again={again} /></div> : loading ? <Loading what="the zones" />
              : zones.length === 0 ? <Empty icon={<Shapes />} title="No zone yet">Draw one on the map. Phones that enter and leave it make events.</Empty>
              : <ZoneList zones={zones} chosen={chosen} choose={choose} />}
          </section>
        )}
        <ZoneEvents />
      </aside>
    </div>
  );
}

function ZoneList({ zones, chosen, choose }: { zones: Zone[]; chosen: number | null; choose: (zone: Zone) => void }) {
  const { building } = useBuilding();
  const labelOf = new Map(building.floors.map((one) => [one.ordinal, one.label]));
  return (
    <table class="dense">
      <thead><tr><th>Name</th><th>Floor</th><th class="number">Area</th></tr></thead>
      <tbody id="zones">
        {zones.map((zone) => (
          <tr key={zone.id} data-name={zone.name} class={zone.id === chosen ? 'picked' : ''} onClick={() => choose(zone)}>
            <td><button class="link" aria-pressed={zone.id === chosen}>{zone.name}</button></td>
            <td>{labelOf.get(zone.floor) || zone.floor}</td>
            <td class="number">{zone.region[0] ? `${areaOf(zone.region[0]).toFixed(0)} m²` : '–'}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
