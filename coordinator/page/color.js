// From radiance to the colours of the screen.

export const kCurves = {
  neutral: "Neutral (as PNG files)",
  agx: "AgX",
  srgb: "sRGB, clipped",
  false: "False colour",
  range: "Range, in colours",
  vector: "Directions",
};

// The curve that suits a layer.
export function curveOf(layer) {
  if (!layer || layer.name === "" || layer.name === "~lights") return "neutral";
  if (layer.channels.length === 1) return "range";
  return layer.name.replace(/^denoising_/, "").startsWith("normal") ? "vector" : "srgb";
}

// IEC 61966-2-1, by the root of the linear value: dark values have as many steps as bright ones.
const kTableSize = 4096;
const kSrgb = (() => {
  const table = new Uint8ClampedArray(kTableSize + 1);
  for (let i = 0; i <= kTableSize; ++i) {
    const linear = (i / kTableSize) ** 2;
    table[i] = Math.round(255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055));
  }
  return table;
})();

function srgb(linear) {
  if (!(linear > 0)) return 0;
  return linear >= 1 ? 255 : kSrgb[(Math.sqrt(linear) * kTableSize + 0.5) | 0];
}

// Khronos PBR Neutral (2024) without its compensation of dark colours.
function neutral(r, g, b, out) {
  const peak = Math.max(r, g, b);
  if (peak < 0.8) { out[0] = r; out[1] = g; out[2] = b; return; }
  const newPeak = 1 - 0.04 / (peak - 0.6);
  const scale = newPeak / peak, fade = 1 - 1 / (0.15 * (peak - newPeak) + 1);
  out[0] = r * scale + (newPeak - r * scale) * fade;
  out[1] = g * scale + (newPeak - g * scale) * fade;
  out[2] = b * scale + (newPeak - b * scale) * fade;
}

// AgX (Troy Sobotka), with the polynomial for its curve by Benjamin Wrensch (2023), which gives encoded values.
function agxCurve(x) {
  const x2 = x * x, x4 = x2 * x2;
  return 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
}

function agxLog(x) {
  const ev = Math.log2(Math.max(x, 1e-10));
  return Math.min(Math.max((ev + 12.47393) / (4.026069 + 12.47393), 0), 1);
}

function agx(r, g, b, out) {
  const ar = agxCurve(agxLog(0.842479062253094 * r + 0.0784335999999992 * g + 0.0792237451477643 * b));
  const ag = agxCurve(agxLog(0.0423282422610123 * r + 0.878468636469772 * g + 0.0791661274605434 * b));
  const ab = agxCurve(agxLog(0.0423756549057051 * r + 0.0784336 * g + 0.879142973793104 * b));
  out[0] = 1.19687900512017 * ar - 0.0980208811401368 * ag - 0.0990297440797205 * ab;
  out[1] = -0.0528968517574562 * ar + 1.15190312990417 * ag - 0.0989611768448433 * ab;
  out[2] = -0.0529716355144438 * ar - 0.0980434501171241 * ag + 1.15107367264116 * ab;
}

export const luminance = (r, g, b) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

// Stops of luminance around 0.18, from -8 to +8: violet, blue, green, grey in the middle, yellow, red, white.
export const kStops = [
  [-8, 30, 0, 60], [-6, 60, 20, 160], [-4, 20, 90, 220], [-2, 20, 160, 150], [-0.5, 60, 170, 60], [0, 128, 128, 128],
  [0.5, 190, 180, 40], [2, 240, 150, 20], [4, 225, 50, 30], [6, 250, 120, 200], [8, 255, 255, 255],
];

function falseColor(r, g, b, out) {
  const stop = Math.log2(Math.max(luminance(r, g, b), 1e-10) / 0.18);
  let i = 1;
  while (i < kStops.length - 1 && stop > kStops[i][0]) ++i;
  const [low, high] = [kStops[i - 1], kStops[i]];
  const t = Math.min(Math.max((stop - low[0]) / (high[0] - low[0]), 0), 1);
  for (let c = 0; c < 3; ++c) out[c] = low[c + 1] + (high[c + 1] - low[c + 1]) * t;
}

// From dark blue to yellow, evenly for the eye: nine colours of viridis (van der Walt and Smith 2015, CC0).
const kRamp = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99],
  [170, 220, 50], [253, 231, 37]];

export function rampColor(t, out) {
  const place = Math.min(Math.max(t, 0), 1) * (kRamp.length - 1);
  const i = Math.min(Math.floor(place), kRamp.length - 2);
  for (let c = 0; c < 3; ++c) out[c] = kRamp[i][c] + (kRamp[i + 1][c] - kRamp[i][c]) * (place - i);
}

// Writes RGBA bytes of `count` pixels, from `values` (three floats each). `range`: of the values, for that curve.
export function toScreen(values, pixels, count, curve, exposure, range) {
  const scale = 2 ** exposure;
  const out = new Float32Array(3);
  const [low, high] = range || [0, 1];
  for (let i = 0, p = 0; i < 3 * count; i += 3, p += 4) {
    const r = values[i] * scale, g = values[i + 1] * scale, b = values[i + 2] * scale;
    if (curve === "range") {
      rampColor((values[i] - low) / (high - low), out);
      pixels[p] = out[0]; pixels[p + 1] = out[1]; pixels[p + 2] = out[2];
    } else if (curve === "vector") {
      for (let c = 0; c < 3; ++c) pixels[p + c] = 127.5 * (1 + values[i + c]);
    } else if (curve === "false") {
      falseColor(r, g, b, out);
      pixels[p] = out[0]; pixels[p + 1] = out[1]; pixels[p + 2] = out[2];
    } else if (curve === "agx") {
      agx(Math.max(r, 0), Math.max(g, 0), Math.max(b, 0), out);
      pixels[p] = 255 * out[0]; pixels[p + 1] = 255 * out[1]; pixels[p + 2] = 255 * out[2];
    } else if (curve === "neutral") {
      neutral(Math.max(r, 0), Math.max(g, 0), Math.max(b, 0), out);
      pixels[p] = srgb(out[0]); pixels[p + 1] = srgb(out[1]); pixels[p + 2] = srgb(out[2]);
    } else {
      pixels[p] = srgb(r); pixels[p + 1] = srgb(g); pixels[p + 2] = srgb(b);
    }
    pixels[p + 3] = 255;
  }
}
