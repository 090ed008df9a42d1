// The list of jobs: ten thousands of rows, of which those in sight are made.
import { View, el, stateMark, doneOf, isOver, count, duration, percent, rate, time } from "./dom.js";
import { keyAction } from "./actions.js";

const SORT_MS = 500, SPARE_ROWS = 6;
const stateOrder = ["running", "queued", "paused", "failed", "canceled", "succeeded"];
const chosen = { text: "", state: "", mine: false, sort: "id", isDown: true, active: null, scroll: 0 };

export const paceOf = (job) => (job.running && job.seconds_per_frame ? job.running / job.seconds_per_frame : 0);

export function phaseText(job) {
  if (!job.phase) return isOver(job) ? "" : "–";
  return job.phase_progress === null ? job.phase : `${job.phase} ${Math.round(job.phase_progress * 100)} %`;
}

export function errorText(job) {
  const parts = [];
  if (job.measured_error !== null) parts.push(percent(job.measured_error));
  if (job.tolerance) parts.push(`${parts.length ? "of" : "≤"} ${percent(job.tolerance)}`);
  if (job.missed) parts.push(`! ${count(job.missed)} over`);
  return parts.join(" ") || (job.draft ? "draft" : "–");
}

export function progressBar(job) {
  const bar = el("progress", { max: 1, "aria-label": "Progress" });
  setProgress(bar, job);
  return bar;
}

const setProgress = (bar, job) => (bar.value = job.frames ? doneOf(job) / job.frames : 0);

const columns = [
  { key: "id", title: "Job", sort: (job) => job.id, text: (job) => `${job.id}` },
  { key: "name", title: "Name", sort: (job) => job.name, text: (job) => job.name, isLink: true },
  { key: "owner", title: "Owner", sort: (job) => job.owner, text: (job) => job.owner },
  { key: "state", title: "State", sort: (job) => stateOrder.indexOf(job.state), isState: true },
  { key: "reason", title: "Why", sort: (job) => job.reason ?? "", text: (job) => job.reason ?? "" },
  { key: "phase", title: "Phase", sort: (job) => job.phase ?? "", text: phaseText },
  { key: "progress", title: "Progress", sort: (job) => doneOf(job) / job.frames, isProgress: true },
  { key: "rate", title: "Frames", sort: paceOf, text: (job) => rate(paceOf(job)) },
  { key: "eta", title: "ETA", sort: (job) => job.eta_s ?? Infinity, text: (job) => isOver(job) ? ""
    : duration(job.eta_s) },
  { key: "error", title: "Error", sort: (job) => job.measured_error ?? -1, text: errorText },
  { key: "method", title: "Method", sort: (job) => job.method ?? "", text: (job) => job.method ?? "–" },
  { key: "priority", title: "Prio", sort: (job) => job.priority, text: (job) => `${job.priority}` },
  { key: "submitted", title: "Submitted", sort: (job) => job.submitted, text: (job) => time(job.submitted) },
];

function makeRow(index) {
  const row = el("div", { class: "row", role: "row", id: `row${index}` });
  row.cells = columns.map((column) => {
    const cell = el("div", { class: `cell ${column.key}`, role: "gridcell" });
    if (column.isLink) cell.append(el("a", { tabindex: "-1" }));
    if (column.isProgress) cell.append(el("progress", { max: 1, "aria-label": "Progress" }), el("span"));
    row.append(cell);
    return cell;
  });
  return row;
}

const setText = (node, text) => node.textContent !== text && (node.textContent = text);

function fillRow(row, job) {
  row.job = job;
  columns.forEach((column, i) => {
    const cell = row.cells[i];
    if (column.isState) {
      if (cell.dataset.state !== job.state) cell.replaceChildren(stateMark(job.state));
      cell.dataset.state = job.state;
    } else if (column.isProgress) {
      setProgress(cell.firstChild, job);
      const failed = job.failed ? ` ✗${count(job.failed)}` : "";
      setText(cell.lastChild, `${count(doneOf(job))}/${count(job.frames)}${failed}`);
    } else if (column.isLink) {
      setText(cell.firstChild, column.text(job));
      cell.firstChild.href = `#/jobs/${job.id}`;
    } else {
      setText(cell, column.text(job));
      if (column.key === "reason") cell.title = job.reason ?? "";
    }
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
  const { sort } = columns.find((column) => column.key === chosen.sort);
  const sign = chosen.isDown ? -1 : 1;
  return (a, b) => {
    const x = sort(a), y = sort(b);
    return x < y ? -sign : x > y ? sign : b.id - a.id;
  };
}

export class JobsView extends View {
  constructor(farm) {
    super();
    this.farm = farm;
    this.title = "Jobs";
    this.pool = new Map(); // index -> row
    this.free = [];
    this.list = [];
    this.root = el("section", { class: "jobs", "aria-label": "Jobs" }, this.makeTools(),
      this.heads = el("div", { class: "heads", role: "row" }),
      this.scroller = el("div", { class: "rows", role: "grid", tabindex: "0", "aria-label": "Jobs",
        onscroll: () => this.draw(), onkeydown: (event) => this.onKey(event), onclick: (event) => this.onClick(event) },
        this.space = el("div", { class: "space", role: "presentation" })),
      this.empty = el("p", { class: "hint", hidden: true }));
    this.makeHeads();
  }

  makeTools() {
    this.search = el("input", { type: "search", id: "search", placeholder: "name, owner, tag, id …", value: chosen.text,
      "aria-label": "Search jobs", oninput: () => this.choose({ text: this.search.value }) });
    const options = [["", "all states"], ["live", "not over"], ...stateOrder.map((state) => [state, state])];
    const state = el("select", { "aria-label": "State", onchange: () => this.choose({ state: state.value }) },
      options.map(([value, text]) => el("option", { value, selected: chosen.state === value }, text)));
    const sort = el("select", { class: "narrow", "aria-label": "Sort by", onchange: () => this.sortBy(sort.value) },
      columns.map(({ key, title }) => el("option", { value: key, selected: chosen.sort === key },
        `by ${title.toLowerCase()}`)));
    const mine = el("input", { type: "checkbox", checked: chosen.mine, onchange: () =>
      this.choose({ mine: mine.checked }) });
    return el("div", { class: "tools" }, this.search, state, sort, el("label", null, mine, " mine"),
      this.sum = el("p", { class: "sum", role: "status" }));
  }

  makeHeads() {
    this.heads.replaceChildren(...columns.map((column) => {
      const isSorted = chosen.sort === column.key;
      return el("div", { class: `cell ${column.key}`, role: "columnheader",
        "aria-sort": isSorted ? (chosen.isDown ? "descending" : "ascending") : "none" },
        el("button", { type: "button", onclick: () => this.sortBy(column.key) },
          column.title, isSorted ? (chosen.isDown ? " ↓" : " ↑") : ""));
    }));
  }

  sortBy(key) {
    this.choose({ isDown: chosen.sort === key ? !chosen.isDown : key === "id", sort: key });
    this.makeHeads();
  }

  choose(choice) {
    Object.assign(chosen, choice);
    this.arrange();
    this.scroller.scrollTop = 0;
  }

  show() {
    this.on(this.farm, "change", ({ detail }) => this.change(detail));
    this.on(window, "resize", () => this.measure());
    this.measure();
    this.arrange();
    this.scroller.scrollTop = chosen.scroll;
    this.draw();
  }

  hide() {
    chosen.scroll = this.scroller.scrollTop;
    clearTimeout(this.timer);
    super.hide();
  }

  focus() { this.scroller.focus(); }

  measure() {
    this.rowHeight = parseFloat(getComputedStyle(this.root).getPropertyValue("--row")) || 32;
    for (const row of this.pool.values()) row.remove();
    this.pool.clear();
    this.draw();
  }

  // Rows in sight change at once, their order at most twice a second.
  change(changed) {
    this.draw();
    if (this.timer || (changed.size === 1 && (changed.has("status") || changed.has("workers")))) return;
    const wait = Math.max(0, (this.arranged ?? 0) + SORT_MS - performance.now());
    this.timer = setTimeout(() => {
      this.timer = null;
      this.arrange();
    }, wait);
  }

  arrange() {
    const { farm } = this;
    this.arranged = performance.now();
    this.list = [...farm.jobs.values()].filter(matcher(farm)).sort(sorter());
    const running = this.list.reduce((sum, job) => sum + paceOf(job), 0);
    const loading = farm.isLoaded ? "" : `, ${count(farm.jobs.size)} loaded`;
    setText(this.sum, `${count(this.list.length)} of ${count(Math.max(farm.total,
      farm.jobs.size))} jobs${loading}, ${rate(running)}`);
    this.empty.hidden = this.list.length > 0;
    setText(this.empty, !farm.isLoaded ? "The farm is asked." : farm.jobs.size ? "No job matches." :
      "There are no jobs yet: submit one with the page's Submit, or with march submit.");
    this.scroller.setAttribute("aria-rowcount", this.list.length);
    this.draw();
  }

  draw() {
    const { pool, rowHeight } = this;
    if (!rowHeight) return;
    const first = Math.max(0, Math.floor(this.scroller.scrollTop / rowHeight) - SPARE_ROWS);
    const last = Math.min(this.list.length, Math.ceil((this.scroller.scrollTop
      + this.scroller.clientHeight) / rowHeight) + SPARE_ROWS);
    this.space.style.height = `${this.list.length * rowHeight}px`;
    for (const [index, row] of pool)
      if (index < first || index >= last) {
        pool.delete(index);
        this.free.push(row);
      }
    for (let index = first; index < last; index++) this.drawRow(index);
    for (const row of this.free.splice(0)) row.remove();
    if (last && !performance.getEntriesByName("jobs shown").length) performance.mark("jobs shown");
    const active = [...pool.values()].find((row) => row.job.id === chosen.active);
    if (active) this.scroller.setAttribute("aria-activedescendant", active.id);
    else this.scroller.removeAttribute("aria-activedescendant");
  }

  drawRow(index) {
    const known = this.list[index], job = this.farm.jobs.get(known.id) ?? known;
    let row = this.pool.get(index);
    if (!row) {
      row = this.free.pop() ?? makeRow(this.rowCount = (this.rowCount ?? 0) + 1);
      this.pool.set(index, row);
      row.style.transform = `translateY(${index * this.rowHeight}px)`;
      row.setAttribute("aria-rowindex", index + 1);
      row.job = null;
      if (!row.isConnected) this.space.append(row);
    }
    if (row.job !== job) fillRow(row, job);
    row.classList.toggle("active", job.id === chosen.active);
    row.setAttribute("aria-selected", String(job.id === chosen.active));
  }

  onClick(event) {
    const row = event.target.closest(".row");
    if (!row) return;
    chosen.active = row.job.id;
    if (!event.target.closest("a")) location.hash = `#/jobs/${row.job.id}`;
  }

  onKey(event) {
    const at = this.list.findIndex((job) => job.id === chosen.active);
    const page = Math.max(1, Math.floor(this.scroller.clientHeight / this.rowHeight) - 1);
    const moves = { ArrowDown: 1, j: 1, ArrowUp: -1, k: -1, PageDown: page, PageUp: -page, Home: -Infinity,
      End: Infinity };
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key in moves && this.list.length) {
      const to = Math.min(this.list.length - 1, Math.max(0, at + moves[event.key]));
      chosen.active = this.list[to].id;
      this.bringToSight(to);
    } else if (event.key === "Enter" && at >= 0) location.hash = `#/jobs/${chosen.active}`;
    else if (!keyAction(this.farm, this.farm.jobs.get(chosen.active), event.key)) return;
    event.preventDefault();
    event.stopPropagation();
  }

  bringToSight(index) {
    const top = index * this.rowHeight, { scroller } = this;
    if (top < scroller.scrollTop) scroller.scrollTop = top;
    if (top + this.rowHeight > scroller.scrollTop + scroller.clientHeight) scroller.scrollTop = top
      + this.rowHeight - scroller.clientHeight;
    this.draw();
  }
}
