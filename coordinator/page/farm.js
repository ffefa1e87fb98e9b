// The farm: throughput, queue and disk over the last hour, and what an administrator should know.

import {get} from "./api.js";
import {bytes, count, h, percent} from "./dom.js";
import {Chart} from "./chart.js";

const kDiskLow = 0.1;
const kSilent_s = 30;

export class FarmView {
  constructor(note) {
    this.title = "Farm";
    this.note = note;
    this.tiles = h("div", {class: "tiles"});
    this.alarms = h("ul", {class: "alarms", "aria-live": "polite"});
    this.charts = {
      rate: new Chart("Samples/s", count),
      slots: new Chart("Busy slots", count),
      results: new Chart("Results/s", bytes),
      queue: new Chart("Samples left", count),
      jobs: new Chart("Open jobs", count),
      workers: new Chart("Workers", count),
      disk: new Chart("Free disk", bytes),
      blobs: new Chart("Scene files", bytes),
      failed: new Chart("Failed units", count),
    };
    this.element = h("section", {class: "farm"}, h("h1", {class: "hidden"}, "Farm"), this.tiles,
      h("h2", {}, "Alarms"), this.alarms, h("h2", {}, "The last hour"),
      h("div", {class: "charts"}, ...Object.values(this.charts).map((chart) => chart.element)),
      h("p", {class: "soft"}, "For monitoring systems: ", h("a", {href: "/metrics"}, "/metrics"), " · for programs: ",
        h("a", {href: "/api/v1/openapi.json"}, "/api/v1/openapi.json")));
  }

  start() {
    get("farm").then((farm) => this.show(farm), (error) => this.note(error.message, true));
    this.loadHistory();
    this.loadTroubled();
  }
  close() { clearTimeout(this.timer); clearTimeout(this.troubledTimer); this.isClosed = true; }

  onEvent(name, farm) {
    if (name === "farm") this.show(farm);
  }

  show(farm) {
    this.farm = farm;
    const slots = farm.slots.leased + farm.slots.fetching + farm.slots.loading + farm.slots.idle;
    const tile = (value, text) => h("div", {class: "tile"}, h("b", {}, value), h("span", {}, text));
    this.tiles.replaceChildren(
      tile(String(farm.workers_total), "workers"), tile(`${farm.slots.leased} / ${slots}`, "slots busy"),
      tile(count(farm.samples_per_second), "samples/s"), tile(count(farm.samples_left), "samples left"),
      tile(String(farm.leases), "units leased"), tile(bytes(farm.bytes.results_in), "of results since the start"),
      tile(bytes(farm.disk.free), "free on disk"));
    this.showAlarms();
  }

  async loadHistory() {
    try {
      const {points, interval_s} = await get("farm/history");
      if (this.isClosed) return;
      const show = (chart, key) => this.charts[chart].show(points.map((point) => point[key]), interval_s);
      show("rate", "samples_per_second");
      show("slots", "slots_leased");
      show("queue", "samples_left");
      show("jobs", "jobs_open");
      show("workers", "workers");
      show("disk", "disk_free");
      show("blobs", "blob_bytes");
      show("failed", "units_failed");
      const rates = points.slice(1).map((point, i) => Math.max(0, point.results_bytes - points[i].results_bytes) /
        Math.max(point.time - points[i].time, 1));
      this.charts.results.show(rates, interval_s);
    } catch (error) { /* tried again */ }
    this.timer = setTimeout(() => this.loadHistory(), 10000);
  }

  // Workers that need attention.
  async loadTroubled() {
    try {
      const quarantined = await get("workers", {state: "quarantined", limit: 20});
      const silent = await get("workers", {sort: "silent", order: "desc", limit: 20});
      const failing = await get("workers", {sort: "failed", order: "desc", limit: 20});
      if (this.isClosed) return;
      this.troubled = {quarantined: quarantined.workers,
        silent: silent.workers.filter((worker) => worker.silent_s > kSilent_s),
        failing: failing.workers.filter((worker) => worker.units_failed > 0)};
      const failed = await get("jobs", {state: "failed", sort: "id", order: "desc", limit: 5});
      this.failedJobs = failed.jobs;
      this.showAlarms();
    } catch (error) { /* tried again */ }
    if (!this.isClosed) this.troubledTimer = setTimeout(() => this.loadTroubled(), 5000);
  }

  showAlarms() {
    const farm = this.farm;
    if (!farm) return;
    const alarms = [];
    const add = (level, text, link) => alarms.push([level, text, link]);
    if (farm.storage_reason) add("bad", `The coordinator cannot write its data: ${farm.storage_reason}`);
    if (farm.disk.total > 0 && farm.disk.free < kDiskLow * farm.disk.total)
      add("bad", `Only ${bytes(farm.disk.free)} (${percent(farm.disk.free / farm.disk.total)}) of the disk are free.`);
    const waiting = (farm.jobs.waiting || 0) + (farm.jobs.running || 0);
    if (farm.workers_total === 0 && waiting > 0) add("bad", `${waiting} jobs wait and no worker is connected.`);
    const {quarantined = [], silent = [], failing = []} = this.troubled || {};
    for (const worker of quarantined) add("bad", `${worker.name} is quarantined: ${worker.reason}`, "#/workers");
    for (const worker of silent) add("warn", `${worker.name} has sent nothing for ${Math.round(worker.silent_s)} s.`, "#/workers");
    for (const worker of failing) add("warn", `${worker.name} has failed ${worker.units_failed} units.`, "#/workers");
    for (const job of this.failedJobs || []) add("warn", `Job ${job.id} failed: ${job.reason}`, `#/jobs/${job.id}`);
    const key = JSON.stringify(alarms);
    if (key === this.alarmsKey) return;
    this.alarmsKey = key;
    this.alarms.replaceChildren(...(alarms.length > 0 ? alarms.map(([level, text, link]) =>
      h("li", {class: level}, h("b", {class: "hidden"}, level === "bad" ? "Alarm: " : "Warning: "),
        link ? h("a", {href: link}, text) : text)) : [h("li", {class: "good"}, "Nothing to worry about.")]));
  }
}
