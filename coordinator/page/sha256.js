// SHA-256 of files. Browsers compute it of bytes that are in memory and in secure contexts alone, so there is a
// second way for large files and for others.

const kWholeBytesMax = 128 * 2 ** 20;
const kPieceBytes = 4 * 2 ** 20;

// FIPS 180-4: the first 32 bits of the fractional parts of cube and square roots of the first primes.
const kPrimes = (() => {
  const primes = [];
  for (let n = 2; primes.length < 64; ++n) {
    if (primes.every((prime) => n % prime !== 0)) primes.push(n);
  }
  return primes;
})();
const fraction = (value) => ((value - Math.floor(value)) * 2 ** 32) | 0;
const kConstants = Int32Array.from(kPrimes, (prime) => fraction(Math.cbrt(prime)));
const kStart = kPrimes.slice(0, 8).map((prime) => fraction(Math.sqrt(prime)));

export class Sha256 {
  constructor() {
    this.state = Int32Array.from(kStart);
    this.words = new Int32Array(64);
    this.block = new Uint8Array(64);
    this.filled = 0;
    this.size = 0;
  }

  add(bytes) {
    this.size += bytes.length;
    let at = 0;
    if (this.filled > 0) {
      at = Math.min(64 - this.filled, bytes.length);
      this.block.set(bytes.subarray(0, at), this.filled);
      this.filled += at;
      if (this.filled < 64) return;
      this.mix(this.block, 0);
      this.filled = 0;
    }
    for (; at + 64 <= bytes.length; at += 64) this.mix(bytes, at);
    this.block.set(bytes.subarray(at));
    this.filled = bytes.length - at;
  }

  mix(bytes, at) {
    const w = this.words;
    for (let i = 0; i < 16; ++i, at += 4)
      w[i] = (bytes[at] << 24) | (bytes[at + 1] << 16) | (bytes[at + 2] << 8) | bytes[at + 3];
    for (let i = 16; i < 64; ++i) {
      const x = w[i - 15], y = w[i - 2];
      const s0 = ((x >>> 7) | (x << 25)) ^ ((x >>> 18) | (x << 14)) ^ (x >>> 3);
      const s1 = ((y >>> 17) | (y << 15)) ^ ((y >>> 19) | (y << 13)) ^ (y >>> 10);
      w[i] = (w[i - 16] + s0 + w[i - 7] + s1) | 0;
    }
    let [a, b, c, d, e, f, g, k] = this.state;
    for (let i = 0; i < 64; ++i) {
      const s1 = ((e >>> 6) | (e << 26)) ^ ((e >>> 11) | (e << 21)) ^ ((e >>> 25) | (e << 7));
      const t1 = (k + s1 + ((e & f) ^ (~e & g)) + kConstants[i] + w[i]) | 0;
      const s0 = ((a >>> 2) | (a << 30)) ^ ((a >>> 13) | (a << 19)) ^ ((a >>> 22) | (a << 10));
      const t2 = (s0 + ((a & b) ^ (a & c) ^ (b & c))) | 0;
      k = g; g = f; f = e; e = (d + t1) | 0; d = c; c = b; b = a; a = (t1 + t2) | 0;
    }
    [a, b, c, d, e, f, g, k].forEach((value, i) => { this.state[i] += value; });
  }

  // Of all that was added, in hexadecimal. Call it once, last.
  finish() {
    const bits = this.size * 8;
    const end = new Uint8Array((this.filled < 56 ? 64 : 128) - this.filled);
    end[0] = 0x80;
    const view = new DataView(end.buffer);
    view.setUint32(end.length - 8, Math.floor(bits / 2 ** 32));
    view.setUint32(end.length - 4, bits >>> 0);
    this.add(end);
    return Array.from(this.state, (word) => (word >>> 0).toString(16).padStart(8, "0")).join("");
  }
}

const hex = (buffer) => Array.from(new Uint8Array(buffer), (byte) => byte.toString(16).padStart(2, "0")).join("");

// `onBytes` is told how many more bytes were read. Throws if the signal is aborted.
export async function digestOf(blob, onBytes, signal) {
  if (crypto.subtle && blob.size <= kWholeBytesMax) {
    const digest = hex(await crypto.subtle.digest("SHA-256", await blob.arrayBuffer()));
    signal.throwIfAborted();
    onBytes(blob.size);
    return digest;
  }
  const hash = new Sha256();
  for (let at = 0; at < blob.size; at += kPieceBytes) {
    const piece = new Uint8Array(await blob.slice(at, at + kPieceBytes).arrayBuffer());
    signal.throwIfAborted();
    hash.add(piece);
    onBytes(piece.length);
  }
  return hash.finish();
}
