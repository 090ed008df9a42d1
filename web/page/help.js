// The keys.
import { View, el } from "./dom.js";

const keys = [
  ["Everywhere", [["1, 2, 3", "jobs, workers, submit"], ["?", "this view"], ["t", "light or dark"],
    ["Esc", "out of a field; one view up"], ["Tab", "to the next thing"]]],
  ["Jobs", [["/", "search"], ["↑ ↓, k j, PgUp PgDn, Home End", "another job"], ["Enter", "open it"]]],
  ["A job, in the list or open", [["p", "pause or resume"], ["c", "cancel"], ["r", "retry"], ["+", "priority"],
    ["Delete", "delete"]]],
  ["An open job", [["f, b, g, x, d", "frames, flipbook, plots, plan, document"], ["← → ↑ ↓, Home End",
    "another frame of the grid"], ["n, N", "the next, the previous failed frame"], ["Enter", "open the frame"]]],
  ["A frame", [["← →", "the frame before, after"], ["+ −, 0", "zoom, fit"], ["Shift and ← → ↑ ↓", "move the picture"],
    ["[ ]", "exposure"], ["a", "exposure by itself"]]],
  ["Flipbook", [["Space", "play, stop"], ["← →", "a frame"], ["Home End", "first, last"]]],
];

export class HelpView extends View {
  title = "Keys";

  root = el("section", { class: "text" }, el("h1", null, "Keys"), keys.map(([title, rows]) => [
    el("h2", null, title), el("dl", { class: "keys" }, rows.map(([key, text]) =>
      el("div", null, el("dt", null, el("kbd", null, key)), el("dd", null, text))))]));
}
