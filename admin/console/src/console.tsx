import { BookOpen, Building2, Database, FileStack, History, KeyRound, Layers, LogOut, MapPinned, Moon, Navigation, Router, ScrollText, Shapes, Sun, Waypoints, Webhook } from 'lucide-preact';
import type { ComponentType } from 'preact';
import { useCallback, useEffect, useMemo, useRef, useState } from 'preact/hooks';
import { StandingContext, type Standing } from './context';
import { Phones } from './live/phones';
import { listenToInks } from './map/inks';
import { Empty, Fault, Loading, Notice, type Tone } from './parts/parts';
import { go, hashOf, useRoute } from './route';
import { isDark, switchTheme } from './theme';
import { AccessPoints } from './views/access_points';
import { Audit } from './views/audit';
import { Buildings } from './views/buildings';
import { Data } from './views/data';
import { FloorPlans } from './views/floor_plans';
import { Keys } from './views/keys';
import { Live } from './views/live';
import { RadioMaps } from './views/radio_maps';
import { Sessions } from './views/sessions';
import { SignIn } from './views/sign_in';
import { Survey } from './views/survey';
import { TimeMachine } from './views/time_machine';
import { Webhooks } from './views/webhooks';
import { Zones } from './views/zones';
import { tabKey } from './wire/api';
import { Observer, type LinkState } from './wire/observer';
import type { Building, BuildingSummary, ZoneEvent } from './wire/shapes';
import { useAnswer } from './wire/use_answer';

interface View { name: string; title: string; short: string; icon: ComponentType<Record<string, unknown>>; show: ComponentType; ofBuilding: boolean }

const view = (name: string, title: string, short: string, icon: unknown, show: ComponentType, ofBuilding = true): View =>
  ({ name, title, short, icon: icon as View['icon'], show, ofBuilding });

const kViews: View[] = [
  view('live', 'Live', 'Live', Navigation, Live),
  view('sessions', 'Sessions', 'Sessions', Waypoints, Sessions),
  view('replay', 'Time machine', 'Replay', History, TimeMachine),
  view('zones', 'Zones', 'Zones', Shapes, Zones),
  view('survey', 'Survey', 'Survey', MapPinned, Survey),
  view('maps', 'Radio maps', 'Maps', Layers, RadioMaps),
  view('access-points', 'Access points', 'Access', Router, AccessPoints),
  view('plans', 'Floor plans', 'Plans', FileStack, FloorPlans),
  view('webhooks', 'Webhooks', 'Hooks', Webhook, Webhooks),
  view('data', 'Data and privacy', 'Data', Database, Data),
  view('buildings', 'Buildings', 'Buildings', Building2, Buildings, false),
  view('keys', 'Keys', 'Keys', KeyRound, Keys, false),
  view('audit', 'Audit', 'Audit', ScrollText, Audit, false),
];

export function Console() {
  const [key, setKey] = useState(tabKey.get());
  const leave = useCallback(() => { tabKey.forget(); setKey(''); }, []);
  return key ? <Signed key={key} leave={leave} /> : <SignIn onKey={(good) => { tabKey.set(good); setKey(good); }} />;
}

function Signed({ leave }: { leave: () => void }) {
  const route = useRoute();
  const list = useAnswer<{ buildings: BuildingSummary[] }>('/v1/buildings');
  // A key for one building may not list them: then the address names it.
  const [removed, setRemoved] = useState<number | null>(null);
  const buildings = list.data?.buildings.filter((each) => each.id !== removed) ?? null;
  const limited = list.fault?.status === 403;
  const id = (route.building !== removed ? route.building : null) ?? buildings?.[0]?.id ?? null;
  const one = useAnswer<Building>(id ? `/v1/buildings/${id}` : null);
  const reload = () => { setRemoved(null); list.again(); one.again(); };
  const forget = (gone: number) => { setRemoved(gone); list.again(); go(null, 'buildings'); };
  const standing = useStandingOf(one.data, buildings, reload, forget);
  const shown = kViews.find((each) => each.name === route.view) ?? kViews[0]!;

  useEffect(() => { document.title = `${shown.title} · ${one.data?.name ?? 'wayfuse'}`; }, [shown, one.data?.name]);
  useEffect(() => { if (list.fault?.status === 401) leave(); }, [list.fault]);

  return (
    <StandingContext.Provider value={standing.value}>
      <div class="shell">
        <button class="skip" onClick={() => document.getElementById('page')!.focus()}>Skip to the page</button>
        <Rail view={shown.name} building={id} />
        <Top buildings={buildings} building={one.data} view={shown.name} link={standing.value.link} leave={leave} />
        <main class="page" id="page" tabIndex={-1}>
          {list.fault && !limited && !list.data ? <div class="sheet"><Fault fault={list.fault} again={list.again} /></div>
            : !shown.ofBuilding ? <shown.show />
            : one.fault && !one.data ? <div class="sheet"><Fault fault={one.fault} again={one.again} /></div>
            : one.data ? <shown.show key={one.data.id} />
            : buildings?.length === 0 ? <NoBuilding /> : <Loading what="the building" />}
        </main>
        <Toasts toasts={standing.toasts} />
      </div>
    </StandingContext.Provider>
  );
}

function useStandingOf(building: Building | null, buildings: BuildingSummary[] | null, reload: () => void, forget: (building: number) => void) {
  const phones = useMemo(() => new Phones(), []);
  const [link, setLink] = useState<LinkState>({ kind: 'connecting' });
  const [zoneEvents, setZoneEvents] = useState<ZoneEvent[]>([]);
  const [floor, setFloor] = useState<number | null>(null);
  const [toasts, setToasts] = useState<{ id: number; tone: Tone; text: string }[]>([]);
  const toastId = useRef(0);
  const say = useCallback((tone: Tone, text: string) => {
    const id = ++toastId.current;
    setToasts((all) => [...all.slice(-3), { id, tone, text }]);
    setTimeout(() => setToasts((all) => all.filter((toast) => toast.id !== id)), 6000);
  }, []);

  useEffect(() => {
    if (!building) return;
    const observer = new Observer(building.id, {
      onLink: setLink,
      onObserved: (observed) => phones.observe(observed),
      onZoneEvent: (event) => setZoneEvents((all) => [event, ...all].slice(0, 500)),
    });
    setZoneEvents([]);
    phones.clear();
    return () => observer.close();
  }, [building?.id]);
  const floors = building?.floors.map((one) => one.ordinal) ?? [];
  const chosen = floor !== null && floors.includes(floor) ? floor : floors.includes(0) ? 0 : floors[0] ?? null;
  const value: Standing = { buildings, building, floor: chosen, setFloor, reload, forget, phones, link, zoneEvents, say };
  return { value, toasts };
}

function Rail({ view, building }: { view: string; building: number | null }) {
  const rail = useRef<HTMLElement>(null);
  // On a phone the rail is a row wider than the screen.
  useEffect(() => rail.current?.querySelector('[aria-current]')?.scrollIntoView({ inline: 'center', block: 'nearest' }), [view]);
  const entry = (each: View) => (
    <a key={each.name} href={hashOf(building, each.name)} aria-current={each.name === view ? 'page' : undefined} title={each.title}>
      <each.icon aria-hidden="true" /><span class="full">{each.title}</span><span class="short" aria-hidden="true">{each.short}</span>
    </a>
  );
  return (
    <nav class="rail" aria-label="Views" ref={rail}>
      <div class="brand"><Mark /><span>wayfuse</span></div>
      <h3>Building</h3>
      {kViews.filter((each) => each.ofBuilding).map(entry)}
      <h3>Server</h3>
      {kViews.filter((each) => !each.ofBuilding).map(entry)}
      <a class="foot" href="/docs" title="API"><BookOpen aria-hidden="true" /><span class="full">API</span><span class="short" aria-hidden="true">API</span></a>
    </nav>
  );
}

export const Mark = () => (
  <svg viewBox="0 0 24 24" fill="none" aria-hidden="true">
    <circle cx="12" cy="12" r="10.5" fill="currentColor" opacity=".16" />
    <circle cx="12" cy="12" r="6.5" fill="currentColor" opacity=".3" />
    <circle cx="12" cy="12" r="3.2" fill="currentColor" />
  </svg>
);

interface TopProps { buildings: BuildingSummary[] | null; building: Building | null; view: string; link: LinkState; leave: () => void }

function Top({ buildings, building, view, link, leave }: TopProps) {
  const [dark, setDark] = useState(isDark());
  useEffect(() => listenToInks(() => setDark(isDark())), []);
  return (
    <header class="top">
      <div class="building-choice">
        {buildings && buildings.length > 0 ? (
          <select aria-label="Building" value={building?.id ?? ''} onChange={(event) => go(Number(event.currentTarget.value), view)}>
            {buildings.map((one) => <option key={one.id} value={one.id}>{one.name}</option>)}
          </select>
        ) : <strong>{building?.name ?? ''}</strong>}
      </div>
      <span class="spring" />
      {building && <LinkBadge link={link} />}
      <button class="quiet" title={dark ? 'Light' : 'Dark'} aria-label={dark ? 'Switch to light' : 'Switch to dark'}
        onClick={switchTheme}>{dark ? <Sun /> : <Moon />}</button>
      <button class="quiet" title="Sign out" aria-label="Sign out" onClick={leave}><LogOut /></button>
    </header>
  );
}

function LinkBadge({ link }: { link: LinkState }) {
  const [tone, text] = link.kind === 'live' ? ['good', 'Live'] : link.kind === 'connecting' ? ['', 'Connecting']
    : link.kind === 'lost' ? ['warn', 'Reconnecting'] : ['bad', 'Not live'];
  return (
    <span class={`badge ${tone}`} id="link" role="status" title={link.kind === 'refused' ? link.cause : undefined}>
      <i class={`dot ${tone}`} />{text}
    </span>
  );
}

function NoBuilding() {
  return (
    <div class="sheet"><div class="card">
      <Empty icon={<Building2 />} title="No building yet">
        <a href={hashOf(null, 'buildings')}>Create the first one</a>: give it a name and its floors, then survey it.
      </Empty>
    </div></div>
  );
}

function Toasts({ toasts }: { toasts: { id: number; tone: Tone; text: string }[] }) {
  return <div class="toasts" aria-live="polite">{toasts.map(({ id, tone, text }) => <Notice key={id} tone={tone}>{text}</Notice>)}</div>;
}
