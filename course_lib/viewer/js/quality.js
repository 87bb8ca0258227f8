// The resolution of views. At rest, and with a fast graphics card, a picture is rendered larger than it is displayed,
// which smooths its edges. During motion on a machine without a graphics card, edges are not smoothed, then large
// meshes are drawn with fewer triangles, and finally the picture is rendered smaller than it is displayed.
//
// The level is chosen by the time that drawing takes, not by the rate of the pictures. Other programs that use the
// processor can only lengthen this time, so the least of a few pictures is the best estimate of what drawing costs: a
// single picture that took long, for example because a kernel was starting, does not change the level. Where most of
// them take long, the machine is busy. A coarser picture then needs less of the little that is left.

/**
 * @typedef {{scale: number, cell: number, simple: boolean}} Quality rendered pixels per displayed pixel; approximate width of
 *   a triangle of a large mesh in displayed pixels, or 0 for all triangles; whether very many parts are drawn as one vertex each
 */
/** @type {Quality[]} */
const LEVELS = [
  { scale: 2, cell: 0, simple: false },
  { scale: 1, cell: 0, simple: true },
  { scale: 1, cell: 3, simple: true },
  { scale: 0.8, cell: 5, simple: true },
  { scale: 0.6, cell: 8, simple: true },
  { scale: 0.45, cell: 12, simple: true },
];
// How many times longer a picture of each level is expected to take than one of the next coarser level.
const RATIOS = [4, 2, 1.7, 1.8, 1.8];
const BUDGET = 14; // [ms] per picture; half of a page's time remains for the page itself
const BUSY = 18; // [ms] usual time of a picture on a busy machine; with as much for the page, this gives 28 pictures per second
const CHEAP = 4; // [ms] least time of a picture that would not become much cheaper
const MUCH_TOO_LONG = 2.5; // multiple of BUDGET from which on two levels are skipped in one step, or a trial ends early
const MOVING = 900; // [ms] maximum time between two pictures of a motion; busy machines draw two per second
const [FEW, ENOUGH, LONGEST] = [2, 4, 256]; // measurements before a much coarser, a coarser, and the longest before a finer level
const RECENT_TIMES = 8; // measurements whose median is the usual time
const MEASURE_EVERY = 6; // with a graphics card one in so many pictures is measured, because each measurement waits for the card

let isSoftware = false;
let initialLevel = 1; // level of the first motion of a view

/** @param {any} gl the context of the page's views; without a graphics card, the initial level is coarse */
export function expectSpeed(gl) {
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  if (!isSoftware && /swiftshader|llvmpipe|software|basic render/i.test(name)) initialLevel = 3;
  isSoftware = initialLevel > 1;
}

/** @returns {Quality} of pictures at rest; tests of pages without a graphics card request a coarser one */
export const atRest = () => ({ ...LEVELS[0], scale: /** @type {any} */ (globalThis).courseRestScale ?? LEVELS[0].scale });

/** @param {number} sinceLast [ms] between two pictures of a view @returns {boolean} whether they belong to one motion */
export const isMotion = (sinceLast) => sinceLast <= MOVING;

/** Chooses the quality of a view's pictures during motion. */
export class MotionQuality {
  constructor() {
    /** @type {number | null} */
    this.level = null;
    /** @type {number[]} [ms] of the last pictures of this level */
    this.times = [];
    this.measured = 0; // number of pictures of this level that were measured
    this.pictures = 0;
    this.wait = ENOUGH; // number of measurements before a finer level is tried
    this.isTrial = false; // whether the last level was coarser
  }

  /** @returns {boolean} whether large meshes are drawn with fewer triangles */
  get isCoarse() {
    return LEVELS[this.level ?? initialLevel].cell > 0;
  }

  /**
   * Draw a picture of a motion, and choose the quality of the next one.
   * @param {(quality: Quality) => void} paint @param {() => void} finish waits until the graphics card has drawn it
   * @param {boolean} isTypical whether this picture takes as long as the next ones
   */
  paint(paint, finish, isTypical) {
    this.level ??= initialLevel;
    const quality = LEVELS[this.level];
    // Software has drawn a picture when it is copied. A graphics card is still at work then.
    if (!isTypical || (!isSoftware && ++this.pictures % MEASURE_EVERY)) return paint(quality);
    if (!isSoftware) finish();
    const start = performance.now();
    paint(quality);
    if (!isSoftware) finish();
    this.level = this.levelAfter(this.level, performance.now() - start);
  }

  /** @param {number} level @param {number} duration [ms] of its last picture @returns {number} the next level */
  levelAfter(level, duration) {
    this.times = [...this.times, duration].slice(-RECENT_TIMES);
    this.measured++;
    const least = Math.min(...this.times.slice(-ENOUGH));
    const usual = [...this.times].sort((one, other) => one - other)[(this.times.length - 1) >> 1];
    if (this.measured >= FEW && least > MUCH_TOO_LONG * BUDGET) return this.step(level, this.isTrial ? 1 : 2);
    const isBusy = this.measured >= RECENT_TIMES && usual > BUSY && least > CHEAP;
    if (this.measured >= ENOUGH && (least > BUDGET || isBusy)) return this.step(level, 1);
    const ratio = RATIOS[level - 1];
    const canImprove = level > (isSoftware ? 1 : 0) && least * ratio < BUDGET && usual * ratio < BUSY;
    return canImprove && this.measured >= this.wait ? this.step(level, -1) : level;
  }

  /** @param {number} level @param {number} change positive if the next level is coarser @returns {number} */
  step(level, change) {
    // A finer level that was too slow is tried again later and later, until the view has come to rest.
    if (change > 0 && this.isTrial) this.wait = Math.min(4 * this.wait, LONGEST);
    this.isTrial = change < 0;
    this.resetMeasurements();
    return Math.min(Math.max(level + change, 0), LEVELS.length - 1);
  }

  resetMeasurements() {
    this.times = [];
    this.measured = 0;
  }

  /** End a motion. Another view of the page begins with the last level of this one. */
  rest() {
    initialLevel = this.level ?? initialLevel;
    this.wait = ENOUGH;
    this.isTrial = false;
    this.resetMeasurements();
  }
}
