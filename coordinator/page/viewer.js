// The picture: float pixels on a canvas, with layers, exposure, tone curve, zoom, the value under the cursor, a histogram,
// the units that workers have, and another picture beside it, divided by a line that moves.

import {PictureSource} from "./picture_source.js";
import {curveOf, luminance, toScreen} from "./color.js";
import {h, setText} from "./dom.js";
import {drawLegend} from "./legend.js";
import {drawUnits, markPixel} from "./viewer_overlay.js";
import {layerText, ViewerTools} from "./viewer_tools.js";

const kZoomMax = 64;
const kPixelMarked = 6;  // from this size on, the pixel under the cursor has a frame
const kHistogramBins = 96;
const kHistogramStops = [-10, 6];
const kWipeGrip = 14;  // pixels beside the line at which it can be moved

// The canvas of a source.
class Sheet {
  constructor(name) {
    this.canvas = h("canvas", {class: name});
    this.context = this.canvas.getContext("2d");
  }
  resize(frame) {
    if (this.canvas.width === frame.width && this.canvas.height === frame.height && this.image) return;
    this.canvas.width = frame.width;
    this.canvas.height = frame.height;
    this.image = new ImageData(frame.width, frame.height);
  }
}

export class Viewer {
  // `urlOf(layer, job, frame)`: of a picture stream.
  constructor(urlOf, fileName) {
    this.urlOf = urlOf;
    this.fileName = fileName;
    this.curve = "neutral";
    this.exposure = 0;
    this.zoom = 0;  // 0: as large as fits
    this.place = {x: 0, y: 0};
    this.wipe = 0.5;
    this.units = [];
    this.cursor = null;
    this.source = null;
    this.other = null;
    this.sheet = new Sheet("picture");
    this.otherSheet = new Sheet("picture other");
    this.canvas = this.sheet.canvas;
    this.behind = h("div", {class: "behind", hidden: true}, this.otherSheet.canvas);
    this.line = h("div", {class: "wipe-line", hidden: true, "aria-hidden": "true"});
    this.overlay = h("canvas", {class: "overlay", "aria-hidden": "true"});
    this.stage = h("div", {class: "stage", tabindex: 0, role: "img", "aria-label": "The picture"}, this.canvas,
      this.behind, this.overlay, this.line);
    this.value = h("output", {class: "value", id: "pixel-value"}, "Point at a pixel");
    this.problem = h("p", {class: "problem", role: "status", hidden: true});
    this.legend = h("canvas", {class: "legend", width: 480, height: 44, role: "img", hidden: true});
    this.histogram = h("canvas", {class: "histogram", width: 2 * kHistogramBins, height: 80, role: "img",
      "aria-label": "Histogram of the luminance, by stops"});
    this.tools = new ViewerTools(this);
    this.element = h("div", {class: "viewer"}, this.tools.element, this.stage, this.problem,
      h("div", {class: "below"}, this.value, this.legend, this.histogram));
    this.listen();
  }

  // Begins to show the colours.
  watch() { this.showLayer(""); }

  showLayer(name) {
    if (this.source) this.source.close();
    const layer = this.tools.find(name);
    this.setCurve(curveOf(layer));
    this.source = new PictureSource(this, layerText(name), layer);
    this.source.watch(this.urlOf(name), (reason) => this.showProblem(reason));
    this.tools.showGains(name === "~lights" ? layer : null, (gains) => {
      this.source.gains = gains;
      this.repaint();
    });
  }

  showProblem(reason) {
    this.problem.hidden = reason === "";
    setText(this.problem, reason);
  }

  // A text instead of a picture; empty: the picture.
  showInstead(text, isProblem) {
    this.element.classList.toggle("empty", text !== "");
    this.problem.classList.toggle("calm", !isProblem);
    this.showProblem(text);
  }

  close() {
    for (const source of [this.source, this.other]) if (source) source.close();
    this.observer.disconnect();
    cancelAnimationFrame(this.painting);
  }

  get frame() { return this.source && this.source.frame; }

  // ---- Another picture beside it ----
  keep() {
    if (!this.frame) return null;
    const done = this.source.state ? ` (${Math.round((100 * this.source.state.done) / Math.max(this.source.state.total, 1))} %)` : "";
    return this.source.keep(`${new Date().toLocaleTimeString()}${done}, ${this.source.label}`);
  }

  compareWith(source) {
    if (this.other && this.other !== source) this.other.close();
    this.other = source;
    this.behind.hidden = this.line.hidden = !source;
    if (source && source.frame) this.otherSheet.resize(source.frame);
    this.setWipe(this.wipe);
    this.repaint();
    this.layout();
  }

  compareWithLayer(layer) {
    this.compareWith(new PictureSource(this, layerText(layer.name), layer).watch(this.urlOf(layer.name),
      (reason) => this.showProblem(reason)));
  }

  compareWithJob(job, frame) {
    this.compareWith(new PictureSource(this, `job ${job}`).watch(this.urlOf("", job, frame),
      (reason) => this.showProblem(reason && `Job ${job}: ${reason}`)));
  }

  // The share of the width that shows this picture; the other one is on the right.
  setWipe(share) {
    this.wipe = Math.min(Math.max(share, 0), 1);
    this.behind.style.clipPath = `inset(0 0 0 ${100 * this.wipe}%)`;
    this.line.style.left = `${100 * this.wipe}%`;
    this.tools.wipe.value = 100 * this.wipe;
  }

  // ---- What the streams show ----
  sheetOf(source) { return source === this.other ? this.otherSheet : this.sheet; }

  onFrame(source) {
    if (source !== this.source && source !== this.other) return;
    this.sheetOf(source).resize(source.frame);
    if (source === this.source) this.stage.style.aspectRatio = `${source.frame.width} / ${source.frame.height}`;
    this.repaint();
    this.layout();
  }

  onRegion(source, x0, y0, width, height) {
    if (this.painting || (source !== this.source && source !== this.other)) return;
    const part = new ImageData(width, height);
    toScreen(source.rgbOf(x0, y0, width, height), part.data, width * height, this.curveFor(source), this.exposure, source.shownRange);
    this.sheetOf(source).context.putImageData(part, x0, y0);
  }

  onState(source) {
    if (source !== this.source && source !== this.other) return;
    if (this.curveFor(source) === "range") this.fitRange(source);
    if (source !== this.source) return;
    const state = source.state;
    this.element.dataset.samplesDone = state.done;
    this.element.dataset.finished = state.isFinished;
    this.element.dataset.layer = source.layer ? source.layer.name : "";
    this.showValue();
    const now = performance.now();
    if (now - (this.histogramAt || 0) > 700 || state.isFinished) {
      this.histogramAt = now;
      this.drawHistogram();
    }
  }

  // The range of the colours follows the values, and stays while these change little.
  fitRange(source) {
    const range = source.range(), shown = source.shownRange;
    const size = range[1] - range[0];
    if (shown && Math.abs(range[0] - shown[0]) < 0.1 * size && Math.abs(range[1] - shown[1]) < 0.1 * size) return;
    source.shownRange = range;
    this.repaint();
  }

  setUnits(units) {
    this.units = units;
    this.drawOverlay();
  }

  // ---- How it looks ----
  // Another layer beside it has a curve of its own.
  curveFor(source) {
    const own = curveOf(source.layer);
    return source === this.source || own === curveOf(this.source.layer) ? this.curve : own;
  }

  setCurve(curve) {
    this.curve = curve;
    this.tools.curve.value = curve;
    if (curve === "range" && this.frame) this.fitRange(this.source);
    this.repaint();
  }

  setExposure(exposure) {
    this.exposure = exposure;
    this.tools.setExposure(exposure);
    this.repaint();
  }

  repaint() {
    if (this.painting) return;
    this.painting = requestAnimationFrame(() => {
      this.painting = 0;
      for (const source of [this.source, this.other]) if (source && source.frame) this.paint(source);
      drawLegend(this.legend, this.curve === "range" && this.source ? this.source.shownRange : null);
    });
  }

  paint(source) {
    const {width, height} = source.frame, sheet = this.sheetOf(source);
    sheet.resize(source.frame);
    toScreen(source.rgbOf(0, 0, width, height), sheet.image.data, width * height, this.curveFor(source), this.exposure, source.shownRange);
    sheet.context.putImageData(sheet.image, 0, 0);
  }

  // ---- Zoom ----
  fitScale() {
    const box = this.stage.getBoundingClientRect();
    return Math.min(box.width / this.frame.width, box.height / this.frame.height);
  }
  scale() { return this.zoom === 0 ? this.fitScale() : this.zoom; }

  fit() {
    this.zoom = 0;
    this.layout();
  }

  zoomBy(factor, point) { this.zoomTo(this.scale() * factor, point); }

  // `point` of the stage stays where it is; without it, the middle.
  zoomTo(scale, point) {
    if (!this.frame) return;
    const box = this.stage.getBoundingClientRect();
    const at = point || {x: box.width / 2, y: box.height / 2};
    const before = this.scale();
    const after = Math.min(Math.max(scale, this.fitScale()), kZoomMax);
    this.place.x = at.x - (at.x - this.place.x) * (after / before);
    this.place.y = at.y - (at.y - this.place.y) * (after / before);
    this.zoom = after <= this.fitScale() ? 0 : after;
    this.layout();
  }

  layout() {
    if (!this.frame) return;
    const box = this.stage.getBoundingClientRect();
    const scale = this.scale();
    const clampTo = (place, size, room) => (size <= room ? (room - size) / 2 : Math.min(0, Math.max(room - size, place)));
    this.place.x = clampTo(this.place.x, this.frame.width * scale, box.width);
    this.place.y = clampTo(this.place.y, this.frame.height * scale, box.height);
    this.move(this.canvas, this.place.x, this.place.y, scale);
    this.layoutOther(scale);
    setText(this.tools.zoomText, this.zoom === 0 ? "fit" : `${Math.round(100 * scale)} %`);
    this.drawOverlay();
  }

  move(canvas, x, y, scale) {
    canvas.style.transform = `translate(${x}px, ${y}px) scale(${scale})`;
    canvas.style.imageRendering = scale >= 2 ? "pixelated" : "auto";
  }

  // Frames of another size are shown as wide as this one.
  layoutOther(scale) {
    if (!this.other || !this.other.frame) return;
    const mine = this.frame, other = this.other.frame;
    const unit = scale / mine.step;  // of the stage, for a pixel of the frame
    const ratio = mine.frameWidth / other.frameWidth;
    this.move(this.otherSheet.canvas, this.place.x + (other.x0 * ratio - mine.x0) * unit,
      this.place.y + (other.y0 * ratio - mine.y0) * unit, unit * ratio * other.step);
  }

  // ---- Pixels ----
  // The pixel at a point of the stage, null outside of the picture.
  pixelAt(point) {
    const x = Math.floor((point.x - this.place.x) / this.scale());
    const y = Math.floor((point.y - this.place.y) / this.scale());
    const isInside = this.frame && x >= 0 && y >= 0 && x < this.frame.width && y < this.frame.height;
    return isInside ? {x, y} : null;
  }

  showValue() {
    const pixel = this.cursor;
    if (!pixel || !this.frame || pixel.x >= this.frame.width || pixel.y >= this.frame.height) return;
    const values = this.source.at(pixel.x, pixel.y), names = this.source.channelNames();
    const x = this.frame.x0 + pixel.x * this.frame.step, y = this.frame.y0 + pixel.y * this.frame.step;
    let text = `x ${x}  y ${y}   ${names.map((name, i) => `${name} ${number(values[i])}`).join("  ")}`;
    const {other} = this, same = other && other.frame && other.frame.width === this.frame.width &&
      other.frame.height === this.frame.height;
    if (same) text += `   |  ${other.at(pixel.x, pixel.y).map(number).join("  ")}`;
    setText(this.value, text);
    Object.assign(this.value.dataset, {x, y, r: values[0], g: values[1], b: values[2]});
  }

  drawHistogram() {
    const bins = new Float64Array(kHistogramBins);
    const count = this.frame.width * this.frame.height;
    const stride = Math.max(1, Math.floor(count / 100000));
    const pixel = new Float32Array(3);
    const [low, high] = kHistogramStops;
    for (let i = 0; i < count; i += stride) {
      this.source.rgb(i, 1, pixel);
      const light = luminance(pixel[0], pixel[1], pixel[2]);
      if (!(light > 0)) continue;
      const bin = Math.floor((kHistogramBins * (Math.log2(light) - low)) / (high - low));
      ++bins[Math.min(Math.max(bin, 0), kHistogramBins - 1)];
    }
    const context = this.histogram.getContext("2d");
    const {width, height} = this.histogram;
    context.clearRect(0, 0, width, height);
    context.fillStyle = getComputedStyle(this.histogram).color;
    const peak = Math.sqrt(Math.max(...bins, 1));
    bins.forEach((size, i) => {
      const tall = (height * Math.sqrt(size)) / peak;
      context.fillRect((width / kHistogramBins) * i, height - tall, width / kHistogramBins - 0.5, tall);
    });
    context.fillRect((width * -low) / (high - low), 0, 1, height);  // radiance 1
  }

  drawOverlay() {
    const box = this.stage.getBoundingClientRect();
    Object.assign(this.overlay, {width: box.width, height: box.height});
    if (!this.frame) return;
    const context = this.overlay.getContext("2d"), scale = this.scale(), point = this.cursorPoint();
    if (scale >= kPixelMarked && point) markPixel(context, point, scale);
    if (this.tools.units.checked) drawUnits(context, this.units, this.frame, this.place, scale);
  }

  // ---- Hands ----
  listen() {
    const at = (event) => {
      const box = this.stage.getBoundingClientRect();
      return {x: event.clientX - box.left, y: event.clientY - box.top};
    };
    const held = new Map();
    this.stage.addEventListener("pointerdown", (event) => {
      const isLine = this.other && Math.abs(at(event).x - this.wipe * this.stage.clientWidth) < kWipeGrip;
      this.isWiping = isLine && held.size === 0;
      held.set(event.pointerId, at(event));
      this.stage.setPointerCapture(event.pointerId);
    });
    for (const name of ["pointerup", "pointercancel"])
      this.stage.addEventListener(name, (event) => held.delete(event.pointerId));
    this.stage.addEventListener("pointermove", (event) => {
      const point = at(event), before = held.get(event.pointerId);
      if (before && this.isWiping) this.setWipe(point.x / this.stage.clientWidth);
      else if (before) {
        const other = [...held].find(([id]) => id !== event.pointerId);
        if (other) this.zoomBy(distance(point, other[1]) / Math.max(distance(before, other[1]), 1), other[1]);
        else this.panBy(point.x - before.x, point.y - before.y);
        held.set(event.pointerId, point);
      }
      this.pointAt(this.pixelAt(point));
    });
    this.stage.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoomBy(2 ** (-event.deltaY / 250), at(event));
    }, {passive: false});
    this.stage.addEventListener("keydown", (event) => this.onKey(event));
    this.observer = new ResizeObserver(() => this.layout());
    this.observer.observe(this.stage);
  }

  pointAt(pixel) {
    if (pixel) this.cursor = pixel;
    this.showValue();
    if (this.scale() >= kPixelMarked) this.drawOverlay();
  }

  // The middle of the pixel under the cursor, on the stage.
  cursorPoint() {
    if (!this.cursor || !this.frame) return null;
    const scale = this.scale();
    return {x: this.place.x + (this.cursor.x + 0.5) * scale, y: this.place.y + (this.cursor.y + 0.5) * scale};
  }

  panBy(x, y) {
    this.place.x += x;
    this.place.y += y;
    this.layout();
  }

  onKey(event) {
    const steps = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
    const step = steps[event.key];
    if (step && this.frame) {
      event.preventDefault();
      const from = this.cursor || {x: 0, y: 0};
      this.pointAt({x: Math.min(Math.max(from.x + step[0], 0), this.frame.width - 1),
        y: Math.min(Math.max(from.y + step[1], 0), this.frame.height - 1)});
    } else if (event.key === "+" || event.key === "=") this.zoomBy(2, this.cursorPoint());
    else if (event.key === "-") this.zoomBy(0.5, this.cursorPoint());
    else if (event.key === "0") this.fit();
    else if (event.key === "1") this.zoomTo(1);
    else if (event.key === "[" || event.key === "]") this.setExposure(this.exposure + (event.key === "]" ? 0.5 : -0.5));
  }
}

const number = (value) => (Math.abs(value) >= 1000 || (value !== 0 && Math.abs(value) < 0.001)
  ? value.toExponential(4) : value.toPrecision(5));
const distance = (a, b) => Math.hypot(a.x - b.x, a.y - b.y);
