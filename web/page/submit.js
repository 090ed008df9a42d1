// Submits a job: a dropped or typed JSON document, whose mistakes are shown at their place in the text.
import { View, el, button, checkbox, toast } from "./dom.js";
import { findSyntaxMistake, findPlace, splitMessage } from "./place.js";

const kept = { text: "" }; // while another view is shown

// Puts a document into the view before it is shown.
export function editDocument(document) {
  kept.text = JSON.stringify(document, null, 2);
  location.hash = "#/submit";
}

// GLSL that is dropped beside the job takes the place of its file, as `march submit` does it.
function putSources(node, sources) {
  if (node === null || typeof node !== "object") return;
  const name = typeof node.file === "string" && node.file.split("/").pop();
  if (node.kind === "glsl" && node.source === undefined && sources.has(name)) node.source = sources.get(name);
  for (const child of Object.values(node)) putSources(child, sources);
}

export class SubmitView extends View {
  title = "Submit";
  text = el("textarea", { id: "document", spellcheck: false, rows: 24, value: kept.text,
    "aria-label": "The job's document", "aria-describedby": "mistake",
    placeholder: "Drop a job file here, with its GLSL files, or type its JSON.", oninput: () => this.clear(),
    onscroll: () => (this.lines.scrollTop = this.text.scrollTop),
    onkeydown: (event) => event.ctrlKey && event.key === "Enter" && this.submit() });
  lines = el("pre", { class: "lines", "aria-hidden": "true" });
  mistake = el("p", { id: "mistake", class: "wrong", role: "alert" });
  paused = checkbox("paused");
  file = el("input", { type: "file", multiple: true, accept: ".json,.glsl",
    "aria-label": "Job file, and its GLSL files", onchange: () => this.read(this.file.files) });
  root = el("section", { class: "submit", "aria-label": "Submit a job", ondrop: (event) => this.onDrop(event),
    ondragover: (event) => this.onDrag(event, true), ondragleave: (event) => this.onDrag(event, false) },
    el("h1", null, "Submit a job"), el("div", { class: "tools" }, this.file, this.paused,
      button("Submit", () => this.submit(), { class: "main", title: "Key: Ctrl and Enter" })),
    this.mistake, el("div", { class: "editor" }, this.lines, this.text));

  show() { this.clear(); }
  focus() { this.text.focus(); }

  hide() {
    kept.text = this.text.value;
    super.hide();
  }

  onDrag(event, isOver) {
    event.preventDefault();
    this.root.classList.toggle("over", isOver);
  }

  onDrop(event) {
    this.onDrag(event, false);
    this.read(event.dataTransfer.files);
  }

  async read(files) {
    const texts = await Promise.all([...files].map(async (file) => [file.name, await file.text()]));
    const job = texts.find(([name]) => name.endsWith(".json"));
    if (!job) return this.fail(null, "there is no JSON file among these");
    this.text.value = job[1].replace(/^\ufeff/, "");
    this.clear();
    const sources = new Map(texts.filter((one) => one !== job));
    if (sources.size === 0 || findSyntaxMistake(this.text.value)) return;
    const document = JSON.parse(this.text.value);
    putSources(document, sources);
    this.text.value = JSON.stringify(document, null, 2);
    this.clear();
  }

  clear() {
    this.mistake.textContent = "";
    this.text.removeAttribute("aria-invalid");
    this.number(0);
  }

  // Line numbers, the wrong one marked by a sign.
  number(wrong) {
    const count = this.text.value.split("\n").length;
    this.lines.replaceChildren(...Array.from({ length: count }, (_, i) => (i + 1 === wrong
      ? el("b", { class: "wrong" }, `✗${i + 1}\n`) : `${i + 1}\n`)));
  }

  fail(place, message) {
    if (!place) return void (this.mistake.textContent = message);
    const before = this.text.value.slice(0, place.start).split("\n"), line = before.length;
    this.mistake.textContent = `Line ${line}, column ${before.at(-1).length + 1}: ${message}`;
    this.text.setAttribute("aria-invalid", "true");
    this.number(line);
    this.text.focus();
    this.text.setSelectionRange(place.start, place.end);
    this.text.scrollTop = Math.max(0, (this.text.scrollHeight / this.text.value.split("\n").length) * (line - 6));
  }

  async submit() {
    this.clear();
    const source = this.text.value, syntax = findSyntaxMistake(source), paused = this.paused.firstChild.checked;
    if (syntax) return this.fail({ start: syntax.at, end: syntax.at + 1 }, syntax.message);
    try {
      const { id } = await this.farm.call("job.submit", { document: JSON.parse(source), paused });
      toast(`Job ${id} is submitted.`);
      location.hash = `#/jobs/${id}`;
    } catch (error) {
      const { path, text } = splitMessage(error.message);
      this.fail(findPlace(source, error.message), path ? `${path}: ${text}` : text);
    }
  }
}
