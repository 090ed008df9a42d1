// Workers, by pool and node: which machine and renderer, what they do now, what was wrong last.
import { View, el, hint, table, facts, stateMark, count, duration } from "./dom.js";

export class WorkersView extends View {
  title = "Workers";
  root = el("section", { class: "text wide", "aria-label": "Workers" });

  show() {
    this.on(this.farm, "change", ({ detail }) => (detail.has("workers") || detail.has("status")) && this.draw());
    this.draw();
  }

  draw() {
    const { status } = this.farm, workers = [...this.farm.workers.values()].sort((a, b) => a.id - b.id);
    const pools = Map.groupBy(workers, (worker) => worker.pool);
    this.root.replaceChildren(el("h1", null, "Workers"), status ? facts([
      ["Workers", `${count(status.workers)}, ${count(status.frames.running)} frames in work`],
      ["Nodes", status.nodes.up + status.nodes.waiting ? `${status.nodes.up} up, ${status.nodes.waiting} waiting` : ""],
      ["Frames", `${count(status.frames.queued)} queued`],
      ["Daemon", `${status.version}, up for ${duration(Date.now() / 1000 - status.started)}, pid ${status.pid}`],
      ["Output", status.output_roots.join(", ")], ["Queue on disk", status.store.state],
    ]) : "", ...[...pools].flatMap(([pool, members]) => [el("h2", null, `Pool ${pool}, ${count(members.length)}`),
      this.drawPool(pool, members)]),
    workers.length ? "" : hint("No workers are known."));
  }

  drawPool(pool, workers) {
    return table(`Workers of pool ${pool}`, ["Worker", "Machine", "State", "Does", "Done", "Renderer", "Last fault"],
      workers.map((worker) => [
      `${worker.id}`, worker.node ?? "this machine", stateMark(worker.state),
      worker.job ? el("a", { href: `#/jobs/${worker.job}` }, `job ${worker.job} ${this.farm.jobs.get(worker.job)?.name
        ?? ""}, ${worker.frames} in flight`) : "–",
      count(worker.done), [worker.backend, worker.renderer, worker.sandbox
        && `(${worker.sandbox})`].filter(Boolean).join(" · ") || "–",
      worker.reason ? el("span", { class: "wrong" }, `! ${worker.reason}`) : "–"]));
  }
}
