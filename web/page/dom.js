// Makes elements, and writes numbers, times and states for people.

// Attributes that are functions are listeners ("onclick"), those that are no text are properties.
export function el(name, attributes, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes ?? {})) {
    if (value === undefined || value === null) continue;
    if (typeof value === "function") made.addEventListener(key.slice(2), value);
    else if (typeof value === "string" || key.includes("-")) made.setAttribute(key, value);
    else made[key] = value;
  }
  made.append(...children.flat(2).filter((child) => child !== null && child !== undefined && child !== false));
  return made;
}

// What a colour of the style sheet is in the present theme: "rgb(1, 2, 3)".
export function styleColour(name) {
  const probe = el("span", { hidden: true });
  probe.style.color = `var(${name})`;
  document.body.append(probe);
  const { color } = getComputedStyle(probe);
  probe.remove();
  return color;
}

export const find = (selector, within = document) => within.querySelector(selector);

// Says a sentence to screen readers.
export const say = (text) => (find("#said").textContent = text);

// Shows a sentence for some seconds; a mistake stays until it is closed.
export function toast(text, isWrong = false) {
  const note = el("div", { class: isWrong ? "toast wrong" : "toast" }, text,
    el("button", { type: "button", "aria-label": "Close this message", onclick: () => note.remove() }, "×"));
  find("#toasts").append(note);
  if (!isWrong) setTimeout(() => note.remove(), 6000);
}

export const signs = { queued: "…", running: "▶", paused: "Ⅱ", succeeded: "✓", failed: "✗", canceled: "⊘", skipped: "»",
  missed: "!" };
export const wordOf = (state) => (state === "missed" ? "over the tolerance" : state);

export function stateMark(state) {
  return el("span", { class: `state ${state}` }, el("span", { class: "sign", "aria-hidden": "true" },
    signs[state] ?? "?"), ` ${wordOf(state)}`);
}

export const isOver = (job) => ["succeeded", "failed", "canceled"].includes(job.state);
export const doneOf = (job) => job.succeeded + job.skipped;

export const count = (number) => Math.round(number).toLocaleString("en");

export function duration(seconds) {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return "–";
  if (seconds < 0.0995) return `${(seconds * 1000).toPrecision(2)} ms`;
  if (seconds < 99.5) return `${seconds < 9.95 ? seconds.toFixed(1) : Math.round(seconds)} s`;
  const minutes = Math.round(seconds / 60);
  if (minutes < 100) return `${minutes} min`;
  if (minutes < 100 * 60) return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
  return `${Math.round(minutes / 1440)} d`;
}

export function percent(share, digits = 2) {
  if (share === null || share === undefined) return "–";
  return `${(share * 100).toPrecision(digits).replace(/e\+.*/, "")} %`;
}

export function rate(framesPerSecond) {
  if (!framesPerSecond) return "–";
  if (framesPerSecond >= 0.1) return `${framesPerSecond.toPrecision(2)}/s`;
  return framesPerSecond * 60 >= 0.1 ? `${(framesPerSecond * 60).toPrecision(2)}/min`
    : `${(framesPerSecond * 3600).toPrecision(2)}/h`;
}

export function size(bytes) {
  if (bytes === null || bytes === undefined) return "–";
  const units = ["B", "KiB", "MiB", "GiB", "TiB"];
  let unit = 0;
  for (; bytes >= 1024 && unit < units.length - 1; unit++) bytes /= 1024;
  return `${unit && bytes < 100 ? bytes.toPrecision(3) : Math.round(bytes)} ${units[unit]}`;
}

export function time(unixSeconds) {
  if (!unixSeconds) return "–";
  const text = new Date(unixSeconds * 1000).toLocaleString("sv"); // 2026-11-23 15:40:02
  return text.slice(text.startsWith(`${new Date().getFullYear()}-`) ? 5 : 0, 16);
}

// What listens until it is hidden.
export class View {
  stop = new AbortController();

  on(target, type, listener) { target.addEventListener(type, listener, { signal: this.stop.signal }); }

  show() {} // what follows the farm begins here

  get isHidden() { return this.stop.signal.aborted; }

  hide() { this.stop.abort(); }

  watchSize(element, draw) {
    const observer = new ResizeObserver(draw);
    observer.observe(element);
    this.stop.signal.addEventListener("abort", () => observer.disconnect());
  }
}

// A list of names and values.
export function facts(rows) {
  return el("dl", { class: "facts" },
    rows.filter((row) => row && ![null, undefined, "", "–"].includes(row[1]))
      .map(([name, value, kind]) => el("div", { class: kind }, el("dt", null, name), el("dd", null, value))));
}

export function table(caption, heads, rows) {
  return el("div", { class: "scroll" }, el("table", null, el("caption", { class: "unseen" }, caption),
    el("thead", null, el("tr", null, heads.map((head) => el("th", { scope: "col" }, head)))),
    el("tbody", null, rows.map((row) => el("tr", null, row.map((cell) => el("td", null, cell ?? "–")))))));
}
