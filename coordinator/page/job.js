// One job: its picture while it refines, what it does, and buttons that change it.

import {get, mayControl, maySeePicture, post} from "./api.js";
import {count, duration, failedText, h, isOpenState, noiseText, percent, progressBar, setClass, setText} from "./dom.js";
import {Strip} from "./strip.js";
import {Viewer} from "./viewer.js";

const kTimes = [
  ["render_s", "rendering"], ["load_s", "loading the scene"], ["fetch_s", "fetching files"], ["waste_s", "in vain"],
  ["overhead_s", "overhead"], ["tail_s", "waiting for the last units"], ["idle_s", "idle"],
  ["writing_s", "writing pictures"], ["other_s", "other jobs"],
];
const kDetailInterval_ms = 1000;
const kMessagesShown = 500;

function whyNoFrames(job) {
  if (job.state === "paused") return "Paused before a worker has prepared the scene.";
  if (job.state === "preparing") return job.reason ? `The scene is not prepared yet: ${job.reason}` : "A worker prepares the scene.";
  return job.reason || "The scene was not prepared.";
}

export class JobView {
  constructor(job, frame, note) {
    this.job = job;
    this.frame = frame;
    this.note = note;
    this.title = `Job ${job}`;
    this.logAfter = 0;
    this.name = h("h1");
    this.state = h("span", {class: "state"});
    this.bar = progressBar("Progress");
    this.figures = h("dl", {class: "figures"});
    this.buttons = h("div", {class: "buttons"});
    this.viewer = new Viewer((layer, of = job, index = frame) =>
      `/api/v1/jobs/${of}/picture?frame=${index}${layer ? `&layer=${encodeURIComponent(layer)}` : ""}`, `job-${job}`);
    this.strip = new Strip(job, frame, this.viewer.stage, (index) => { location.hash = `#/jobs/${job}/${index}`; });
    this.times = h("div", {class: "times"});
    this.log = h("ol", {class: "log", role: "log", "aria-label": "Messages"});
    this.missing = h("p", {class: "none", hidden: true});
    this.element = h("section", {class: "job-view"},
      h("p", {class: "crumb"}, h("a", {href: "#/jobs"}, "‹ All jobs")), this.missing,
      h("div", {class: "job-head"}, this.name, this.state),
      h("div", {class: "job-progress"}, this.bar, this.percent = h("span", {class: "figure"})),
      this.buttons, this.viewer.element, this.strip.element,
      h("div", {class: "columns"},
        h("div", {class: "card"}, h("h2", {}, "Figures"), this.figures),
        h("div", {class: "card"}, h("h2", {}, "Where the time went"), this.times),
        h("div", {class: "card"}, h("h2", {}, "Messages"), this.log)));
  }

  start() {
    this.loadDetail(true);
  }

  close() {
    this.isClosed = true;
    clearTimeout(this.timer);
    this.viewer.close();
    this.strip.close();
  }

  async loadDetail(isFirst = false) {
    clearTimeout(this.timer);
    try {
      const detail = await get(`jobs/${this.job}`, {frame: this.frame});
      if (this.isClosed) return;
      this.detail = detail;
      this.show(detail);
      this.viewer.tools.setLayers(detail.layers || []);
      if (isFirst) this.open(detail);
      this.strip.show(detail.frames);
      this.showTimes(detail.times);
      this.viewer.setUnits(detail.units);
      this.loadLog();
    } catch (error) {
      if (this.isClosed) return;
      this.missing.hidden = error.status !== 404;
      setText(this.missing, error.message);
    }
    const isOpen = this.status && isOpenState(this.status.state);
    this.timer = setTimeout(() => document.hidden || this.loadDetail(!this.isOpened), isOpen ? kDetailInterval_ms : 5000);
  }

  // A job has no frames while it is prepared.
  open(detail) {
    this.isOpened = detail.frames_total > 0;
    if (this.isOpened || !this.pause) this.buttons.replaceChildren(...this.makeButtons(detail));
    if (!this.isOpened) {
      this.viewer.showInstead(whyNoFrames(detail), detail.state === "failed" || (detail.state === "preparing" && detail.reason !== ""));
    } else if (maySeePicture(detail)) {
      this.viewer.showInstead("", false);
      this.viewer.watch();
    } else {
      this.viewer.showProblem("Its owner, viewers and operators may see the picture.");
    }
    this.enable();
  }

  onEvent(name, job) {
    if (name === "job" && job) this.show(job);
  }

  show(job) {
    const before = this.status;
    this.status = job;
    document.title = `${percent(job.progress)} ${job.name || this.title} · Tessera`;
    setText(this.name, job.name || this.title);
    setText(this.state, job.state);
    setClass(this.state, `state ${job.state}`);
    this.bar.value = job.progress;
    setText(this.percent, percent(job.progress));
    this.showFigures(job);
    if (before && (before.state !== job.state || before.priority !== job.priority)) this.loadLog();
    this.enable();
  }

  // What happened since the last call: the coordinator keeps the log.
  async loadLog() {
    if (this.isLoadingLog) return;
    this.isLoadingLog = true;
    try {
      for (let hasMore = true; hasMore && !this.isClosed;) {
        const page = await get(`jobs/${this.job}/log`, {after: this.logAfter});
        for (const entry of page.entries) this.addMessage(entry);
        hasMore = page.has_more;
      }
    } catch (error) { /* asked again with the next detail */ }
    this.isLoadingLog = false;
  }

  addMessage(entry) {
    this.logAfter = entry.number;
    const time = new Date(entry.unix_time_ms);
    const isToday = time.toDateString() === new Date().toDateString();
    this.log.prepend(h("li", {class: entry.level},
      h("time", {datetime: time.toISOString()}, isToday ? time.toLocaleTimeString() : time.toLocaleString()), " ",
      entry.level === "info" ? null : h("b", {class: "hidden"}, `${entry.level}: `), entry.text));
    while (this.log.children.length > kMessagesShown) this.log.lastChild.remove();
  }

  showFigures(job) {
    const detail = this.detail || {};
    const figures = [
      ["Job", `#${job.id}`], ["Owner", job.owner || "none"], ["Priority", String(job.priority)],
      ["Size", detail.width ? `${detail.width} × ${detail.height}` : ""],
      ["Samples per pixel", detail.samples_per_pixel ? String(detail.samples_per_pixel) : ""],
      ["Samples", `${count(job.samples_done)} of ${count(job.samples_total)}`],
      ["Samples/s", job.samples_per_second > 0 ? count(job.samples_per_second) : ""],
      ["Noise reached", noiseText(job.noise)],
      ["Noise threshold", detail.noise_threshold ? noiseText(detail.noise_threshold) : ""],
      ["Workers", String(job.workers)], ["Elapsed", duration(job.elapsed_s)], ["Time left", duration(job.left_s)],
      ["Frames", job.frames_total > 1 ? `${job.frames_finished} of ${job.frames_total}${failedText(job)}` : ""],
      ["Scene", detail.scene_file || ""],
    ].filter(([, text]) => text !== "");
    const rows = [...this.figures.children];
    if (rows.length !== figures.length) {
      this.figures.replaceChildren(...figures.map(([name, text]) => h("div", {}, h("dt", {}, name), h("dd", {}, text))));
    } else {
      figures.forEach(([name, text], i) => { setText(rows[i].firstChild, name); setText(rows[i].lastChild, text); });
    }
  }

  showTimes(times) {
    const all = kTimes.reduce((sum, [key]) => sum + times[key], 0);
    if (all <= 0) return this.times.replaceChildren(h("p", {class: "soft"}, "Nothing yet."));
    const parts = kTimes.map(([key, text], i) => [times[key], text, i]).filter(([value]) => value / all > 0.002);
    const bar = h("div", {class: "time-bar", role: "img", "aria-label":
      parts.map(([value, text]) => `${text} ${percent(value / all)}`).join(", ")},
      ...parts.map(([value, text, i]) => {
        const part = h("span", {class: `t${i}`, title: `${text}: ${duration(value)}`});
        part.style.flexGrow = value / all;
        return part;
      }));
    this.times.replaceChildren(bar, h("ul", {class: "legend"}, ...parts.map(([value, text, i]) =>
      h("li", {}, h("i", {class: `t${i}`}), `${text} `, h("b", {}, percent(value / all)), ` ${duration(value)}`))));
  }

  // ---- Buttons ----
  makeButtons(detail) {
    const button = (id, text, action) => h("button", {type: "button", id, onclick: action}, text);
    this.pause = button("pause", "Pause", () => this.change("pause"));
    this.resume = button("resume", "Resume", () => this.change("resume"));
    this.cancel = button("cancel", "Cancel", () => {
      if (confirm(`Cancel job ${this.job}?`)) this.change("cancel");
    });
    this.cancel.classList.add("danger");
    this.priorityInput = h("input", {type: "number", id: "priority", min: -1000000, max: 1000000, step: 1,
      value: detail.priority, "aria-label": "Priority"});
    this.extendInput = h("input", {type: "number", id: "spp", min: 1, max: 1048576, step: 1,
      value: 2 * (detail.samples_per_pixel || 1), "aria-label": "Samples per pixel"});
    this.priorityForm = h("form", {class: "inline", onsubmit: (event) => {
      event.preventDefault();
      this.change("priority", {priority: Number(this.priorityInput.value)});
    }}, this.priorityInput, h("button", {id: "set-priority"}, "Set priority"));
    this.extendForm = h("form", {class: "inline", onsubmit: (event) => {
      event.preventDefault();
      this.change("extend", {samples_per_pixel: Number(this.extendInput.value)});
    }}, this.extendInput, h("button", {id: "extend", title: detail.can_extend ? "" :
      "Only jobs with the samplers independent, sobol or paddedsobol can be extended"}, "Extend"));
    const link = (id, text, file) => h("a", {class: "button", id, download: "",
      href: `/api/v1/jobs/${this.job}/${file}?frame=${this.frame}`}, text);
    this.downloads = h("span", {class: "inline"}, link("exr", "EXR", "picture.exr"), link("png", "PNG", "picture.png"));
    this.downloads.hidden = !maySeePicture(detail) || detail.frames_total === 0;
    return [this.pause, this.resume, this.cancel, this.priorityForm, this.extendForm, this.downloads];
  }

  enable() {
    if (!this.pause || !this.status) return;
    const job = this.status;
    const may = mayControl(job);
    const isOpen = isOpenState(job.state);
    const isPaused = job.state === "paused" && job.paused_by_user;
    this.pause.hidden = !may || !isOpen || isPaused;
    this.resume.hidden = !may || !isPaused;
    this.cancel.hidden = !may || !isOpen;
    this.priorityForm.hidden = !may || !isOpen;
    this.extendForm.hidden = !may || job.frames_total === 0 || !(isOpen || job.state === "finished");
    this.extendForm.querySelector("button").disabled = !(this.detail && this.detail.can_extend);
  }

  async change(what, body) {
    try {
      const job = await post(`jobs/${this.job}/${what}`, body);
      this.show(job);
      this.note(`Job ${this.job}: ${what === "priority" ? `priority ${job.priority}` : job.state}`);
      this.loadDetail();
    } catch (error) {
      this.note(error.message, true);
    }
  }

  onKey(event) {
    if (event.key === "p" && this.status)
      this.change(this.status.state === "paused" ? "resume" : "pause");
    else if (["+", "=", "-", "0", "1", "[", "]"].includes(event.key)) this.viewer.onKey(event);
    else return false;
    return true;
  }
}
