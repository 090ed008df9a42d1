// Seconds of each frame, and its error with the 95 % bound against the tolerance.
import { View, el, hint, once, styleColour, duration, percent } from "./dom.js";

const DRAW_MS = 2000, POINTS = 1500;
let chart; // the library, when it is loaded

const plotBox = (name) => el("div", null, el("h2", null, name), hint(""),
  el("div", { class: "chart" }, el("canvas", { role: "img" })));

export class Plots extends View {
  charts = [];
  seconds = plotBox("Seconds a frame");
  errors = plotBox("Error of each frame");
  root = el("div", null, this.seconds, this.errors);

  async show() {
    this.on(this.map, "change", once(() => this.draw(), (act) => setTimeout(act, DRAW_MS)));
    await import("/vendor/chart.js");
    chart = globalThis.Chart;
    this.draw();
  }

  hide() {
    super.hide();
    for (const one of this.charts) one.destroy();
  }

  points(values, scale = 1) {
    return [...values].map((value, index) => ({ x: this.map.numbers[index], y: value * scale }))
      .filter(({ y }) => !Number.isNaN(y)).sort((a, b) => a.x - b.x);
  }

  draw() {
    if (!chart || this.isHidden || !this.map.isLoaded) return;
    for (const one of this.charts) one.destroy();
    const { map } = this, { tolerance } = this.view.job ?? {};
    const line = (label, data, name, more) => ({ label, data, borderColor: styleColour(name),
      backgroundColor: styleColour(name), borderWidth: 1.5, pointRadius: data.length > 300 ? 0 : 2.5, ...more });
    const seconds = this.points(map.seconds), errors = this.points(map.errors, 100),
      bounds = this.points(map.bounds, 100);
    const ends = seconds.length ? [seconds[0].x, seconds.at(-1).x] : [];
    this.charts = [
      this.plot(this.seconds, "s", [line("seconds", seconds, "--running")], this.tellSeconds(seconds)),
      this.plot(this.errors, "%", [line("error", errors, "--succeeded"), line("95 % bound", bounds, "--quiet",
        { borderDash: [5, 3], pointStyle: "triangle" }),
        line("tolerance", tolerance ? ends.map((x) => ({ x, y: tolerance * 100 })) : [], "--failed",
          { borderDash: [2, 3], pointRadius: 0 })], this.tellErrors(errors, tolerance)),
    ];
  }

  plot(box, unit, datasets, told) {
    const ink = styleColour("--quiet"), lines = styleColour("--line"), canvas = box.querySelector("canvas");
    const shown = datasets.filter(({ data }) => data.length);
    const axis = (text) => ({ type: "linear", title: { display: true, text, color: ink }, ticks: { color: ink },
      grid: { color: lines } });
    box.querySelector(".hint").textContent = told;
    canvas.setAttribute("aria-label", told);
    return new chart(canvas, { type: "line", data: { datasets: shown },
      options: { animation: false, parsing: false, normalized: true, maintainAspectRatio: false,
        interaction: { mode: "nearest", axis: "x", intersect: false },
        onClick: (_, [hit]) => hit && this.view.openFrame(shown[hit.datasetIndex].data[hit.index].x),
        plugins: { decimation: { enabled: true, algorithm: "min-max", threshold: POINTS },
          legend: { labels: { color: ink, usePointStyle: true, boxWidth: 7, boxHeight: 7 } } },
        scales: { x: axis("frame"), y: { ...axis(unit), beginAtZero: true } } } });
  }

  tellSeconds(points) {
    if (!points.length) return "No frame has a time yet.";
    const sorted = points.toSorted((a, b) => a.y - b.y), most = sorted.at(-1);
    return `Median ${duration(sorted[sorted.length >> 1].y)}, the longest ${duration(most.y)} (frame ${most.x}).`;
  }

  tellErrors(points, tolerance) {
    if (!points.length) return "No frame has a measured error yet.";
    const most = points.reduce((a, b) => (b.y > a.y ? b : a));
    return `The largest ${percent(most.y / 100)} (frame ${most.x})${tolerance
      ? `, tolerance ${percent(tolerance)}, ${points.filter(({ y }) => y > tolerance * 100).length} frames over it`
      : ""}.`;
  }
}
