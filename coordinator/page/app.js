// Shows the view that the address names, and the state of the farm above it.

import {Events, loadMe, me} from "./api.js";
import {count, h, setText} from "./dom.js";
import {JobsView} from "./jobs.js";
import {JobView} from "./job.js";
import {WorkersView} from "./workers.js";
import {FarmView} from "./farm.js";
import {SubmitView} from "./submit.js";

const main = document.getElementById("main");
let view = null;
let events = null;

export function note(text, isError = false) {
  const line = h("p", {class: isError ? "note error" : "note"}, text);
  document.getElementById("notes").append(line);
  setTimeout(() => line.remove(), isError ? 12000 : 5000);
}

function makeView(path) {
  const job = path.match(/^\/jobs\/([1-9][0-9]*)(?:\/([0-9]+))?$/);
  if (job) return new JobView(Number(job[1]), Number(job[2] || 0), note);
  if (path.startsWith("/workers")) return new WorkersView(note);
  if (path.startsWith("/farm")) return new FarmView(note);
  if (path.startsWith("/submit")) return new SubmitView(note);
  return new JobsView(note);
}

function show() {
  const path = location.hash.replace(/^#/, "") || "/jobs";
  if (path === "main") return;
  if (view) view.close();
  view = makeView(path);
  main.replaceChildren(view.element);
  document.title = `${view.title} · Tessera`;
  for (const link of document.querySelectorAll("nav a")) {
    const isCurrent = path.startsWith(link.getAttribute("href").slice(1));
    if (isCurrent) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
  scrollTo(0, 0);
  if (events) events.watchJob(view.job ?? null);
  view.start();
}

function showSummary(farm) {
  const jobs = ["preparing", "waiting", "running", "paused"].reduce((sum, state) => sum + (farm.jobs[state] || 0), 0);
  const slots = farm.slots.leased + farm.slots.fetching + farm.slots.loading + farm.slots.idle;
  setText(document.getElementById("summary"),
    `${jobs} open jobs · ${farm.slots.leased}/${slots} slots · ${count(farm.samples_per_second)} samples/s`);
}

function showWho() {
  const who = document.getElementById("who");
  if (me.role) who.append(h("span", {}, `${me.name} (${me.role})`));
  else who.append(h("span", {title: "Programs of other users of this machine may look at the farm"}, "looking"));
  if (!me.logout_proof) return;
  who.append(h("form", {method: "post", action: "/logout"},
    h("input", {type: "hidden", name: "proof", value: me.logout_proof}),
    h("button", {class: "quiet"}, "Log out")));
}

function typing(event) {
  return event.target.closest("input, select, textarea") || event.ctrlKey || event.metaKey || event.altKey;
}

const kKeys = {j: "#/jobs", w: "#/workers", f: "#/farm", s: "#/submit"};

addEventListener("keydown", (event) => {
  if (typing(event)) return;
  if (event.key === "/") {
    const search = document.querySelector("input[type=search]");
    if (search) { event.preventDefault(); search.focus(); }
  } else if (kKeys[event.key] && !(view && view.onKey && view.onKey(event))) {
    location.hash = kKeys[event.key];
  } else if (view && view.onKey) {
    view.onKey(event);
  }
});

async function start() {
  try {
    await loadMe();
  } catch (error) {
    document.getElementById("offline").hidden = false;
    setTimeout(start, 3000);
    return;
  }
  showWho();
  document.getElementById("submit-link").hidden = me.may["Jobs.Submit"] === "none";
  events = new Events((name, data) => {
    if (name === "farm") showSummary(data);
    if (view) view.onEvent(name, data);
  }, (isConnected) => { document.getElementById("offline").hidden = isConnected; });
  addEventListener("hashchange", show);
  show();
}

start();
