// The motion core of wayfuse in JavaScript: attitude, steps, how the phone is carried; the same code as on the phone, as WebAssembly.
// Times in microseconds of one monotonic clock, metres, radians, microtesla; axes as Android's: x right, y up along the screen, z out.
import load from './wayfuse_motion.mjs';

const references = ['magnetic', 'true', 'arbitrary'];
const carryings = ['unknown', 'lying', 'held', 'calling', 'pocket', 'swinging'];
const climbings = ['none', 'stairs', 'lift'];

export class MotionTracker {
  #core;
  #motion;

  /** `headingEstimator`: a name of the catalogue, like 'complementary'; otherwise the best there is. */
  static async create({ headingEstimator = '' } = {}) {
    const core = await load();
    const motion = core.ccall('wf_motion_create', 'number', ['string'], [headingEstimator]);
    if (motion === 0) throw new RangeError(`headingEstimator: no estimator is called '${headingEstimator}'`);
    return new MotionTracker(core, motion);
  }

  constructor(core, motion) {
    this.#core = core;
    this.#motion = motion;
  }

  /**
   * Takes one sample: `{time_us, acceleration_mps2: [x, y, z], turn_rate_radps, field_ut, pressure_hpa}`, what a sensor did not say
   * left out; a `marg` line of a recording as it stands. Returns a report at every step and at least twice a second, else null.
   */
  feed(sample) {
    if (!Number.isFinite(sample.time_us)) throw new TypeError('time_us: a number of microseconds is needed');
    const into = this.#numbers('wf_motion_in', 12);
    let has = 0;
    for (const [i, name] of ['acceleration_mps2', 'turn_rate_radps', 'field_ut'].entries()) {
      const axes = sample[name];
      if (axes === undefined || axes === null) continue;
      if (axes.length !== 3) throw new TypeError(`${name}: three axes are needed`);
      has |= 1 << i;
      into.set(axes, 2 + 3 * i);
    }
    if (typeof sample.pressure_hpa === 'number') {
      has |= 8;
      into[11] = sample.pressure_hpa;
    }
    into[0] = sample.time_us;
    into[1] = has;
    if (this.#core._wf_motion_feed(this.#handle()) === 0) return null;
    const [time_us, interval_us, steps, step_length_m, distance_m, heading_rad, heading_sigma_rad, reference, turn_rate_radps, at_rest] =
      this.#numbers('wf_motion_out', 10);
    return { time_us, interval_us, steps, step_length_m, distance_m, heading_rad, heading_sigma_rad,
             reference: references[reference], turn_rate_radps, at_rest: at_rest === 1 };
  }

  /** What the building's Welcome says of its magnetic field: headings become true ones. */
  expect({ declination_rad, dip_rad, norm_ut }) {
    this.#core._wf_motion_expect(this.#handle(), declination_rad, dip_rad, norm_ut);
  }

  /** How the phone is turned: body to east-north-up; null until gravity was seen. */
  attitude() {
    if (this.#core._wf_motion_attitude(this.#handle()) === 0) return null;
    const [w, x, y, z, heading_rad, heading_sigma_rad, magnetic_quality] = this.#numbers('wf_motion_out', 7);
    return { body_to_enu: { w, x, y, z }, heading_rad, heading_sigma_rad, magnetic_quality };
  }

  walk() {
    this.#core._wf_motion_walk(this.#handle());
    const [walking, steps, cadence_hz, step_length_m, speed_mps, speed_sigma_mps, carrying, climbing] = this.#numbers('wf_motion_out', 8);
    return { walking: walking === 1, steps, cadence_hz, step_length_m, speed_mps, speed_sigma_mps,
             carrying: carryings[carrying], climbing: climbings[climbing] };
  }

  /** Frees the core's memory; the tracker is of no use afterwards. */
  close() {
    if (this.#motion !== 0) this.#core._wf_motion_destroy(this.#motion);
    this.#motion = 0;
  }

  #handle() {
    if (this.#motion === 0) throw new Error('the tracker is closed');
    return this.#motion;
  }

  // A view of the core's own array; made anew each time, for its memory may have grown.
  #numbers(which, count) {
    const at = this.#core[`_${which}`](this.#handle()) / 8;
    return this.#core.HEAPF64.subarray(at, at + count);
  }
}

/** The events of a recording (JSON lines, its header first), one after the other. */
export function* events(text) {
  const lines = text.split('\n');
  if (JSON.parse(lines[0]).type !== 'wayfuse-recording') throw new Error('line 1: this is no wayfuse recording');
  for (let i = 1; i < lines.length; ++i) {
    if (lines[i].trim() !== '') yield JSON.parse(lines[i]);
  }
}
