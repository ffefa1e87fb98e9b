// The pixels of one layer of one frame, as its stream sends them or as they were at some moment.

import {PictureStream} from "./picture_stream.js";

// Calls `onFrame()`, `onRegion(x0, y0, width, height)` and `onState(state)` of its owner.
export class PictureSource {
  constructor(owner, label, layer = null) {
    this.owner = owner;
    this.label = label;
    this.layer = layer;  // {name, channels}; null: colours
    this.gains = null;   // of light groups: [r, g, b] each
    this.frame = null;
    this.values = new Float32Array(0);
    this.channels = 3;
  }

  watch(url, onProblem) {
    this.stream = new PictureStream(url, this, onProblem);
    return this;
  }

  close() {
    if (this.stream) this.stream.close();
  }

  // The pixels as they are now.
  keep(label) {
    const kept = new PictureSource(this.owner, label, this.layer);
    Object.assign(kept, {frame: this.frame, values: this.values.slice(), channels: this.channels, state: this.state,
      gains: this.gains});
    return kept;
  }

  onFrame(frame) {
    this.frame = frame;
    this.channels = frame.channels;
    this.values = new Float32Array(frame.channels * frame.width * frame.height);
    this.owner.onFrame(this);
  }

  onRegion(x0, y0, width, height, values) {
    const row = this.channels * this.frame.width, part = this.channels * width;
    for (let y = 0; y < height; ++y)
      this.values.set(values.subarray(part * y, part * (y + 1)), row * (y0 + y) + this.channels * x0);
    this.owner.onRegion(this, x0, y0, width, height);
  }

  onState(state) {
    this.state = state;
    this.owner.onState(this);
  }

  isMixed() { return this.channels > 3; }

  // Red, green and blue of `count` pixels from the pixel `first` on: a single channel is grey, light groups are added up.
  rgb(first, count, out) {
    const n = this.channels, values = this.values;
    if (n === 3) {
      out.set(values.subarray(3 * first, 3 * (first + count)));
      return out;
    }
    for (let p = 0; p < count; ++p) {
      const i = n * (first + p), o = 3 * p;
      if (n < 3) {
        out[o] = values[i];
        out[o + 1] = n === 2 ? values[i + 1] : values[i];
        out[o + 2] = n === 2 ? 0 : values[i];
        continue;
      }
      let r = 0, g = 0, b = 0;
      for (let k = 0; k < n; k += 3) {
        const gain = this.gains ? this.gains[k / 3] : kOne;
        r += gain[0] * values[i + k];
        g += gain[1] * values[i + k + 1];
        b += gain[2] * values[i + k + 2];
      }
      out[o] = r; out[o + 1] = g; out[o + 2] = b;
    }
    return out;
  }

  rgbOf(x0, y0, width, height) {
    const out = new Float32Array(3 * width * height);
    for (let y = 0; y < height; ++y)
      this.rgb(this.frame.width * (y0 + y) + x0, width, out.subarray(3 * width * y, 3 * width * (y + 1)));
    return out;
  }

  // What is shown of a pixel: the values of its channels, or of several light groups their sum.
  at(x, y) {
    const pixel = this.frame.width * y + x;
    if (this.isMixed()) return [...this.rgb(pixel, 1, new Float32Array(3))];
    return [...this.values.subarray(this.channels * pixel, this.channels * (pixel + 1))];
  }

  channelNames() {
    if (!this.layer || this.layer.name === "" || this.isMixed()) return ["R", "G", "B"];
    return this.layer.channels.map((name) => name.slice(name.lastIndexOf(".") + 1));
  }

  // The range of most finite values: those between 1 % and 99 %.
  range() {
    const some = [];
    const stride = Math.max(1, Math.floor(this.values.length / 20000));
    for (let i = 0; i < this.values.length; i += stride) {
      if (Number.isFinite(this.values[i])) some.push(this.values[i]);
    }
    some.sort((a, b) => a - b);
    if (some.length === 0) return [0, 1];
    const low = some[Math.floor(some.length * 0.01)], high = some[Math.ceil(some.length * 0.99) - 1];
    return high > low ? [low, high] : [Math.min(low, 0), Math.max(high, low + 1e-6, 1e-6)];
  }
}

const kOne = [1, 1, 1];
