// Submits a job: a dropped or typed JSON document, whose mistakes are shown at their place in the text.
import { View, el, toast } from "./dom.js";
import { findSyntaxMistake, findPlace, splitMessage, lineOf } from "./place.js";

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

  constructor(farm) {
    super();
    this.farm = farm;
    this.text = el("textarea", { id: "document", spellcheck: false, rows: 24, value: kept.text,
      "aria-label": "The job's document",
      "aria-describedby": "mistake", placeholder: "Drop a job file here, with its GLSL files, or type its JSON.",
        oninput: () => this.clear() });
    this.lines = el("pre", { class: "lines", "aria-hidden": "true" });
    this.text.addEventListener("scroll", () => (this.lines.scrollTop = this.text.scrollTop));
    this.mistake = el("p", { id: "mistake", class: "wrong", role: "alert" });
    this.paused = el("input", { type: "checkbox" });
    const file = el("input", { type: "file", multiple: true, accept: ".json,.glsl",
      "aria-label": "Job file, and its GLSL files", onchange: () => this.read(file.files) });
    this.root = el("section", { class: "submit", "aria-label": "Submit a job", ondrop: (event) => this.onDrop(event),
      ondragover: (event) => this.onDrag(event, true), ondragleave: (event) => this.onDrag(event, false) },
      el("h1", null, "Submit a job"), el("div", { class: "tools" }, file, el("label", null, this.paused, " paused"),
        el("button", { class: "main", title: "Key: Ctrl and Enter", onclick: () => this.submit() }, "Submit")),
      this.mistake, el("div", { class: "editor" }, this.lines, this.text));
    this.text.addEventListener("keydown", (event) => event.ctrlKey && event.key === "Enter" && this.submit());
  }

  show() { this.clear(); }

  hide() {
    kept.text = this.text.value;
    super.hide();
  }

  focus() { this.text.focus(); }

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
    const { line, column } = lineOf(this.text.value, place.start);
    this.mistake.textContent = `Line ${line}, column ${column}: ${message}`;
    this.text.setAttribute("aria-invalid", "true");
    this.number(line);
    this.text.focus();
    this.text.setSelectionRange(place.start, place.end);
    this.text.scrollTop = Math.max(0, (this.text.scrollHeight / this.text.value.split("\n").length) * (line - 6));
  }

  async submit() {
    this.clear();
    const source = this.text.value, syntax = findSyntaxMistake(source);
    if (syntax) return this.fail({ start: syntax.at, end: syntax.at + 1 }, syntax.message);
    try {
      const { id } = await this.farm.call("job.submit", { document: JSON.parse(source), paused: this.paused.checked });
      toast(`Job ${id} is submitted.`);
      location.hash = `#/jobs/${id}`;
    } catch (error) {
      const { path, text } = splitMessage(error.message);
      this.fail(findPlace(source, error.message), path ? `${path}: ${text}` : text);
    }
  }
}
