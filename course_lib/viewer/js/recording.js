const KEYFRAME_INTERVAL = 64; // number of batches between two stored states, which make seeking backward fast
const IDENTITY = new Float32Array([1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
const DEFAULTS = {};

/** The recorded changes of a scene; shows the scene at any time in a mirror. */
export class SceneRecording {
  /** @param {{start: number, end: number, note: string, batches: any[]}} data @param {import("./mirror.js").Mirror} mirror */
  constructor(data, mirror) {
    this.data = data;
    this.batches = data.batches;
    this.mirror = mirror;
    this.index = -1; // index of the last batch that was applied
    /** @type {Map<string, any>} the effective commands, by path and kind */
    this.state = new Map();
    this.keyframes = [];
    const state = new Map();
    /** @type {string[]} */
    let paths = [];
    for (const [i, batch] of this.batches.entries()) {
      if (batch.matrices) paths = batch.paths ??= paths;
      advance(state, batch);
      if (i % KEYFRAME_INTERVAL === 0) this.keyframes.push(new Map(state));
    }
  }

  /** @param {number} time [s] since the start, at which the scene is shown */
  seek(time) {
    const index = this.indexAt(time);
    if (index === this.index) return;
    const keyframe = Math.floor(index / KEYFRAME_INTERVAL);
    const isAhead = this.index <= index && this.index >= keyframe * KEYFRAME_INTERVAL;
    const state = new Map(isAhead ? this.state : this.keyframes[keyframe]);
    for (let i = isAhead ? this.index + 1 : keyframe * KEYFRAME_INTERVAL + 1; i <= index; i++) advance(state, this.batches[i]);
    this.show(state);
    [this.state, this.index] = [state, index];
  }

  /** @param {number} time [s] @returns {number} index of the last batch up to this time */
  indexAt(time) {
    let [low, high] = [0, this.batches.length];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.batches[middle].time <= time + 1e-9) low = middle;
      else high = middle;
    }
    return low;
  }

  /** @param {number} time [s] @param {number} count of frames, negative to step backward @returns {number} the time of that frame [s] */
  timeOfStep(time, count) {
    const index = Math.max(0, Math.min(this.batches.length - 1, this.indexAt(time) + count));
    return this.batches[index].time;
  }

  /** @param {Map<string, any>} state to show, by applying its differences from the current state */
  show(state) {
    for (const path of new Set([...this.state.keys(), ...state.keys()])) {
      const [old, now] = [this.state.get(path) ?? DEFAULTS, state.get(path) ?? DEFAULTS];
      if (old === now) continue;
      for (const kind of new Set([...Object.keys(old), ...Object.keys(now)]))
        if (old[kind] !== now[kind]) this.change(path, kind, now[kind]);
    }
    this.mirror.invalidateViews();
  }

  /** @param {string} path @param {string} kind @param {any} value undefined for the default of a new scene */
  change(path, kind, value) {
    if (kind === "matrix") this.mirror.apply({ paths: [path], matrices: value ?? IDENTITY });
    else if (value) this.mirror.handlers[kind](value);
    else if (kind === "visible") this.mirror.node(path).visible = true;
    else if (kind === "object") this.mirror.removeObject(path);
    else if (kind === "animation") this.mirror.mixer = null;
  }
}

/** @param {Map<string, any>} state is changed @param {any} batch */
function advance(state, batch) {
  for (const command of batch.commands ?? []) {
    const path = command.path ?? "";
    if (command.type === "delete") removeBelow(state, path);
    else state.set(path, { ...state.get(path), [command.type]: command });
  }
  if (!batch.matrices) return;
  for (const [i, path] of batch.paths.entries())
    state.set(path, { ...state.get(path), matrix: batch.matrices.subarray(12 * i, 12 * i + 12) });
}

/** @param {Map<string, any>} state @param {string} path removed with all nodes below it */
function removeBelow(state, path) {
  const { background, camera } = state.get("") ?? DEFAULTS;
  for (const other of state.keys())
    if (!path || other === path || other.startsWith(`${path}/`)) state.delete(other);
  if (!path) state.set("", { background, camera });
}
