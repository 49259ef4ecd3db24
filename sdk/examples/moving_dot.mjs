// A dot that moves with the phone: node moving_dot.mjs RECORDING [FOLDER OF wayfuse.mjs]
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const { MotionTracker, events } = await import(pathToFileURL(`${process.argv[3] ?? '.'}/wayfuse.mjs`));
const tracker = await MotionTracker.create();
const dot = { east_m: 0, north_m: 0 };
for (const event of events(readFileSync(process.argv[2], 'utf8'))) {
  if (event.type !== 'marg') continue;
  const report = tracker.feed(event);
  if (!report || report.steps === 0) continue;
  dot.east_m += report.distance_m * Math.cos(report.heading_rad);
  dot.north_m += report.distance_m * Math.sin(report.heading_rad);
  console.log(`${dot.east_m.toFixed(2)} m east, ${dot.north_m.toFixed(2)} m north of the start`);
}
const { steps, carrying } = tracker.walk();
console.log(`${steps} steps, the phone is ${carrying}`);
tracker.close();
