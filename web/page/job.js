// One job: what it is, what can be done with it, and its frames, flipbook, plots, plan and document.
import { View, el, facts, stateMark, doneOf, isOver, count, duration, percent, rate, time } from "./dom.js";
import { actionButtons, keyAction } from "./actions.js";
import { paceOf, phaseText, errorText, progressBar } from "./jobs.js";
import { FrameMap } from "./framemap.js";
import { FrameGrid } from "./grid.js";
import { formatRange } from "./ranges.js";

const tabs = [["frames", "Frames", "f"], ["flipbook", "Flipbook", "b"], ["plots", "Plots", "g"],
  ["plan", "Plan", "x"], ["document", "Document", "d"]];

export class JobView extends View {
  constructor(farm, id, tab) {
    super();
    Object.assign(this, { farm, id, tab: tab ?? "frames", title: `Job ${id}` });
    this.map = new FrameMap(farm, id);
    this.head = el("div", { class: "head" });
    this.buttons = actionButtons(farm);
    this.tabs = el("div", { class: "tabs", role: "tablist", "aria-label": "About this job",
      onkeydown: (event) => this.onTabKey(event) },
      tabs.map(([name, title, key]) => el("a", { role: "tab", id: `tab-${name}`, href: this.hash(name),
        title: `Key: ${key}`, "aria-controls": "panel" }, title)));
    this.panel = el("div", { id: "panel", role: "tabpanel" });
    this.root = el("section", { class: "job", "aria-label": "Job" }, this.head, this.buttons, this.tabs, this.panel);
  }

  hash(tab) { return `#/jobs/${this.id}${tab === "frames" ? "" : `/${tab}`}`; }

  get job() { return this.farm.jobs.get(this.id) ?? this.shown; }

  async show() {
    this.on(this.farm, "change", ({ detail }) => detail.has(this.id) && this.drawHead());
    this.on(this.farm, "state", () => this.farm.state === "live" && !this.isOpen && this.load());
    if (this.job) this.drawHead();
    else this.head.replaceChildren(el("p", { class: "hint" }, "The farm is asked."));
    this.selectTab(this.tab);
    if (this.farm.state === "live") await this.load();
  }

  async load() {
    this.isOpen = true;
    try {
      this.shown = await this.farm.call("job.show", { id: this.id });
      await this.map.open();
      this.drawHead(); // with the frames that failed
      this.selectTab(this.tab);
    } catch (error) {
      this.head.replaceChildren(el("h1", null, `Job ${this.id}`), el("p", { class: "wrong" }, error.message));
    }
  }

  hide() {
    super.hide();
    this.content?.hide();
    this.map.close();
  }

  focus() {
    (this.content?.canvas ?? this.tabs.querySelector("[aria-selected=true]"))?.focus({ preventScroll: true });
  }

  openFrame(frame) { location.hash = `#/jobs/${this.id}/frames/${frame}`; }

  // Another tab of the same job keeps the view.
  follow(hash) {
    const found = tabs.find(([name]) => this.hash(name) === hash);
    if (!found) return false;
    this.selectTab(found[0]);
    return true;
  }

  async selectTab(tab) {
    this.tab = tab;
    for (const link of this.tabs.children) {
      const isSelected = link.id === `tab-${tab}`;
      link.setAttribute("aria-selected", String(isSelected));
      link.tabIndex = isSelected ? 0 : -1;
    }
    this.panel.setAttribute("aria-labelledby", `tab-${tab}`);
    const make = {
      frames: () => new FrameGrid(this.map, () => this.job, (frame) => this.openFrame(frame)),
      flipbook: async () => new (await import("./flipbook.js")).Flipbook(this),
      plots: async () => new (await import("./plots.js")).Plots(this),
      plan: async () => new (await import("./document.js")).Plans(this),
      document: async () => new (await import("./document.js")).JobDocument(this),
    }[tab];
    const content = await make();
    if (this.tab !== tab) return;
    this.content?.hide();
    this.content = content;
    this.panel.replaceChildren(content.root);
    content.show();
  }

  drawHead() {
    const { job } = this;
    if (!job) return;
    if (this.shown && this.farm.isLoaded && !this.farm.jobs.has(this.id)) return this.drawDeleted();
    this.title = `Job ${job.id}, ${job.name}`;
    const counts = ["queued", "running", "succeeded", "skipped", "failed", "canceled"].filter((state) => job[state]);
    this.head.replaceChildren(
      el("h1", null, el("span", { class: "number" }, `${job.id} `), job.name, " ", stateMark(job.state)),
      job.reason ? el("p", { class: "why" }, job.reason) : "",
      job.comment ? el("p", { class: "hint" }, job.comment) : "",
      el("div", { class: "bar" }, progressBar(job),
        el("span", null, `${count(doneOf(job))} of ${count(job.frames)} frames`)),
      facts([
        ["Frames", counts.map((state) => `${count(job[state])} ${state}`).join(", ")],
        ["Range", job.range], ["Phase", phaseText(job)], ["Speed", job.seconds_per_frame
          && `${paceOf(job) ? `${rate(paceOf(job))}, ` : ""}${duration(job.seconds_per_frame)} a frame`],
        ["ETA", isOver(job) ? null : duration(job.eta_s)], ["Latest error", errorText(job)],
        ["Below, with 95 %", percent(job.error95)], ["Method", job.method], ["Owner", job.owner],
        ["Priority", `${job.priority}`], ["Pool", job.pool], ["Tags", job.tags?.join(", ")],
        ["Submitted", time(job.submitted)], ["Started", time(job.started)], ["Finished", time(job.finished)],
        ["Output", el("code", null, job.output), "long"],
      ]), this.failures());
    this.buttons.refresh(job);
  }

  drawDeleted() {
    this.map.close();
    this.root.replaceChildren(el("h1", null, `Job ${this.id}`), el("p", { class: "why" }, "The job is deleted."),
      el("a", { href: "#/jobs" }, "All jobs"));
  }

  failures() {
    if (!this.job.failed || !this.map.isLoaded) return "";
    const failed = this.map.framesOf("failed");
    return el("p", { class: "wrong" }, `✗ Failed: ${formatRange(failed.slice(0, 2000)).slice(0, 400)}`);
  }

  onTabKey(event) {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const at = tabs.findIndex(([name]) => name === this.tab), next = tabs[(at + step + tabs.length) % tabs.length][0];
    location.hash = this.hash(next);
    this.tabs.querySelector(`#tab-${next}`).focus();
    event.preventDefault();
    event.stopPropagation();
  }

  onKey(event) {
    if (this.tab !== "frames" && this.content?.onKey?.(event)) return true;
    const tab = tabs.find(([, , key]) => key === event.key);
    if (tab) location.hash = this.hash(tab[0]);
    return Boolean(tab) || keyAction(this.farm, this.job, event.key);
  }

  onTheme() { this.content?.draw?.(); }
}
