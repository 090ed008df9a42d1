// The page: which view is shown, the keys that work everywhere, the connection's state, light and dark.
import { Farm } from "./farm.js";
import { JobsView } from "./jobs.js";
import { el, find, say } from "./dom.js";

const farm = new Farm();
let view, shownHash;

// A view that is not asked for is not loaded.
const routes = [
  [/^#\/jobs$/, () => new JobsView(farm)],
  [/^#\/jobs\/(\d+)(?:\/(frames|flipbook|plots|plan|document))?$/, async (id, tab) =>
    new (await import("./job.js")).JobView(farm, Number(id), tab)],
  [/^#\/jobs\/(\d+)\/frames\/(-?\d+)$/, async (id, frame) => new (await import("./frame.js")).FrameView(farm,
    Number(id), Number(frame))],
  [/^#\/workers$/, async () => new (await import("./workers.js")).WorkersView(farm)],
  [/^#\/submit$/, async () => new (await import("./submit.js")).SubmitView(farm)],
  [/^#\/help$/, async () => new (await import("./help.js")).HelpView()],
];

async function route() {
  const hash = location.hash || "#/jobs";
  const found = routes.map(([pattern, make]) => [pattern.exec(hash), make]).find(([match]) => match);
  if (!found) return location.replace("#/jobs");
  if (view?.follow?.(hash)) return finishRoute(hash);
  const [match, make] = found;
  const next = await make(...match.slice(1));
  if ((location.hash || "#/jobs") !== hash) return;
  view?.hide();
  view = next;
  find("#main").replaceChildren(view.root);
  view.show();
  finishRoute(hash);
}

function finishRoute(hash) {
  document.title = `${view.title} · marchd`;
  for (const link of document.querySelectorAll("nav a"))
    if (hash.startsWith(link.getAttribute("href"))) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  if (shownHash !== undefined) (say(view.title), view.focus?.());
  shownHash = hash;
}

function showLink() {
  const place = find("#link"), words = { connecting: "connecting", live: "live", closed: "no session" };
  clearInterval(showLink.timer);
  document.body.dataset.link = farm.state;
  if (farm.state === "lost") {
    const text = el("span", null), left = () => Math.max(0, Math.ceil((farm.retryAt - Date.now()) / 1000));
    const tell = () => (text.textContent = `✗ not live: ${farm.why}; again in ${left()} s`);
    showLink.timer = setInterval(tell, 1000);
    tell();
    place.replaceChildren(text, " ", el("button", { type: "button", onclick: () => farm.connect() }, "Now"));
  } else place.replaceChildren(el("span", { class: "sign", "aria-hidden": "true" },
    farm.state === "live" ? "● " : "○ "), words[farm.state]);
  showUser();
  if (farm.state === "closed") {
    view?.hide();
    view = { root: el("section", { class: "text" }, el("h1", null, "No session"),
      el("p", null, "Type ", el("code", null, "march web"),
        " in a terminal: it opens this page with a session of yours.")), hide() {}, title: "No session" };
    find("#main").replaceChildren(view.root);
  }
}

function showUser() {
  const { session } = farm;
  find("#user").replaceChildren(...(session && farm.state !== "closed" ? [`${session.user} (${session.scope}) `,
    el("button", { type: "button", onclick: leave }, "Log out")] : []));
}

const leave = () => fetch("/logout", { method: "POST" }).finally(() => location.reload());

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

function setTheme(theme) {
  const root = document.documentElement, button = find("#theme");
  const isDark = theme ? theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  if (theme) root.dataset.theme = theme;
  button.textContent = isDark ? "☀" : "☾";
  button.setAttribute("aria-label", isDark ? "Light colours" : "Dark colours");
  button.onclick = () => {
    localStorage.setItem("theme", isDark ? "light" : "dark");
    setTheme(isDark ? "light" : "dark");
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
  if (view?.onKey?.(event)) return event.preventDefault();
  if (event.key in places) location.hash = places[event.key];
  else if (event.key === "/" && find("#search")) find("#search").focus();
  else if (event.key === "t") find("#theme").click();
  else if (event.key === "Escape") location.hash = location.hash.replace(/\/(frames\/)?[^/]*$/, "") || "#/jobs";
  else return;
  event.preventDefault();
});

addEventListener("hashchange", route);
addEventListener("unhandledrejection", (event) => console.error(event.reason));
farm.addEventListener("state", showLink);
farm.addEventListener("change", ({ detail }) => detail.has("status") && showBanner());
setTheme(localStorage.getItem("theme"));
showLink();
route();
farm.connect();
window.marchdPage = { farm }; // for a look from the browser's console
