// One frame: its picture, log, attempts and header.
import { View, el, button, checkbox, clamp, select, facts, hint, leftOut, stateMark, table, duration, percent, size,
  time } from "./dom.js";
import { parseRange } from "./ranges.js";

const ZOOMS = [0, 0.5, 1, 2, 4, 8, 16], MOST_PX = 4096, STOPS = 16;
// Kept from frame to frame; zoom 0: all of it.
const look = { channel: "color", exposure: null, zoom: 0, x: 0.5, y: 0.5 };

export const pictureUrl = (job, frame, params) =>
  `/frame/${job}/${frame}.png?${new URLSearchParams(Object.entries(params).filter(([, value]) => value !== null))}`;

// An answer that has what was asked for; else the error says why not.
export async function getAnswer(url) {
  const answer = await fetch(url);
  if (answer.ok) return answer;
  const text = await answer.text();
  throw new Error(answer.headers.get("Content-Type")?.includes("json") ? JSON.parse(text).error : text.trim());
}

export class FrameView extends View {
  head = el("h1");
  facts = el("div");
  picture = el("img", { class: "picture", alt: "The frame", draggable: false, onload: () => this.place(),
    onerror: () => getAnswer(this.picture.src).catch((error) => (this.note.textContent = error.message)) });
  box = el("div", { class: "picturebox", tabindex: "0", role: "group", "aria-label": "Picture",
    ondblclick: () => this.zoomBy(1), onpointerdown: (event) => this.grab(event),
    onpointermove: (event) => this.drag(event), onpointerup: (event) => this.drop(event) }, this.picture);
  note = hint("", { role: "status" });
  log = el("div");
  header = el("div");
  channel = select("Channel", [], "", (channel) => this.set({ channel }));
  exposure = el("input", { type: "range", min: `${-STOPS}`, max: `${STOPS}`, step: "0.25", value: "0",
    "aria-label": "Exposure in stops", oninput: () => this.set({ exposure: Number(this.exposure.value) }) });
  auto = checkbox("by itself", { onchange: ({ target }) =>
    this.set({ exposure: target.checked ? null : Number(this.exposure.value) }) });
  zoom = select("Zoom", ZOOMS.map((zoom) => [`${zoom}`, zoom ? `${zoom * 100} %` : "all of it"]), "",
    (zoom) => this.set({ zoom: Number(zoom) }));
  stops = el("span");
  root = el("section", { class: "frame", "aria-label": "Frame" }, this.head, this.facts, el("div", { class: "tools" },
    button("‹ before", () => this.step(-1), { title: "Key: ←" }), button("after ›", () => this.step(1),
      { title: "Key: →" }), this.channel, el("label", null, "exposure ", this.exposure), this.stops, this.auto,
    this.zoom), this.note, this.box,
  el("h2", null, "Attempts and their logs"), this.log, el("h2", null, "Header of the file"), this.header);

  get title() { return `Frame ${this.frame} of job ${this.id}`; }

  async show() {
    this.watchSize(this.box, () => this.draw());
    this.on(this.farm, "state", () => this.farm.state === "live" && this.load());
    this.farm.watch(this.id, (event) => event.type === "frame" && event.frame === this.frame
      && this.load()).catch(() => {});
    if (this.farm.state === "live") await this.load();
  }

  hide() {
    super.hide();
    this.farm.unwatch(this.id);
  }

  focus() { this.box.focus({ preventScroll: true }); }

  // Another frame of the job keeps the view.
  follow(hash) {
    const match = new RegExp(`^#/jobs/${this.id}/frames/(-?\\d+)$`).exec(hash);
    if (match) this.load(Number(match[1]));
    return Boolean(match);
  }

  async load(frame = this.frame) {
    const { farm, id } = this;
    this.frame = frame;
    try {
      const [job, { frames }, { attempts }] = await Promise.all([farm.jobs.get(id) ?? farm.call("job.show", { id }),
        farm.call("job.frames", { id, range: `${frame}`, limit: 1 }), farm.call("job.log", { id, frame })]);
      if (this.isHidden || frame !== this.frame) return;
      this.numbers ??= parseRange(job.range);
      if (!frames.length) throw new Error(`job ${id} has no frame ${frame}`);
      this.drawFacts(job, frames[0]);
      this.drawLog(attempts);
      await this.loadPicture(frames[0]);
    } catch (error) {
      this.note.textContent = error.message;
    }
  }

  drawFacts(job, frame) {
    this.head.replaceChildren(`Frame ${frame.frame} of `, el("a", { href: `#/jobs/${this.id}` },
      `${this.id} ${job.name}`), " ", stateMark(frame.missed ? "missed" : frame.state));
    this.facts.replaceChildren(facts([
      ["Attempts", `${frame.attempts}`],
      ["Worker", frame.worker === null ? null : `${frame.worker}${frame.node ? ` on ${frame.node}` : ""}`],
      ["Phase", frame.phase], ["Rendering", duration(frame.render_s)], ["Audit", duration(frame.audit_s)],
      ["Encoding", duration(frame.encode_s)], ["Size", size(frame.size_bytes)],
      ["Error", percent(frame.measured_error || NaN)], ["Below, with 95 %", percent(frame.error95)],
      ["Compared with", frame.audit?.replace("_", " ")], ["Method", frame.method], ["Plan", frame.plan],
      ["Cut light", percent(frame.cut_share)], ["Traced", percent(frame.traced)],
      ["Failure", frame.error && el("span", { class: "wrong" }, frame.error), "long"],
      ["File", frame.path && el("code", null, frame.path), "long"],
    ]));
  }

  drawLog(attempts) {
    const rows = attempts.map((attempt) => [`${attempt.attempt}`, time(attempt.ended), `${attempt.worker}`,
      attempt.outcome, el("pre", null, attempt.log || "–")]);
    this.log.replaceChildren(rows.length ? table("Attempts", ["Attempt", "Ended", "Worker", "Outcome", "Log"], rows)
      : hint("No attempt failed."));
  }

  async loadPicture(frame) {
    const isThere = ["succeeded", "skipped"].includes(frame.state);
    this.box.hidden = !isThere;
    this.header.replaceChildren();
    if (!isThere) return void (this.note.textContent = `The frame is ${frame.state}: there is no picture yet.`);
    this.about = await (await getAnswer(`/frame/${this.id}/${this.frame}.json`)).json();
    const { channels, attributes, compression, width_px: width, height_px: height } = this.about;
    const names = new Set(channels.map(({ name }) => name.replace(/^[RGB]$/, "color").replace(/\.[RGB]$/, "")));
    if (!names.has(look.channel)) look.channel = "color";
    this.channel.replaceChildren(...[...names].map((value) => el("option", { value, selected: value === look.channel },
      { color: "colour", A: "alpha", Z: "Z (depth)" }[value] ?? value)));
    this.header.replaceChildren(facts([["Size", `${width} × ${height}`], ["Compression", compression],
      ["Light left out", leftOut(attributes["marchd:beyond"], attributes["marchd:beyond95"])],
      ["Channels", channels.map(({ name, pixel }) => `${name} (${pixel})`).join(", "), "long"],
      ...Object.entries(attributes).map(([name, value]) => [name, typeof value === "object" ? JSON.stringify(value)
        : `${value}`, "long"])]));
    this.note.textContent = "";
    this.draw();
  }

  set(change) {
    Object.assign(look, change);
    this.draw();
  }

  zoomBy(step) {
    this.set({ zoom: ZOOMS[clamp(ZOOMS.indexOf(look.zoom) + step, 0, ZOOMS.length - 1)] });
  }

  // Asks for as much of the picture as the box shows at this zoom.
  draw() {
    if (!this.about || this.box.hidden || !this.box.clientWidth) return;
    const { width_px: width, height_px: height } = this.about, wide = this.box.clientWidth;
    const tall = clamp((wide * height) / width, 120, innerHeight * 0.7);
    this.box.style.height = `${tall}px`;
    this.zoom.value = `${look.zoom}`;
    this.auto.firstChild.checked = look.exposure === null;
    this.exposure.value = `${look.exposure ?? 0}`;
    this.stops.textContent = look.exposure === null ? "" : `${look.exposure > 0 ? "+" : ""}${look.exposure}`;
    const { channel, exposure } = look, scale = look.zoom || Math.min(wide / width, tall / height);
    const w = Math.min(width, Math.ceil(wide / scale)), h = Math.min(height, Math.ceil(tall / scale));
    const x = Math.round(clamp(look.x * width - w / 2, 0, width - w)),
      y = Math.round(clamp(look.y * height - h / 2, 0, height - h));
    this.shown = { w, h, scale };
    Object.assign(look, { x: (x + w / 2) / width, y: (y + h / 2) / height });
    const size = Math.min(MOST_PX, Math.max(w, h));
    const url = pictureUrl(this.id, this.frame, { channel, exposure, x, y, w, h, size });
    if (this.url === url) return this.place();
    this.url = url;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => (this.picture.src = url), 60); // a slider's ways are no requests
    this.picture.alt = `Frame ${this.frame}, ${look.channel}`;
  }

  place() {
    const { w, h, scale } = this.shown;
    this.note.textContent = "";
    Object.assign(this.picture.style, { width: `${w * scale}px`, height: `${h * scale}px`, translate: "" });
    this.picture.classList.toggle("pixels", scale >= 2);
  }

  pan(dx, dy) {
    if (look.zoom) this.set({ x: look.x - dx / look.zoom / this.about.width_px,
      y: look.y - dy / look.zoom / this.about.height_px });
  }

  grab(event) {
    if (!look.zoom) return;
    this.box.setPointerCapture(event.pointerId);
    this.moved = (now) => [now.clientX - event.clientX, now.clientY - event.clientY];
  }

  drag(event) {
    if (this.moved) this.picture.style.translate = this.moved(event).map((by) => `${by}px`).join(" ");
  }

  drop(event) {
    if (this.moved) this.pan(...this.moved(event));
    this.moved = null;
  }

  step(by) {
    const next = this.numbers?.[this.numbers.indexOf(this.frame) + by];
    if (next !== undefined) location.replace(`#/jobs/${this.id}/frames/${next}`);
  }

  onKey(event) {
    const { key } = event, far = 80;
    const pans = { ArrowLeft: [far, 0], ArrowRight: [-far, 0], ArrowUp: [0, far], ArrowDown: [0, -far] };
    if (event.shiftKey && key in pans) this.pan(...pans[key]);
    else if (key === "ArrowLeft" || key === "ArrowRight") this.step(key === "ArrowLeft" ? -1 : 1);
    else if (key === "+" || key === "=" || key === "-") this.zoomBy(key === "-" ? -1 : 1);
    else if (key === "0") this.set({ zoom: 0 });
    else if (key === "[" || key === "]")
      this.set({ exposure: clamp((look.exposure ?? 0) + (key === "[" ? -0.5 : 0.5), -STOPS, STOPS) });
    else if (key === "a") this.set({ exposure: look.exposure === null ? 0 : null });
    else return false;
    return true;
  }
}
