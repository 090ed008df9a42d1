// What can be done with a job, who may, and asking before what cannot be undone.
import { el, button, checkbox, hint, toast, doneOf, isOver, count } from "./dom.js";

// Opens the action's dialog about the job; resolves to its form's fields, or to null where it is closed without them.
function ask({ title, form, confirm, kind = "main" }, job) {
  return new Promise((resolve) => {
    const fields = el("form", { method: "dialog" }, el("h1", { id: "asked" }, `${title} job ${job.id}, ${job.name}`),
      form(job), el("div", { class: "buttons" }, button("Leave it", () => dialog.close()),
        el("button", { class: kind, value: "yes" }, confirm)));
    const dialog = el("dialog", { "aria-labelledby": "asked", onclose: () => {
      resolve(dialog.returnValue === "yes" ? new FormData(fields) : null);
      dialog.remove();
    } }, fields);
    document.body.append(dialog);
    dialog.showModal();
  });
}

function retryForm(job) {
  const states = ["failed", "canceled", "succeeded", "skipped"], chosen = states.find((state) => job[state]);
  return [el("fieldset", null, el("legend", null, "Frames that are"), states.map((state) =>
    checkbox(`${state} (${count(job[state])})`, { name: "state", value: state, checked: state === chosen }))),
  el("label", null, "Only of this range (all: empty) ", el("input", { name: "range", placeholder: "1-100x2,140" })),
  checkbox("render also what is there and whole", { name: "force" })];
}

const priorityForm = (job) => el("label", null, "0 to 100, of administrators to 200 ",
  el("input", { name: "priority", type: "number", min: "0", max: "200", required: true, value: `${job.priority}` }));

const cancelForm = (job) => el("p", null, `${count(job.queued + job.running)} frames are not rendered; `
  + "what runs is stopped and lost. They can be retried later.");

const deleteForm = (job) => [
  el("p", null, "The farm forgets the job, its frames and their logs. This cannot be undone."),
  checkbox(`also remove the files that it wrote (${count(job.succeeded)} frames)`, { name: "files" })];

// In the order of their buttons. Those with a form ask before; `read` makes its fields the method's parameters, `said`
// tells of the method's result what was done.
const actions = [
  { name: "pause", key: "p", label: "Pause", may: (job) => ["queued", "running"].includes(job.state),
    said: () => "is paused" },
  { name: "resume", key: "p", label: "Resume", may: (job) => job.state === "paused", said: () => "goes on" },
  { name: "cancel", key: "c", label: "Cancel…", kind: "danger", may: (job) => !isOver(job),
    title: "Cancel", form: cancelForm, confirm: "Cancel the job", said: () => "is canceled" },
  { name: "retry", key: "r", label: "Retry…", may: (job) => job.failed + job.canceled + doneOf(job) > 0,
    title: "Retry frames of", form: retryForm, confirm: "Retry", read: (fields) => ({ state: fields.getAll("state"),
      range: fields.get("range").trim() || undefined, force: fields.has("force") }),
    said: ({ retried }) => `${count(retried)} frames are tried again` },
  { name: "priority", key: "+", label: "Priority…", may: (job) => !isOver(job),
    title: "Priority of", form: priorityForm, confirm: "Set", said: () => "has another priority",
    read: (fields) => ({ priority: Number(fields.get("priority")) }) },
  { name: "delete", key: "Delete", label: "Delete…", kind: "danger", may: isOver,
    title: "Delete", form: deleteForm, confirm: "Delete", read: (fields) => ({ files: fields.has("files") }),
    said: (result) => `deleted; ${count(result.files_removed)} files removed, ${count(result.files_kept)} kept` },
];

async function act(farm, action, job) {
  const begin = `Job ${job.id}, ${job.name}:`;
  try {
    const fields = action.form && await ask(action, job);
    if (fields === null) return;
    const result = await farm.call(`job.${action.name}`, { id: job.id, ...action.read?.(fields) });
    toast(`${begin} ${action.said(result)}.`);
  } catch (error) {
    toast(`${begin} ${error.message}`, true);
  }
}

const mayChange = (farm) => farm.session?.scope !== "read";

// Whether the key is one of an action that the job allows; begins it.
export function keyAction(farm, job, key) {
  const action = job && mayChange(farm) && actions.find((known) => known.key === key && known.may(job));
  if (action) act(farm, action, job);
  return Boolean(action);
}

// Buttons for what the job allows; `refresh(job)` shows them as the job is now.
export function actionButtons(farm) {
  let job;
  const buttons = actions.map((action) =>
    button(action.label, () => act(farm, action, job), { class: action.kind, title: `Key: ${action.key}` }));
  const row = el("div", { class: "tools actions", role: "group", "aria-label": "What can be done with this job" },
    buttons, mayChange(farm) ? null : hint("This session may only read."));
  row.refresh = (now) => {
    job = now;
    buttons.forEach((each, i) => (each.hidden = !mayChange(farm) || !actions[i].may(job)));
  };
  return row;
}
