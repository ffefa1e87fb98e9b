// The colours of a range and the values that they stand for.

import {rampColor} from "./color.js";

const text = (value) => (value !== 0 && (Math.abs(value) >= 10000 || Math.abs(value) < 0.01)
  ? value.toExponential(1) : value.toPrecision(3));

export function drawLegend(canvas, range) {
  canvas.hidden = !range;
  if (!range) return;
  const {width, height} = canvas, context = canvas.getContext("2d");
  const key = `${range[0]} ${range[1]}`;
  canvas.setAttribute("aria-label", `Colours from ${text(range[0])} to ${text(range[1])}`);
  if (canvas.dataset.range === key) return;
  canvas.dataset.range = key;
  context.clearRect(0, 0, width, height);
  const color = [0, 0, 0];
  for (let x = 0; x < width; ++x) {
    rampColor(x / (width - 1), color);
    context.fillStyle = `rgb(${color.map(Math.round).join(" ")})`;
    context.fillRect(x, 0, 1, 16);
  }
  context.fillStyle = getComputedStyle(canvas).color;
  context.font = "20px system-ui, sans-serif";
  context.textBaseline = "bottom";
  [0, 0.5, 1].forEach((share, i) => {
    context.textAlign = ["left", "center", "right"][i];
    context.fillText(text(range[0] + share * (range[1] - range[0])), share * width, height);
  });
}
