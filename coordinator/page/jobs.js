// All jobs: small pictures, progress, time left. Fluent with thousands.

import {get, maySeePicture} from "./api.js";
import {count, duration, failedText, h, isOpenState, noiseText, percent, progressBar, setClass, setText} from "./dom.js";
import {sortButtons, Throttle, VirtualList} from "./list.js";

const kColumns = [
  [null, "", "c-picture"], ["id", "Job", "c-name"], ["state", "State", "c-state"], ["progress", "Done", "c-done"],
  ["noise", "Noise", "c-noise"], ["left", "Time left", "c-left"], ["rate", "Samples/s", "c-rate"], ["priority", "Priority", "c-priority"],
  ["owner", "Owner", "c-owner"],
];
const kStates = [["", "All"], ["open", "Open"], ["preparing", "Preparing"], ["running", "Running"], ["waiting", "Waiting"], ["paused", "Paused"],
  ["finished", "Finished"], ["failed", "Failed"], ["cancelled", "Cancelled"]];
const kPictureInterval_ms = 20000;
const kMissingPictureInterval_ms = 3000;
const kFilterInterval_ms = 60;  // between requests while someone types

export class JobsView {
  constructor(note) {
    this.title = "Jobs";
    this.note = note;
    this.filter = {search: "", state: ""};
    this.sort = {key: "id", order: "desc"};
    this.search = h("input", {type: "search", placeholder: "Search name, owner or number  ( / )",
      "aria-label": "Search jobs", oninput: () => this.filtering.request()});
    this.state = h("select", {"aria-label": "State", onchange: () => this.filtering.request()},
      ...kStates.map(([value, text]) => h("option", {value}, text)));
    this.filtering = new Throttle(kFilterInterval_ms, () => this.applyFilter());
    this.found = h("span", {class: "soft", role: "status"});
    this.heads = sortButtons(kColumns, this.sort, (key) => this.sortBy(key));
    this.list = new VirtualList({
      label: "Jobs",
      empty: "No jobs. Submit one: here, or with tessera submit scene.pbrt",
      load: (offset, limit) => this.load(offset, limit),
      onTotal: (total) => setText(this.found, `${total} ${total === 1 ? "job" : "jobs"}`),
      makeRow: () => makeRow(),
    });
    this.element = h("section", {class: "jobs"},
      h("h1", {class: "hidden"}, "Jobs"),
      h("div", {class: "tools"}, this.search, this.state, this.found),
      h("div", {class: "row heads"}, ...this.heads.buttons),
      this.list.element);
  }

  start() { this.list.refresh(true).catch((error) => this.note(error.message, true)); }
  close() { this.list.close(); this.filtering.cancel(); }

  applyFilter() {
    this.filter = {search: this.search.value.trim(), state: this.state.value};
    this.start();
  }

  sortBy(key) {
    this.sort.order = this.sort.key === key && this.sort.order === "desc" ? "asc" : "desc";
    this.sort.key = key;
    this.heads.show();
    this.start();
  }

  async load(offset, limit) {
    const page = await get("jobs", {...this.filter, sort: this.sort.key, order: this.sort.order, offset, limit});
    return {total: page.total, rows: page.jobs};
  }

  onEvent(name) {
    if (name === "farm") this.list.refresh().catch(() => {});
  }
}

// A row shows any job; it is used again for another while the list scrolls.
function makeRow() {
  const picture = h("img", {alt: "", width: 80, height: 45, class: "absent"});
  const name = h("a", {class: "name"});
  const number = h("span", {class: "soft"});
  const state = h("span", {class: "state"});
  const reason = h("small", {class: "reason"});
  const bar = progressBar("Progress");
  const done = h("span", {class: "figure"});
  const [noise, left, rate, priority, owner] = ["c-noise", "c-left", "c-rate", "c-priority", "c-owner"]
    .map((c) => h("span", {class: c}));
  const element = h("div", {class: "row job"},
    h("span", {class: "c-picture"}, picture), h("span", {class: "c-name"}, name, number),
    h("span", {class: "c-state"}, state, reason), h("span", {class: "c-done"}, bar, done), noise, left, rate, priority, owner);
  let shown = null, pictureDue = 0, pictureOf = "";
  picture.addEventListener("error", () => picture.classList.add("absent"));
  picture.addEventListener("load", () => picture.classList.remove("absent"));
  // A picture that is not made yet is asked for again soon, one of a job that renders from time to time.
  const showPicture = (job) => {
    const now = Date.now();
    const isThere = !picture.classList.contains("absent");
    const version = `${job.id} ${job.samples_done}`;
    if (shown === job.id && (now < pictureDue || (isThere && pictureOf === version))) return;
    if (shown !== job.id) {
      picture.classList.add("absent");
      picture.removeAttribute("src");
    }
    pictureDue = now + (isThere && shown === job.id ? kPictureInterval_ms : kMissingPictureInterval_ms);
    pictureOf = version;
    if (maySeePicture(job) && job.samples_done > 0) picture.src = `/api/v1/jobs/${job.id}/thumbnail.png?at=${now}`;
  };
  const show = (job) => {
    showPicture(job);
    shown = job.id;
    setText(name, job.name || `Job ${job.id}`);
    name.href = `#/jobs/${job.id}`;
    name.title = job.name;
    const frames = job.frames_total > 1 ? ` · ${job.frames_finished}/${job.frames_total} frames${failedText(job)}` : "";
    setText(number, `#${job.id}${frames}`);
    setText(state, job.state);
    setClass(state, `state ${job.state}`);
    setText(reason, job.reason);
    reason.title = job.reason;
    bar.value = job.progress;
    setText(done, percent(job.progress));
    setText(noise, noiseText(job.noise));
    const isOpen = isOpenState(job.state);
    setText(left, job.left_s !== null ? duration(job.left_s) : isOpen ? "" : `took ${duration(job.elapsed_s)}`);
    setText(rate, isOpen && job.samples_per_second > 0 ? `${count(job.samples_per_second)}/s` : "");
    setText(priority, String(job.priority));
    setText(owner, job.owner);
  };
  return {element, show};
}
