// What is known of each frame of a job: state, seconds, error, kept up to date by events.
import { View, once } from "./dom.js";
import { parseRange } from "./ranges.js";

const CHUNK = 50000, REFRESH_MS = 1000, REFRESH_COUNT = 1000;
const letters = { q: "queued", r: "running", s: "succeeded", k: "skipped", m: "missed", f: "failed", c: "canceled" };
export const states = Object.values(letters);

export class FrameMap extends View {
  numbers = []; // of frames, in the job's order
  stale = new Set(); // indices whose numbers are to be asked again
  running = new Map(); // frame -> its last event
  note = once(() => this.isHidden || this.dispatchEvent(new Event("change")));

  async show() {
    const { farm, id } = this;
    this.on(farm, "state", () => farm.state === "live" && this.load().catch(() => {}));
    this.timer = setInterval(() => this.refresh().catch(() => {}), REFRESH_MS);
    await farm.watch(id, (event) => this.hear(event));
    await this.load();
  }

  hide() {
    super.hide();
    clearInterval(this.timer);
    this.farm.unwatch(this.id);
  }

  async load() {
    let offset = 0, part;
    do {
      part = await this.farm.call("job.frame_map", { id: this.id, offset, limit: CHUNK });
      if (offset === 0) this.begin(parseRange(part.frames));
      for (let i = 0; i < part.states.length; i++)
        this.put(offset + i, letters[part.states[i]], part.seconds[i], part.errors[i], part.errors95?.[i]);
      offset += part.states.length;
    } while (part.states.length && offset < this.numbers.length && !this.isHidden);
    this.isLoaded = true;
    this.note();
  }

  begin(numbers) {
    this.numbers = numbers;
    this.indexOf = new Map(numbers.map((frame, index) => [frame, index]));
    this.states = new Array(numbers.length).fill("queued");
    for (const name of ["seconds", "errors", "bounds"]) this[name] = new Float32Array(numbers.length).fill(NaN);
  }

  put(index, state, seconds, error, bound) {
    this.states[index] = state;
    this.seconds[index] = seconds ?? NaN;
    this.errors[index] = error ?? NaN;
    this.bounds[index] = bound ?? NaN;
  }

  hear(event) {
    const index = this.indexOf?.get(event.frame), { frame, state } = event;
    if (index === undefined) return;
    if (event.type === "frame") this.states[index] = state;
    if (state === "succeeded" || state === "skipped") this.stale.add(index);
    if (event.type === "frame" && state !== "running") this.running.delete(frame);
    else this.running.set(frame, event);
    this.note();
  }

  // An event has no seconds and no error: those of frames that are done are asked for together.
  async refresh() {
    if (!this.stale.size || document.hidden || this.farm.state !== "live") return;
    if (this.stale.size > REFRESH_COUNT * 4) {
      this.stale.clear();
      return this.load();
    }
    const indices = [...this.stale].slice(0, REFRESH_COUNT);
    for (const index of indices) this.stale.delete(index);
    const range = indices.map((index) => this.numbers[index]).join(",");
    const { frames } = await this.farm.call("job.frames", { id: this.id, range, limit: indices.length });
    for (const one of frames)
      this.put(this.indexOf.get(one.frame), one.missed ? "missed" : one.state, one.render_s === null ? NaN
        : one.render_s + one.audit_s + one.encode_s, one.measured_error, one.error95);
    this.note();
  }

  framesOf(...wanted) { return this.numbers.filter((_, index) => wanted.includes(this.states[index])); }
}
