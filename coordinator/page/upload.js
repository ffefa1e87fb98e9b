// Sends files that the farm lacks, a few at a time. An upload that breaks goes on where it stopped.

import {me, post} from "./api.js";

const kUploads = 3;
const kDigestsPerCall = 500;
const kAttemptsMax = 6;
const kAttemptPause_ms = 1000;

const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

async function missingOf(digests, signal) {
  const missing = new Map();
  for (let at = 0; at < digests.length; at += kDigestsPerCall) {
    signal.throwIfAborted();
    const answer = await again(() => post("blobs/missing", {digests: digests.slice(at, at + kDigestsPerCall)}), signal);
    for (const each of answer.missing) missing.set(each.digest, each.held);
  }
  return missing;
}

// Tries what fails because the coordinator is busy or away a few times.
async function again(action, signal) {
  for (let attempt = 1; ; ++attempt) {
    try {
      return await action();
    } catch (error) {
      const isPassing = error.status === 503 || error.status === undefined || error.status === 0;
      if (signal.aborted || !isPassing || attempt === kAttemptsMax) throw error;
      await pause(kAttemptPause_ms * attempt);
    }
  }
}

class UploadError extends Error {
  constructor(status, reason) {
    super(reason);
    this.status = status;
  }
}

// fetch does not tell how much was sent.
function put(digest, blob, offset, onSent, signal) {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    const stop = () => request.abort();
    signal.addEventListener("abort", stop);
    request.open("PUT", `/api/v1/blobs/${digest}?offset=${offset}`);
    request.setRequestHeader("X-Tessera-Proof", me.proof);
    request.setRequestHeader("Content-Type", "application/octet-stream");
    request.upload.onprogress = (event) => onSent(event.loaded);
    request.onloadend = () => {
      signal.removeEventListener("abort", stop);
      if (request.status === 200) return resolve();
      let reason = request.status ? `the coordinator answered with ${request.status}` : "the connection broke";
      try { reason = JSON.parse(request.responseText).error || reason; } catch { /* no reason was given */ }
      reject(new UploadError(request.status, reason));
    };
    request.send(blob.slice(offset));
  });
}

async function send(digest, file, held, onBytes, signal) {
  let offset = held, counted = 0;
  const count = (bytes) => { onBytes(bytes - counted); counted = bytes; };
  count(offset);
  await again(async () => {
    try {
      await put(digest, file, offset, (sent) => count(offset + sent), signal);
      count(file.size);
    } catch (error) {
      if (signal.aborted) throw error;
      const missing = await missingOf([digest], signal);
      if (!missing.has(digest)) return count(file.size);
      offset = missing.get(digest);
      count(offset);
      throw error;
    }
  }, signal);
}

// `blobs`: file by digest. `onProgress` is told how many bytes were sent of how many.
export async function uploadMissing(blobs, onProgress, signal) {
  const missing = await missingOf([...blobs.keys()], signal);
  const waiting = [...missing.keys()];
  const total = waiting.reduce((sum, digest) => sum + blobs.get(digest).size, 0);
  let sent = 0;
  const onBytes = (bytes) => { sent += bytes; onProgress(sent, total); };
  onBytes(0);
  const work = async () => {
    for (let digest = waiting.shift(); digest !== undefined; digest = waiting.shift()) {
      signal.throwIfAborted();
      await send(digest, blobs.get(digest), missing.get(digest), onBytes, signal);
    }
  };
  await Promise.all(Array.from({length: kUploads}, work));
  return {files: missing.size, bytes: total};
}
