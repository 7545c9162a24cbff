"use strict";
// The list of the scene's parts. A part that is chosen there, or by a click on the picture, stays selected until another one is.

let outline = null;      // { of, rows }: the list, as in the file after the reload `of`
let listing = null;      // { of }: the list that is being fetched
let reveals = false;     // true if the next list opens what holds the selected part
let current = null;      // the key of the row that the keyboard is at
let openRows = null;     // the keys of the open rows; null for the default
const wide = matchMedia("(min-width: 761px)");

const isSelected = part => part !== null && JSON.stringify(part) === JSON.stringify(view.selected);

// Fetches the list after every change of the file.
function fetchOutline() {
  at("outline").hidden = !state.edits.possible || state.reloads === 0;
  if (!at("outline").hidden && at("outline").open && (listing ?? outline)?.of !== reload() && state.edits.tried.length === 0) list();
}

async function list() {
  const of = reload(), filter = at("outline-filter").value.trim(), own = listing = { of };
  const answer = await post("outline", { filter, open: openRows, selected: view.selected, reveals }).catch(() => null);
  const rows = answer?.ok ? await answer.json() : null;
  if (listing !== own) return;
  listing = null;
  if (!rows) return;
  outline = { of, rows };
  // While a filter shows all that it finds, what is open stays as it was.
  if (filter === "") openRows = rows.filter(row => row.is_open).map(row => row.key);
  drawOutline();
  if (reveals) scrollToRow(at("outline-rows").querySelector("[aria-selected=true]"), at("outline-rows"));
  reveals = false;
}

// Scrolls the list to a row, and nothing around it.
function scrollToRow(row, box) {
  if (row) box.scrollTop += row.getBoundingClientRect().top - box.getBoundingClientRect().top - box.clientHeight / 2;
}

const reveal = () => { reveals = true; list(); };

function drawOutline() {
  const place = at("outline-rows"), focused = place.contains(document.activeElement), { rows } = outline;
  if (!rows.some(row => row.key === current)) current = (rows.find(row => isSelected(row.part)) ?? rows[0])?.key ?? null;
  place.replaceChildren(...rows.map(outlineRow));
  if (rows.length === 0) place.append(element("p", "Nothing has this name.", { className: "faint" }));
  // The keyboard's place is kept.
  if (focused) rowOf(current)?.focus();
}

const rowOf = key => [...at("outline-rows").children].find(row => row.dataset.key === key);

function outlineRow({ part, key, name, kind, level, count, is_open }) {
  const row = element("div", undefined, { className: "part", title: name });
  row.dataset.key = key;
  row.style.setProperty("--level", level);
  if (part === null && count === 0) { row.classList.add("faint"); row.setAttribute("role", "none"); row.append(name); return row; }
  row.setAttribute("role", "treeitem");
  row.setAttribute("aria-level", level);
  if (part) row.setAttribute("aria-selected", isSelected(part));
  if (count > 0) row.setAttribute("aria-expanded", is_open);
  row.tabIndex = key === current ? 0 : -1;
  const twist = element("span", count > 0 ? is_open ? "▾" : "▸" : "", { className: "twist" });
  twist.setAttribute("aria-hidden", "true");
  row.append(twist, element("span", name, { className: part ? "" : "heading" }));
  if (kind || count > 0) row.append(element("small", [kind, count > 0 ? count : ""].filter(Boolean).join(" · ")));
  row.onclick = event => {
    moveTo(row);
    if (part && event.target !== twist) select(part);
    else if (count > 0) toggleRow(key, !is_open);
  };
  return row;
}

function toggleRow(key, opens) {
  openRows = openRows.filter(open => open !== key);
  if (opens) openRows.push(key);
  list();
}

function moveTo(row) {
  if (!row) return;
  rowOf(current)?.setAttribute("tabindex", "-1");
  current = row.dataset.key;
  row.tabIndex = 0;
  row.focus();
}

at("outline-rows").onkeydown = event => {
  const all = [...at("outline-rows").querySelectorAll("[role=treeitem]")], index = all.findIndex(row => row.dataset.key === current);
  const row = outline?.rows.find(row => row.key === current);
  if (!row || event.ctrlKey || event.altKey || event.metaKey) return;
  const level = row => Number(row.getAttribute("aria-level"));
  const actions = {
    ArrowDown: () => moveTo(all[index + 1]), ArrowUp: () => moveTo(all[index - 1]), Home: () => moveTo(all[0]), End: () => moveTo(all.at(-1)),
    ArrowRight: () => { if (row.count > 0 && !row.is_open) toggleRow(row.key, true); else if (row.is_open) moveTo(all[index + 1]); },
    ArrowLeft: () => { if (row.is_open) toggleRow(row.key, false); else moveTo(all.slice(0, index).findLast(other => level(other) < row.level)); },
    Enter: () => row.part ? select(row.part) : toggleRow(row.key, !row.is_open),
  };
  const action = actions[event.key === " " ? "Enter" : event.key];
  if (!action) return;
  action();
  event.preventDefault();
  event.stopPropagation();
};

// Selects a part; what holds it in the list is opened for one that is chosen elsewhere.
function select(part, isElsewhere = false) {
  const differs = !isSelected(part);
  Object.assign(view, { selected: part });
  keep();
  if (differs) reaches.clear();
  drawSelected();
  fetchPlacement();
  for (const row of at("outline-rows").querySelectorAll("[aria-selected]")) row.setAttribute("aria-selected", isSelected(outline.rows.find(({ key }) => key === row.dataset.key).part));
  if (isElsewhere && at("outline").open) reveal();
}

const openIfWide = () => { at("outline").open = view.outline ?? wide.matches; };
wide.onchange = openIfWide;
openIfWide();
at("outline").addEventListener("toggle", () => {
  if (at("outline").open !== (view.outline ?? wide.matches)) { view.outline = at("outline").open; keep(); }
  if (state) fetchOutline();
});
at("outline-filter").oninput = () => { if (state) list(); };
at("outline-filter").onkeydown = event => {
  if (event.key === "Escape" && at("outline-filter").value !== "") { at("outline-filter").value = ""; reveal(); event.preventDefault(); }
  if (event.key === "ArrowDown") { moveTo(at("outline-rows").querySelector("[role=treeitem]")); event.preventDefault(); }
  event.stopPropagation();
};

// Selects the part that was edited last in the file.
let followed = null;  // the reload of the edit whose part was selected last
function followEdit(isFirst) {
  const { edited } = state, of = edited && `${state.session} ${edited.reloads}`;
  if (of === followed) return;
  followed = of;
  if (edited && !isFirst) select(edited.part, true);
}
