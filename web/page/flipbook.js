// Plays the frames that are done, while others arrive.
import { View, el, count } from "./dom.js";
import { pictureUrl, getAnswer } from "./frame.js";

const SIZE_PX = 960, AHEAD = 12, KEPT = 120, AT_ONCE = 3, FPS = 24;

export class Flipbook extends View {
  constructor(view) {
    super();
    Object.assign(this, { view, map: view.map, at: 0, pictures: new Map(), waiting: new Set(), exposure: null });
    this.canvas = el("canvas", { class: "flip", role: "img", "aria-label": "The frame that is shown" });
    this.button = el("button", { type: "button", class: "main", title: "Key: Space",
      onclick: () => this.play(!this.isPlaying) });
    this.slider = el("input", { type: "range", min: "0", value: "0", "aria-label": "Frame",
      oninput: () => this.goto(Number(this.slider.value)) });
    this.fps = el("input", { type: "number", min: "1", max: "60", value: `${view.shown?.document?.fps ?? FPS}`,
      "aria-label": "Frames a second" });
    this.stops = el("input", { type: "number", step: "0.1", min: "-16", max: "16",
      "aria-label": "Exposure in stops", onchange: () => this.expose() });
    this.told = el("p", { class: "tell" });
    this.root = el("div", { class: "flipbook" }, this.told, el("div", { class: "tools" }, this.button, this.slider,
      el("label", null, this.fps, " fps"), el("label", null, "exposure ", this.stops),
      el("button", { type: "button", onclick: () => this.done.length && view.openFrame(this.frame) },
        "Open this frame")), this.canvas);
  }

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

  // One exposure for all frames, so that nothing flickers: that of the first, or one set by hand.
  expose() {
    this.exposure = this.stops.value === "" ? null : Number(this.stops.value);
    this.drop();
    this.draw();
  }

  drop() {
    for (const picture of this.pictures.values()) picture.close();
    this.pictures.clear();
  }

  list() {
    const frame = this.done?.[this.at];
    this.done = this.map.isLoaded ? this.map.numbers.filter((_, index) => this.map.isDone(index)) : [];
    this.at = Math.max(0, this.done.indexOf(frame));
    this.slider.max = `${Math.max(0, this.done.length - 1)}`;
    this.draw();
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
    const next = this.done.length ? (this.at + 1) % this.done.length : 0;
    if (this.pictures.get(this.done[next])) this.goto(next);
    else this.load();
    if (this.isPlaying) this.timer = setTimeout(() => this.tick(), 1000 / Math.max(1, Number(this.fps.value) || FPS));
  }

  draw() {
    this.slider.value = `${this.at}`;
    if (!this.done.length) return void (this.told.textContent = "No frame is done yet.");
    const picture = this.pictures.get(this.frame);
    const place = `${count(this.at + 1)} of ${count(this.done.length)} that are done`;
    this.told.textContent = `Frame ${this.frame}, ${place}${picture ? "" : ", loading"}`;
    this.slider.setAttribute("aria-valuetext", `frame ${this.frame}`);
    if (picture) {
      if (this.canvas.width !== picture.width) this.canvas.width = picture.width;
      if (this.canvas.height !== picture.height) this.canvas.height = picture.height;
      this.canvas.getContext("2d").drawImage(picture, 0, 0);
    }
    this.load();
  }

  load() {
    const most = this.exposure === null ? 1 : AT_ONCE;
    for (let i = 0; i < Math.min(AHEAD, this.done.length) && this.waiting.size < most; i++) {
      const frame = this.done[(this.at + i) % this.done.length];
      if (!this.pictures.has(frame) && !this.waiting.has(frame)) this.fetch(frame);
    }
    for (const [frame, picture] of this.pictures) {
      if (this.pictures.size <= KEPT) break;
      this.pictures.delete(frame);
      picture.close();
    }
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
      this.play(false);
      return;
    } finally {
      this.waiting.delete(frame);
    }
    if (this.isHidden) return;
    if (frame === this.frame) this.draw();
    else this.load();
  }

  onKey(event) {
    const { key } = event, last = this.done.length - 1;
    const moves = { ArrowLeft: this.at - 1, ArrowRight: this.at + 1, Home: 0, End: last };
    if (key === " " && event.target.localName !== "button") this.play(!this.isPlaying);
    else if (key in moves && last >= 0) this.goto(Math.min(last, Math.max(0, moves[key])));
    else return false;
    return true;
  }
}
