// The interface of the coordinator, /api/v1 (openapi.json describes it).

export const me = {name: "", role: "", member: "", proof: "", may: {}};

export class ApiError extends Error {
  constructor(status, reason) {
    super(reason);
    this.status = status;
  }
}

async function call(path, options = {}) {
  const response = await fetch(`/api/v1/${path}`, {credentials: "same-origin", ...options});
  if (response.ok) return response.json();
  if (response.status === 401) location.assign("/login");
  const body = await response.json().catch(() => ({}));
  throw new ApiError(response.status, body.error || `the coordinator answered with ${response.status}`);
}

export function get(path, parameters = {}) {
  const query = new URLSearchParams();
  for (const [name, value] of Object.entries(parameters)) {
    if (value !== "" && value !== null && value !== undefined) query.set(name, value);
  }
  const text = query.toString();
  return call(text ? `${path}?${text}` : path);
}

export function post(path, body) {
  return call(path, {
    method: "POST",
    headers: {"Content-Type": "application/json", "X-Tessera-Proof": me.proof},
    body: JSON.stringify(body || {}),
  });
}

export async function loadMe() {
  Object.assign(me, await get("me"));
}

export function mayControl(job) {
  const reach = me.may["Jobs.Pause"];
  return reach === "all" || (reach === "own" && me.member !== "" && me.member === job.owner_member);
}

export function maySeePicture(job) {
  const reach = me.may["Jobs.FetchPicture"];
  return reach === "all" || (reach === "own" && me.member !== "" && me.member === job.owner_member);
}

// Events of the farm, and of a job, while the page is visible. Reconnects by itself.
export class Events {
  constructor(onEvent, onConnected) {
    this.onEvent = onEvent;
    this.onConnected = onConnected;
    this.job = null;
    this.source = null;
    this.timer = 0;
    document.addEventListener("visibilitychange", () => this.open());
    addEventListener("pagehide", () => this.close());
    this.open();
  }

  watchJob(job) {
    if (job === this.job && this.source) return;
    this.job = job;
    this.open();
  }

  close() {
    clearTimeout(this.timer);
    if (this.source) this.source.close();
    this.source = null;
  }

  open() {
    this.close();
    if (document.hidden) return;
    const source = new EventSource(this.job === null ? "/api/v1/events" : `/api/v1/events?job=${this.job}`);
    this.source = source;
    source.onopen = () => this.onConnected(true);
    for (const name of ["farm", "job"])
      source.addEventListener(name, (event) => this.onEvent(name, JSON.parse(event.data)));
    source.onerror = () => {
      this.onConnected(false);
      // A browser gives up after an answer that is not a stream: the session may have ended.
      if (source.readyState === EventSource.CLOSED) {
        loadMe().catch(() => {});
        this.timer = setTimeout(() => this.open(), 3000);
      }
    };
  }
}
