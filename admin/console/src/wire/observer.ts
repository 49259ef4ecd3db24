// The observer's WebSocket (proto/README.md, role observe): newest positions of a building's phones, and zone events.

import { tabKey } from './api';
import type { Observed, ZoneEvent } from './shapes';

export type LinkState = { kind: 'connecting' } | { kind: 'live'; zonesOnly: boolean } | { kind: 'lost' } | { kind: 'refused'; cause: string };

export interface Hearing {
  onLink(state: LinkState): void;
  onObserved(observed: Observed[]): void;
  onZoneEvent(event: ZoneEvent): void;
}

const kIntervalUs = 200_000;
const kLongestWaitMs = 15_000;

export class Observer {
  private socket: WebSocket | null = null;
  private wait = 500;
  private refused = false;
  private zonesOnly = false;           // a coarse key: it is told zones and no positions
  private timer = 0;

  constructor(private readonly building: number, private readonly hearing: Hearing) {
    this.connect();
  }

  close(): void {
    clearTimeout(this.timer);
    const socket = this.socket;
    this.socket = null;
    socket?.close();
  }

  private connect(): void {
    this.hearing.onLink({ kind: 'connecting' });
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const socket = new WebSocket(`${scheme}://${location.host}/v1/session`, 'wayfuse.v1.json');
    this.socket = socket;
    socket.onopen = () => {
      socket.send(JSON.stringify({ type: 'hello', role: 'observe', building: this.building, token: tabKey.get(), app: 'wayfuse console', phone_time_us: 0 }));
      this.subscribe(socket);
    };
    socket.onmessage = ({ data }) => this.socket === socket && this.receive(JSON.parse(data as string));
    socket.onclose = () => this.socket === socket && this.lost();
  }

  private subscribe(socket: WebSocket): void {
    const wanted = { type: 'subscribe', min_interval_us: kIntervalUs, zone_events: true, ...(this.zonesOnly && { positions: false }) };
    socket.send(JSON.stringify(wanted));
  }

  private receive(message: { type: string } & Record<string, unknown>): void {
    if (message.type === 'welcome') {
      this.wait = 500;
      this.refused = false;
      this.hearing.onLink({ kind: 'live', zonesOnly: this.zonesOnly });
    } else if (message.type === 'fault') {
      const fault = message.fault as { name?: string; field?: string; cause?: string };
      if (fault.field === 'positions' && !this.zonesOnly) {
        this.zonesOnly = true;
        this.subscribe(this.socket!);
        return this.hearing.onLink({ kind: 'live', zonesOnly: true });
      }
      this.refused = true;
      this.hearing.onLink({ kind: 'refused', cause: fault.cause || fault.name || 'refused' });
    } else if (message.type === 'observation') {
      this.hearing.onObserved(message.tracked as Observed[]);
    } else if (message.type === 'zone_event') {
      this.hearing.onZoneEvent(message as unknown as ZoneEvent);
    }
  }

  // Tries again at a random moment within a growing interval, so that a restarted server is not met by everybody at once.
  private lost(): void {
    if (!this.refused) this.hearing.onLink({ kind: 'lost' });
    this.timer = window.setTimeout(() => this.connect(), Math.random() * this.wait);
    this.wait = Math.min(this.wait * 2, kLongestWaitMs);
  }
}
