// One frame: its picture, log, attempts and header.
import { View, el, facts, stateMark, table, duration, percent, size, time } from "./dom.js";
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
  constructor(farm, job, frame) {
    super();
    Object.assign(this, { farm, id: job, frame });
    this.head = el("h1");
    this.facts = el("div");
    this.picture = el("img", { class: "picture", draggable: false });
    this.box = el("div", { class: "picturebox", tabindex: "0", role: "group", "aria-label": "Picture",
      ondblclick: () => this.zoomBy(1),
      onpointerdown: (event) => this.grab(event), onpointermove: (event) => this.drag(event),
        onpointerup: () => this.drop() }, this.picture);
    this.note = el("p", { class: "hint", role: "status" });
    this.log = el("div");
    this.header = el("div");
    this.picture.onload = () => this.place();
    this.picture.onerror = () => getAnswer(this.picture.src).catch((error) => (this.note.textContent = error.message));
    this.root = el("section", { class: "frame", "aria-label": "Frame" }, this.head, this.facts, this.makeTools(),
      this.note, this.box,
      el("h2", null, "Attempts and their logs"), this.log, el("h2", null, "Header of the file"), this.header);
  }

  makeTools() {
    this.channel = el("select", { "aria-label": "Channel", onchange: () => this.set({ channel: this.channel.value }) });
    this.exposure = el("input", { type: "range", min: `${-STOPS}`, max: `${STOPS}`, step: "0.25", value: "0",
      "aria-label": "Exposure in stops", oninput: () => this.set({ exposure: Number(this.exposure.value) }) });
    this.auto = el("input", { type: "checkbox", checked: true,
      onchange: () => this.set({ exposure: this.auto.checked ? null : Number(this.exposure.value) }) });
    this.zoom = el("select", { "aria-label": "Zoom", onchange: () => this.set({ zoom: Number(this.zoom.value) }) },
      ZOOMS.map((zoom) => el("option", { value: `${zoom}` }, zoom ? `${zoom * 100} %` : "all of it")));
    this.stops = el("output");
    return el("div", { class: "tools" }, el("button", { type: "button", title: "Key: ←",
      onclick: () => this.step(-1) }, "‹ before"),
      el("button", { type: "button", title: "Key: →", onclick: () => this.step(1) }, "after ›"), this.channel,
      el("label", null, "exposure ", this.exposure), this.stops, el("label", null, this.auto, " by itself"), this.zoom);
  }

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
    if (!match) return false;
    this.frame = Number(match[1]);
    this.load();
    return true;
  }

  async load() {
    const { farm, id, frame } = this;
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
      ["Error", percent(frame.measured_error)], ["Below, with 95 %", percent(frame.error95)],
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
      : el("p", { class: "hint" }, "No attempt failed."));
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
    const option = (value, text) => el("option", { value, selected: value === look.channel }, text);
    this.channel.replaceChildren(...[...names].map((name) => option(name,
      { color: "colour", A: "alpha", Z: "Z (depth)" }[name] ?? name)));
    this.header.replaceChildren(facts([["Size", `${width} × ${height}`], ["Compression", compression],
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
    this.set({ zoom: ZOOMS[Math.min(ZOOMS.length - 1, Math.max(0, ZOOMS.indexOf(look.zoom) + step))] });
  }

  // The part of the picture that is asked for: all of it, or as much as the box shows at this zoom.
  draw() {
    if (!this.about || this.box.hidden || !this.box.clientWidth) return;
    const { width_px: width, height_px: height } = this.about, wide = this.box.clientWidth;
    const tall = Math.max(120, Math.min(innerHeight * 0.7, (wide * height) / width));
    this.box.style.height = `${tall}px`;
    this.zoom.value = `${look.zoom}`;
    this.auto.checked = look.exposure === null;
    this.exposure.value = `${look.exposure ?? 0}`;
    this.stops.textContent = look.exposure === null ? "" : `${look.exposure > 0 ? "+" : ""}${look.exposure}`;
    const params = { channel: look.channel, exposure: look.exposure };
    this.shown = { w: width, h: height, scale: Math.min(wide / width, tall / height) };
    if (look.zoom) {
      const w = Math.min(width, Math.ceil(wide / look.zoom)), h = Math.min(height, Math.ceil(tall / look.zoom));
      const x = Math.round(Math.min(width - w, Math.max(0, look.x * width - w / 2))),
        y = Math.round(Math.min(height - h, Math.max(0, look.y * height - h / 2)));
      this.shown = { w, h, scale: look.zoom };
      Object.assign(look, { x: (x + w / 2) / width, y: (y + h / 2) / height });
      Object.assign(params, { x, y, w, h, size: Math.min(MOST_PX, Math.max(w, h)) });
    } else params.size = Math.min(MOST_PX, Math.max(width, height), Math.ceil(Math.max(wide, tall) * devicePixelRatio));
    const url = pictureUrl(this.id, this.frame, params);
    if (this.url === url) return this.place();
    this.url = url;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => (this.picture.src = url), 60); // a slider's ways are no requests
    this.picture.alt = `Frame ${this.frame}, ${look.channel}`;
  }

  place() {
    const { w, h, scale } = this.shown;
    this.note.textContent = "";
    this.picture.style.width = `${w * scale}px`;
    this.picture.style.height = `${h * scale}px`;
    this.picture.style.transform = "";
    this.picture.classList.toggle("pixels", scale >= 2);
  }

  pan(dx, dy) {
    if (look.zoom) this.set({ x: look.x - dx / look.zoom / this.about.width_px,
      y: look.y - dy / look.zoom / this.about.height_px });
  }

  grab(event) {
    if (!look.zoom) return;
    this.box.setPointerCapture(event.pointerId);
    this.grabbed = { x: event.clientX, y: event.clientY, dx: 0, dy: 0 };
  }

  drag(event) {
    if (!this.grabbed) return;
    this.grabbed.dx = event.clientX - this.grabbed.x;
    this.grabbed.dy = event.clientY - this.grabbed.y;
    this.picture.style.transform = `translate(${this.grabbed.dx}px, ${this.grabbed.dy}px)`;
  }

  drop() {
    if (this.grabbed) this.pan(this.grabbed.dx, this.grabbed.dy);
    this.grabbed = null;
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
    else if (key === "[" || key === "]") this.set({ exposure: Math.max(-STOPS,
      Math.min(STOPS, (look.exposure ?? 0) + (key === "[" ? -0.5 : 0.5))) });
    else if (key === "a") this.set({ exposure: look.exposure === null ? 0 : null });
    else return false;
    return true;
  }
}
