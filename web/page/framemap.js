// What is known of each frame of a job: state, seconds, error, kept up to date by events.
import { parseRange } from "./ranges.js";

const CHUNK = 50000, REFRESH_MS = 1000, REFRESH_COUNT = 1000;
const letters = { q: "queued", r: "running", s: "succeeded", f: "failed", c: "canceled", k: "skipped", m: "missed" };
export const codes = ["queued", "running", "succeeded", "skipped", "missed", "failed", "canceled"];
const codeOf = Object.fromEntries(codes.map((state, code) => [state, code]));
const codeOfLetter = Object.fromEntries(Object.entries(letters).map(([letter, state]) => [letter, codeOf[state]]));

export class FrameMap extends EventTarget {
  constructor(farm, id) {
    super();
    Object.assign(this, { farm, id });
    this.numbers = []; // of frames, in the job's order
    this.stale = new Set(); // indices whose numbers are to be asked again
    this.running = new Map(); // frame -> its last event
  }

  async open() {
    this.onState = () => this.farm.state === "live" && this.load().catch(() => {});
    this.farm.addEventListener("state", this.onState);
    this.timer = setInterval(() => this.refresh().catch(() => {}), REFRESH_MS);
    await this.farm.watch(this.id, (event) => this.hear(event));
    await this.load();
  }

  close() {
    this.isClosed = true;
    clearInterval(this.timer);
    this.farm.removeEventListener("state", this.onState);
    this.farm.unwatch(this.id);
  }

  async load() {
    let offset = 0;
    do {
      const part = await this.farm.call("job.frame_map", { id: this.id, offset, limit: CHUNK });
      if (offset === 0) this.begin(parseRange(part.frames));
      for (let i = 0; i < part.states.length; i++) {
        this.states[offset + i] = codeOfLetter[part.states[i]] ?? 0;
        this.seconds[offset + i] = part.seconds[i] ?? NaN;
        this.errors[offset + i] = part.errors[i] ?? NaN;
        this.bounds[offset + i] = part.errors95?.[i] ?? NaN;
      }
      offset += part.states.length;
      if (part.states.length === 0) break;
    } while (offset < this.numbers.length && !this.isClosed);
    this.isLoaded = true;
    this.note();
  }

  begin(numbers) {
    if (this.numbers.length !== numbers.length) {
      this.numbers = numbers;
      this.indexOf = new Map(numbers.map((frame, index) => [frame, index]));
    }
    this.states = new Uint8Array(numbers.length);
    for (const name of ["seconds", "errors", "bounds"]) this[name] = new Float32Array(numbers.length).fill(NaN);
  }

  stateOf(index) { return codes[this.states[index]]; }

  hear(event) {
    const index = this.indexOf?.get(event.frame);
    if (index === undefined) return;
    if (event.type === "frame") {
      this.states[index] = codeOf[event.state] ?? 0;
      if (event.state === "running") this.running.set(event.frame, event);
      else this.running.delete(event.frame);
      if (event.state === "succeeded" || event.state === "skipped") this.stale.add(index);
      this.note(event.state === "running" ? undefined : event.frame);
    } else {
      this.running.set(event.frame, event);
      this.note();
    }
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
    for (const frame of frames) {
      const index = this.indexOf.get(frame.frame);
      this.states[index] = frame.missed ? codeOf.missed : codeOf[frame.state] ?? 0;
      this.seconds[index] = frame.render_s === null ? NaN : frame.render_s + frame.audit_s + frame.encode_s;
      this.errors[index] = frame.measured_error ?? NaN;
      this.bounds[index] = frame.error95 ?? NaN;
    }
    this.note();
  }

  note(ended) {
    if (ended !== undefined) this.dispatchEvent(new CustomEvent("ended", { detail: ended }));
    if (this.isNoted) return;
    this.isNoted = true;
    requestAnimationFrame(() => {
      this.isNoted = false;
      if (!this.isClosed) this.dispatchEvent(new Event("change"));
    });
  }

  isDone(index) { return this.states[index] >= codeOf.succeeded && this.states[index] <= codeOf.missed; }

  counts() {
    const sums = new Array(codes.length).fill(0);
    for (let i = 0; i < this.states.length; i++) sums[this.states[i]]++;
    return Object.fromEntries(codes.map((state, code) => [state, sums[code]]));
  }

  framesOf(state) {
    const code = codeOf[state];
    return this.numbers.filter((_, index) => this.states[index] === code);
  }
}
