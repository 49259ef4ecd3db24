// node compare.mjs FOLDER_OF_WAYFUSE.MJS RECORDING NATIVE_LINES: every number of every report within 1e-6 of the native core's.
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const [folder, recording, native] = process.argv.slice(2);
const { MotionTracker, events } = await import(pathToFileURL(`${folder}/wayfuse.mjs`));
const expected = readFileSync(native, 'utf8').trim().split('\n').map((line) => JSON.parse(line));
let worst = 0;
let lines = 0;
function fail(words) {
  console.error(words);
  process.exit(1);
}
function compare(numbers) {
  const other = expected[lines++];
  if (!other || other.length !== numbers.length) fail(`line ${lines}: the native core says ${JSON.stringify(other)}`);
  for (const [i, number] of numbers.entries()) {
    const off = Math.abs(number - other[i]);
    if (!(off <= 1e-6)) fail(`line ${lines}, number ${i + 1}: ${number} here, ${other[i]} there`);
    worst = Math.max(worst, off);
  }
}

const tracker = await MotionTracker.create();
for (const event of events(readFileSync(recording, 'utf8'))) {
  if (event.type !== 'marg') continue;
  const r = tracker.feed(event);
  if (r) compare([r.time_us, r.steps, r.distance_m, r.heading_rad, r.heading_sigma_rad, r.turn_rate_radps, Number(r.at_rest)]);
}
const { w, x, y, z } = tracker.attitude().body_to_enu;
const walk = tracker.walk();
compare([w, x, y, z, walk.steps, walk.cadence_hz, walk.speed_mps]);
if (lines !== expected.length || lines < 100) fail(`${lines} reports here, ${expected.length} there`);

for (const [bad, words] of [[{}, 'time_us'], [{ time_us: 1, field_ut: [1, 2] }, 'field_ut']]) {
  try {
    tracker.feed(bad);
    fail(`${JSON.stringify(bad)} was taken`);
  } catch (error) {
    if (!error.message.startsWith(words)) fail(`${JSON.stringify(bad)}: ${error.message}`);
  }
}
await MotionTracker.create({ headingEstimator: 'magic' }).then(() => fail('magic was found'), () => {});
tracker.close();
tracker.close();
console.log(`${lines} reports, the largest difference ${worst}`);
