// A scene folder is dropped or chosen, uploaded as far as the farm lacks its files, and submitted.

import {me, post} from "./api.js";
import {bytes, h, percent, progressBar, setText} from "./dom.js";
import {chosenFiles, kFilesMax, likelyScenes, manifestOf, nameFrom, packagePath} from "./scene_package.js";
import {digestOf} from "./sha256.js";
import {uploadMissing} from "./upload.js";

const kSubmissionMax = 2 ** 52;

function randomNumber() {
  const [low, high] = crypto.getRandomValues(new Uint32Array(2));
  return 1 + (high % 2 ** 20) * 2 ** 32 + low % kSubmissionMax;
}

const field = (label, input, hint) => h("label", {class: "field"}, h("span", {}, label), input, h("small", {}, hint));
const numberOf = (input) => (input.value.trim() === "" ? undefined : Number(input.value));

export class SubmitView {
  constructor(note) {
    this.title = "Submit";
    this.note = note;
    this.files = [];
    this.choices = 0;
    this.abort = null;
    this.order = "";  // what was sent without an answer
    const choose = (input) => this.choose(null, input.files);
    this.folder = h("input", {type: "file", id: "folder", class: "hidden", webkitdirectory: true, multiple: true,
      tabindex: -1, "aria-hidden": "true", onchange: (event) => choose(event.target)});
    this.single = h("input", {type: "file", id: "files", class: "hidden", multiple: true, tabindex: -1,
      "aria-hidden": "true", onchange: (event) => choose(event.target)});
    this.found = h("p", {class: "soft", id: "found", role: "status"}, "The folder of a scene with all its files.");
    this.drop = h("div", {class: "drop",
      ondragover: (event) => { event.preventDefault(); this.drop.classList.add("over"); },
      ondragleave: () => this.drop.classList.remove("over"),
      ondrop: (event) => this.onDrop(event)},
      h("p", {}, "Drop a scene folder here, or"),
      h("p", {class: "tools"},
        h("button", {type: "button", id: "choose-folder", onclick: () => this.folder.click()}, "Choose a folder"),
        h("button", {type: "button", class: "quiet", id: "choose-files", onclick: () => this.single.click()}, "Choose files")),
      this.found);
    this.makeForm();
    this.element = h("section", {class: "submit"}, h("h1", {}, "Submit a job"),
      me.may["Jobs.Submit"] === "none"
        ? h("p", {class: "none", id: "refused"}, "Your role may not submit jobs. Ask for a token with the role user.")
        : h("div", {}, this.folder, this.single, this.drop, this.form));
  }

  makeForm() {
    const number = (id, attributes) => h("input", {type: "number", id, ...attributes});
    const text = (id, attributes) => h("input", {type: "text", id, autocomplete: "off", spellcheck: "false", ...attributes});
    this.scene = h("select", {id: "scene", required: true, onchange: () => this.showName()});
    this.name = text("name", {maxlength: 200});
    this.priority = number("priority", {value: 0, min: -1000000, max: 1000000, step: 1});
    this.spp = number("spp", {min: 1, max: 2 ** 20, step: 1});
    this.width = number("width", {min: 1, max: 65536, step: 1, "aria-label": "Width"});
    this.height = number("height", {min: 1, max: 65536, step: 1, "aria-label": "Height"});
    this.noise = number("noise", {min: 0, max: 1, step: "any"});
    this.frames = text("frames", {pattern: "[0-9]+(-[0-9]+(x[0-9]+)?)?", placeholder: "1-250"});
    this.rate = number("rate", {min: 0.001, step: "any", placeholder: "24"});
    this.layers = text("layers", {placeholder: "albedo,normal", pattern: "[a-z0-9_, \\-]*"});
    this.denoise = h("input", {type: "checkbox", id: "denoise"});
    this.go = h("button", {id: "start"}, "Submit");
    this.stop = h("button", {type: "button", class: "quiet", id: "stop", hidden: true, onclick: () => this.abort.abort()}, "Stop");
    this.bar = progressBar("Progress of the upload");
    this.bar.hidden = true;
    this.doing = h("span", {role: "status", id: "doing"});
    this.fields = h("fieldset", {class: "fields"}, h("legend", {class: "hidden"}, "Options"),
      field("Scene file", this.scene, "which file of the folder is rendered"),
      field("Name", this.name, "of the job"),
      field("Priority", this.priority, "higher goes first"),
      field("Samples per pixel", this.spp, "empty: as in the scene"),
      h("div", {class: "field", role: "group", "aria-label": "Resolution"}, h("span", {}, "Resolution"),
        h("span", {class: "inline"}, this.width, "×", this.height), h("small", {}, "pixels; empty: as in the scene")),
      field("Noise threshold", this.noise, "pixels stop early: 0.2 is a draft, 0.05 is clean"),
      field("Frames", this.frames, "of a sequence: A-B or A-BxSTEP"),
      field("Frames per second", this.rate, "of an animated scene"),
      field("Layers", this.layers, "separated by commas; tessera kinds lists them"),
      h("label", {class: "field check"}, this.denoise, h("span", {}, "Denoise the finished picture")));
    this.form = h("form", {class: "card", hidden: true, onsubmit: (event) => { event.preventDefault(); this.run(); }},
      this.fields, h("p", {class: "tools"}, this.go, this.stop, this.bar, this.doing));
  }

  start() {}
  onEvent() {}
  close() { if (this.abort) this.abort.abort(); }

  onDrop(event) {
    event.preventDefault();
    this.drop.classList.remove("over");
    this.choose(event.dataTransfer, event.dataTransfer.files);
  }

  // The last choice counts, however long others take to be read.
  async choose(transfer, list) {
    if (this.abort) return;
    const choice = ++this.choices;
    this.form.hidden = true;
    this.files = [];
    try {
      const {folder, files} = await chosenFiles(transfer, list);
      const scenes = files.length > kFilesMax ? [] : await likelyScenes(files);
      if (choice === this.choices) this.take(folder, files, scenes);
    } catch (error) {
      this.note(`The files cannot be read: ${error.message}`, true);
    }
  }

  take(folder, files, scenes) {
    if (files.length > kFilesMax) return setText(this.found, `More than ${kFilesMax} files. Use tessera submit.`);
    if (scenes.length === 0) return setText(this.found, "There is no scene file (.pbrt) among these files.");
    this.files = files;
    const size = files.reduce((sum, each) => sum + each.file.size, 0);
    setText(this.found, `${folder || "Files"}: ${files.length} ${files.length === 1 ? "file" : "files"}, ${bytes(size)}`);
    this.scene.replaceChildren(...scenes.map((path) => h("option", {value: path}, path)));
    this.showName();
    this.form.hidden = false;
    this.scene.focus();
  }

  showName() {
    this.name.placeholder = this.scene.value.split("/").pop().replace(/\.pbrt(\.gz)?$/i, "");
  }

  show(text, share) {
    setText(this.doing, text);
    this.bar.hidden = share === undefined;
    if (share !== undefined) this.bar.value = share;
  }

  async run() {
    this.abort = new AbortController();
    this.drop.inert = this.fields.disabled = this.go.disabled = true;
    this.stop.hidden = false;
    this.show("Reading files", 0);
    this.go.parentElement.scrollIntoView({block: "nearest"});
    try {
      const job = await this.submit(this.abort.signal);
      this.note(`Job ${job.id} is submitted`);
      if (this.element.isConnected) location.hash = `#/jobs/${job.id}`;
    } catch (error) {
      const isStopped = this.abort.signal.aborted;
      this.show(isStopped ? "Stopped. What was sent is kept for a while." : `Not submitted: ${error.message}`);
      if (!isStopped) this.note(error.message, true);
    }
    this.abort = null;
    this.drop.inert = this.fields.disabled = this.go.disabled = false;
    this.stop.hidden = true;
  }

  async submit(signal) {
    const body = this.body();
    const {manifest, blobs} = await this.pack(signal);
    const sent = await uploadMissing(blobs, (done, all) =>
      this.show(`Uploading ${bytes(done)} of ${bytes(all)}`, all > 0 ? done / all : 1), signal);
    this.show(`Uploaded ${sent.files} of ${blobs.size} files. Submitting.`, 1);
    // If the answer is lost, another attempt with the same options is the same job.
    const order = {...body, package: manifest}, text = JSON.stringify(order);
    if (text !== this.order) [this.order, this.submission] = [text, randomNumber()];
    const job = await post("jobs", {...order, submission: this.submission});
    this.order = "";
    return job;
  }

  // Reads every file. Their digests are kept for another attempt.
  async pack(signal) {
    const scene = this.scene.value, total = this.files.reduce((sum, each) => sum + each.file.size, 0);
    const blobs = new Map(), listed = new Map();
    let read = 0;
    for (const each of this.files) {
      const path = packagePath(nameFrom(scene, each.path));
      if (path === "") throw new Error(`${each.path}: the name is too long`);
      if (each.digest === undefined) {
        const before = read;
        each.digest = await digestOf(each.file, (count) => {
          read += count;
          this.show(`Reading ${bytes(read)} of ${bytes(total)} (${percent(total > 0 ? read / total : 1)})`, total > 0 ? read / total : 1);
        }, signal);
        read = before;
      }
      read += each.file.size;
      listed.set(path, {path, digest: each.digest, size: each.file.size});
      blobs.set(each.digest, each.file);
    }
    const text = new Blob([manifestOf([...listed.values()])]);
    const manifest = await digestOf(text, () => {}, signal);
    blobs.set(manifest, text);
    return {manifest, blobs};
  }

  body() {
    const scene = this.scene.value;
    const options = {
      samples_per_pixel: numberOf(this.spp), width: numberOf(this.width), height: numberOf(this.height),
      noise_threshold: numberOf(this.noise), aov: this.layers.value.replace(/\s/g, "").replace(/^,+|,+$/g, "") || undefined,
      denoise: this.denoise.checked || undefined,
    };
    return {
      name: this.name.value.trim() || this.name.placeholder,
      priority: numberOf(this.priority), scene_file: packagePath(this.sceneFile(scene)),
      frames: this.frames.value.trim() || undefined, frames_per_second: numberOf(this.rate), options,
    };
  }

  // With a range of frames whose files are there one by one, the pattern of their names.
  sceneFile(scene) {
    const name = scene.split("/").pop();
    const digits = name.match(/([0-9]+)(?=\.pbrt(\.gz)?$)/i);
    if (this.frames.value.trim() === "" || !digits) return name;
    const others = this.files.filter((each) => each.path.replace(/[0-9]+(?=\.pbrt(\.gz)?$)/i, "") === scene.replace(/[0-9]+(?=\.pbrt(\.gz)?$)/i, ""));
    return others.length > 1 ? name.replace(digits[0], "#".repeat(digits[0].length)) : name;
  }
}
