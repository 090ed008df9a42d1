// The connection to the farm: calls, events, and what is known of jobs and workers. It comes back by itself.

const PAGE = 1000, FIRST_PAGE = 100, RETRY_S = [0.5, 1, 2, 4, 8];

export class Farm extends EventTarget {
  constructor() {
    super();
    this.jobs = new Map(); // by id
    this.workers = new Map();
    this.status = null; // of daemon.status
    this.session = null; // {user, scope, expires}
    this.state = "connecting"; // or live, lost, closed (no session)
    this.total = 0; // of jobs, while they are loaded
    this.isLoaded = false;
    this.watched = new Map(); // job id -> listener of its frames' events
    this.pending = new Map();
    this.changed = new Set(); // ids of jobs, since listeners were told
    this.tries = 0;
    this.lastId = 0;
    setInterval(() => this.state === "live" && !document.hidden && this.askStatus(), 5000);
  }

  // Tells listeners at most once between two pictures of the screen.
  note(what) {
    this.changed.add(what);
    if (this.isNoted) return;
    this.isNoted = true;
    requestAnimationFrame(() => {
      const changed = this.changed;
      this.changed = new Set();
      this.isNoted = false;
      this.dispatchEvent(new CustomEvent("change", { detail: changed }));
    });
  }

  setState(state, why = "") {
    this.state = state;
    this.why = why;
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
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`, "marchd");
    socket.onopen = () => this.begin(socket);
    socket.onmessage = (event) => this.hear(JSON.parse(event.data));
    socket.onclose = (event) => this.socket === socket || !this.socket ? this.retry(event.code === 1013 ?
      "the daemon is away" : "the connection broke") : null;
    this.socket = socket;
  }

  retry(why) {
    const wait = RETRY_S[Math.min(this.tries++, RETRY_S.length - 1)];
    for (const { reject } of this.pending.values()) reject(new Error("the connection broke"));
    this.pending.clear();
    this.socket = null;
    this.retryAt = Date.now() + wait * 1000;
    this.setState("lost", why);
    this.timer = setTimeout(() => this.connect(), wait * 1000);
  }

  async begin() {
    try {
      await this.call("events.subscribe", { frames: false });
      await Promise.all([...this.watched.keys()].map((id) => this.call("events.subscribe", { id })));
      await Promise.all([this.askStatus(), this.loadWorkers(), this.loadJobs()]);
    } catch (error) {
      this.socket?.close(); // the next try says why
      this.why = error.message;
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
    if (message.error) asked?.reject(Object.assign(new Error(message.error.message), { code: message.error.code }));
    else asked?.resolve(message.result);
  }

  hearEvent(event) {
    if (event.type === "job") this.putJob(event.job);
    else if (event.type === "worker") this.putWorker(event.worker);
    else if (event.type === "deleted") {
      this.jobs.delete(event.id);
      this.touched?.set(event.id, "deleted");
      this.note(event.id);
    } else this.watched.get(event.id)?.(event);
  }

  putJob(job) {
    this.jobs.set(job.id, job);
    this.touched?.set(job.id, "changed");
    this.note(job.id);
  }

  putWorker(worker) {
    if (worker.state === "stopping" || worker.state === "gone") this.askWorkersSoon();
    this.workers.set(worker.id, worker);
    this.note("workers");
  }

  // A worker that is gone leaves no event that says so for each kind of end: the list is asked again.
  askWorkersSoon() {
    this.workersTimer ??= setTimeout(() => {
      this.workersTimer = null;
      this.loadWorkers().catch(() => {});
    }, 1000);
  }

  async askStatus() {
    this.status = await this.call("daemon.status");
    this.note("status");
  }

  async loadWorkers() {
    const { workers } = await this.call("worker.list");
    this.workers = new Map(workers.map((worker) => [worker.id, worker]));
    this.note("workers");
  }

  // The newest first, page by page, so that the first ones show at once. Jobs of which an event came meanwhile are
  // asked once more: whether the page or the event is the newer one is not known.
  async loadJobs() {
    const seen = new Set();
    this.touched = new Map();
    let cursor;
    do {
      const page = await this.call("job.list", { order: "-id", limit: seen.size ? PAGE : FIRST_PAGE, cursor });
      for (const job of page.jobs) {
        seen.add(job.id);
        if (!this.touched.has(job.id)) this.jobs.set(job.id, job);
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
    for (const id of this.jobs.keys()) if (!seen.has(id) && !this.touched.has(id)) this.jobs.delete(id);
    const touched = [...this.touched.keys()];
    this.touched = null;
    for (let i = 0; i < touched.length; i += PAGE)
      for (const job of (await this.call("job.list", { ids: touched.slice(i, i + PAGE) })).jobs)
        this.jobs.set(job.id, job);
    this.note("jobs");
  }

  // Events of the job's frames go to `listener` until unwatch.
  async watch(id, listener) {
    this.watched.set(id, listener);
    if (this.state === "live") await this.call("events.subscribe", { id });
  }

  unwatch(id) {
    if (!this.watched.delete(id) || this.state !== "live") return;
    this.call("events.unsubscribe", { id }).catch(() => {});
  }
}
