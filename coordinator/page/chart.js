// Small charts as SVG: lines over the last hour.

import {h, setText, svg} from "./dom.js";

const kWidth = 240, kHeight = 60;

// A line without axes. `values` oldest first, `label` for screen readers.
export function sparkline(width = 120, height = 28) {
  const line = svg("polyline", {fill: "none", "vector-effect": "non-scaling-stroke"});
  const reference = svg("line", {class: "median", x1: 0, x2: width, visibility: "hidden",
    "vector-effect": "non-scaling-stroke"});
  const element = svg("svg", {class: "spark", viewBox: `0 0 ${width} ${height}`, preserveAspectRatio: "none", role: "img"},
    reference, line);
  const show = (values, label, median = null) => {
    const peak = Math.max(...values, median || 0, 1e-9);
    const step = width / Math.max(values.length - 1, 1);
    const y = (value) => (height - 1 - (value / peak) * (height - 2)).toFixed(1);
    line.setAttribute("points", values.map((value, i) => `${(i * step).toFixed(1)},${y(value)}`).join(" "));
    reference.setAttribute("visibility", median === null ? "hidden" : "visible");
    if (median !== null) { reference.setAttribute("y1", y(median)); reference.setAttribute("y2", y(median)); }
    element.setAttribute("aria-label", label);
  };
  return {element, show};
}

// A titled chart with its newest and largest value.
export class Chart {
  constructor(title, format) {
    this.title = title;
    this.format = format;
    this.now = h("b");
    this.peak = h("small", {class: "soft"});
    this.line = sparkline(kWidth, kHeight);
    this.line.element.classList.add("wide");
    this.element = h("figure", {class: "card chart"}, h("figcaption", {}, h("span", {}, title), this.now), this.line.element,
      h("div", {class: "axis"}, this.span = h("small", {class: "soft"}), this.peak));
  }

  show(values, interval_s) {
    if (values.length === 0) return;
    const last = values[values.length - 1];
    setText(this.now, this.format(last));
    setText(this.peak, `peak ${this.format(Math.max(...values))}`);
    const minutes = Math.round((values.length * interval_s) / 60);
    setText(this.span, minutes > 0 ? `last ${minutes} min` : "since a moment ago");
    this.line.show(values.length > 1 ? values : [last, last], `${this.title}: now ${this.format(last)}`);
  }
}

export function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted.length > 0 ? sorted[sorted.length >> 1] : null;
}
