// What can be done with a job, who may, and asking before what cannot be undone.
import { el, toast, isOver, count } from "./dom.js";
import { parseRange } from "./ranges.js";

// Opens a dialog; resolves to its form's fields, or to null where it is closed without them.
export function ask(title, children, confirm, isDangerous = false) {
  return new Promise((resolve) => {
    const form = el("form", { method: "dialog" }, el("h2", { id: "asked" }, title), children,
      el("div", { class: "buttons" },
        el("button", { type: "button", onclick: () => dialog.close() }, "Leave it"),
        el("button", { class: isDangerous ? "danger" : "main", value: "yes" }, confirm)));
    const dialog = el("dialog", { "aria-labelledby": "asked" }, form);
    dialog.addEventListener("close", () => {
      resolve(dialog.returnValue === "yes" ? new FormData(form) : null);
      dialog.remove();
    });
    document.body.append(dialog);
    dialog.showModal();
  });
}

async function askRetry(job) {
  const chosen = job.failed ? "failed" : job.canceled ? "canceled" : "succeeded";
  const boxes = ["failed", "canceled", "succeeded", "skipped"].map((state) => el("label", null,
    el("input", { type: "checkbox", name: "state", value: state, checked: state === chosen }),
    ` ${state} (${count(job[state])})`));
  const fields = await ask(`Retry frames of job ${job.id}, ${job.name}`, [
    el("fieldset", null, el("legend", null, "Frames that are"), boxes),
    el("label", null, "Only of this range (all: empty) ", el("input", { name: "range", placeholder: "1-100x2,140" })),
    el("label", null, el("input", { type: "checkbox", name: "force" }), " render also what is there and whole"),
  ], "Retry");
  if (!fields) return null;
  const range = fields.get("range").trim();
  if (range) parseRange(range);
  return { state: fields.getAll("state"), range: range || undefined, force: fields.has("force") };
}

async function askPriority(job) {
  const value = `${job.priority}`, label = el("label", null, "0 to 100, of administrators to 200 ",
    el("input", { name: "priority", type: "number", min: "0", max: "200", required: true, value }));
  const fields = await ask(`Priority of job ${job.id}, ${job.name}`, label, "Set");
  return fields && { priority: Number(fields.get("priority")) };
}

async function askDelete(job) {
  const fields = await ask(`Delete job ${job.id}, ${job.name}?`, [
    el("p", null, "The farm forgets the job, its frames and their logs. This cannot be undone."),
    el("label", null, el("input", { type: "checkbox", name: "files" }),
      ` also remove the files that it wrote (${count(job.succeeded)} frames)`),
  ], "Delete", true);
  return fields && { files: fields.has("files") };
}

async function askCancel(job) {
  const left = job.queued + job.running;
  return await ask(`Cancel job ${job.id}, ${job.name}?`,
    el("p", null, `${count(left)} frames are not rendered; what runs is stopped and lost. They can be retried later.`),
      "Cancel the job", true) && {};
}

export const actions = [
  { name: "pause", key: "p", label: "Pause", may: (job) => ["queued", "running"].includes(job.state),
    said: "is paused" },
  { name: "resume", key: "p", label: "Resume", may: (job) => job.state === "paused", said: "goes on" },
  { name: "cancel", key: "c", label: "Cancel…", may: (job) => !isOver(job), ask: askCancel, said: "is canceled" },
  { name: "retry", key: "r", label: "Retry…", may: (job) => job.failed + job.canceled + job.succeeded + job.skipped > 0,
    ask: askRetry, said: (result) => `${count(result.retried)} frames are tried again` },
  { name: "priority", key: "+", label: "Priority…", may: (job) => !isOver(job), ask: askPriority,
    said: "has another priority" },
  { name: "delete", key: "Delete", label: "Delete…", may: isOver, ask: askDelete,
    said: (result) => `deleted; ${count(result.files_removed)} files removed, ${count(result.files_kept)} kept` },
];

export async function act(farm, action, job) {
  try {
    const params = action.ask ? await action.ask(job) : {};
    if (!params) return;
    const result = await farm.call(`job.${action.name}`, { id: job.id, ...params });
    toast(`Job ${job.id}, ${job.name}: ${typeof action.said === "string" ? action.said : action.said(result)}.`);
  } catch (error) {
    toast(`Job ${job.id}, ${job.name}: ${error.message}`, true);
  }
}

export const mayChange = (farm) => farm.session?.scope !== "read";

// Whether the key is one of an action that the job allows; begins it.
export function keyAction(farm, job, key) {
  const action = job && mayChange(farm) && actions.find((known) => known.key === key && known.may(job));
  if (action) act(farm, action, job);
  return Boolean(action);
}

// Buttons for what the job allows; `refresh(job)` shows them as the job is now.
export function actionButtons(farm) {
  let job;
  const buttons = actions.map((action) => el("button", { type: "button", class: action.name === "delete"
    || action.name === "cancel" ? "danger" : "",
    title: `Key: ${action.key}`, onclick: () => act(farm, action, job) }, action.label));
  const row = el("div", { class: "actions", role: "group", "aria-label": "What can be done with this job" }, buttons,
    mayChange(farm) ? null : el("p", { class: "hint" }, "This session may only read."));
  row.refresh = (now) => {
    job = now;
    buttons.forEach((button, i) => (button.hidden = !mayChange(farm) || !actions[i].may(job)));
  };
  return row;
}
