// The connection to the farm: calls, events, and what is known of jobs and workers. It comes back by itself.
import { once } from "./dom.js";

const PAGE = 1000, FIRST_PAGE = 100, WORKERS_S = 1, LEAST_RETRY_S = 0.2, MOST_RETRY_S = 15;

export class Farm extends EventTarget {
  jobs = new Map(); // by id
  workers = new Map();
  status = null; // of daemon.status
  session = null; // {user, scope, expires}
  state = "connecting"; // or live, lost, closed (no session)
  total = 0; // of jobs, while they are loaded
  isLoaded = false;
  fresh = new Set(); // ids of jobs that were told of since loading began
  watched = new Map(); // job id -> listener of its frames' events
  pending = new Map();
  changed = new Set(); // ids of jobs, since listeners were told
  tries = 0;
  lastId = 0;

  tell = once(() => {
    const detail = this.changed;
    this.changed = new Set();
    this.dispatchEvent(new CustomEvent("change", { detail }));
  });

  note(what) {
    this.changed.add(what);
    this.tell();
  }

  setState(state, why = "") {
    Object.assign(this, { state, why });
    this.dispatchEvent(new Event("state"));
  }

  async connect() {
    clearTimeout(this.timer);
    try {
      const answer = await fetch("/session", { cache: "no-store" });
      if (answer.status === 401) return this.setState("closed");
      if (!answer.ok) throw new Error(answer.status === 503 ? "the daemon is away" : `an answer of ${answer.status}`);
      this.session = await answer.json();
    } catch (error) {
      return this.retry(error.message);
    }
    const socket = new WebSocket("/ws", "marchd");
    socket.onopen = () => this.begin(socket);
    socket.onmessage = (event) => this.hear(JSON.parse(event.data));
    socket.onclose = ({ code }) => (!this.socket || this.socket === socket)
      && this.retry(code === 1013 ? "the daemon is away" : "the connection broke");
    this.socket = socket;
  }

  // The wait doubles, and is drawn anew each time: pages that lost the farm together do not come back together.
  retry(why) {
    const longest = Math.min(MOST_RETRY_S, 2 ** this.tries++), wait = LEAST_RETRY_S + Math.random() * longest;
    for (const { reject } of this.pending.values()) reject(new Error("the connection broke"));
    this.pending.clear();
    this.socket = null;
    this.retryAt = Date.now() + wait * 1000;
    this.setState("lost", why);
    this.timer = setTimeout(() => this.connect(), wait * 1000);
  }

  async begin(socket) {
    try {
      await this.call("events.subscribe", { frames: false });
      await Promise.all([...this.watched.keys()].map((id) => this.call("events.subscribe", { id })));
      await Promise.all([this.askStatus(), this.loadWorkers(), this.loadJobs()]);
    } catch {
      socket.close(); // the next try says why
    }
  }

  call(method, params = {}) {
    return new Promise((resolve, reject) => {
      if (this.socket?.readyState !== WebSocket.OPEN) return reject(new Error("there is no connection to the farm"));
      this.pending.set(++this.lastId, { resolve, reject });
      this.socket.send(JSON.stringify({ jsonrpc: "2.0", id: this.lastId, method, params }));
    });
  }

  hear(message) {
    if (message.method === "event") return this.hearEvent(message.params);
    const asked = this.pending.get(message.id);
    this.pending.delete(message.id);
    if (message.error) asked?.reject(new Error(message.error.message));
    else asked?.resolve(message.result);
  }

  hearEvent(event) {
    const { type, job, worker, id = job?.id } = event;
    if (worker) {
      if (worker.state === "stopping" || worker.state === "gone") this.askWorkersSoon();
      this.workers.set(worker.id, worker);
      return this.note("workers");
    }
    if (type !== "job" && type !== "deleted") return this.watched.get(id)?.(event);
    if (job) this.jobs.set(id, job);
    else this.jobs.delete(id);
    this.fresh.add(id);
    this.note(id);
  }

  // A worker that is gone leaves no event that says so for each kind of end: the list is asked again.
  askWorkersSoon = once(() => this.loadWorkers().catch(() => {}), (act) => setTimeout(act, WORKERS_S * 1000));

  async askStatus() {
    this.status = await this.call("daemon.status");
    this.note("status");
  }

  async loadWorkers() {
    const { workers } = await this.call("worker.list");
    this.workers = new Map(workers.map((worker) => [worker.id, worker]));
    this.note("workers");
  }

  // The newest first, page by page, so that the first ones show at once. What an event says of a job is kept: if the
  // page is newer, another event comes.
  async loadJobs() {
    let cursor;
    this.fresh.clear();
    do {
      const page = await this.call("job.list", { order: "-id", limit: cursor ? PAGE : FIRST_PAGE, cursor });
      for (const job of page.jobs) {
        if (!this.fresh.has(job.id)) this.jobs.set(job.id, job);
        this.fresh.add(job.id);
      }
      cursor = page.next ?? undefined;
      this.total = page.total;
      this.isLoaded = !cursor;
      if (this.state !== "live") {
        this.tries = 0;
        this.setState("live");
      }
      this.note("jobs");
    } while (cursor);
    for (const id of this.jobs.keys()) if (!this.fresh.has(id)) this.jobs.delete(id);
    this.note("jobs");
  }

  // Events of the job's frames go to `listener` until unwatch.
  async watch(id, listener) {
    this.watched.set(id, listener);
    if (this.state === "live") await this.call("events.subscribe", { id });
  }

  unwatch(id) {
    if (this.watched.delete(id) && this.state === "live") this.call("events.unsubscribe", { id }).catch(() => {});
  }
}
