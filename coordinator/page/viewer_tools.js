// The controls of the viewer: layer, tone curve, exposure, zoom, comparison, and the gains of light groups.

import {kCurves} from "./color.js";
import {h, setText} from "./dom.js";

const kLayerNames = {"": "Colours", "~samples": "Samples per pixel", "~noise": "Noise", "~lights": "Light groups, mixed",
  A: "alpha"};
export const layerText = (name) => kLayerNames[name] || name.replaceAll("_", " ");

function button(text, label, action, id = null) {
  return h("button", {type: "button", class: "quiet", "aria-label": label, title: label, onclick: action, id}, text);
}

export class ViewerTools {
  constructor(viewer) {
    this.viewer = viewer;
    this.layer = h("select", {id: "layer", onchange: () => viewer.showLayer(this.layer.value)}, h("option", {value: ""}, "Colours"));
    this.curve = h("select", {id: "curve", onchange: () => viewer.setCurve(this.curve.value)},
      ...Object.entries(kCurves).map(([value, text]) => h("option", {value}, text)));
    this.exposure = h("input", {type: "range", id: "exposure", min: -10, max: 10, step: 0.25, value: 0,
      oninput: () => viewer.setExposure(Number(this.exposure.value))});
    this.exposureText = h("output", {for: "exposure"}, "0 EV");
    this.units = h("input", {type: "checkbox", id: "units", onchange: () => viewer.drawOverlay()});
    this.zoomText = h("output", {}, "fit");
    this.compare = h("select", {id: "compare", onchange: () => this.pickCompared()});
    this.wipe = h("input", {type: "range", id: "wipe", min: 0, max: 100, step: 0.5, value: 50, "aria-label": "Wipe",
      oninput: () => viewer.setWipe(Number(this.wipe.value) / 100)});
    this.wipeLabel = h("label", {hidden: true}, "Wipe ", this.wipe);
    this.gains = h("div", {class: "gains", hidden: true});
    this.layers = [];
    this.kept = [];
    this.element = h("div", {class: "viewer-tools"},
      h("div", {class: "tools"},
        h("label", {}, "Layer ", this.layer), h("label", {}, "Tone ", this.curve),
        h("label", {}, "Exposure ", this.exposure, this.exposureText), h("label", {}, this.units, " Units"),
        h("span", {class: "zoom"}, button("−", "Zoom out", () => viewer.zoomBy(0.5)), this.zoomText,
          button("+", "Zoom in", () => viewer.zoomBy(2)), button("Fit", "Fit the picture", () => viewer.fit()),
          button("1:1", "Show every pixel", () => viewer.zoomTo(1)))),
      h("div", {class: "tools"},
        h("label", {}, "Compare with ", this.compare), this.wipeLabel,
        button("Keep this moment", "Keep the picture as it is now, to compare it later", () => this.keep(), "keep")),
      this.gains);
    this.showCompared();
  }

  setLayers(layers) {
    const key = JSON.stringify(layers);
    if (key === this.layersKey) return;
    this.layersKey = key;
    this.layers = layers;
    const chosen = this.layer.value;
    this.layer.replaceChildren(...layers.map((layer) => h("option", {value: layer.name}, layerText(layer.name))));
    this.layer.value = layers.some((layer) => layer.name === chosen) ? chosen : "";
    this.showCompared();
  }

  find(name) { return this.layers.find((layer) => layer.name === name) || null; }

  setExposure(exposure) {
    this.exposure.value = exposure;
    setText(this.exposureText, `${exposure > 0 ? "+" : ""}${exposure} EV`);
  }

  // ---- Comparison ----
  showCompared() {
    const chosen = this.compare.value;
    this.compare.replaceChildren(h("option", {value: ""}, "nothing"),
      ...this.kept.map((source, i) => h("option", {value: `kept ${i}`}, source.label)),
      ...this.layers.map((layer) => h("option", {value: `layer ${layer.name}`}, `layer: ${layerText(layer.name)}`)),
      h("option", {value: "job"}, "another job …"));
    this.compare.value = [...this.compare.options].some((option) => option.value === chosen) ? chosen : "";
  }

  keep() {
    const source = this.viewer.keep();
    if (!source) return;
    this.kept.push(source);
    if (this.kept.length > kKeptMax) this.kept.shift();
    this.showCompared();
    this.compare.value = `kept ${this.kept.length - 1}`;
    this.pickCompared();
  }

  pickCompared() {
    const [what, ...rest] = this.compare.value.split(" ");
    const name = rest.join(" ");
    if (what === "kept") this.viewer.compareWith(this.kept[Number(name)]);
    else if (what === "layer") this.viewer.compareWithLayer(this.find(name));
    else if (what === "job") this.askForJob();
    else this.viewer.compareWith(null);
    this.wipeLabel.hidden = !this.viewer.other;
  }

  askForJob() {
    const answer = prompt("Number of the job, or job/frame (frames count from 0)");
    const match = (answer || "").trim().match(/^#?([1-9][0-9]{0,15})(?:\/([0-9]{1,5}))?$/);
    if (!match) {
      this.compare.value = "";
      return this.viewer.compareWith(null);
    }
    this.viewer.compareWithJob(Number(match[1]), Number(match[2] || 0));
  }

  // ---- Light groups ----
  showGains(layer, onGains) {
    this.gains.hidden = !layer;
    if (!layer) return;
    const names = layer.channels.filter((_, i) => i % 3 === 0).map((name) => name.replace(/^light_/, "").replace(/\.[^.]*$/, ""));
    const state = names.map(() => ({gain: 1, tint: [1, 1, 1]}));
    const command = h("code", {id: "relight"});
    const change = () => {
      const gains = state.map(({gain, tint}) => tint.map((part) => Number((gain * part).toFixed(3))));
      onGains(gains);
      setText(command, relightCommand(this.viewer.fileName, names, gains));
    };
    this.gains.replaceChildren(...names.map((name, i) => {
      const text = h("output", {}, "1");
      const gain = h("input", {type: "range", min: 0, max: 4, step: 0.05, value: 1, class: "gain", "aria-label": `Gain of ${name}`,
        oninput: () => { state[i].gain = Number(gain.value); setText(text, gain.value); change(); }});
      const tint = h("input", {type: "color", value: "#ffffff", "aria-label": `Tint of ${name}`,
        oninput: () => { state[i].tint = linear(tint.value); change(); }});
      return h("label", {}, h("b", {}, name), gain, text, tint);
    }), h("div", {class: "command"}, command,
      button("Copy", "Copy the command", () => navigator.clipboard.writeText(command.textContent))));
    change();
  }
}

const kKeptMax = 4;

// A colour of the screen as gains of which the largest is 1.
function linear(hex) {
  const parts = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255)
    .map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
  const most = Math.max(...parts);
  return most > 0 ? parts.map((part) => part / most) : [0, 0, 0];
}

function relightCommand(file, names, gains) {
  const words = gains.map((gain, i) => [names[i], gain[0] === gain[1] && gain[1] === gain[2] ? `${gain[0]}` : gain.join(",")])
    .filter(([, gain]) => gain !== "1").map(([name, gain]) => `--gain ${name}=${gain}`);
  return ["tessera relight", `${file}.exr`, "-o", `${file}-relit.exr`, ...words].join(" ");
}
