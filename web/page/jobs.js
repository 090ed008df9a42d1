// The list of jobs: ten thousands of rows, of which those in sight are made.
import { View, el, button, checkbox, clamp, select, hint, once, say, stateMark, doneOf, isOver, count, duration,
  percent, rate, time } from "./dom.js";
import { keyAction } from "./actions.js";

const SORT_MS = 500, SPARE_ROWS = 6;
const stateOrder = ["running", "queued", "paused", "failed", "canceled", "succeeded"];
const chosen = { text: "", state: "", mine: false, sort: "id", isDown: true, active: null, scroll: 0 };
const nameLink = (job) => el("a", { tabindex: "-1", href: `#/jobs/${job.id}` }, job.name);
export const paceOf = (job) => (job.running && job.seconds_per_frame ? job.running / job.seconds_per_frame : 0);

export function phaseText(job) {
  if (!job.phase) return isOver(job) ? "" : "–";
  return job.phase_progress === null ? job.phase : `${job.phase} ${Math.round(job.phase_progress * 100)} %`;
}

export function errorText(job) {
  const parts = [], { measured_error: error, error95 } = job;
  if (error !== null) parts.push(error || !error95 ? percent(error) : `≤ ${percent(error95)}`);
  if (job.tolerance) parts.push(`${parts.length ? "of" : "≤"} ${percent(job.tolerance)}`);
  if (job.missed) parts.push(`! ${count(job.missed)} over`);
  return parts.join(" ") || (job.draft ? "draft" : "–");
}

export const progressBar = (job) =>
  el("progress", { max: 1, "aria-label": "Progress", value: job.frames ? doneOf(job) / job.frames : 0 });

const progressText = (job) =>
  `${count(doneOf(job))}/${count(job.frames)}${job.failed ? ` ✗${count(job.failed)}` : ""}`;

// What a cell shows is `text` of the job, and that is what jobs are sorted by, where the column has no `sort`.
const columns = [
  { key: "id", title: "Job", text: (job) => job.id },
  { key: "name", title: "Name", text: (job) => job.name, content: nameLink },
  { key: "owner", title: "Owner", text: (job) => job.owner },
  { key: "state", title: "State", text: (job) => job.state, content: (job) => stateMark(job.state),
    sort: (job) => stateOrder.indexOf(job.state) },
  { key: "reason", title: "Why", text: (job) => job.reason ?? "" },
  { key: "phase", title: "Phase", text: phaseText },
  { key: "progress", title: "Progress", text: progressText, content: (job) => [progressBar(job), progressText(job)],
    sort: (job) => doneOf(job) / job.frames },
  { key: "rate", title: "Frames", text: (job) => rate(paceOf(job)), sort: paceOf },
  { key: "eta", title: "ETA", text: (job) => (isOver(job) ? "" : duration(job.eta_s)),
    sort: (job) => job.eta_s ?? Infinity },
  { key: "error", title: "Error", text: errorText, sort: (job) => job.measured_error ?? -1 },
  { key: "method", title: "Method", text: (job) => job.method ?? "–" },
  { key: "priority", title: "Prio", text: (job) => job.priority },
  { key: "submitted", title: "Submitted", text: (job) => time(job.submitted), sort: (job) => job.submitted },
];

const makeRow = (number) => el("div", { class: "row", role: "row", id: `row${number}` },
  columns.map(({ key }) => el("div", { class: `cell ${key}`, role: "gridcell", "--area": key })));

// Only what differs is written: the browser draws rows in sight anew many times a second.
function fillRow(row, job) {
  row.job = job;
  columns.forEach(({ text, content }, i) => {
    const cell = row.children[i], shown = `${text(job)}`, key = content ? `${job.id} ${shown}` : shown;
    if (cell.key === key) return;
    cell.key = key;
    cell.replaceChildren(...[content ? content(job) : shown].flat());
    cell.title = shown;
  });
}

function matcher(farm) {
  const words = chosen.text.toLowerCase().split(/\s+/).filter(Boolean);
  return (job) => {
    if (chosen.state === "live" ? isOver(job) : chosen.state && job.state !== chosen.state) return false;
    if (chosen.mine && job.owner !== farm.session?.user) return false;
    if (!words.length) return true;
    const text = [job.id, job.name, job.owner, job.state, ...job.tags, job.comment, job.reason].join(" ").toLowerCase();
    return words.every((word) => text.includes(word));
  };
}

function sorter() {
  const { text, sort = text } = columns.find((column) => column.key === chosen.sort);
  const sign = chosen.isDown ? -1 : 1;
  return (a, b) => {
    const x = sort(a), y = sort(b);
    return x < y ? -sign : x > y ? sign : b.id - a.id;
  };
}

export class JobsView extends View {
  title = "Jobs";
  rows = []; // row i shows the jobs i, i + rows.length, ...
  list = [];
  search = el("input", { type: "search", id: "search", placeholder: "name, owner, tag, id …", value: chosen.text,
    "aria-label": "Search jobs", oninput: () => this.choose({ text: this.search.value }) });
  sum = el("p", { class: "sum" });
  heads = el("div", { class: "heads", role: "row", id: "heads" });
  space = el("div", { class: "space", role: "rowgroup", id: "space" });
  scroller = el("div", { class: "rows", role: "grid", tabindex: "0", "aria-label": "Jobs", "aria-owns": "heads space",
    onscroll: () => this.draw(), onclick: (event) => this.onClick(event) }, this.space);
  empty = hint("", { hidden: true });
  root = el("section", { class: "jobs", "aria-label": "Jobs" }, el("h1", { class: "unseen" }, "Jobs"),
    el("div", { class: "tools" }, this.search,
    select("State", [["", "all states"], ["live", "not over"], ...stateOrder.map((state) => [state, state])],
      chosen.state, (state) => this.choose({ state })),
    select("Sort by", columns.map(({ key, title }) => [key, `by ${title.toLowerCase()}`]), chosen.sort,
      (key) => this.sortBy(key), { class: "narrow" }),
    checkbox("mine", { checked: chosen.mine, onchange: ({ target }) => this.choose({ mine: target.checked }) }),
    this.sum), this.heads, this.scroller, this.empty);
  arrangeSoon = once(() => this.isHidden || this.arrange(), (act) => setTimeout(act, SORT_MS));

  makeHeads() {
    this.heads.replaceChildren(...columns.map(({ key, title }) => {
      const order = chosen.sort !== key ? "none" : chosen.isDown ? "descending" : "ascending";
      return el("div", { class: `cell ${key}`, role: "columnheader", "aria-sort": order },
        button([title, el("span", { "aria-hidden": "true" }, { none: "", descending: " ↓", ascending: " ↑" }[order])],
          () => this.sortBy(key)));
    }));
  }

  sortBy(key) {
    this.choose({ isDown: chosen.sort === key ? !chosen.isDown : key === "id", sort: key });
    this.makeHeads();
  }

  choose(choice) {
    Object.assign(chosen, choice);
    this.arrange();
    say(this.sum.textContent);
    this.scroller.scrollTop = 0;
  }

  show() {
    this.on(this.farm, "change", ({ detail }) => this.change(detail));
    this.on(window, "resize", () => this.measure());
    this.makeHeads();
    this.arrange();
    this.measure();
    this.scroller.scrollTop = chosen.scroll;
    this.draw();
  }

  hide() {
    chosen.scroll = this.scroller.scrollTop;
    super.hide();
  }

  focus() { this.scroller.focus(); }

  measure() {
    this.rowHeight = parseFloat(getComputedStyle(this.root).getPropertyValue("--row"));
    this.draw();
  }

  // Rows in sight change at once, their order at most twice a second.
  change(changed) {
    this.draw();
    if (changed.size > 1 || !(changed.has("status") || changed.has("workers"))) this.arrangeSoon();
  }

  arrange() {
    const { farm } = this, known = farm.jobs.size;
    this.list = [...farm.jobs.values()].filter(matcher(farm)).sort(sorter());
    const running = this.list.reduce((sum, job) => sum + paceOf(job), 0);
    this.sum.textContent = `${count(this.list.length)} of ${count(Math.max(farm.total, known))} jobs${farm.isLoaded ? ""
      : `, ${count(known)} loaded`}, ${rate(running)}`;
    this.empty.hidden = this.list.length > 0;
    this.empty.textContent = !farm.isLoaded ? "The farm is asked." : known ? "No job matches."
      : "There are no jobs yet: submit one with the page's Submit, or with march submit.";
    this.scroller.setAttribute("aria-rowcount", this.list.length);
    this.draw();
  }

  draw() {
    const { rows, rowHeight, scroller } = this;
    if (!rowHeight) return;
    this.space.style.height = `${this.list.length * rowHeight}px`;
    const first = Math.max(0, Math.floor(scroller.scrollTop / rowHeight) - SPARE_ROWS);
    const needed = Math.ceil(scroller.clientHeight / rowHeight) + 2 * SPARE_ROWS;
    while (rows.length < needed) rows.push(makeRow(rows.length));
    for (let index = first; index < first + rows.length; index++) this.drawRow(rows[index % rows.length], index);
    if (this.list.length && !performance.getEntriesByName("jobs shown").length) performance.mark("jobs shown");
    const active = rows.find((row) => row.isConnected && row.job.id === chosen.active);
    scroller.setAttribute("aria-activedescendant", active?.id ?? "");
  }

  drawRow(row, index) {
    const known = this.list[index];
    if (!known) return row.remove();
    const job = this.farm.jobs.get(known.id) ?? known;
    if (row.job !== job) fillRow(row, job);
    row.style.setProperty("--at", index);
    row.setAttribute("aria-rowindex", index + 1);
    row.setAttribute("aria-selected", String(job.id === chosen.active));
    if (!row.isConnected) this.space.append(row);
  }

  onClick(event) {
    const row = event.target.closest(".row");
    if (!row) return;
    chosen.active = row.job.id;
    if (!event.target.closest("a")) location.hash = `#/jobs/${row.job.id}`;
  }

  onKey({ key }) {
    const at = this.list.findIndex((job) => job.id === chosen.active);
    const page = Math.max(1, Math.floor(this.scroller.clientHeight / this.rowHeight) - 1);
    const moves = { ArrowDown: 1, j: 1, ArrowUp: -1, k: -1, PageDown: page, PageUp: -page, Home: -Infinity,
      End: Infinity };
    if (key in moves && this.list.length) {
      const to = clamp(at + moves[key], 0, this.list.length - 1);
      const { scroller, rowHeight } = this, top = to * rowHeight;
      chosen.active = this.list[to].id;
      scroller.scrollTop = Math.min(top, Math.max(scroller.scrollTop, top + rowHeight - scroller.clientHeight));
      this.draw();
    } else if (key === "Enter" && at >= 0) location.hash = `#/jobs/${chosen.active}`;
    else return keyAction(this.farm, this.farm.jobs.get(chosen.active), key);
    return true;
  }
}
