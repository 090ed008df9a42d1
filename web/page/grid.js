// A job's frames as a canvas of cells, coloured by state, error or time. Its keys and its tell line are for all.
import { View, el, styleColour, signs, wordOf, count, duration, percent } from "./dom.js";
import { codes } from "./framemap.js";

const LEAST_PX = 3, MOST_PX = 26, SIGN_PX = 13, DRAW_MS = 100,
  REST = 8; // a drawing takes an eighth of the time at most
// Dark to light for little to much (viridis), so that it reads without hues.
const ramp = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

function rampColour(share) {
  const at = Math.min(0.9999, Math.max(0, share)) * (ramp.length - 1), i = Math.floor(at);
  return ramp[i].map((from, c) => Math.round(from + (ramp[i + 1][c] - from) * (at - i)));
}

const pack = ([r, g, b]) => ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;

const packStyle = (name) => pack(styleColour(name).match(/[\d.]+/g).slice(0, 3).map(Number));

export class FrameGrid extends View {
  static kept = new Map(); // job -> index of the frame at which one was

  constructor(map, job, open) {
    super();
    Object.assign(this, { map, job, open, by: "state", only: null }); // job: () -> the job as it is now
    this.at = FrameGrid.kept.get(map.id) ?? 0;
    this.canvas = el("canvas", { tabindex: "0", role: "application",
      "aria-label": "Frames: arrows move, Enter opens, n and N go to failed ones",
      "aria-describedby": "tell", onkeydown: (event) => this.onKey(event),
        onpointermove: (event) => this.onPoint(event),
      onclick: (event) => this.onPoint(event) && this.open(this.map.numbers[this.at]), onfocus: () => this.tell() });
    this.cursor = el("div", { class: "cursor", "aria-hidden": "true" });
    this.legend = el("div", { class: "legend" });
    this.told = el("p", { id: "tell", class: "tell", "aria-live": "polite" }, "");
    this.root = el("div", { class: "grid" }, this.makeChoice(), this.legend, this.told,
      this.box = el("div", { class: "canvas" }, this.canvas, this.cursor));
  }

  makeChoice() {
    return el("fieldset", { class: "choice" }, el("legend", null, "Colour by"),
      ["state", "error", "time"].map((by) => el("label", null,
      el("input", { type: "radio", name: "by", value: by, checked: by === this.by, onchange: () => {
        this.by = by;
        this.draw();
      } }), ` ${by}`)));
  }

  show() {
    this.watchSize(this.box, () => this.draw());
    this.on(this.map, "change", () => this.drawSoon());
    this.draw();
  }

  drawSoon() {
    this.timer ??= setTimeout(() => {
      this.timer = null;
      this.draw();
    }, Math.max(0, (this.drawn ?? 0) + Math.max(DRAW_MS, REST * this.took) - performance.now()));
  }

  // The largest cells with which all frames fit.
  measure() {
    const width = this.box.clientWidth - 6, most = Math.max(240, innerHeight * 0.5),
      total = Math.max(1, this.map.numbers.length);
    let cell = MOST_PX;
    while (cell > LEAST_PX && Math.ceil(total / Math.max(1, Math.floor(width / cell))) * cell > most) cell--;
    this.cell = cell;
    this.columns = Math.max(1, Math.floor(width / cell));
    this.rows = Math.ceil(total / this.columns);
    this.scale = devicePixelRatio || 1;
  }

  draw() {
    if (!this.box.clientWidth || !this.map.isLoaded) return;
    performance.mark("grid-begin");
    this.drawn = performance.now();
    this.measure();
    const { canvas, columns, rows } = this, px = Math.max(1, Math.round(this.cell * this.scale)),
      gap = px >= 8 ? 2 : px >= 4 ? 1 : 0;
    canvas.width = columns * px;
    canvas.height = rows * px;
    canvas.style.width = `${columns * this.cell}px`;
    canvas.style.height = `${rows * this.cell}px`;
    const context = canvas.getContext("2d"), image = context.createImageData(canvas.width, canvas.height);
    const pixels = new Uint32Array(image.data.buffer), colourOf = this.colours();
    const total = this.map.numbers.length, { width } = canvas;
    for (let row = 0; row < rows; row++) { // one line of pixels, then copies of it
      const top = row * px * width, end = Math.min(columns, total - row * columns);
      for (let column = 0, at = top; column < end; column++, at += px) {
        const colour = colourOf(row * columns + column);
        for (let x = 0; x < px - gap; x++) pixels[at + x] = colour;
      }
      for (let y = 1; y < px - gap; y++) pixels.copyWithin(top + y * width, top, top + width);
    }
    context.putImageData(image, 0, 0);
    if (this.cell >= SIGN_PX && this.by === "state") this.drawSigns(context, px, gap);
    this.drawLegend();
    this.moveCursor();
    if (this.told.textContent) this.tell();
    this.took = performance.measure("grid", "grid-begin").duration;
  }

  drawSigns(context, px, gap) {
    context.font = `${Math.round(px * 0.6)}px sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = styleColour("--cell-sign");
    for (let index = 0; index < this.map.numbers.length; index++) {
      const sign = signs[this.map.stateOf(index)];
      const x = index % this.columns, y = Math.floor(index / this.columns);
      context.fillText(sign, x * px + (px - gap) / 2, y * px + (px - gap) / 2);
    }
  }

  colours() {
    const { map } = this, plain = packStyle("--cell-none");
    if (this.by === "state") {
      const packed = codes.map((state) => (this.only && this.only !== state ? plain : packStyle(`--${state}`)));
      return (index) => packed[map.states[index]];
    }
    const values = this.by === "error" ? map.errors : map.seconds;
    const tolerance = this.by === "error" ? this.job()?.tolerance : null;
    const known = values.filter((value) => value > 0);
    this.low = known.reduce((least, value) => Math.min(least, value), Infinity);
    this.high = tolerance ?? known.reduce((most, value) => Math.max(most, value), 0);
    if (tolerance) this.low = 0;
    const over = packStyle("--failed"), table = Array.from({ length: 64 }, (_, i) => pack(rampColour(i / 63)));
    return (index) => {
      const value = values[index];
      if (Number.isNaN(value)) return plain;
      if (tolerance && value > tolerance) return over;
      return table[Math.round((63 * Math.max(0, Math.min(this.high, value) - this.low)) / (this.high - this.low || 1))];
    };
  }

  drawLegend() {
    const counts = this.map.counts(), key = this.by === "state" ? Object.values(counts).join() + this.only
      : `${this.by} ${this.low} ${this.high}`;
    if (this.legend.dataset.key === key) return;
    this.legend.dataset.key = key;
    if (this.by === "state") {
      const focused = document.activeElement?.dataset?.only;
      this.legend.replaceChildren(...codes.filter((state) => counts[state]).map((state) =>
        el("button", { type: "button",
        "aria-pressed": String(this.only === state), "data-only": state, title: "Only these", onclick: () => {
          this.only = this.only === state ? null : state;
          this.draw();
        } }, el("span", { class: `swatch ${state}` }, signs[state]),
          ` ${wordOf(state)} ${count(counts[state])}`)));
      if (focused) this.legend.querySelector(`[data-only=${focused}]`)?.focus();
      return;
    }
    const strip = el("canvas", { width: 160, height: 10, "aria-hidden": "true" }), context = strip.getContext("2d");
    for (let x = 0; x < 160; x++) {
      context.fillStyle = `rgb(${rampColour(x / 159)})`;
      context.fillRect(x, 0, 1, 10);
    }
    const write = this.by === "error" ? percent : duration, isKnown = Number.isFinite(this.low);
    this.legend.replaceChildren(...(isKnown ? [write(this.low), strip, write(this.high)] : ["no frame has one yet"]));
    if (isKnown && this.by === "error" && this.job()?.tolerance) this.legend.append(el("span",
      { class: "swatch failed" }, "!"), "over the tolerance");
  }

  moveCursor() {
    this.cursor.hidden = !this.map.numbers.length;
    this.cursor.style.width = this.cursor.style.height = `${Math.max(6, this.cell)}px`;
    const left = (this.at % this.columns) * this.cell, top = Math.floor(this.at / this.columns) * this.cell;
    this.cursor.style.transform = `translate(${left}px, ${top}px)`;
  }

  tell() { this.told.textContent = this.describe(this.at); }

  describe(index) {
    const { map } = this, frame = map.numbers[index], running = map.running.get(frame);
    if (frame === undefined || !map.states) return "";
    const parts = [`Frame ${frame}: ${wordOf(map.stateOf(index))}`];
    if (map.stateOf(index) === "running" && running?.phase)
      parts.push(`${running.phase}${running.phase_progress === null ? ""
        : ` ${Math.round(running.phase_progress * 100)} %`}`);
    if (!Number.isNaN(map.seconds[index])) parts.push(duration(map.seconds[index]));
    if (!Number.isNaN(map.errors[index])) parts.push(`error ${percent(map.errors[index])}`);
    if (!Number.isNaN(map.bounds[index])) parts.push(`below ${percent(map.bounds[index])} with 95 %`);
    return parts.join(", ");
  }

  onPoint(event) {
    const box = this.canvas.getBoundingClientRect();
    const x = Math.floor((event.clientX - box.left) / this.cell), y = Math.floor((event.clientY - box.top) / this.cell);
    const index = y * this.columns + x;
    if (x < 0 || x >= this.columns || index < 0 || index >= this.map.numbers.length) return false;
    this.move(index);
    return true;
  }

  move(index) {
    if (!this.map.numbers.length) return;
    this.at = Math.min(this.map.numbers.length - 1, Math.max(0, index));
    FrameGrid.kept.set(this.map.id, this.at);
    this.moveCursor();
    this.tell();
  }

  findFailed(step) {
    for (let index = this.at + step; index >= 0 && index < this.map.numbers.length; index += step)
      if (["failed", "missed"].includes(this.map.stateOf(index))) return this.move(index);
    this.told.textContent = `No failed frame ${step > 0 ? "after" : "before"} this one.`;
  }

  onKey(event) {
    const moves = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: this.columns, ArrowUp: -this.columns,
      PageDown: this.columns * 10, PageUp: -this.columns * 10, Home: -Infinity, End: Infinity };
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key in moves) this.move(this.at + moves[event.key]);
    else if (event.key === "n") this.findFailed(1);
    else if (event.key === "N") this.findFailed(-1);
    else if (event.key === "Enter") this.open(this.map.numbers[this.at]);
    else return;
    this.cursor.scrollIntoView({ block: "nearest" });
    event.preventDefault();
    event.stopPropagation();
  }
}
