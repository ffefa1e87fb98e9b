// Elements and numbers. Text from the farm only ever becomes text nodes and attributes, never markup.

export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  setAttributes(element, attributes);
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

export function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  setAttributes(element, attributes);
  element.append(...children);
  return element;
}

function setAttributes(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? "" : value);
  }
}

// Sets a text only when it differs, so that screen readers and the layout are left alone.
export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

export function setClass(node, name) {
  if (node.className !== name) node.className = name;
}

export function progressBar(label) {
  return h("progress", {max: 1, value: 0, "aria-label": label});
}

const kPrefixes = ["", "k", "M", "G", "T", "P"];

function scaled(value, base, unit) {
  let prefix = 0;
  while (Math.abs(value) >= base && prefix < kPrefixes.length - 1) { value /= base; ++prefix; }
  const digits = prefix === 0 || value >= 100 ? 0 : 1;
  return `${value.toFixed(digits)} ${kPrefixes[prefix]}${unit}`.trimEnd();
}

export const count = (value) => scaled(value, 1000, "");
export const bytes = (value) => scaled(value, 1000, "B");
export const percent = (value) => `${(100 * value).toFixed(value > 0 && value < 0.1 ? 1 : 0)} %`;

// After the number of a job's frames: those that no worker can render.
export const failedText = (job) => (job.frames_failed > 0 ? `, ${job.frames_failed} failed` : "");
// The root of the relMSE: the typical error of a pixel relative to its value.
export const noiseText = (noise) => (noise === null || noise === undefined ? "" : `${(100 * noise).toPrecision(2)} %`);

export function duration(seconds) {
  if (seconds === null || seconds === undefined) return "";
  const s = Math.round(seconds);
  if (s < 60) return `${s} s`;
  if (s < 3600) return `${Math.floor(s / 60)} min ${s % 60} s`;
  if (s < 86400) return `${Math.floor(s / 3600)} h ${Math.floor((s % 3600) / 60)} min`;
  return `${Math.floor(s / 86400)} d ${Math.floor((s % 86400) / 3600)} h`;
}

export const isOpenState = (state) => ["preparing", "waiting", "running", "paused"].includes(state);
