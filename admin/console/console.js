// The operator's console: one floor plan, its reference points and the phones on it, live over the observer's WebSocket.

const $ = (id) => document.getElementById(id);
const kTrackSeconds = 60;
const kPageSize = 1000;

const state = {
  key: sessionStorage.getItem('key') ?? '',
  building: null,
  floor: null,
  points: [],
  phones: new Map(),   // public name -> {position, received, gone, trail: [{x, y, floor, at}]}
  chosen: null,
  view: { x: 0, y: 0, scale: 8 },   // metres at the canvas centre, pixels a metre
  fitted: true,                     // nobody moved the plan: it follows the window
  socket: null,
  retry: 500,
};

async function ask(path) {
  const response = await fetch(path, { headers: { authorization: `Bearer ${state.key}` } });
  const body = await response.json();
  if (!response.ok) throw new Error(body.detail ?? body.title ?? `HTTP ${response.status}`);
  return body;
}

function say(text, bad = false) {
  $('link').textContent = text;
  $('link').classList.toggle('bad', bad);
}

// ---------------------------------------------------------------- data

async function signIn() {
  const { buildings } = await ask('/v1/buildings');
  $('building').replaceChildren(...buildings.map((b) => new Option(b.name, b.id)));
  $('building').disabled = buildings.length === 0;
  $('forget').hidden = false;
  if (buildings.length === 0) {
    $('hint').textContent = 'No building yet. Create one with POST /v1/buildings.';
    return;
  }
  const wanted = new URLSearchParams(location.search).get('building');
  if (buildings.some((b) => String(b.id) === wanted)) $('building').value = wanted;
  await openBuilding(Number($('building').value));
}

async function openBuilding(id) {
  state.building = await ask(`/v1/buildings/${id}`);
  state.phones.clear();
  const floors = [...state.building.floors].sort((a, b) => b.ordinal - a.ordinal);
  $('floor').replaceChildren(...floors.map((f) => new Option(f.label, f.ordinal)));
  $('floor').disabled = floors.length === 0;
  const ground = floors.find((f) => f.ordinal === 0) ?? floors[0];
  if (ground) $('floor').value = ground.ordinal;
  chooseFloor();
  connect();
  await loadPoints(id);
}

async function loadPoints(id) {
  state.points = [];
  for (let after = 0; ;) {
    const page = await ask(`/v1/buildings/${id}/points?most=${kPageSize}&after=${after}`);
    if (state.building.id !== id) return;
    state.points.push(...page.points.map((p) => p.place));
    draw();
    if (!page.next) return;
    after = page.next;
  }
}

function chooseFloor() {
  state.floor = state.building.floors.find((f) => f.ordinal === Number($('floor').value)) ?? null;
  fit();
}

// ---------------------------------------------------------------- live positions

function connect() {
  state.socket?.close();
  const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
  const socket = new WebSocket(`${scheme}://${location.host}/v1/session`, 'wayfuse.v1.json');
  state.socket = socket;
  const send = (message) => socket.send(JSON.stringify(message));
  socket.onopen = () => {
    send({ type: 'hello', role: 'observe', building: state.building.id, token: state.key, app: 'wayfuse console', phone_time_us: 0 });
    send({ type: 'subscribe', min_interval_us: 200000 });
  };
  socket.onmessage = ({ data }) => receive(JSON.parse(data));
  socket.onclose = () => {
    if (state.socket !== socket) return;
    say('connection lost, trying again', true);
    setTimeout(() => state.socket === socket && connect(), Math.random() * state.retry);
    state.retry = Math.min(state.retry * 2, 15000);
  };
}

function receive(message) {
  if (message.type === 'welcome') {
    state.retry = 500;
    say(`live · radio map ${message.radio_map_version}`);
  } else if (message.type === 'fault') {
    say(`${message.fault.name}: ${message.fault.cause ?? ''}`, true);
  } else if (message.type === 'observation') {
    for (const one of message.tracked) observe(one);
    schedule();
  }
}

function observe({ tracked, position, gone }) {
  const now = performance.now();
  const phone = state.phones.get(tracked) ?? { trail: [] };
  const { x_m, y_m, floor } = position.place;
  phone.trail.push({ x: x_m, y: y_m, floor, at: now });
  while (now - phone.trail[0].at > kTrackSeconds * 1000) phone.trail.shift();
  Object.assign(phone, { position, gone: Boolean(gone), received: now });
  state.phones.set(tracked, phone);
}

// ---------------------------------------------------------------- drawing

const canvas = $('plan');
const pen = canvas.getContext('2d');
let colours = {};

function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ['outline', 'walkable', 'closed', 'point', 'phone', 'bad', 'ink', 'ground', 'faint']) {
    colours[name] = style.getPropertyValue(`--${name}`).trim();
  }
}

const toX = (x) => canvas.clientWidth / 2 + (x - state.view.x) * state.view.scale;
const toY = (y) => canvas.clientHeight / 2 - (y - state.view.y) * state.view.scale;

function fit() {
  state.fitted = true;
  const rings = state.floor?.outline ?? [];
  const all = rings.length ? rings.flat() : state.points.map((p) => [p.x_m, p.y_m]);
  if (all.length) {
    const xs = all.map((p) => p[0]), ys = all.map((p) => p[1]);
    const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    state.view.x = (x0 + x1) / 2;
    state.view.y = (y0 + y1) / 2;
    state.view.scale = 0.92 * Math.min(canvas.clientWidth / (x1 - x0 || 1), canvas.clientHeight / (y1 - y0 || 1));
  }
  schedule();
}

let scheduled = false;
function schedule() {
  if (scheduled) return;
  scheduled = true;
  requestAnimationFrame(() => { scheduled = false; draw(); });
}

function path(rings) {
  pen.beginPath();
  for (const ring of rings) {
    ring.forEach(([x, y], i) => (i ? pen.lineTo(toX(x), toY(y)) : pen.moveTo(toX(x), toY(y))));
    pen.closePath();
  }
}

function drawPlan() {
  if (!state.floor) return;
  path(state.floor.outline);
  pen.fillStyle = state.floor.walkable.length ? colours.closed : colours.walkable;
  pen.fill('evenodd');
  pen.fillStyle = colours.walkable;
  for (const polygon of state.floor.walkable) { path(polygon); pen.fill('evenodd'); }
  path(state.floor.outline);
  pen.strokeStyle = colours.outline;
  pen.lineWidth = 1.5;
  pen.stroke();
}

function drawPoints() {
  if (!$('show-points').checked || !state.floor) return;
  pen.fillStyle = colours.point;
  for (const p of state.points) {
    if (p.floor === state.floor.ordinal) pen.fillRect(toX(p.x_m) - 1.5, toY(p.y_m) - 1.5, 3, 3);
  }
}

function drawTrail(phone) {
  pen.beginPath();
  let down = false;
  for (const t of phone.trail) {
    if (t.floor !== state.floor.ordinal) { down = false; continue; }
    down ? pen.lineTo(toX(t.x), toY(t.y)) : pen.moveTo(toX(t.x), toY(t.y));
    down = true;
  }
  pen.globalAlpha = 0.45;
  pen.stroke();
  pen.globalAlpha = 1;
}

function drawPhone(name, phone) {
  const { place, radius68_m, azimuth_deg, integrity } = phone.position;
  pen.strokeStyle = pen.fillStyle = integrity === 'ok' ? colours.phone : colours.bad;
  pen.lineWidth = 1.5;
  if ($('show-tracks').checked) drawTrail(phone);
  if (place.floor !== state.floor.ordinal || phone.gone) return;
  const x = toX(place.x_m), y = toY(place.y_m);
  pen.beginPath();
  pen.arc(x, y, radius68_m * state.view.scale, 0, 2 * Math.PI);
  pen.globalAlpha = 0.13;
  pen.fill();
  pen.globalAlpha = 1;
  pen.beginPath();
  pen.arc(x, y, name === state.chosen ? 8 : 5, 0, 2 * Math.PI);
  pen.fill();
  const a = ((90 - azimuth_deg) * Math.PI) / 180;
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(x + 13 * Math.cos(a), y - 13 * Math.sin(a));
  pen.stroke();
}

function draw() {
  const ratio = devicePixelRatio || 1;
  const [w, h] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
  if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, w, h);
  drawPlan();
  drawPoints();
  if (state.floor) for (const [name, phone] of state.phones) drawPhone(name, phone);
  listPhones();
}

let listed = 0;
function listPhones() {
  const now = performance.now();
  if (now - listed < 500) return;
  listed = now;
  $('count').textContent = [...state.phones.values()].filter((p) => !p.gone).length;
  const rows = [...state.phones].slice(0, 200).map(([name, phone]) => {
    const row = document.createElement('tr');
    row.className = `${name === state.chosen ? 'chosen ' : ''}${phone.gone ? 'gone' : ''}`;
    row.dataset.name = name;
    const { place, radius68_m, integrity } = phone.position;
    for (const text of [name.slice(0, 10), place.floor, `${radius68_m.toFixed(1)} m`, phone.gone ? 'gone' : integrity]) {
      row.insertCell().textContent = text;
    }
    return row;
  });
  $('phones').replaceChildren(...rows);
}

// ---------------------------------------------------------------- hands

function zoom(factor, cx = canvas.clientWidth / 2, cy = canvas.clientHeight / 2) {
  state.fitted = false;
  const { view } = state;
  const x = view.x + (cx - canvas.clientWidth / 2) / view.scale, y = view.y - (cy - canvas.clientHeight / 2) / view.scale;
  view.scale = Math.min(400, Math.max(0.2, view.scale * factor));
  view.x = x - (cx - canvas.clientWidth / 2) / view.scale;
  view.y = y + (cy - canvas.clientHeight / 2) / view.scale;
  schedule();
}

function move(dx, dy) {
  state.fitted = false;
  state.view.x -= dx / state.view.scale;
  state.view.y += dy / state.view.scale;
  schedule();
}

canvas.addEventListener('wheel', (e) => { e.preventDefault(); zoom(Math.exp(-e.deltaY / 400), e.offsetX, e.offsetY); }, { passive: false });
canvas.addEventListener('pointerdown', (e) => canvas.setPointerCapture(e.pointerId));
canvas.addEventListener('pointermove', (e) => { if (e.buttons & 1) move(e.movementX, e.movementY); });
canvas.addEventListener('keydown', (e) => {
  const keys = { ArrowLeft: [40, 0], ArrowRight: [-40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] };
  if (keys[e.key]) move(...keys[e.key]);
  else if (e.key === '+' || e.key === '=') zoom(1.25);
  else if (e.key === '-') zoom(0.8);
  else if (e.key === '0') fit();
  else return;
  e.preventDefault();
});
$('phones').addEventListener('click', (e) => {
  const name = e.target.closest('tr')?.dataset.name;
  if (!name) return;
  state.chosen = name;
  const { place } = state.phones.get(name).position;
  $('floor').value = place.floor;
  chooseFloor();
  listed = 0;
});
$('building').addEventListener('change', () => openBuilding(Number($('building').value)).catch((e) => say(e.message, true)));
$('floor').addEventListener('change', chooseFloor);
for (const id of ['show-points', 'show-tracks']) $(id).addEventListener('change', schedule);
$('forget').addEventListener('click', () => { sessionStorage.removeItem('key'); location.reload(); });
$('sign-in').addEventListener('cancel', (e) => e.preventDefault());
$('sign-in').querySelector('form').addEventListener('submit', async (e) => {
  e.preventDefault();
  state.key = $('key').value.trim();
  try {
    await signIn();
    sessionStorage.setItem('key', state.key);
    $('sign-in').close();
  } catch (error) {
    $('sign-in-fault').textContent = error.message;
  }
});
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { readColours(); schedule(); });
new ResizeObserver(() => (state.fitted ? fit() : schedule())).observe(canvas);

readColours();
setInterval(schedule, 1000);
if (state.key) signIn().catch(() => $('sign-in').showModal());
else $('sign-in').showModal();
