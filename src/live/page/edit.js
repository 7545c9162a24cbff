"use strict";
// Values and views that are changed by hand: tried at once, then written into the files.

const DRAG = 4;            // pixels from which on a press is a drag, not a click
const TURN = 0.006;        // radians per pixel
const DOLLY = 0.0015;      // share of the distance, as a logarithm, per unit of the wheel
const PATIENCE = 250;      // milliseconds to wait for the picture of a try before the next one

let trying = null;         // the values of the try that waits, or true while one is under way and none waits
let dragged = null;        // { view, x, y, kind }: the camera when the drag began
let moved = false;         // the click that follows a drag belongs to it

async function edit(what) {
  const answer = await post("edit", what).catch(() => null);
  const refused = answer === null ? "the server is away" : answer.ok ? "" : await answer.text();
  write(at("refused"), refused.split("\n")[0]);
  at("refused").title = refused;
  return refused === "";
}

// Tries values, the last of those that arrive while another try is under way.
async function attempt(values) {
  if (trying !== null) { trying = values; return; }
  trying = true;
  while (values) {
    await edit({ try: values });
    const reloads = state.reloads, start = performance.now();
    while (!(shown && shown.reloads >= reloads) && performance.now() - start < PATIENCE) await new Promise(requestAnimationFrame);
    values = trying === true ? null : trying;
    trying = true;
  }
  trying = null;
}

async function settled() {
  while (trying !== null) await new Promise(requestAnimationFrame);
}

// Writes what is tried into the files.
async function keepEdits() {
  await settled();
  if (state.edits.tried.length > 0) await edit("keep");
}

async function dropEdits() {
  await settled();
  if (state.edits.tried.length > 0) await edit("drop");
}

const undo = () => { if (!at("undo").disabled) edit("undo"); };

// Numbers as one would write them.
const written = number => { const text = String(Number(number.toPrecision(7))); return text.includes("e") ? number.toFixed(12).replace(/0+$/, "0") : text; };
const triple = vector => `(${vector.map(written).join(", ")})`;

// The camera.

const add = (a, b, scale = 1) => a.map((number, axis) => number + scale * b[axis]);
const dot = (a, b) => a.reduce((sum, number, axis) => sum + number * b[axis], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => { const length = Math.hypot(...a); return length > 0 ? a.map(number => number / length) : [0, 1, 0]; };
// Rodrigues' formula.
function turned(vector, axis, angle) {
  const parallel = dot(axis, vector) * (1 - Math.cos(angle));
  return add(add(vector.map(number => number * Math.cos(angle)), cross(axis, vector), Math.sin(angle)), axis, parallel);
}

// The view after a movement of the pointer by `right` and `down` pixels.
function movedView({ position, target, up, right_handed }, kind, right, down) {
  const offset = add(position, target, -1), pole = unit(up), hand = right_handed ? -1 : 1;
  const side = unit(cross(pole, offset)).map(number => -hand * number);  // to the right in the picture
  if (kind === "pan") {
    const { height } = at("film").getBoundingClientRect(), scale = Math.hypot(...offset) / height;
    const rise = unit(cross(side, offset)).map(number => hand * number);
    const shift = add(side.map(number => -scale * right * number), rise, scale * down);
    return { position: add(position, shift), target: add(target, shift) };
  }
  // Up to 3 degrees before the pole.
  const height = Math.acos(Math.max(-1, Math.min(1, dot(unit(offset), pole))));
  const lift = Math.max(0.05, Math.min(Math.PI - 0.05, height - TURN * down)) - height;
  const around = turned(offset, pole, hand * TURN * right);
  const axis = unit(cross(pole, around));
  return { position: add(target, turned(around, axis, lift)), target };
}

function setView(view, { position, target }) {
  const values = [`${view.path}.position=${triple(position)}`];
  values.push(view.has_direction ? `${view.path}.view=${triple(add(target, position, -1))}` : `${view.path}.target=${triple(target)}`);
  attempt(values);
}

async function currentView() {
  const answer = await fetch("camera", { method: "POST" }).catch(() => null);
  return answer?.ok ? answer.json() : null;
}

function beginDrag(event) {
  if (event.button > 2 || at("film").classList.contains("wipe") || !state?.edits.possible) return;
  dragged = { view: null, x: event.clientX, y: event.clientY, kind: event.shiftKey || event.button > 0 ? "pan" : "orbit", begun: false };
  moved = false;
}

async function drag(event) {
  if (!dragged) return;
  const right = event.clientX - dragged.x, down = event.clientY - dragged.y;
  if (!dragged.begun) {
    if (Math.hypot(right, down) < DRAG) return;
    dragged.begun = moved = true;
    at("film").setPointerCapture(event.pointerId);
    if (playing) pause();
    const own = dragged;
    own.view = await currentView();
    if (!own.view) write(at("refused"), "the scene moves this camera, or points it to an entity: change that in the file");
  }
  if (dragged?.view) setView(dragged.view, movedView(dragged.view, dragged.kind, right, down));
}

let wheeling = null;  // { view, factor }, until the wheel rests
async function dolly(event) {
  if (view.zoom > 0 || !state?.edits.possible || event.ctrlKey) return;
  event.preventDefault();
  if (!wheeling) {
    wheeling = { view: null, factor: 1 };
    const own = wheeling;
    own.view = await currentView();
  }
  wheeling.factor *= Math.exp(DOLLY * event.deltaY);
  clearTimeout(wheeling.rest);
  const own = wheeling;
  own.rest = setTimeout(() => { if (wheeling === own) wheeling = null; }, 300);
  if (!own.view) return;
  const { position, target } = own.view;
  setView(own.view, { position: add(target, add(position, target, -1), own.factor), target });
}

// The panel of values.

async function valuesAt(path) {
  const answer = await post("values", path).catch(() => null);
  return answer?.ok ? answer.json() : [];
}

const quoted = name => `"${name}"`;

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
  const sections = parts.filter(([, , values]) => values.length > 0).map(([title, path, values]) => {
    const section = element("section"), names = namesOf(path, values);
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

// The last step of each path or, where several values of the part have it, the last two.
function namesOf(part, values) {
  const last = ({ path }, steps) => path.slice(part.length + 1).split(".").slice(-steps).join(".");
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
    const parts = value.text.slice(1, -1).split(",").map(part => Number(part));
    row.append(...parts.map((part, axis) => input("number", part, box => {
      if (box.value === "") return null;
      parts[axis] = Number(box.value);
      return triple(parts);
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
  const reach = Math.max(Math.abs(now), 0.5);
  const low = bounded ? value.least : Math.max(value.least ?? -Infinity, now >= 0 ? 0 : now - reach);
  const high = bounded ? value.most : Math.min(value.most ?? Infinity, now + 2 * reach);
  const step = whole ? 1 : 10 ** Math.floor(Math.log10(Math.max(high - low, 1e-9) / 200));
  const text = box => box.value === "" ? null : written(Number(box.value));
  const slider = input("range", now, box => { number.value = box.value; return text(box); }, { min: low, max: high, step });
  slider.value = now;
  const number = input("number", now, box => { slider.value = box.value; return text(box); }, { step: whole ? 1 : "any" });
  return [slider, number];
}

function drawEdits() {
  const { tried, undoable, notice, possible } = state.edits;
  at("undo").disabled = undoable === 0;
  at("undo").hidden = !possible;
  at("unsaved").hidden = tried.length === 0 || dragged !== null && !dragged.begun;
  if (notice) write(at("refused"), notice);
}

at("film").addEventListener("pointerdown", beginDrag);
at("film").addEventListener("pointermove", drag);
for (const end of ["pointerup", "pointercancel"]) at("film").addEventListener(end, () => { dragged = null; });
at("film").addEventListener("contextmenu", event => { if (moved) event.preventDefault(); });
at("view").addEventListener("wheel", dolly, { passive: false });
at("undo").onclick = undo;
at("keep").onclick = keepEdits;
at("drop").onclick = dropEdits;
