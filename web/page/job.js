// One job: what it is, what can be done with it, and its frames, flipbook, plots, plan and document.
import { View, el, facts, hint, markCurrent, say, stateMark, doneOf, isOver, count, duration, percent, rate, time }
  from "./dom.js";
import { actionButtons, keyAction } from "./actions.js";
import { paceOf, phaseText, errorText, progressBar } from "./jobs.js";
import { FrameMap } from "./framemap.js";
import { FrameGrid } from "./grid.js";
import { formatRange } from "./ranges.js";

// Name, title and key of each; what makes its content is not loaded before.
const tabs = [
  ["frames", "Frames", "f", () => FrameGrid],
  ["flipbook", "Flipbook", "b", async () => (await import("./flipbook.js")).Flipbook],
  ["plots", "Plots", "g", async () => (await import("./plots.js")).Plots],
  ["plan", "Plan", "x", async () => (await import("./document.js")).Plans],
  ["document", "Document", "d", async () => (await import("./document.js")).JobDocument],
];

export class JobView extends View {
  title = `Job ${this.id}`;
  map = new FrameMap({ farm: this.farm, id: this.id });
  head = el("div");
  buttons = actionButtons(this.farm);
  tabs = el("nav", { class: "tabs", "aria-label": "About this job" },
    tabs.map(([name, title, key]) => el("a", { href: this.hash(name), title: `Key: ${key}` }, title)));
  panel = el("div", { id: "panel" });
  root = el("section", { class: "job", "aria-label": "Job" }, this.head, this.buttons, this.tabs, this.panel);

  hash(tab) { return `#/jobs/${this.id}${tab === "frames" ? "" : `/${tab}`}`; }
  get job() { return this.farm.jobs.get(this.id) ?? this.shown; }

  async show() {
    this.on(this.farm, "change", ({ detail }) => detail.has(this.id) && this.drawHead());
    this.on(this.farm, "state", () => this.farm.state === "live" && !this.isOpen && this.load());
    if (this.job) this.drawHead();
    else this.head.replaceChildren(hint("The farm is asked."));
    this.selectTab(this.tab);
    if (this.farm.state === "live") await this.load();
  }

  async load() {
    this.isOpen = true;
    try {
      this.shown = await this.farm.call("job.show", { id: this.id });
      if (this.isHidden) return;
      await this.map.show();
      this.drawHead(); // with the frames that failed
      this.selectTab(this.tab);
    } catch (error) {
      this.head.replaceChildren(el("h1", null, `Job ${this.id}`), el("p", { class: "wrong" }, error.message));
    }
  }

  hide() {
    super.hide();
    this.content?.hide();
    this.map.hide();
  }

  focus() { this.tabs.querySelector("[aria-current]").focus({ preventScroll: true }); }
  openFrame(frame) { location.hash = `#/jobs/${this.id}/frames/${frame}`; }

  // Another tab of the same job keeps the view.
  follow(hash) {
    const found = tabs.find(([name]) => this.hash(name) === hash);
    if (found) this.selectTab(found[0]);
    return Boolean(found);
  }

  async selectTab(tab = "frames") {
    this.tab = tab;
    markCurrent(this.tabs, (href) => href === this.hash(tab));
    const Content = await tabs.find(([name]) => name === tab)[3]();
    if (this.tab !== tab) return;
    this.content?.hide();
    this.content = new Content({ view: this, map: this.map });
    this.panel.replaceChildren(this.content.root);
    this.content.show();
  }

  drawHead() {
    const { job } = this;
    if (!job) return;
    if (this.shown && this.farm.isLoaded && !this.farm.jobs.has(this.id)) return this.drawDeleted();
    this.title = `Job ${job.id}, ${job.name}`;
    if (this.said !== job.state) say(`${this.title}: ${job.state}`);
    this.said = job.state;
    const counts = ["queued", "running", "succeeded", "skipped", "failed", "canceled"].filter((state) => job[state]);
    const failed = job.failed && this.map.isLoaded ? this.map.framesOf("failed").slice(0, 2000) : [];
    this.head.replaceChildren(
      el("h1", null, el("span", { class: "number" }, `${job.id} `), job.name, " ", stateMark(job.state)),
      job.reason ? el("p", { class: "why" }, job.reason) : "",
      job.comment ? hint(job.comment) : "",
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
      ]), failed.length ? el("p", { class: "wrong" }, `✗ Failed: ${formatRange(failed).slice(0, 400)}`) : "");
    this.buttons.refresh(job);
  }

  drawDeleted() {
    this.map.hide();
    this.root.replaceChildren(el("h1", null, `Job ${this.id}`), el("p", { class: "why" }, "The job is deleted."),
      el("a", { href: "#/jobs" }, "All jobs"));
  }

  onKey(event) {
    if (this.content?.onKey?.(event)) return true;
    const tab = tabs.find(([, , key]) => key === event.key);
    if (tab) location.hash = this.hash(tab[0]);
    return Boolean(tab) || keyAction(this.farm, this.job, event.key);
  }

  onTheme() { this.content?.draw?.(); }
}
