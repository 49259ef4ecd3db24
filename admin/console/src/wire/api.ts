// One way to the HTTP API: the key goes into the header, a problem document (RFC 9457) comes out as a Refusal.

const kKeyName = 'wayfuse-key';

// The key lives in this tab: sessionStorage is neither shared with other tabs nor kept when the tab closes.
export const tabKey = {
  get: () => sessionStorage.getItem(kKeyName) ?? '',
  set: (key: string) => sessionStorage.setItem(kKeyName, key),
  forget: () => sessionStorage.removeItem(kKeyName),
};

export class Refusal extends Error {
  /// status 0: the server could not be reached.
  constructor(readonly status: number, readonly code: string, message: string, readonly field = '', readonly document: unknown = null) {
    super(message);
  }
}

export interface Answer<T> { status: number; body: T; etag: string | null; headers: Headers }

interface Question { method?: string; body?: unknown; raw?: BodyInit; type?: string; headers?: Record<string, string>; signal?: AbortSignal; key?: string }

/// 128 random bits in hex: an Idempotency-Key. (crypto.randomUUID is missing where the page came over plain HTTP.)
export function freshName(): string {
  return [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, '0')).join('');
}

async function send(path: string, question: Question): Promise<Response> {
  const headers: Record<string, string> = { authorization: `Bearer ${question.key ?? tabKey.get()}`, ...question.headers };
  const method = question.method ?? 'GET';
  if (question.body !== undefined) headers['content-type'] = 'application/json';
  if (question.type) headers['content-type'] = question.type;
  if (method !== 'POST') delete headers['idempotency-key'];
  const body = question.raw ?? (question.body === undefined ? undefined : JSON.stringify(question.body));
  try {
    return await fetch(path, { method, headers, body, signal: question.signal, cache: 'no-store' });
  } catch (error) {
    if ((error as Error).name === 'AbortError') throw error;
    throw new Refusal(0, 'unreachable', 'The server cannot be reached.');
  }
}

async function refusalOf(response: Response): Promise<Refusal> {
  const text = await response.text();
  try {
    const problem = JSON.parse(text) as { detail?: string; title?: string; code?: string; field?: string };
    const said = problem.detail ?? problem.title ?? `HTTP ${response.status}`;
    return new Refusal(response.status, problem.code ?? '', problem.field ? `${problem.field}: ${said}` : said, problem.field, problem);
  } catch {
    return new Refusal(response.status, '', `HTTP ${response.status} ${response.statusText}`);
  }
}

function parsed<T>(text: string): T {
  try {
    return (text ? JSON.parse(text) : null) as T;
  } catch {
    throw new Refusal(0, 'not_json', 'What answers here does not speak like a wayfuse server. Is there a proxy in between?');
  }
}

/// A question asked twice by the network happens once: every POST carries an Idempotency-Key.
export async function request<T>(path: string, question: Question = {}): Promise<Answer<T>> {
  const response = await send(path, { ...question, headers: { 'idempotency-key': freshName(), ...question.headers } });
  if (!response.ok) throw await refusalOf(response);
  const text = await response.text();
  return { status: response.status, body: parsed<T>(text), etag: response.headers.get('etag'), headers: response.headers };
}

export async function ask<T>(path: string, question: Question = {}): Promise<T> {
  return (await request<T>(path, question)).body;
}

/// Bytes, for what is saved or shown as it is (exports, pictures).
export async function askBytes(path: string, question: Question = {}): Promise<Blob> {
  const response = await send(path, question);
  if (!response.ok) throw await refusalOf(response);
  return response.blob();
}

/// Every page of a list that is given in pages (`after`, `most`, `next`).
export async function* askPages<T>(path: string, field: string, signal?: AbortSignal): AsyncGenerator<T[]> {
  const join = path.includes('?') ? '&' : '?';
  for (let after: string | number = 0; ; ) {
    const page: Record<string, unknown> = await ask(`${path}${join}most=1000&after=${after}`, { signal });
    yield page[field] as T[];
    if (!page.next) return;
    after = page.next as string | number;
  }
}
