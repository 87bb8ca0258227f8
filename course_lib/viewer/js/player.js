/** Plays a recording: its clock, driven by time bars. */
export class Player {
  /**
   * @param {import("./recording.js").SceneRecording} recording
   * @param {(time: import("./protocol.js").TimeState) => void} onTime called with the time for the bars
   * @param {() => boolean} isSeen whether the recording is in sight; otherwise it is paused
   */
  constructor(recording, onTime, isSeen = () => true) {
    this.recording = recording;
    this.onTime = onTime;
    this.isSeen = isSeen;
    this.end = recording.data.end; // [s]
    this.now = this.end; // the page initially shows the end, from which `play` starts at the beginning
    this.paused = true;
    this.rate = 1;
    this.loop = false;
    this.lastTick = 0; // [ms] of the page's clock
    this.apply({ now: this.end });
  }

  /** @param {import("./protocol.js").TimeChange} change made by the user with a bar */
  apply(change) {
    if (change.now !== undefined) this.now = Math.max(0, Math.min(this.end, change.now));
    if (change.step) [this.paused, this.now] = [true, this.recording.timeOfStep(this.now, change.step)];
    if (change.rate) this.rate = change.rate;
    if (change.loop !== undefined) this.loop = change.loop;
    if (change.paused !== undefined) this.setPlaying(!change.paused);
    this.show();
  }

  /** Play again and again from the start, unless the user prefers reduced motion. */
  replay() {
    const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (!isStill) this.apply({ now: 0, loop: true, paused: false });
  }

  /** @param {boolean} isPlaying */
  setPlaying(isPlaying) {
    const wasPlaying = !this.paused;
    this.paused = !isPlaying;
    if (isPlaying && this.now >= this.end) this.now = 0;
    if (!isPlaying || wasPlaying) return;
    this.lastTick = performance.now();
    requestAnimationFrame((time) => this.tick(time));
  }

  /** @param {number} time [ms] of the page's clock */
  tick(time) {
    if (this.paused) return;
    const elapsed = this.isSeen() ? Math.max(time - this.lastTick, 0) / 1000 : 0; // [s]
    this.lastTick = time;
    this.now += elapsed * this.rate;
    if (this.now >= this.end) {
      this.now = this.loop ? this.now % this.end : this.end;
      this.paused = !this.loop;
    }
    if (elapsed) this.show();
    if (!this.paused) requestAnimationFrame((next) => this.tick(next));
  }

  show() {
    const { now, end, paused, rate, loop, recording } = this;
    const { start, note } = recording.data;
    recording.seek(now);
    this.onTime({ now: start + now, elapsed: now, range: [0, end], paused, rate, loop, note });
  }
}
