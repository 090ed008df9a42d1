// What was planned for a job, what march explain says of it, and its document.
import { View, el, button, hint, facts, count, leftOut, percent, table } from "./dom.js";
import { getAnswer } from "./frame.js";
import { editDocument } from "./submit.js";

const short = (_, value) => (typeof value === "number" ? Number(value.toPrecision(4)) : value);
const notAllowed = () => hint("Only its owner and administrators may read a job's document.");

async function explain({ id, shown }) {
  if (!shown.document) return [notAllowed()];
  const { counted, ...lists } = await (await getAnswer(`/job/${id}/explain`)).json();
  const each = counted.evaluations, about = (number) => number && count(Number(number.toPrecision(2)));
  const titled = (title, heads, rows) => (rows.length ? [el("h2", null, title), table(title, heads, rows)] : []);
  const features = (title, list) => titled(title, ["What", "Why"], list.map(({ feature, why }) => [feature, why]));
  return [features("Modelled", lists.modelled), features("Not modelled", lists.not_modelled),
    titled("Evaluations of densities for one sample, counted", ["Method", "Evaluations"],
      counted.methods.map(({ method, evaluations }) => [method, about(evaluations)])),
    each ? facts([["A pixel, at most", about(each)], ["A frame", about(each * counted.pixels)],
      ["All frames", about(each * counted.pixels * counted.frames)]]) : ""].flat();
}

export class Plans extends View {
  root = el("div", null, hint("The farm is asked."));

  async show() {
    if (!this.view.shown) return; // it is shown again when the job is known
    const { plans } = await this.view.farm.call("job.plans", { id: this.view.id });
    const rows = plans.map(({ number, quality: { method, ...others }, why, scouts, beyond }) => [`${number}`, method,
      JSON.stringify(others, short, 1).replace(/[{}"\n]/g, "").trim(), why, percent(Math.max(...scouts, 0)),
      leftOut(beyond?.error, beyond?.error95) ?? beyond?.why ?? "–"]);
    const explained = el("div", null, hint("The farm is asked what is modelled."));
    this.root.replaceChildren(rows.length ? table("Plans", ["Plan", "Method", "Numbers", "Why", "Foreseen error",
      "Light left out"], rows)
      : hint("Nothing was planned: the job states its method, or no frame has begun."), explained);
    explained.replaceChildren(...await explain(this.view).catch(({ message }) => [hint(message)]));
  }
}

export class JobDocument extends View {
  root = el("div");

  show() {
    const { document, name } = this.view.shown ?? {}, text = document && JSON.stringify(document, null, 2);
    if (!text) return this.root.replaceChildren(notAllowed());
    const href = URL.createObjectURL(new Blob([text], { type: "application/json" }));
    this.root.replaceChildren(el("div", { class: "tools" },
      el("a", { class: "button", download: `${name}.json`, href }, "Save"),
      button("Copy", () => navigator.clipboard.writeText(text)),
      button("Submit a changed one…", () => editDocument(document))),
    el("pre", { class: "code", tabindex: "0", role: "region", "aria-label": "The job's document" }, text));
  }
}
