// A list of any length of which only the rows in sight are elements. Rows have one height; the server sorts, filters
// and sends the part that is shown.

import {h, setText} from "./dom.js";

const kMargin = 8;  // rows above and below those in sight
const kFetchInterval_ms = 30;  // between requests while the list is scrolled

// Runs an action at intervals for as long as it is requested: the first time right away, and after the last request once
// more.
export class Throttle {
  constructor(interval_ms, action) {
    this.interval = interval_ms;
    this.action = action;
    this.timer = 0;
    this.ranAt = -Infinity;
  }

  request() {
    if (this.timer) return;
    const rest = this.interval - (performance.now() - this.ranAt);
    this.timer = setTimeout(() => {
      this.timer = 0;
      this.ranAt = performance.now();
      this.action();
    }, Math.max(rest, 0));
  }

  cancel() {
    clearTimeout(this.timer);
    this.timer = 0;
  }
}

export class VirtualList {
  // `load(offset, limit)` resolves to {total, rows}; `makeRow()` returns {element, show(row)}; onTotal(total) is called
  // when rows were loaded.
  constructor({label, load, makeRow, onTotal, empty}) {
    this.load = load;
    this.onTotal = onTotal;
    this.makeRow = makeRow;
    this.rows = new Map();   // by index, as loaded last
    this.shown = new Map();  // index -> row element and its show()
    this.total = 0;
    this.generation = 0;
    // Loads what is in sight.
    this.fetching = new Throttle(kFetchInterval_ms, () => this.refresh().catch(() => {}));
    this.filler = h("div", {class: "list-filler", role: "list", "aria-label": label});
    this.empty = h("p", {class: "none", hidden: true}, empty);
    this.element = h("div", {class: "list"}, this.empty, this.filler);
    this.onScroll = () => { this.render(); this.fetching.request(); };
    addEventListener("scroll", this.onScroll, {passive: true});
    addEventListener("resize", this.onScroll, {passive: true});
  }

  close() {
    removeEventListener("scroll", this.onScroll);
    removeEventListener("resize", this.onScroll);
    this.fetching.cancel();
  }

  rowHeight() {
    return parseFloat(getComputedStyle(this.element).getPropertyValue("--row")) || 60;
  }

  // The rows in sight, with the margin.
  window() {
    const height = this.rowHeight();
    const top = -this.filler.getBoundingClientRect().top;
    const first = Math.max(0, Math.floor(top / height) - kMargin);
    const last = Math.ceil((top + innerHeight) / height) + kMargin;
    return {first, last: Math.max(first, last), height};
  }

  // Loads what is in sight again. `reset`: the list is another one.
  async refresh(reset = false) {
    if (reset) { this.rows.clear(); ++this.generation; }
    const generation = this.generation;
    const {first, last} = this.window();
    if (this.loading && !reset) {
      this.isWanted = true;
      return;
    }
    this.loading = true;
    this.isWanted = false;
    try {
      const {total, rows} = await this.load(first, Math.min(last - first, 200));
      if (generation !== this.generation) return;
      this.total = total;
      this.onTotal(total);
      rows.forEach((row, i) => this.rows.set(first + i, row));
      this.render();
    } finally {
      this.loading = false;
      if (this.isWanted) this.fetching.request();
    }
  }

  render() {
    const {first, last, height} = this.window();
    this.empty.hidden = this.total > 0;
    this.filler.style.height = `${this.total * height}px`;
    const end = Math.min(last, this.total);
    const free = [];
    for (const [index, row] of this.shown) {
      if (index >= first && index < end) continue;
      this.shown.delete(index);
      free.push(row);
    }
    for (let index = first; index < end; ++index) {
      let row = this.shown.get(index);
      if (!row) {
        row = free.pop() || this.add();
        this.shown.set(index, row);
      }
      row.element.style.transform = `translateY(${index * height}px)`;
      row.element.setAttribute("aria-posinset", index + 1);
      row.element.setAttribute("aria-setsize", this.total);
      const data = this.rows.get(index);
      row.element.classList.toggle("pending", !data);
      if (data) row.show(data);
    }
    for (const row of free) row.element.remove();
  }

  add() {
    const row = this.makeRow();
    row.element.setAttribute("role", "listitem");
    this.filler.append(row.element);
    return row;
  }
}

// Buttons that sort a list: [key, text, class].
export function sortButtons(columns, sort, onSort) {
  const buttons = columns.map(([key, text, name]) => {
    const button = h("button", {class: `sort ${name || ""}`, type: "button"}, text);
    if (key) button.addEventListener("click", () => onSort(key));
    else button.disabled = true;
    return button;
  });
  const show = () => columns.forEach(([key, text], i) => {
    const isSorted = key && key === sort.key;
    const order = sort.order === "desc" ? "descending" : "ascending";
    setText(buttons[i], isSorted ? `${text} ${sort.order === "desc" ? "▾" : "▴"}` : text);
    if (key) buttons[i].setAttribute("aria-label", isSorted ? `${text}, sorted ${order}` : `Sort by ${text}`);
  });
  show();
  return {buttons, show};
}
