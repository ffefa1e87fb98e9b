// Reads the stream of a picture that refines (coordinator/web/api/picture_format.h describes the bytes).

const kHeadBytes = 12;
const kMagic = 0x58495054;  // "TPIX"
const kMessageBytesMax = 1 << 22;  // a region of 64 light groups

// Halves as floats, by their bits.
const kHalves = (() => {
  const floats = new Float32Array(65536);
  for (let bits = 0; bits < 65536; ++bits) {
    const exponent = (bits >> 10) & 31, fraction = bits & 1023;
    const size = exponent === 0 ? fraction * 2 ** -24
      : exponent === 31 ? (fraction ? NaN : Infinity) : (1 + fraction / 1024) * 2 ** (exponent - 15);
    floats[bits] = bits & 0x8000 ? -size : size;
  }
  return floats;
})();

// Calls `target`.onFrame(frame), onRegion(x, y, width, height, values) and onState(state). Reconnects until Close.
export class PictureStream {
  constructor(url, target, onProblem) {
    this.url = url;
    this.target = target;
    this.onProblem = onProblem;
    this.delay = 500;
    this.bytesReceived = 0;
    this.onVisible = () => (document.hidden ? this.stop() : this.open());
    document.addEventListener("visibilitychange", this.onVisible);
    this.open();
  }

  close() {
    document.removeEventListener("visibilitychange", this.onVisible);
    this.stop();
  }

  stop() {
    clearTimeout(this.timer);
    if (this.abort) this.abort.abort();
    this.abort = null;
  }

  async open() {
    this.stop();
    if (document.hidden) return;
    const abort = new AbortController();
    this.abort = abort;
    this.problem = "";
    let reason = "";
    try {
      const response = await fetch(this.url, {signal: abort.signal});
      if (!response.ok) reason = (await response.json().catch(() => ({}))).error || `error ${response.status}`;
      else await this.read(response.body.getReader());
    } catch (error) {
      reason = "not connected";
    }
    if (abort.signal.aborted) return;
    this.onProblem(reason);
    this.delay = Math.min(this.delay * 2, 15000);
    this.timer = setTimeout(() => this.open(), this.delay);
  }

  async read(reader) {
    let pending = new Uint8Array(0);
    for (;;) {
      const {done, value} = await reader.read();
      if (done) return;
      this.bytesReceived += value.length;
      this.delay = 500;
      const bytes = new Uint8Array(pending.length + value.length);
      bytes.set(pending);
      bytes.set(value, pending.length);
      pending = bytes.slice(this.take(bytes));
    }
  }

  // Handles whole messages and returns how many bytes they had.
  take(bytes) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    let at = 0;
    while (bytes.length - at >= kHeadBytes) {
      const size = view.getUint32(at + 8, true);
      if (view.getUint32(at, true) !== kMagic || view.getUint8(at + 4) !== 1 || size > kMessageBytesMax)
        throw new Error("the stream has another format");
      if (bytes.length - at - kHeadBytes < size) break;
      this.message(view.getUint8(at + 5), view, at + kHeadBytes, size);
      at += kHeadBytes + size;
    }
    return at;
  }

  message(kind, view, at, size) {
    const number = (i) => view.getUint32(at + 4 * i, true);
    if (kind === 1) {
      this.isHalf = view.getUint8(at + 28) === 1;
      this.target.onFrame({width: number(0), height: number(1), step: number(2), x0: number(3), y0: number(4),
        frameWidth: number(5), frameHeight: number(6), isHalf: this.isHalf, channels: view.getUint8(at + 29)});
    } else if (kind === 2) {
      const values = this.isHalf ? halves(view, at + 16, size - 16) : floats(view, at + 16, size - 16);
      this.target.onRegion(number(0), number(1), number(2), number(3), values);
    } else if (kind === 4) {
      this.problem = new TextDecoder().decode(new Uint8Array(view.buffer, view.byteOffset + at, size));
      this.onProblem(this.problem);
    } else if (kind === 3) {
      this.onProblem(this.problem);
      this.target.onState({done: Number(view.getBigUint64(at, true)), total: Number(view.getBigUint64(at + 8, true)),
        isFinished: view.getUint8(at + 16) === 1});
    }
  }
}

function halves(view, at, size) {
  const values = new Float32Array(size / 2);
  for (let i = 0; i < values.length; ++i) values[i] = kHalves[view.getUint16(at + 2 * i, true)];
  return values;
}

function floats(view, at, size) {
  return new Float32Array(view.buffer.slice(view.byteOffset + at, view.byteOffset + at + size));
}
