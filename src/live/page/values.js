"use strict";
// The panel of values of the selected part, or of the controls of a program.

const quoted = name => `"${name}"`;
const reaches = new Map();  // the ends of sliders without a valid range by path, which stay while the same part is selected
const unfolded = new Set(); // the titles of the sections whose defaults are shown
let drawn = null;           // the part, and the reload, whose values are in the panel

// Shows the values of the selected part, as in the file, or the controls of a program. A slider that is being dragged stays; afterwards, the keyboard's place is kept.
async function drawSelected() {
  const { possible } = state.edits, part = possible ? view.selected : null, of = `${reload()} ${JSON.stringify(part)}`;
  const stays = () => trying !== null || state.edits.tried.length > 0 && at("values").contains(document.activeElement);
  if (drawn === of || stays()) return;
  const before = drawn;
  drawn = of;
  const answer = part || !possible ? await post("part", part).catch(() => null) : null;
  const info = answer?.ok ? await answer.json() : null;
  if (drawn !== of) return;
  if (stays()) { drawn = before; return; }
  const active = document.activeElement, label = at("values").contains(active) ? active.getAttribute("aria-label") : null, { type } = active;
  at("values").replaceChildren(...info ? partSections(info) : []);
  if (label) [...at("values").querySelectorAll("input")].find(input => input.getAttribute("aria-label") === label && input.type === type)?.focus();
}

function partSections({ title, place, sections, note }) {
  const heading = (title, place) => {
    const made = element("h3", title);
    if (place) { const where = element("small", undefined, { title: place }); where.append(placeLink(place)); made.append(" ", where); }
    return made;
  };
  if (sections.length === 0) return [heading(title, place), element("p", note, { className: "faint" })];
  if (!state.edits.possible) return sections.map(controlSection);
  return sections.map(({ title, values, animated }, index) => {
    const section = element("section"), names = namesOf(values), row = value => valueRow(value, names[values.indexOf(value)], animated.find(({ path }) => path === value.path));
    const written = values.filter(value => !value.is_default), others = values.filter(value => value.is_default);
    section.append(heading(title, index === 0 ? place : null), ...written.map(row));
    if (others.length === 0) return section;
    const more = element("details", undefined, { className: "defaults", open: unfolded.has(title) || written.length === 0 });
    more.append(element("summary", `${others.length} not in the file`, { title: "Shown with their defaults; a change writes them" }), ...others.map(row));
    more.ontoggle = () => unfolded[more.open ? "add" : "delete"](title);
    section.append(more);
    return section;
  });
}

// The controls of a program, each with a way back to its initial value.
function controlSection({ title, values, initial }) {
  const section = element("section", undefined, { className: "program" }), heading = element("h3", title), changed = Object.entries(initial);
  const reset = (text, title, values) => Object.assign(element("button", text, { title, disabled: values.length === 0 }), {
    onclick: async event => {
      // The keyboard stays at the value, since the button is disabled afterwards.
      event.target.closest("label, section").querySelector("input").focus();
      await attempt(values.map(value => value.join("=")));
      keepEdits();
    },
  });
  heading.append(reset("Reset", "All initial values", changed));
  section.append(heading, ...values.map(value => {
    const { path } = value, row = valueRow(value, path), own = changed.filter(([name]) => name === path), first = initial[path]?.replaceAll('"', "");
    if (first !== undefined) row.firstChild.append(element("small", `initially ${first}`));
    const back = reset("↺", first === undefined ? "The initial value" : `Back to ${first}`, own);
    back.setAttribute("aria-label", `${path}: ${back.title}`);
    row.append(back);
    return row;
  }));
  return section;
}

// The last step of each path or, where several values have it, the last two.
function namesOf(values) {
  // A path begins with the kind of the part and its name, which is quoted if it has dots.
  const last = ({ path }, steps) => path.replace(/^\w+\.("[^"]*"|[^.]*)\./, "").split(".").slice(-steps).join(".");
  return values.map(value => last(value, values.filter(other => last(other, 1) === last(value, 1)).length > 1 ? 2 : 1));
}

// What sets a value over time: its key at the shown frame or, without keys, its place in the file.
function animatedNote({ track, is_script, place }) {
  const note = element("small"), where = placeLink(place);
  if (is_script) { note.append("script ", where); return note; }
  const button = element("button", "animated", { type: "button", className: "place", title: "A track sets this value over time: shows its key at this frame" });
  button.onclick = () => { if (!pickAtFrame(track)) note.replaceChildren("animated ", where); };
  note.append(button);
  return note;
}

// A row of a value; one that is set over time shows what the file has, and is not changed there.
function valueRow(value, name, animated) {
  const row = inputRow(value, name, animated ? "div" : "label");
  if (!animated) return row;
  row.firstChild.append(animatedNote(animated));
  row.classList.add("animated");
  row.title = `Set over time: what the file has here, ${value.text}, has no effect`;
  for (const input of row.querySelectorAll("input")) input.disabled = true;
  return row;
}

// Drags within a slider try values; its release writes them.
function inputRow(value, name, kind) {
  const row = element(kind, undefined, { className: "value", title: value.about });
  row.append(element("span", name));
  const input = (type, current, text, attributes = {}, path = value.path) => {
    const made = element("input", undefined, { type, value: current, ...attributes });
    made.setAttribute("aria-label", `${value.path} ${attributes.label ?? ""}`.trim());
    made.oninput = () => { const now = text(made); if (now !== null) attempt([`${path}=${now}`]); };
    made.onchange = keepEdits;
    return made;
  };
  if (value.kind === "flag") {
    row.append(input("checkbox", "", box => String(box.checked), { checked: value.text === "true" }));
  } else if (value.kind === "color") {
    row.append(colorInput(value, input));
  } else if (value.kind === "vector") {
    // A word may precede the numbers, as in Euler(0, 90, 0).
    const start = value.text.indexOf("("), word = value.text.slice(0, start);
    const parts = value.text.slice(start + 1, -1).replace(/,\s*$/, "").split(",").map(part => part.trim() === "" ? NaN : Number(part));
    // Numbers in a notation of RON alone, and comments among them, are changed in the text.
    if (parts.some(Number.isNaN)) { row.append(element("code", value.text)); return row; }
    // Written numbers are changed one by one: the others stay as they are, even if the file has others by now.
    const isWhole = value.is_default || word !== "";
    row.append(...parts.map((part, axis) => input("number", part, box => {
      if (box.value === "") return null;
      parts[axis] = Number(box.value);
      return isWhole ? word + triple(parts) : formatted(parts[axis]);
    }, { step: "any", label: "xyz"[axis] }, isWhole ? value.path : `${value.path}.${axis}`)));
  } else {
    row.append(...numberInputs(value, input));
  }
  return row;
}

function colorInput(value, input) {
  const hex = byte => Math.max(0, Math.min(255, Math.round(byte))).toString(16).padStart(2, "0");
  const isHex = value.text.startsWith('"');
  const color = isHex ? value.text.slice(1, -1) : "#" + value.text.slice(1, -1).split(",").map(part => hex(Number(part))).join("");
  const bytes = text => [1, 3, 5].map(start => parseInt(text.slice(start, start + 2), 16));
  return input("color", color, box => isHex ? `"${box.value}"` : `(${bytes(box.value).join(", ")})`);
}

// A slider over the valid range or, without one, around the value; and the number.
function numberInputs(value, input) {
  const now = Number(value.text), whole = value.kind === "whole";
  const bounded = value.least !== null && value.most !== null && value.most - value.least <= 1000;
  const reach = Math.max(Math.abs(now), 0.5), [from, to] = reaches.get(value.path) ?? [now >= 0 ? 0 : now - reach, now + 2 * reach];
  reaches.set(value.path, [Math.min(from, now), Math.max(to, now)]);
  const low = bounded ? value.least : Math.max(value.least ?? -Infinity, Math.min(from, now));
  const high = bounded ? value.most : Math.min(value.most ?? Infinity, Math.max(to, now));
  const step = whole ? 1 : 10 ** Math.floor(Math.log10(Math.max(high - low, 1e-9) / 200));
  const text = box => box.value === "" ? null : formatted(Number(box.value));
  const slider = input("range", now, box => { number.value = box.value; return text(box); }, { min: low, max: high, step });
  slider.value = now;
  const number = input("number", now, box => { slider.value = box.value; return text(box); }, { step: whole ? 1 : "any" });
  return [slider, number];
}
