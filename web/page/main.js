// The page: which view is shown, the keys that work everywhere, the connection's state, light and dark.
import { Farm } from "./farm.js";
import { JobsView } from "./jobs.js";
import { find, markCurrent, say } from "./dom.js";

const farm = new Farm();
let view, shownHash;

// A view that is not asked for is not loaded.
const routes = [
  [/^#\/jobs$/, () => JobsView],
  [/^#\/jobs\/(?<id>\d+)(?:\/(?<tab>flipbook|plots|plan|document))?$/, async () => (await import("./job.js")).JobView],
  [/^#\/jobs\/(?<id>\d+)\/frames\/(?<frame>-?\d+)$/, async () => (await import("./frame.js")).FrameView],
  [/^#\/workers$/, async () => (await import("./workers.js")).WorkersView],
  [/^#\/submit$/, async () => (await import("./submit.js")).SubmitView],
  [/^#\/help$/, async () => (await import("./help.js")).HelpView],
];

async function route() {
  const hash = location.hash || "#/jobs";
  const [pattern, load] = routes.find(([each]) => each.test(hash)) ?? [];
  if (!pattern) return location.replace("#/jobs");
  if (view?.follow?.(hash)) return finishRoute(hash);
  const Next = await load(), { id, frame, tab } = pattern.exec(hash).groups ?? {};
  if ((location.hash || "#/jobs") !== hash) return;
  view?.hide();
  view = new Next({ farm, id: Number(id), frame: Number(frame), tab });
  find("#main").replaceChildren(view.root);
  view.show();
  finishRoute(hash);
}

function finishRoute(hash) {
  document.title = `${view.title} · marchd`;
  markCurrent(find("header nav"), (href) => hash.startsWith(href));
  if (shownHash !== undefined) say(view.title);
  if (shownHash !== undefined) view.focus?.();
  shownHash = hash;
}

function showLink() {
  const { state, session } = farm, isClosed = state === "closed", place = find("#link");
  const text = { live: "● live", lost: `✗ not live: ${farm.why}`, connecting: "○ connecting" }[state] ?? "no session";
  document.body.dataset.link = state;
  if (place.textContent !== text) place.textContent = text;
  find("#now").hidden = state !== "lost";
  find("#user").textContent = session && !isClosed ? `${session.user} (${session.scope})` : "";
  find("#leave").hidden = !session || isClosed;
  find("#main").hidden = isClosed;
  find("#closed").hidden = !isClosed;
}

// What the whole farm waits for.
function showBanner() {
  const { status } = farm, lines = [];
  if (status?.drain) lines.push(`${status.drain.user} has drained the farm: no frame begins.`);
  if (status && status.store.state !== "ok") lines.push(`The queue's disk: ${status.store.reason}`);
  for (const root of status?.roots ?? [])
    if (!root.is_there) lines.push(`The output root ${root.path} is away: ${root.reason}`);
  const text = lines.join(" "), banner = find("#banner");
  if (banner.textContent !== text) banner.textContent = text;
  banner.hidden = !text;
}

function setTheme(isDark) {
  document.documentElement.style.colorScheme = isDark ? "dark" : "light";
  find("#theme").textContent = isDark ? "☀" : "☾";
  find("#theme").setAttribute("aria-label", isDark ? "Light colours" : "Dark colours");
  find("#theme").onclick = () => {
    localStorage.setItem("theme", isDark ? "light" : "dark");
    setTheme(!isDark);
    view?.onTheme?.();
  };
}

const places = { 1: "#/jobs", 2: "#/workers", 3: "#/submit", "?": "#/help" };

addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || find("dialog[open]")) return;
  if (event.target.matches("input, textarea, select")) {
    if (event.key === "Escape") (view?.focus?.(), event.preventDefault());
    return;
  }
  if (event.key === "Enter" && event.target.matches("a, button")) return;
  if (view?.onKey?.(event)) return event.preventDefault();
  if (event.key in places) location.hash = places[event.key];
  else if (event.key === "/" && find("#search")) find("#search").focus();
  else if (event.key === "t") find("#theme").click();
  else if (event.key === "Escape") location.hash = location.hash.replace(/\/(frames\/)?[^/]*$/, "") || "#/jobs";
  else return;
  event.preventDefault();
});

addEventListener("hashchange", route);
farm.addEventListener("state", showLink);
farm.addEventListener("change", ({ detail }) => detail.has("status") && showBanner());
find("#now").onclick = () => farm.connect();
find("#leave").onclick = () => fetch("/logout", { method: "POST" }).finally(() => location.reload());
setTheme((localStorage.getItem("theme") ?? (matchMedia("(prefers-color-scheme: dark)").matches && "dark")) === "dark");
showLink();
route();
farm.connect();
setInterval(() => farm.state === "live" && !document.hidden && farm.askStatus(), 5000);
window.marchdPage = { farm }; // for a look from the browser's console
