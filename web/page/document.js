// What was planned for a job, and its document.
import { View, el, percent, table } from "./dom.js";
import { editDocument } from "./submit.js";

const short = (_, value) => (typeof value === "number" ? Number(value.toPrecision(4)) : value);

export class Plans extends View {
  constructor(view) {
    super();
    this.view = view;
    this.root = el("div", null, el("p", { class: "hint" }, "The farm is asked."));
  }

  async show() {
    if (!this.view.shown) return; // it is shown again when the job is known
    const { plans } = await this.view.farm.call("job.plans", { id: this.view.id });
    const rows = plans.map(({ number, quality: { method, ...others }, why, scouts }) => [`${number}`, method,
      JSON.stringify(others, short, 1).replace(/[{}"\n]/g, "").trim(), why, percent(Math.max(...scouts, 0))]);
    this.root.replaceChildren(rows.length ? table("Plans", ["Plan", "Method", "Numbers", "Why", "Foreseen error"], rows)
      : el("p", { class: "hint" }, "Nothing was planned: the job states its method, or no frame has begun."));
  }
}

export class JobDocument extends View {
  constructor({ shown }) {
    super();
    const { document } = shown ?? {}, text = document && JSON.stringify(document, null, 2);
    const link = text && el("a", { class: "button", download: `${shown.name}.json`,
      href: URL.createObjectURL(new Blob([text], { type: "application/json" })) }, "Save");
    this.root = text ? el("div", null, el("div", { class: "tools" }, link,
      el("button", { type: "button", onclick: () => navigator.clipboard.writeText(text) }, "Copy"),
      el("button", { type: "button", onclick: () => editDocument(document) }, "Submit a changed one…")),
        el("pre", { class: "code", tabindex: "0" }, text))
      : el("p", { class: "hint" }, "Only its owner and administrators may read a job's document.");
  }
}
