"use strict";
// The panel of values of the clicked thing.

async function valuesAt(path) {
  const answer = await post("values", path).catch(() => null);
  return answer?.ok ? answer.json() : [];
}

const quoted = name => `"${name}"`;
const reaches = new Map();  // the ends of sliders without a valid range by path, which stay while the same thing is selected
let selected = "";          // the paths of that thing

// Names are unique in the scene's own file only: other files may have the same ones.
function isInSceneFile(place) {
  const file = place?.replace(/(:\d+)+(, .*)?$/, "").replace(/^\.[\\/]/, "");
  return Boolean(file) && state.scene.endsWith(file);
}

async function drawValues(surface) {
  const parts = [];
  if (surface && state.edits.possible && isInSceneFile(surface.place)) {
    const entity = surface.entity.startsWith("#") ? surface.entity.slice(1) : quoted(surface.entity);
    parts.push([`entity ${surface.entity}`, `entities.${entity}`]);
    if (surface.material) parts.push([`material ${surface.material}`, `materials.${quoted(surface.material)}`]);
    for (const part of parts) part.push(await valuesAt(part[1]));
  }
  const paths = parts.map(part => part[1]).join();
  if (paths !== selected) reaches.clear();
  selected = paths;
  const sections = parts.filter(([, , values]) => values.length > 0).map(([title, , values]) => {
    const section = element("section"), names = namesOf(values);
    section.append(element("h3", title), ...values.map((value, index) => valueRow(value, names[index])));
    return section;
  });
  if (sections.length === 0 && surface?.place && state.edits.possible) {
    const advice = isInSceneFile(surface.place) ? "With a name, its values can be changed here." : "Its values are changed in its own file.";
    sections.push(element("p", advice, { className: "faint" }));
  }
  // A slider that is being dragged stays; afterwards, the keyboard's place is kept.
  if (trying !== null || state.edits.tried.length > 0 && at("values").contains(document.activeElement)) return;
  const label = at("values").contains(document.activeElement) ? document.activeElement.getAttribute("aria-label") : null;
  const type = document.activeElement.type;
  at("values").replaceChildren(...sections);
  if (label) [...at("values").querySelectorAll("input")].find(input => input.getAttribute("aria-label") === label && input.type === type)?.focus();
}

// The last step of each path or, where several values have it, the last two.
function namesOf(values) {
  // A path begins with the kind of the part and its name, which is quoted if it has dots.
  const last = ({ path }, steps) => path.replace(/^\w+\.("[^"]*"|[^.]*)\./, "").split(".").slice(-steps).join(".");
  return values.map(value => last(value, values.filter(other => last(other, 1) === last(value, 1)).length > 1 ? 2 : 1));
}

// Drags within a slider try values; its release writes them.
function valueRow(value, name) {
  const row = element("label", undefined, { className: "value", title: value.about });
  row.append(element("span", name));
  const set = text => attempt([`${value.path}=${text}`]);
  const input = (type, current, text, attributes = {}) => {
    const made = element("input", undefined, { type, value: current, ...attributes });
    made.setAttribute("aria-label", `${value.path} ${attributes.label ?? ""}`.trim());
    made.oninput = () => { const now = text(made); if (now !== null) set(now); };
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
    row.append(...parts.map((part, axis) => input("number", part, box => {
      if (box.value === "") return null;
      parts[axis] = Number(box.value);
      return word + triple(parts);
    }, { step: "any", label: "xyz"[axis] })));
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
