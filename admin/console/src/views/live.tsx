import type L from 'leaflet';
import { Smartphone, X } from 'lucide-preact';
import { useEffect, useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { nearestPhone, type Phone } from '../live/phones';
import { usePhones } from '../live/use_phones';
import { FloorMap, toLatLng } from '../map/floor_map';
import { useFloorImage } from '../map/image_layer';
import { PhoneLayer } from '../map/phone_layer';
import { zoneLayer } from '../map/zone_layer';
import { useLayer } from '../map/use_layer';
import { Badge, Empty, Notice } from '../parts/parts';
import { toneOf } from '../parts/tones';
import { metres, plural } from '../parts/words';
import { hashOf } from '../route';
import type { Session } from '../wire/shapes';
import type { Zone } from '../wire/zone_shapes';
import { useAnswer } from '../wire/use_answer';
import { PhoneCard } from './phone_card';

const kRows = 100;

export function Live() {
  const { building, floor, setFloor, phones, link } = useBuilding();
  const [map, setMap] = useState<L.Map | null>(null);
  const [chosen, setChosen] = useState<string | null>(null);
  const [follow, setFollow] = useState(false);
  const [tracks, setTracks] = useState(true);
  const [inner, setInner] = useState(true);
  const [outer, setOuter] = useState(true);
  const [showZones, setShowZones] = useState(true);
  usePhones(phones);
  const sessions = useAnswer<{ sessions: Session[] }>(`/v1/buildings/${building.id}/sessions`, 5000);
  const layer = useLayer(map, (made) => new PhoneLayer(made, phones));
  useEffect(() => layer?.show({ floor, chosen, tracks, inner, outer }), [layer, floor, chosen, tracks, inner, outer]);

  const zones = useAnswer<{ zones: Zone[] }>(`/v1/buildings/${building.id}/zones?most=1000`);
  useFloorImage(map, building.id, floor);
  useEffect(() => {
    if (!map || !showZones) return;
    const group = zoneLayer((zones.data?.zones ?? []).filter((zone) => zone.floor === floor), null, true).addTo(map);
    return () => { group.remove(); };
  }, [map, zones.data, floor, showZones]);

  const phone = chosen ? phones.byName.get(chosen) ?? null : null;
  const there = phone?.position.place;
  useEffect(() => {
    if (!follow || !map || !there) return;
    if (there.floor !== floor) setFloor(there.floor);
    map.panTo(toLatLng([there.x_m, there.y_m]), { animate: true });
  }, [follow, map, there?.x_m, there?.y_m, there?.floor]);

  const choose = (name: string | null) => {
    setChosen(name);
    setFollow(false);
    const place = name ? phones.byName.get(name)?.position.place : undefined;
    if (!place || !map) return;
    setFloor(place.floor);
    map.panInside(toLatLng([place.x_m, place.y_m]), { padding: [60, 60] });
  };
  const pick = (x: number, y: number, reach: number) => choose(nearestPhone(phones.present(), floor, x, y, reach));
  const present = phones.present();
  const counts = new Map<number, number>();
  for (const one of present) counts.set(one.position.place.floor, (counts.get(one.position.place.floor) ?? 0) + 1);

  return (
    <div class="split">
      <FloorMap floors={building.floors} floor={floor} onFloor={setFloor} onMap={setMap} onPick={pick} counts={counts}
        label={`Live floor plan with ${plural(present.length, 'phone')}.`}>
        <div class="map-panel" role="group" aria-label="What is drawn">
          <label class="check"><input type="checkbox" checked={inner} onChange={() => setInner(!inner)} />68 %</label>
          <label class="check"><input type="checkbox" checked={outer} onChange={() => setOuter(!outer)} />95 %</label>
          <label class="check"><input type="checkbox" checked={tracks} onChange={() => setTracks(!tracks)} />Last minute’s track</label>
          {zones.data && zones.data.zones.length > 0 && (
            <label class="check"><input type="checkbox" checked={showZones} onChange={() => setShowZones(!showZones)} />Zones</label>
          )}
        </div>
        {building.floors.length === 0 && (
          <div class="map-message"><Empty title="No floor plan yet">
            <a href={hashOf(building.id, 'plans')}>Import a plan</a> or <a href={hashOf(building.id, 'buildings')}>describe the floors</a> to see phones on them.
          </Empty></div>
        )}
      </FloorMap>
      <aside class="side" aria-label="Phones">
        {link.kind === 'refused' && <section><Notice tone="bad">Live positions were refused: {link.cause}</Notice></section>}
        {link.kind === 'live' && link.zonesOnly && (
          <section><Notice>This key sees which zone a phone is in, not where it is: see <a href={hashOf(building.id, 'zones')}>Zones</a> and <a href={hashOf(building.id, 'sessions')}>Sessions</a>.</Notice></section>
        )}
        {phone && (
          <section>
            <div class="side-head">
              <h2 class="mono">{phone.name}</h2>
              <button aria-pressed={follow} class={follow ? 'primary' : ''} onClick={() => setFollow(!follow)}>{follow ? 'Following' : 'Follow'}</button>
              <button class="quiet" aria-label="Close" onClick={() => choose(null)}><X /></button>
            </div>
            <PhoneCard phone={phone} session={sessions.data?.sessions.find((one) => one.tracked === phone.name) ?? null} floors={building.floors} />
          </section>
        )}
        {!(link.kind === 'live' && link.zonesOnly) && <PhoneList phones={[...phones.byName.values()]} chosen={chosen} choose={choose} />}
      </aside>
    </div>
  );
}

function PhoneList({ phones, chosen, choose }: { phones: Phone[]; chosen: string | null; choose: (name: string) => void }) {
  const { building } = useBuilding();
  const [wanted, setWanted] = useState('');
  const labelOf = new Map(building.floors.map((one) => [one.ordinal, one.label]));
  const present = phones.filter((phone) => !phone.gone).length;
  const found = phones.filter((phone) => phone.name.includes(wanted.trim())).sort((a, b) => Number(a.gone) - Number(b.gone) || (a.name < b.name ? -1 : 1));
  return (
    <section class="flush">
      <div class="side-head">
        <h2>Phones <span class="badge" id="count">{present}</span></h2>
        {phones.length > 8 && (
          <input type="search" placeholder="Find" aria-label="Find a phone" value={wanted}
            onInput={(event) => setWanted(event.currentTarget.value)} />
        )}
      </div>
      {phones.length === 0 ? (
        <Empty icon={<Smartphone />} title="No phone is here">Phones appear as soon as they send a scan that this building’s survey knows.</Empty>
      ) : (
        <table class="dense">
          <thead><tr><th>Phone</th><th>Floor</th><th class="number">68 %</th><th>Radio</th></tr></thead>
          <tbody id="phones">
            {found.slice(0, kRows).map((phone) => (
              <tr key={phone.name} data-name={phone.name} class={phone.name === chosen ? 'picked' : ''} onClick={() => choose(phone.name)}>
                <td><button class="link mono clip" title={phone.name} aria-pressed={phone.name === chosen}>{phone.name}</button></td>
                <td>{labelOf.get(phone.position.place.floor) || phone.position.place.floor}</td>
                <td class="number">{metres(phone.position.radius68_m)}</td>
                <td>{phone.gone ? <Badge>gone</Badge> : <Badge tone={toneOf(phone.position.integrity)}>{phone.position.integrity}</Badge>}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      {found.length > kRows && <p class="hint">The first {kRows} of {found.length}. Find narrows the list.</p>}
      {phones.length > 0 && found.length === 0 && <p class="hint">No phone’s name contains “{wanted}”.</p>}
    </section>
  );
}
