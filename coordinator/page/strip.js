// The frames of a sequence: small pictures in a strip, and a player of those that are finished.

import {h, setText} from "./dom.js";

const kCell = 108, kMargin = 4;       // pixels of a cell; cells beside those in sight
const kRates = [6, 12, 24, 30];       // frames per second
const kLoadedMax = 480;               // pictures of at most some 300 KB
const kRetry_ms = 700;                // small pictures are made one after the other
const kRefresh_ms = 5000;

export class Strip {
  // `stage`: the element over which the sequence plays.
  constructor(job, frame, stage, go) {
    Object.assign(this, {job, frame, stage, go});
    this.frames = [];
    this.cells = new Map();
    this.loaded = new Map();  // pictures as they came, by frame
    this.filler = h("div", {class: "strip-filler", role: "list", "aria-label": "Frames"});
    this.scroller = h("div", {class: "strip", tabindex: 0, onscroll: () => this.render()}, this.filler);
    this.button = h("button", {type: "button", class: "quiet", id: "play", onclick: () => this.toggle()}, "Play");
    this.rate = h("select", {"aria-label": "Frames per second"},
      ...kRates.map((rate) => h("option", {value: rate, selected: rate === 24}, `${rate} / s`)));
    this.status = h("span", {class: "soft", role: "status"});
    this.screen = h("canvas", {class: "screen", role: "img", "aria-label": "The sequence", hidden: true});
    this.element = h("div", {class: "sequence", hidden: true},
      h("div", {class: "tools"},
        h("button", {type: "button", class: "quiet", "aria-label": "Previous frame", onclick: () => this.step(-1)}, "‹"),
        this.button,
        h("button", {type: "button", class: "quiet", "aria-label": "Next frame", onclick: () => this.step(1)}, "›"),
        this.rate, this.status),
      this.scroller);
    stage.append(this.screen);
    this.observer = new ResizeObserver(() => this.render());
    this.observer.observe(this.scroller);
  }

  close() {
    this.isClosed = true;
    this.stop();
    this.observer.disconnect();
    this.loaded.clear();
  }

  // `frames`: [number, whether it is finished] each.
  show(frames) {
    this.frames = frames;
    this.element.hidden = frames.length < 2;
    if (frames.length < 2) return;
    this.filler.style.width = `${frames.length * kCell}px`;
    if (!this.hasScrolled) {
      this.hasScrolled = true;
      this.scroller.scrollLeft = (this.frame + 0.5) * kCell - this.scroller.clientWidth / 2;
    }
    this.render();
    if (!this.isPlaying) this.tellFrame();
  }

  tellFrame() {
    const [number, isFinished] = this.frames[this.frame] || [];
    if (number !== undefined) setText(this.status, `Frame ${number}${isFinished ? ", finished" : ""}`);
  }

  step(by) { this.go(Math.min(Math.max(this.frame + by, 0), this.frames.length - 1)); }

  // ---- The strip ----
  render() {
    const first = Math.max(0, Math.floor(this.scroller.scrollLeft / kCell) - kMargin);
    const last = Math.min(this.frames.length, Math.ceil((this.scroller.scrollLeft + this.scroller.clientWidth) / kCell) + kMargin);
    for (const [index, cell] of this.cells) {
      if (index >= first && index < last) continue;
      cell.element.remove();
      this.cells.delete(index);
    }
    for (let index = first; index < last; ++index) {
      if (!this.cells.has(index)) this.cells.set(index, this.makeCell(index));
      this.cells.get(index).show(this.frames[index]);
    }
  }

  makeCell(index) {
    const picture = h("img", {alt: "", width: 96, height: 54, class: "absent", loading: "lazy"});
    const number = h("span");
    const element = h("button", {type: "button", class: "cell", role: "listitem", onclick: () => this.go(index)}, picture, number);
    element.style.transform = `translateX(${index * kCell}px)`;
    if (index === this.frame) element.setAttribute("aria-current", "true");
    let due = 0, version = "";
    picture.addEventListener("error", () => picture.classList.add("absent"));
    picture.addEventListener("load", () => picture.classList.remove("absent"));
    const show = ([frame, isFinished]) => {
      setText(number, String(frame));
      element.classList.toggle("finished", isFinished);
      element.setAttribute("aria-label", `Frame ${frame}${isFinished ? ", finished" : ""}`);
      const now = Date.now(), isThere = !picture.classList.contains("absent");
      if ((!isFinished && index !== this.frame) || now < due || (isThere && version === "finished")) return;
      due = now + (isThere ? kRefresh_ms : kRetry_ms);
      version = isFinished ? "finished" : "";
      picture.src = `/api/v1/jobs/${this.job}/thumbnail.png?frame=${index}&at=${now}`;
    };
    this.filler.append(element);
    return {element, show};
  }

  // ---- The player ----
  toggle() { return this.isPlaying ? this.stop() : this.play(); }

  play() {
    this.isPlaying = true;
    setText(this.button, "Stop");
    this.screen.hidden = false;
    this.load();
    this.at = -1;
    const tick = (now) => {
      if (!this.isPlaying) return;
      if (now >= (this.due || 0)) {
        this.due = now + 1000 / Number(this.rate.value) - 4;
        this.showNext();
      }
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  stop() {
    this.isPlaying = false;
    setText(this.button, "Play");
    this.screen.hidden = true;
    this.tellFrame();
  }

  finished() { return this.frames.flatMap(([, isFinished], i) => (isFinished ? [i] : [])).slice(0, kLoadedMax); }

  showNext() {
    const there = this.finished().filter((index) => this.loaded.has(index));
    const next = there.find((index) => index > this.at) ?? there[0];
    const all = this.finished().length;
    if (next === undefined) return setText(this.status, `No pictures yet: 0 of ${all}`);
    this.at = next;
    this.draw(next);
    setText(this.status, `Frame ${this.frames[next][0]}${there.length < all ? `, ${there.length} of ${all} loaded` : ""}`);
  }

  async draw(index) {
    const picture = await createImageBitmap(this.loaded.get(index));
    if (!this.isPlaying) return picture.close();
    Object.assign(this.screen, {width: picture.width, height: picture.height});
    this.screen.getContext("2d").drawImage(picture, 0, 0);
    this.screen.dataset.frame = index;
    picture.close();
  }

  // One after the other: each is made when it is asked for.
  async load() {
    if (this.isLoading) return;
    this.isLoading = true;
    while (this.isPlaying && !this.isClosed) {
      const missing = this.finished().filter((index) => !this.loaded.has(index));
      if (missing.length === 0) {
        await new Promise((resolve) => setTimeout(resolve, kRetry_ms));
        continue;
      }
      // The next are asked for as well, so that they are made meanwhile.
      const answers = await Promise.all(missing.slice(0, 3).map((index) => this.fetchPicture(index)));
      if (!answers.some((isThere) => isThere)) await new Promise((resolve) => setTimeout(resolve, kRetry_ms));
    }
    this.isLoading = false;
  }

  async fetchPicture(index) {
    try {
      const response = await fetch(`/api/v1/jobs/${this.job}/thumbnail.png?frame=${index}&size=640`);
      if (!response.ok) return false;
      const blob = await response.blob();
      if (!this.isClosed) this.loaded.set(index, blob);
      return true;
    } catch (error) {
      return false;
    }
  }
}
