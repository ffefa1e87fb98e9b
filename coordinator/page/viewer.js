// The picture: float pixels on a canvas, with exposure, tone curve, zoom, the value under the cursor, a histogram and the
// units that workers have.

import {PictureStream} from "./picture_stream.js";
import {kCurves, luminance, toScreen} from "./color.js";
import {h, setText} from "./dom.js";

const kZoomMax = 64;
const kPixelMarked = 6;  // from this size on, the pixel under the cursor has a frame
const kHistogramBins = 96;
const kHistogramStops = [-10, 6];

export class Viewer {
  constructor() {
    this.frame = null;
    this.values = new Float32Array(0);
    this.curve = "neutral";
    this.exposure = 0;
    this.zoom = 0;  // 0: as large as fits
    this.place = {x: 0, y: 0};
    this.units = [];
    this.cursor = null;
    this.canvas = h("canvas", {class: "picture"});
    this.overlay = h("canvas", {class: "overlay", "aria-hidden": "true"});
    this.stage = h("div", {class: "stage", tabindex: 0, role: "img", "aria-label": "The picture"}, this.canvas,
      this.overlay);
    this.value = h("output", {class: "value", id: "pixel-value"}, "Point at a pixel");
    this.problem = h("p", {class: "problem", role: "status", hidden: true});
    this.histogram = h("canvas", {class: "histogram", width: 2 * kHistogramBins, height: 80, role: "img",
      "aria-label": "Histogram of the luminance, by stops"});
    this.element = h("div", {class: "viewer"}, this.tools(), this.stage, this.problem,
      h("div", {class: "below"}, this.value, this.histogram));
    this.listen();
  }

  tools() {
    const curve = h("select", {id: "curve", onchange: (event) => this.setCurve(event.target.value)},
      ...Object.entries(kCurves).map(([value, text]) => h("option", {value}, text)));
    this.exposureInput = h("input", {type: "range", id: "exposure", min: -10, max: 10, step: 0.25, value: 0,
      oninput: (event) => this.setExposure(Number(event.target.value))});
    this.exposureText = h("output", {for: "exposure"}, "0 EV");
    this.showUnits = h("input", {type: "checkbox", id: "units", onchange: () => this.drawOverlay()});
    this.zoomText = h("output", {}, "fit");
    const button = (text, label, action) => h("button", {type: "button", class: "quiet", "aria-label": label,
      title: label, onclick: action}, text);
    return h("div", {class: "tools"},
      h("label", {}, "Tone ", curve),
      h("label", {}, "Exposure ", this.exposureInput, this.exposureText),
      h("label", {}, this.showUnits, " Units"),
      h("span", {class: "zoom"}, button("−", "Zoom out", () => this.zoomBy(0.5)), this.zoomText,
        button("+", "Zoom in", () => this.zoomBy(2)), button("Fit", "Fit the picture", () => this.fit()),
        button("1:1", "Show every pixel", () => this.zoomTo(1))));
  }

  watch(url) {
    if (this.stream) this.stream.close();
    this.stream = new PictureStream(url, this, (reason) => {
      this.problem.hidden = reason === "";
      setText(this.problem, reason);
    });
  }

  close() {
    if (this.stream) this.stream.close();
    this.observer.disconnect();
    cancelAnimationFrame(this.painting);
  }

  // ---- What the stream shows ----
  onFrame(frame) {
    const isSame = this.frame && this.frame.width === frame.width && this.frame.height === frame.height;
    this.frame = frame;
    this.values = new Float32Array(3 * frame.width * frame.height);
    if (!isSame) {
      this.canvas.width = frame.width;
      this.canvas.height = frame.height;
      this.stage.style.aspectRatio = `${frame.width} / ${frame.height}`;
    }
    this.image = new ImageData(frame.width, frame.height);
    this.repaint();
    this.layout();
  }

  onRegion(x0, y0, width, height, values) {
    const row = 3 * this.frame.width;
    for (let y = 0; y < height; ++y)
      this.values.set(values.subarray(3 * width * y, 3 * width * (y + 1)), row * (y0 + y) + 3 * x0);
    const part = new ImageData(width, height);
    toScreen(values, part.data, width * height, this.curve, this.exposure);
    this.canvas.getContext("2d").putImageData(part, x0, y0);
  }

  onState(state) {
    this.state = state;
    this.element.dataset.samplesDone = state.done;
    this.element.dataset.finished = state.isFinished;
    this.showValue();
    const now = performance.now();
    if (now - (this.histogramAt || 0) > 700 || state.isFinished) {
      this.histogramAt = now;
      this.drawHistogram();
    }
    if (this.onUpdate) this.onUpdate(state);
  }

  setUnits(units) {
    this.units = units;
    this.drawOverlay();
  }

  // ---- How it looks ----
  setCurve(curve) {
    this.curve = curve;
    this.repaint();
  }

  setExposure(exposure) {
    this.exposure = exposure;
    this.exposureInput.value = exposure;
    setText(this.exposureText, `${exposure > 0 ? "+" : ""}${exposure} EV`);
    this.repaint();
  }

  repaint() {
    if (!this.frame || this.painting) return;
    this.painting = requestAnimationFrame(() => {
      this.painting = 0;
      toScreen(this.values, this.image.data, this.frame.width * this.frame.height, this.curve, this.exposure);
      this.canvas.getContext("2d").putImageData(this.image, 0, 0);
    });
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
    this.canvas.style.transform = `translate(${this.place.x}px, ${this.place.y}px) scale(${scale})`;
    this.canvas.style.imageRendering = scale >= 2 ? "pixelated" : "auto";
    setText(this.zoomText, this.zoom === 0 ? "fit" : `${Math.round(100 * scale)} %`);
    this.drawOverlay();
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
    if (!pixel || !this.frame) return;
    const i = 3 * (this.frame.width * pixel.y + pixel.x);
    const rgb = [this.values[i], this.values[i + 1], this.values[i + 2]];
    const x = this.frame.x0 + pixel.x * this.frame.step, y = this.frame.y0 + pixel.y * this.frame.step;
    setText(this.value, `x ${x}  y ${y}   R ${number(rgb[0])}  G ${number(rgb[1])}  B ${number(rgb[2])}`);
    Object.assign(this.value.dataset, {x, y, r: rgb[0], g: rgb[1], b: rgb[2]});
  }

  drawHistogram() {
    const bins = new Float64Array(kHistogramBins);
    const count = this.values.length / 3;
    const stride = Math.max(1, Math.floor(count / 200000));
    const [low, high] = kHistogramStops;
    for (let i = 0; i < count; i += stride) {
      const light = luminance(this.values[3 * i], this.values[3 * i + 1], this.values[3 * i + 2]);
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
    this.overlay.width = box.width;
    this.overlay.height = box.height;
    if (!this.frame) return;
    const context = this.overlay.getContext("2d");
    this.markPixel(context);
    if (!this.showUnits.checked) return;
    const scale = this.scale() / this.frame.step;
    context.font = "11px system-ui, sans-serif";
    context.textBaseline = "top";
    for (const unit of this.units) {
      const x = this.place.x + (unit.x0 - this.frame.x0) * scale, y = this.place.y + (unit.y0 - this.frame.y0) * scale;
      const width = (unit.x1 - unit.x0) * scale, height = (unit.y1 - unit.y0) * scale;
      const color = `hsl(${hue(unit.worker)} 90% 60%)`;
      context.strokeStyle = color;
      context.lineWidth = unit.running ? 2 : 1;
      context.setLineDash(unit.running ? [] : [3, 3]);
      context.strokeRect(x + 1, y + 1, Math.max(width - 2, 1), Math.max(height - 2, 1));
      if (width < 44 || !unit.running) continue;
      context.fillStyle = "rgb(0 0 0 / 60%)";
      const text = unit.worker_name || unit.worker.slice(0, 6);
      context.fillRect(x + 2, y + 2, Math.min(context.measureText(text).width + 6, width - 4), 14);
      context.fillStyle = color;
      context.fillText(text, x + 5, y + 3, width - 8);
    }
  }

  markPixel(context) {
    const scale = this.scale(), point = this.cursorPoint();
    if (scale < kPixelMarked || !point) return;
    for (const [color, width] of [["#000", 3], ["#fff", 1]]) {
      context.strokeStyle = color;
      context.lineWidth = width;
      context.strokeRect(point.x - scale / 2, point.y - scale / 2, scale, scale);
    }
  }

  // ---- Hands ----
  listen() {
    const at = (event) => {
      const box = this.stage.getBoundingClientRect();
      return {x: event.clientX - box.left, y: event.clientY - box.top};
    };
    const held = new Map();
    this.stage.addEventListener("pointerdown", (event) => {
      held.set(event.pointerId, at(event));
      this.stage.setPointerCapture(event.pointerId);
    });
    for (const name of ["pointerup", "pointercancel"])
      this.stage.addEventListener(name, (event) => held.delete(event.pointerId));
    this.stage.addEventListener("pointermove", (event) => {
      const point = at(event), before = held.get(event.pointerId);
      if (before) {
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

function hue(text) {
  let sum = 0;
  for (const letter of text) sum = (31 * sum + letter.charCodeAt(0)) % 360;
  return sum;
}
