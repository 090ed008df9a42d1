// A job's document, to read, to keep, or to submit again.
import { View, el } from "./dom.js";
import { editDocument } from "./submit.js";

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
