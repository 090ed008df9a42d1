// A job's frames as a canvas of cells, coloured by state, error or time. Its keys and its tell line are for all.
import { View, el, button, clamp, once, styleColour, signs, signOf, wordOf, count, duration, percent } from "./dom.js";
import { states } from "./framemap.js";

const LEAST_PX = 3, MOST_PX = 26, SIGN_PX = 13, DRAW_MS = 100, REST = 8; // it draws an eighth of the time at most
// Dark to light for little to much (viridis), so that it reads without hues.
const ramp = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

function rampColour(share) {
  const at = Math.min(0.9999, share) * (ramp.length - 1), i = Math.floor(at);
  return ramp[i].map((from, c) => Math.round(from + (ramp[i + 1][c] - from) * (at - i)));
}

const pack = ([r, g, b]) => ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;
const packStyle = (name) => pack(styleColour(name).match(/[\d.]+/g).slice(0, 3).map(Number));

export class FrameGrid extends View {
  static kept = new Map(); // job -> index of the frame at which one was
  by = "state";
  only = null; // the state that alone is shown
  took = 0; // ms of the last drawing
  at = FrameGrid.kept.get(this.view.id) ?? 0;
  canvas = el("canvas", { tabindex: "0", role: "application",
    "aria-label": "Frames: arrows move, Enter opens, n and N go to failed ones", "aria-describedby": "tell",
    onpointermove: (event) => this.onPoint(event), onclick: (event) => this.onPoint(event) && this.open(),
    onfocus: () => this.tell() });
  cursor = el("div", { class: "cursor", "aria-hidden": "true" });
  legend = el("div", { class: "legend" });
  told = el("p", { id: "tell", class: "tell", "aria-live": "polite" }, "");
  box = el("div", { class: "canvas" }, this.canvas, this.cursor);
  root = el("div", null, el("div", { class: "tools choice", role: "radiogroup", "aria-label": "Colour by" },
    "Colour by", ["state", "error", "time"].map((by) => el("label", null, el("input", { type: "radio", name: "by",
      checked: by === this.by, onchange: () => this.choose({ by }) }), ` ${by}`))), this.legend, this.told, this.box);

  show() {
    this.watchSize(this.box, () => this.draw());
    this.on(this.map, "change", once(() => this.draw(),
      (act) => setTimeout(act, Math.max(DRAW_MS, REST * this.took))));
    this.draw();
  }

  choose(choice) {
    Object.assign(this, choice);
    this.draw();
  }

  open() { this.view.openFrame(this.map.numbers[this.at]); }

  // The largest cells with which all frames fit.
  measure() {
    const width = this.box.clientWidth - 6, most = Math.max(240, innerHeight * 0.5),
      total = Math.max(1, this.map.numbers.length);
    let cell = MOST_PX;
    while (cell > LEAST_PX && Math.ceil(total / Math.max(1, Math.floor(width / cell))) * cell > most) cell--;
    this.cell = cell;
    this.columns = Math.max(1, Math.floor(width / cell));
    this.rows = Math.ceil(total / this.columns);
  }

  draw() {
    if (this.isHidden || !this.box.clientWidth || !this.map.isLoaded) return;
    performance.mark("grid-begin");
    this.measure();
    const { canvas, cell, columns, rows } = this, px = Math.max(1, Math.round(cell * devicePixelRatio)),
      gap = px >= 8 ? 2 : px >= 4 ? 1 : 0;
    Object.assign(canvas, { width: columns * px, height: rows * px });
    Object.assign(canvas.style, { width: `${columns * cell}px`, height: `${rows * cell}px` });
    const context = canvas.getContext("2d"), image = context.createImageData(canvas.width, canvas.height);
    const pixels = new Uint32Array(image.data.buffer), colourOf = this.colours(), total = this.map.numbers.length;
    for (let row = 0; row < rows; row++) { // one line of pixels, then copies of it
      const top = row * px * canvas.width, end = Math.min(columns, total - row * columns);
      for (let column = 0, at = top; column < end; column++, at += px) {
        const colour = colourOf(row * columns + column);
        for (let x = at; x < at + px - gap; x++) pixels[x] = colour;
      }
      for (let y = 1; y < px - gap; y++) pixels.copyWithin(top + y * canvas.width, top, top + canvas.width);
    }
    context.putImageData(image, 0, 0);
    if (cell >= SIGN_PX && this.by === "state") this.drawSigns(context, px, gap);
    this.drawLegend();
    this.moveCursor();
    if (this.told.textContent) this.tell();
    this.took = performance.measure("grid", "grid-begin").duration;
  }

  drawSigns(context, px, gap) {
    Object.assign(context, { font: `${Math.round(px * 0.6)}px sans-serif`, textAlign: "center", textBaseline: "middle",
      fillStyle: styleColour("--cell-sign") });
    for (let index = 0; index < this.map.numbers.length; index++) {
      const x = index % this.columns, y = Math.floor(index / this.columns);
      context.fillText(signs[this.map.states[index]], x * px + (px - gap) / 2, y * px + (px - gap) / 2);
    }
  }

  // A function from a frame's index to its colour.
  colours() {
    const { map } = this, plain = packStyle("--line");
    if (this.by === "state") {
      const packed = Object.fromEntries(states.map((state) =>
        [state, this.only && this.only !== state ? plain : packStyle(`--${state}`)]));
      return (index) => packed[map.states[index]];
    }
    const values = this.by === "error" ? map.errors : map.seconds, known = values.filter((value) => value > 0);
    this.tolerance = this.by === "error" ? this.view.job?.tolerance : null;
    this.low = this.tolerance ? 0 : known.reduce((least, value) => Math.min(least, value), Infinity);
    this.high = this.tolerance || known.reduce((most, value) => Math.max(most, value), 0);
    const { tolerance, low, high } = this, over = packStyle("--failed");
    const table = Array.from({ length: 64 }, (_, i) => pack(rampColour(i / 63)));
    return (index) => {
      const value = values[index];
      if (Number.isNaN(value)) return plain;
      if (tolerance && value > tolerance) return over;
      return table[Math.round((63 * (clamp(value, low, high) - low)) / (high - low || 1))];
    };
  }

  drawLegend() {
    const counts = Object.fromEntries(states.map((state) => [state, 0]));
    for (const state of this.map.states) counts[state]++;
    const key = this.by === "state" ? Object.values(counts).join() + this.only : `${this.by} ${this.low} ${this.high}`;
    if (this.legend.dataset.key === key) return;
    this.legend.dataset.key = key;
    const focused = document.activeElement?.dataset.only;
    this.legend.replaceChildren(...(this.by === "state" ? this.stateLegend(counts) : this.rampLegend()));
    if (focused) this.legend.querySelector(`[data-only=${focused}]`)?.focus();
  }

  stateLegend(counts) {
    return states.filter((state) => counts[state]).map((state) => button([signOf(state),
      ` ${wordOf(state)} ${count(counts[state])}`], () => this.choose({ only: this.only === state ? null : state }),
    { "aria-pressed": String(this.only === state), "data-only": state, title: "Only these" }));
  }

  rampLegend() {
    const write = this.by === "error" ? percent : duration;
    if (!Number.isFinite(this.low)) return ["no frame has one yet"];
    const fill = `linear-gradient(to right, ${ramp.map((colour) => `rgb(${colour})`)})`;
    return [write(this.low), el("span", { class: "ramp", "--fill": fill }), write(this.high),
      ...(this.tolerance ? [signOf("failed"), "over the tolerance"] : [])];
  }

  moveCursor() {
    const left = (this.at % this.columns) * this.cell, top = Math.floor(this.at / this.columns) * this.cell;
    const width = `${Math.max(6, this.cell)}px`;
    Object.assign(this.cursor.style, { width, height: width, translate: `${left}px ${top}px` });
  }

  tell() {
    const { map, at: index } = this, frame = map.numbers[index], running = map.running.get(frame);
    if (frame === undefined) return;
    const parts = [`Frame ${frame}: ${wordOf(map.states[index])}`];
    if (map.states[index] === "running" && running?.phase)
      parts.push(`${running.phase}${running.phase_progress === null ? ""
        : ` ${Math.round(running.phase_progress * 100)} %`}`);
    if (!Number.isNaN(map.seconds[index])) parts.push(duration(map.seconds[index]));
    if (!Number.isNaN(map.errors[index])) parts.push(`error ${percent(map.errors[index])}`);
    if (!Number.isNaN(map.bounds[index])) parts.push(`below ${percent(map.bounds[index])} with 95 %`);
    this.told.textContent = parts.join(", ");
  }

  onPoint(event) {
    const x = Math.floor(event.offsetX / this.cell), index = Math.floor(event.offsetY / this.cell) * this.columns + x;
    if (x < 0 || x >= this.columns || index < 0 || index >= this.map.numbers.length) return false;
    this.move(index);
    return true;
  }

  move(index) {
    if (!this.map.numbers.length) return;
    this.at = clamp(index, 0, this.map.numbers.length - 1);
    FrameGrid.kept.set(this.view.id, this.at);
    this.moveCursor();
    this.tell();
  }

  findFailed(step) {
    for (let index = this.at + step; index >= 0 && index < this.map.numbers.length; index += step)
      if (["failed", "missed"].includes(this.map.states[index])) return this.move(index);
    this.told.textContent = `No failed frame ${step > 0 ? "after" : "before"} this one.`;
  }

  onKey({ key, target }) {
    const moves = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: this.columns, ArrowUp: -this.columns,
      PageDown: this.columns * 10, PageUp: -this.columns * 10, Home: -Infinity, End: Infinity };
    if (target !== this.canvas) return false;
    if (key in moves) this.move(this.at + moves[key]);
    else if (key === "n" || key === "N") this.findFailed(key === "n" ? 1 : -1);
    else if (key === "Enter") this.open();
    else return false;
    this.cursor.scrollIntoView({ block: "nearest" });
    return true;
  }
}
