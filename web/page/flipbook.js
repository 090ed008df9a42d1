// Plays the frames that are done, while others arrive.
import { View, el, button, clamp, count } from "./dom.js";
import { pictureUrl, getAnswer } from "./frame.js";

const SIZE_PX = 960, AHEAD = 12, KEPT = 120, AT_ONCE = 3, FPS = 24;

export class Flipbook extends View {
  at = 0;
  done = []; // numbers of the frames that are
  pictures = new Map(); // by frame
  waiting = new Set(); // frames whose pictures were asked for
  exposure = null; // one for all frames, so that nothing flickers: that of the first, or one set by hand
  canvas = el("canvas", { class: "flip", role: "img", "aria-label": "The frame that is shown" });
  button = button("", () => this.play(!this.isPlaying), { class: "main", title: "Key: Space" });
  slider = el("input", { type: "range", min: "0", value: "0", "aria-label": "Frame",
    oninput: () => this.goto(Number(this.slider.value)) });
  fps = el("input", { type: "number", min: "1", max: "60", value: `${this.view.shown?.document?.fps ?? FPS}`,
    "aria-label": "Frames a second" });
  stops = el("input", { type: "number", step: "0.1", min: "-16", max: "16", "aria-label": "Exposure in stops",
    onchange: () => this.expose() });
  told = el("p", { class: "tell" });
  root = el("div", { class: "flipbook" }, this.told, el("div", { class: "tools" }, this.button, this.slider,
    el("label", null, this.fps, " fps"), el("label", null, "exposure ", this.stops),
    button("Open this frame", () => this.done.length && this.view.openFrame(this.frame))), this.canvas);

  show() {
    this.on(this.map, "change", () => this.list());
    this.play(false);
    this.list();
  }

  hide() {
    this.play(false);
    super.hide();
    this.drop();
  }

  get frame() { return this.done[this.at]; }

  expose() {
    this.exposure = this.stops.value === "" ? null : Number(this.stops.value);
    this.drop();
    this.draw();
  }

  // Gives up the oldest pictures.
  drop(kept = 0) {
    for (const [frame, picture] of this.pictures) {
      if (this.pictures.size <= kept) break;
      this.pictures.delete(frame);
      picture.close();
    }
  }

  list() {
    const { frame } = this;
    this.done = this.map.isLoaded ? this.map.framesOf("succeeded", "skipped", "missed") : [];
    this.slider.max = `${Math.max(0, this.done.length - 1)}`;
    this.goto(Math.max(0, this.done.indexOf(frame)));
  }

  goto(at) {
    this.at = at;
    this.draw();
  }

  play(isPlaying) {
    this.isPlaying = isPlaying;
    this.button.textContent = isPlaying ? "Ⅱ Stop" : "▶ Play";
    clearTimeout(this.timer);
    if (isPlaying) this.tick();
  }

  // A frame that is not loaded yet is waited for.
  tick() {
    const next = (this.at + 1) % this.done.length;
    if (this.pictures.has(this.done[next])) this.goto(next);
    else this.load();
    if (this.isPlaying) this.timer = setTimeout(() => this.tick(), 1000 / Math.max(1, Number(this.fps.value) || FPS));
  }

  draw() {
    this.slider.value = `${this.at}`;
    if (!this.done.length) return void (this.told.textContent = "No frame is done yet.");
    const { canvas, frame } = this, picture = this.pictures.get(frame);
    const place = `${count(this.at + 1)} of ${count(this.done.length)} that are done`;
    this.told.textContent = `Frame ${frame}, ${place}${picture ? "" : ", loading"}`;
    this.slider.setAttribute("aria-valuetext", `frame ${frame}`);
    if (picture) {
      Object.assign(canvas, { width: picture.width, height: picture.height });
      canvas.getContext("2d").drawImage(picture, 0, 0);
    }
    this.load();
  }

  load() {
    const most = this.exposure === null ? 1 : AT_ONCE;
    for (let i = 0; i < Math.min(AHEAD, this.done.length) && this.waiting.size < most; i++) {
      const frame = this.done[(this.at + i) % this.done.length];
      if (!this.pictures.has(frame) && !this.waiting.has(frame)) this.fetch(frame);
    }
    this.drop(KEPT);
  }

  async fetch(frame) {
    const { exposure } = this;
    this.waiting.add(frame);
    try {
      const answer = await getAnswer(pictureUrl(this.view.id, frame, { exposure, size: SIZE_PX }));
      const picture = await createImageBitmap(await answer.blob());
      if (this.isHidden || exposure !== this.exposure) picture.close();
      else this.pictures.set(frame, picture);
      this.exposure ??= JSON.parse(answer.headers.get("Marchd-Picture")).exposure;
      this.stops.value = this.exposure.toFixed(1);
    } catch (error) {
      this.told.textContent = `Frame ${frame}: ${error.message}`;
      return this.play(false);
    } finally {
      this.waiting.delete(frame);
    }
    if (this.isHidden) return;
    if (frame === this.frame) this.draw();
    else this.load();
  }

  onKey({ key, target }) {
    const last = this.done.length - 1;
    const moves = { ArrowLeft: this.at - 1, ArrowRight: this.at + 1, Home: 0, End: last };
    if (key === " " && target.localName !== "button") this.play(!this.isPlaying);
    else if (key in moves && last >= 0) this.goto(clamp(moves[key], 0, last));
    else return false;
    return true;
  }
}
