// Makes elements, and writes numbers, times and states for people.

// Attributes that are functions are listeners ("onclick"), those that are no text are properties, "--name" is CSS.
export function el(name, attributes, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes ?? {})) {
    if (value === undefined || value === null) continue;
    if (typeof value === "function") made.addEventListener(key.slice(2), value);
    else if (key.startsWith("--")) made.style.setProperty(key, value);
    else if (typeof value === "string" || key.includes("-")) made.setAttribute(key, value);
    else made[key] = value;
  }
  made.append(...children.flat(2).filter((child) => child !== null && child !== undefined && child !== false));
  return made;
}

export const button = (text, onclick, attributes) => el("button", { type: "button", onclick, ...attributes }, text);

export const checkbox = (text, attributes) =>
  el("label", null, el("input", { type: "checkbox", ...attributes }), ` ${text}`);

// `choices` are pairs of a value and its text; `choose` gets a value.
export const select = (label, choices, chosen, choose, attributes) =>
  el("select", { "aria-label": label, onchange: ({ target }) => choose(target.value), ...attributes },
    choices.map(([value, text]) => el("option", { value, selected: value === chosen }, text)));

export const hint = (text, attributes) => el("p", { class: "hint", ...attributes }, text);
export const find = (selector, within = document) => within.querySelector(selector);
export const say = (text) => (find("#said").textContent = text); // to screen readers

// Says which of the links within is that of the present view.
export function markCurrent(links, isCurrent) {
  for (const link of links.querySelectorAll("a"))
    if (isCurrent(link.getAttribute("href"))) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
}

// What a colour of the style sheet is in the present theme: "rgb(1, 2, 3)".
export function styleColour(name) {
  const unseen = find("#said");
  unseen.style.color = `var(${name})`;
  return getComputedStyle(unseen).color;
}

// Calls `act` once, however often it is called until then: with the screen's next picture, or when `plan` lets it.
export function once(act, plan = requestAnimationFrame) {
  let isPlanned = false;
  return () => {
    if (isPlanned) return;
    isPlanned = true;
    plan(() => {
      isPlanned = false;
      act();
    });
  };
}

// Shows a sentence for some seconds; a mistake stays until it is closed.
export function toast(text, isWrong = false) {
  const note = el("div", { class: isWrong ? "toast wrong" : "toast" }, text,
    button("×", () => note.remove(), { "aria-label": "Close this message" }));
  find("#toasts").append(note);
  if (!isWrong) setTimeout(() => note.remove(), 6000);
}

export const signs = { queued: "…", running: "▶", paused: "Ⅱ", succeeded: "✓", failed: "✗", canceled: "⊘", skipped: "»",
  missed: "!", busy: "▶", idle: "○", starting: "…", backing_off: "✗", stopping: "⊘", waiting: "Ⅱ" };
export const wordOf = (state) => (state === "missed" ? "over the tolerance" : state.replace("_", " "));
export const signOf = (state) => el("span", { class: "sign", "aria-hidden": "true",
  "--fill": `var(--${state}, var(--queued))` }, signs[state] ?? "?");
export const stateMark = (state) => el("span", { class: `state ${state}` }, signOf(state), ` ${wordOf(state)}`);
export const isOver = (job) => ["succeeded", "failed", "canceled"].includes(job.state);
export const doneOf = (job) => job.succeeded + job.skipped;
export const clamp = (value, least, most) => Math.min(most, Math.max(least, value));
export const count = (number) => Math.round(number).toLocaleString("en");

export function duration(seconds) {
  if (!Number.isFinite(seconds)) return "–";
  if (seconds < 0.0995) return `${(seconds * 1000).toPrecision(2)} ms`;
  if (seconds < 99.5) return `${seconds < 9.95 ? seconds.toFixed(1) : Math.round(seconds)} s`;
  const minutes = Math.round(seconds / 60);
  if (minutes < 100) return `${minutes} min`;
  if (minutes < 100 * 60) return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
  return `${Math.round(minutes / 1440)} d`;
}

export const percent = (share, digits = 2) => (!Number.isFinite(share) ? "–" // all digits of 100 and more
  : `${share < 0.995 ? (share * 100).toPrecision(digits) : Math.round(share * 100)} %`);
// What the modelled orders of scattering leave out; null where that is not known.
export const leftOut = (error, error95) =>
  (Number.isFinite(error) ? `${percent(error)} of it, below ${percent(error95)} with 95 %` : null);

export function rate(framesPerSecond) {
  const [seconds, unit] = [[1, "s"], [60, "min"]].find(([each]) => framesPerSecond * each >= 0.1) ?? [3600, "h"];
  return framesPerSecond ? `${(framesPerSecond * seconds).toPrecision(2)}/${unit}` : "–";
}

export function size(bytes) {
  if (!Number.isFinite(bytes)) return "–";
  const power = Math.min(4, Math.floor(Math.log2(Math.max(1, bytes)) / 10)), number = bytes / 1024 ** power;
  const unit = ["B", "KiB", "MiB", "GiB", "TiB"][power];
  return `${power && number < 100 ? number.toPrecision(3) : Math.round(number)} ${unit}`;
}

export function time(unixSeconds) {
  if (!unixSeconds) return "–";
  const text = new Date(unixSeconds * 1000).toLocaleString("sv"); // 2026-11-23 15:40:02
  return text.slice(text.startsWith(`${new Date().getFullYear()}-`) ? 5 : 0, 16);
}

// What listens until it is hidden.
export class View extends EventTarget {
  stop = new AbortController();

  constructor(members) { Object.assign(super(), members); }
  on(target, type, listener) { target.addEventListener(type, listener, { signal: this.stop.signal }); }
  show() {} // what follows the farm begins here
  hide() { this.stop.abort(); }
  get isHidden() { return this.stop.signal.aborted; }

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
