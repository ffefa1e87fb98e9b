// A scene package of chosen files: which paths they have in it, and its manifest (proto/scene_package.h,
// proto/package_names.h).

export const kFilesMax = 10000;
const kPathBytesMax = 4096;
const kFirstLine = "tessera-package 1";
const encoder = new TextEncoder();

function isPackagePath(path) {
  if (path === "" || encoder.encode(path).length > kPathBytesMax || /[\x00-\x1f\x7f\\]/.test(path)) return false;
  return path.split("/").every((part) => part !== "" && part !== "." && part !== "..");
}

// The path of a file that the scene refers to by this name. Empty if the name is too long.
export function packagePath(name) {
  if (isPackagePath(name) && !name.startsWith("names/")) return name;
  const path = "names/" + Array.from(encoder.encode(name), (byte) => {
    const letter = String.fromCharCode(byte);
    return /[A-Za-z0-9_-]/.test(letter) ? letter : "%" + byte.toString(16).toUpperCase().padStart(2, "0");
  }).join("");
  return isPackagePath(path) ? path : "";
}

// How a scene in the folder of `scene` refers to the file `path`: both are paths in the chosen folder.
export function nameFrom(scene, path) {
  const folders = scene.split("/").slice(0, -1), parts = path.split("/");
  let common = 0;
  while (common < folders.length && common < parts.length - 1 && folders[common] === parts[common]) ++common;
  return "../".repeat(folders.length - common) + parts.slice(common).join("/");
}

export const isScene = (path) => /\.pbrt(\.gz)?$/i.test(path);

// Scene files, those that are most likely meant first: high in the folder, then by name.
export function scenesOf(paths) {
  const depth = (path) => path.split("/").length;
  return paths.filter(isScene).sort((a, b) => depth(a) - depth(b) || a.localeCompare(b, undefined, {numeric: true}));
}

// Reading more takes longer than choosing by hand.
const kScenesReadMax = 500;
const kHeadBytes = 65536;

// Scene files, those that are most likely meant first: those that begin a world, as files that others include do not;
// then as scenesOf has them.
export async function likelyScenes(files) {
  const byPath = new Map(files.map((each) => [each.path, each.file]));
  const paths = scenesOf([...byPath.keys()]);
  const isMeant = async (path) => /^\s*WorldBegin\b/m.test(await byPath.get(path).slice(0, kHeadBytes).text());
  const meant = new Set();
  for (const path of paths.slice(0, kScenesReadMax)) {
    if (await isMeant(path)) meant.add(path);
  }
  return [...paths.filter((path) => meant.has(path)), ...paths.filter((path) => !meant.has(path))];
}

function compareBytes(a, b) {
  const x = encoder.encode(a), y = encoder.encode(b);
  for (let i = 0; i < Math.min(x.length, y.length); ++i) {
    if (x[i] !== y[i]) return x[i] - y[i];
  }
  return x.length - y.length;
}

// `files` have path, digest and size.
export function manifestOf(files) {
  const sorted = [...files].sort((a, b) => compareBytes(a.path, b.path));
  return [kFirstLine, ...sorted.map((file) => `${file.digest} ${file.size} ${file.path}`)].join("\n") + "\n";
}

// The files of a drop or of an input, as {path, file}. The name of a folder that all are in is left out, and so
// are hidden files and folders.
export async function chosenFiles(transfer, list) {
  const found = [];
  const entries = Array.from((transfer && transfer.items) || [], (item) => item.webkitGetAsEntry && item.webkitGetAsEntry())
    .filter((entry) => entry);
  for (const entry of entries) await addEntry(entry, entry.name, found);
  if (entries.length === 0) {
    for (const file of list || []) found.push({path: file.webkitRelativePath || file.name, file});
  }
  const folder = found.length > 0 ? found[0].path.split("/")[0] + "/" : "";
  const isShared = found.every((each) => each.path.startsWith(folder));
  const files = isShared ? found.map((each) => ({...each, path: each.path.slice(folder.length)})) : found;
  return {folder: isShared ? folder.slice(0, -1) : "", files: files.filter((each) => !/(^|\/)\./.test(each.path))};
}

async function addEntry(entry, path, found) {
  if (found.length > kFilesMax) return;
  if (entry.isFile) {
    found.push({path, file: await new Promise((resolve, reject) => entry.file(resolve, reject))});
    return;
  }
  const reader = entry.createReader();
  while (true) {  // a reader gives some of the entries at a time
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) return;
    for (const each of some) await addEntry(each, `${path}/${each.name}`, found);
  }
}
