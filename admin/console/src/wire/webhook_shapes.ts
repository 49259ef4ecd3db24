// Webhooks (admin/README.md); how deliveries go is counted since the server began.

export interface Webhook {
  id: number;
  url: string;
  zones: number[];                   // none: every zone
  enabled: boolean;
  created_at_us: number;
  waiting: number;
  delivered: number;
  failed_attempts: number;
  dead_letters: number;
  dropped: number;                   // dead letters that had to make room
  last_failure: string | null;
  secret?: string;                   // once, in the answer that made it
}

export interface DeadLetter { event: string; at_us: number; attempts: number; failure: string }

export interface Delivery {
  event: string;
  at_us: number;
  attempt: number;
  status: number | null;             // HTTP; null: there was no answer
  took_us: number;
  outcome: 'delivered' | 'waits' | 'dead';
  failure: string | null;
}
