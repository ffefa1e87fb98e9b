// All workers: load and samples/s over the last hour beside the farm's median, failures, and a matrix for thousands.

import {get, me, post} from "./api.js";
import {bytes, count, duration, h, percent, setClass, setText} from "./dom.js";
import {median, sparkline} from "./chart.js";
import {sortButtons, Throttle, VirtualList} from "./list.js";

const kColumns = [["name", "Worker", "w-name"], ["state", "State", "w-state"], ["use", "Load", "w-use"],
  ["memory", "Memory", "w-memory"], ["rate", "Samples/s, last hour", "w-rate"], ["failed", "Units", "w-units"], ["silent", "Seen", "w-seen"], [null, "", "w-act"]];
const kStates = ["rendering", "idle", "loading", "fetching", "draining", "quarantined"];
const kFilterInterval_ms = 60;  // between requests while someone types
const kCell = 14, kGap = 2;

export class WorkersView {
  constructor(note) {
    this.title = "Workers";
    this.note = note;
    this.filter = {search: "", state: ""};
    this.sort = {key: "name", order: "asc"};
    this.median = null;
    this.search = h("input", {type: "search", placeholder: "Search name, tag or id  ( / )", "aria-label": "Search workers",
      oninput: () => this.filtering.request()});
    this.state = h("select", {"aria-label": "State", onchange: () => this.filtering.request()}, h("option", {value: ""}, "All"),
      ...kStates.map((value) => h("option", {value}, value)));
    this.filtering = new Throttle(kFilterInterval_ms, () => this.applyFilter());
    this.found = h("span", {class: "soft", role: "status"});
    this.matrix = h("canvas", {class: "matrix", role: "img", "aria-label":
      "All workers by load; the list below has the same", onpointermove: (event) => this.point(event),
      onclick: (event) => this.pick(event)});
    this.tip = h("p", {class: "soft tip"}, "Each cell is a worker: the brighter, the busier.");
    this.heads = sortButtons(kColumns, this.sort, (key) => this.sortBy(key));
    this.list = new VirtualList({
      label: "Workers",
      empty: "No workers are connected. Start one: tessera-worker",
      load: (offset, limit) => this.load(offset, limit),
      onTotal: (total) => setText(this.found, `${total} ${total === 1 ? "worker" : "workers"}`),
      makeRow: () => makeRow(this),
    });
    this.element = h("section", {class: "workers"}, h("h1", {class: "hidden"}, "Workers"),
      h("div", {class: "tools"}, this.search, this.state, this.found), this.matrix, this.tip,
      h("div", {class: "row heads worker"}, ...this.heads.buttons), this.list.element);
  }

  start() {
    this.list.refresh(true).catch((error) => this.note(error.message, true));
    this.loadMatrix();
  }
  close() { this.isClosed = true; this.list.close(); this.filtering.cancel(); clearTimeout(this.matrixTimer); }

  applyFilter() {
    this.filter = {search: this.search.value.trim(), state: this.state.value};
    this.list.refresh(true).catch(() => {});
  }

  sortBy(key) {
    this.sort.order = this.sort.key === key && this.sort.order === "asc" ? "desc" : "asc";
    this.sort.key = key;
    this.heads.show();
    this.list.refresh(true).catch(() => {});
  }

  async load(offset, limit) {
    const page = await get("workers", {...this.filter, sort: this.sort.key, order: this.sort.order, offset, limit, history: 1});
    return {total: page.total, rows: page.workers};
  }

  onEvent(name) {
    if (name === "farm") this.list.refresh().catch(() => {});
  }

  // All workers, in pages, every few seconds.
  async loadMatrix() {
    clearTimeout(this.matrixTimer);
    const workers = [];
    try {
      for (let total = 1; workers.length < total && workers.length < 10000;) {
        const page = await get("workers", {sort: "name", offset: workers.length, limit: 1000});
        total = page.total;
        if (page.workers.length === 0) break;
        workers.push(...page.workers);
      }
      if (this.isClosed) return;
      this.all = workers;
      this.median = median(workers.map((worker) => worker.samples_per_second));
      this.drawMatrix();
    } catch (error) { /* the list shows why */ }
    if (!this.isClosed) this.matrixTimer = setTimeout(() => this.loadMatrix(), 5000);
  }

  columns() { return Math.max(1, Math.floor((this.matrix.parentElement.clientWidth + kGap) / (kCell + kGap))); }

  drawMatrix() {
    const columns = this.columns(), rows = Math.ceil(this.all.length / columns);
    const isShown = this.all.length > 12;
    this.matrix.hidden = this.tip.hidden = !isShown;
    if (!isShown) return;
    const ratio = devicePixelRatio || 1;
    const width = columns * (kCell + kGap), height = rows * (kCell + kGap);
    Object.assign(this.matrix, {width: width * ratio, height: height * ratio});
    Object.assign(this.matrix.style, {width: `${width}px`, height: `${height}px`});
    const context = this.matrix.getContext("2d");
    context.scale(ratio, ratio);
    const style = getComputedStyle(this.matrix);
    const color = (name) => style.getPropertyValue(name).trim();
    const colors = {rendering: color("--bar"), idle: color("--soft"), loading: color("--warn"), fetching: color("--warn"),
      draining: color("--warn"), quarantined: color("--bad")};
    this.all.forEach((worker, i) => {
      const x = (i % columns) * (kCell + kGap), y = Math.floor(i / columns) * (kCell + kGap);
      context.globalAlpha = 0.25 + 0.75 * (worker.state === "quarantined" ? 1 : worker.use);
      context.fillStyle = colors[worker.state];
      context.fillRect(x, y, kCell, kCell);
      if (worker.units_failed === 0 || worker.state === "quarantined") return;
      context.globalAlpha = 1;
      context.fillStyle = colors.quarantined;
      context.fillRect(x + kCell - 5, y, 5, 5);
    });
  }

  workerAt(event) {
    if (!this.all) return null;
    const column = Math.floor(event.offsetX / (kCell + kGap)), row = Math.floor(event.offsetY / (kCell + kGap));
    return this.all[row * this.columns() + column] || null;
  }

  point(event) {
    const worker = this.workerAt(event);
    if (worker) setText(this.tip, `${worker.name}: ${worker.state}, ${percent(worker.use)} busy, ${count(worker.samples_per_second)} samples/s, ${worker.units_failed} failed`);
  }

  pick(event) {
    const worker = this.workerAt(event);
    if (!worker) return;
    this.search.value = worker.name;
    this.filtering.request();
  }

  async change(worker, what) {
    try {
      await post(`workers/${worker.id}/${what}`);
      this.note(`${worker.name}: ${what === "drain" ? "gets no more work" : "released"}`);
      this.list.refresh().catch(() => {});
    } catch (error) {
      this.note(error.message, true);
    }
  }
}

function makeRow(view) {
  const name = h("b"), details = h("small", {class: "soft"});
  const state = h("span", {class: "state"}), reason = h("small", {class: "reason"});
  const use = h("span", {class: "figure"}), useLine = sparkline();
  const memory = h("span", {class: "figure"}), scenes = h("small", {class: "scenes"});
  const rate = h("span", {class: "figure"}), rateLine = sparkline();
  const units = h("span"), failed = h("b", {class: "bad"});
  const failure = h("small", {class: "bad failure"});
  const seen = h("span", {class: "w-seen"});
  let worker = null;
  const act = h("button", {type: "button", class: "quiet", onclick: () =>
    view.change(worker, worker.draining || worker.quarantined ? "release" : "drain")});
  act.hidden = me.may["Jobs.DrainWorkers"] !== "all";
  const element = h("div", {class: "row worker"}, h("span", {class: "w-name"}, name, details),
    h("span", {class: "w-state"}, state, reason), h("span", {class: "w-use"}, useLine.element, use), h("span", {class: "w-memory"}, memory, scenes),
    h("span", {class: "w-rate"}, rateLine.element, rate), h("span", {class: "w-units"}, units, failed, failure), seen,
    h("span", {class: "w-act"}, act));
  const show = (data) => {
    worker = data;
    setText(name, data.name);
    name.title = data.id;
    setText(details, [`${data.slots} ${data.slots === 1 ? "slot" : "slots"}`, data.version, ...data.tags].join(" · "));
    setText(state, data.state);
    setClass(state, `state ${data.state}`);
    setText(reason, data.reason);
    reason.title = data.reason;
    setText(use, percent(data.use));
    useLine.show([...data.history.map((point) => point[1]), data.use], `${data.name}: load ${percent(data.use)}`);
    setText(rate, `${count(data.samples_per_second)}/s`);
    rateLine.show([...data.history.map((point) => point[0]), data.samples_per_second],
      `${data.name}: ${count(data.samples_per_second)} samples per second`, view.median);
    setText(units, `${count(data.units_finished)} done`);
    setText(failed, data.units_failed > 0 ? `${data.units_failed} failed` : "");
    setText(failure, data.last_failure);
    failure.title = data.last_failure;
    setText(memory, data.memory_bytes > 0 ? bytes(data.memory_bytes) : "");
    const loaded = data.scenes.join(" ");
    if (scenes.dataset.jobs !== loaded) {
      scenes.dataset.jobs = loaded;
      scenes.replaceChildren(...data.scenes.flatMap((job, i) => [i > 0 ? ", " : "scene of ",
        h("a", {href: `#/jobs/${job}`}, `#${job}`)]));
    }
    setText(seen, data.silent_s < 5 ? "now" : `${duration(data.silent_s)} ago`);
    setText(act, data.draining || data.quarantined ? "Release" : "Drain");
    act.setAttribute("aria-label", `${act.textContent} ${data.name}`);
  };
  return {element, show};
}
