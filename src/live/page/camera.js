"use strict";
// The camera, turned and moved by drags and the wheel.

const DRAG = 4;            // pixels from which on a press is a drag, not a click
const TURN = 0.006;        // radians per pixel
const POLE_MARGIN = 0.05;  // radians that the view keeps from straight up and down
const DOLLY = 0.0015;      // share of the distance, as a logarithm, per unit of the wheel
const WHEEL_REST = 300;    // milliseconds after which the wheel rests

let dragged = null;        // { x, y, kind, begun, view, right, down }: the press, the camera then, and the movement since
let wheeling = null;       // { factor, view }, until the wheel rests
let moved = false;         // the click that follows a drag belongs to it

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
  const height = Math.acos(Math.max(-1, Math.min(1, dot(unit(offset), pole))));
  const lift = Math.max(POLE_MARGIN, Math.min(Math.PI - POLE_MARGIN, height - TURN * down)) - height;
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

// Applies a movement to the camera of its beginning, which may arrive after the movement.
async function beginView(movement, apply) {
  movement.view = await currentView();
  if (movement.view) apply(movement);
  else write(at("refused"), "the scene moves this camera, or points it to an entity: change that in the file");
}

const turn = ({ view, kind, right, down }) => setView(view, movedView(view, kind, right, down));

function approach({ view, factor }) {
  const { position, target } = view;
  setView(view, { position: add(target, add(position, target, -1), factor), target });
}

function beginDrag(event) {
  if (event.button > 2 || at("film").classList.contains("wipe") || !state?.edits.possible) return;
  const kind = event.shiftKey || event.button > 0 ? "pan" : "orbit";
  dragged = { x: event.clientX, y: event.clientY, kind, begun: false, view: null };
  moved = false;
}

function drag(event) {
  if (!dragged) return;
  dragged.right = event.clientX - dragged.x;
  dragged.down = event.clientY - dragged.y;
  if (dragged.view) turn(dragged);
  if (dragged.begun || Math.hypot(dragged.right, dragged.down) < DRAG) return;
  dragged.begun = moved = true;
  at("film").setPointerCapture(event.pointerId);
  if (playing) pause();
  beginView(dragged, turn);
}

function dolly(event) {
  if (view.zoom > 0 || !state?.edits.possible || event.ctrlKey) return;
  event.preventDefault();
  const begins = wheeling === null, own = wheeling ??= { factor: 1, view: null };
  own.factor *= Math.exp(DOLLY * event.deltaY);
  clearTimeout(own.rest);
  own.rest = setTimeout(() => { if (wheeling === own) wheeling = null; }, WHEEL_REST);
  if (begins) beginView(own, approach);
  else if (own.view) approach(own);
}

at("film").addEventListener("pointerdown", beginDrag);
at("film").addEventListener("pointermove", drag);
for (const end of ["pointerup", "pointercancel"]) at("film").addEventListener(end, () => { dragged = null; });
at("film").addEventListener("contextmenu", event => { if (moved) event.preventDefault(); });
at("view").addEventListener("wheel", dolly, { passive: false });
