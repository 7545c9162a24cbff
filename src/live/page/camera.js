"use strict";
// The camera, moved by drags, the wheel and keys.

const DRAG = 4;            // pixels from which on a press is a drag, not a click
const TURN = 0.006;        // radians per pixel
const POLE_MARGIN = 0.05;  // radians that the view keeps from straight up and down
const DOLLY = 0.0015;      // share of the distance, as a logarithm, per unit of the wheel
const WHEEL_REST = 300;    // milliseconds after which the wheel rests
const TILT = 1e-4;         // radians from straight above or below, to the front, by which views from there differ
const NEAREST = 0.1;       // share of the distance that the camera keeps from a near point on which it is centred

let dragged = null;        // { x, y, pixel, kind, begun, view, right, down }: the press, the camera then, and the movement since
let wheeling = null;       // { factor, view }, until the wheel rests
let moved = false;         // the click that follows a drag belongs to it
let hovered = null;        // the pixel under the pointer

const add = (a, b, scale = 1) => a.map((number, axis) => number + scale * b[axis]);
const scaled = (a, scale) => a.map(number => scale * number);
const dot = (a, b) => a.reduce((sum, number, axis) => sum + number * b[axis], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => { const length = Math.hypot(...a); return length > 0 ? scaled(a, 1 / length) : [0, 1, 0]; };
const handOf = ({ right_handed }) => right_handed ? -1 : 1;
const distanceOf = ({ position, target }) => Math.hypot(...add(target, position, -1));
// Rodrigues' formula.
function turned(vector, axis, angle) {
  const parallel = dot(axis, vector) * (1 - Math.cos(angle));
  return add(add(scaled(vector, Math.cos(angle)), cross(axis, vector), Math.sin(angle)), axis, parallel);
}

// The directions of a picture in the scene. A view along `up` has another one, as in the renderer.
function directions({ position, target, up, roll, right_handed }) {
  const forward = unit(add(target, position, -1));
  const across = [up, [0, 1, 0], [0, 0, 1]].map(up => cross(unit(up), forward)).find(across => Math.hypot(...across) > 1e-12);
  const side = unit(across), top = cross(forward, side), level = right_handed ? scaled(side, -1) : side;
  const right = add(scaled(level, Math.cos(roll)), top, Math.sin(roll)), rise = add(scaled(top, Math.cos(roll)), level, -Math.sin(roll));
  return { forward, level, right, rise };
}

// Turns a vector along the view, or against it: about `up`, then away from it.
function swung(view, vector, right, away) {
  const { forward, level } = directions(view), pole = unit(view.up), hand = handOf(view);
  const height = Math.acos(Math.max(-1, Math.min(1, dot(unit(vector), pole))));
  const lift = Math.max(POLE_MARGIN, Math.min(Math.PI - POLE_MARGIN, height + away)) - height;
  const axis = scaled(level, hand * Math.sign(dot(vector, forward)));
  return turned(turned(vector, pole, hand * right), turned(axis, pole, hand * right), lift);
}

// The view after a movement of the pointer by `right` and `down` pixels. Its target stays in place or, for `pan`, the point that was pressed
// stays under the pointer.
function movedView(view, kind, right, down) {
  const { position, target, pixel_size } = view;
  if (kind === "pan") {
    const axes = directions(view), box = at("film").getBoundingClientRect(), [width, height] = film();
    const depth = view.is_orthographic ? 1 : view.depth;
    const across = right * width / box.width * pixel_size[0] * depth, downwards = down * height / box.height * pixel_size[1] * depth;
    const shift = add(scaled(axes.right, -across), axes.rise, downwards);
    return { position: add(position, shift), target: add(target, shift) };
  }
  return { position: add(target, swung(view, add(position, target, -1), TURN * right, -TURN * down)), target };
}

// Tries a view. Tracks of the camera get keys at the frame; without a track, the field of the camera changes. A camera that is moved by
// something else stays: the view is only looked from.
function setView(view, { position, target }) {
  showGizmo({ ...view, position, target });
  lookAtPlacement({ ...view, position, target });
  if (view.look || looksFree()) { attemptEdit({ look: { position, target, up: view.up, is_free: looksFree() } }); return; }
  const [field, vector] = view.has_direction ? ["view", add(target, position, -1)] : ["target", target];
  attemptAt([
    { path: `${view.path}.position`, key: view.position_key, text: triple(position) },
    { path: `${view.path}.${field}`, key: view.target_key, text: triple(vector) },
  ]);
}

// The camera of the requested frame; the reason is shown if it cannot be moved.
async function currentView() {
  if (playing) pause();
  while (requested !== null || scrubbed !== null) await new Promise(requestAnimationFrame);
  const answer = await post("camera").catch(() => null);
  if (answer?.ok) return answer.json();
  write(at("refused"), await answer?.text() ?? "the server is away");
  return null;
}

async function pointAt(pixel) {
  const answer = await post("probe", pixel).catch(() => null);
  return answer?.ok ? (await answer.json())?.surface?.point : undefined;
}

// How far a point is in front of the camera; without a point, the target.
const depthOf = (view, point = view.target) => dot(add(point, view.position, -1), directions(view).forward);

// Applies a movement to the camera of its beginning, which may arrive after the movement.
async function beginView(movement, apply) {
  const [view, point] = await Promise.all([currentView(), movement.kind === "pan" ? pointAt(movement.pixel) : undefined]);
  if (!view) return;
  movement.view = { ...view, depth: depthOf(view, point) };
  apply(movement);
}

const turn = ({ view, kind, right, down }) => setView(view, movedView(view, kind, right, down));

function approach({ view, factor }) {
  const { position, target } = view;
  if (view.is_orthographic && (view.look || looksFree())) { write(at("refused"), view.look ?? "a view with parallel rays is not magnified while the path is shown"); return; }
  if (view.is_orthographic) { attempt([`${view.path}.orthographic=${formatted(factor * view.pixel_size[1] * film()[1])}`]); return; }
  setView(view, { position: add(target, add(position, target, -1), factor), target });
}

// Centres the view on a visible point, which becomes the target. Direction and distance stay.
async function focusOn(pixel) {
  if (!state?.edits.possible) return;
  const [camera, point] = await Promise.all([currentView(), pointAt(pixel)]);
  if (!camera) return;
  if (!point) { write(at("refused"), "there is no shape at this pixel"); return; }
  const depth = Math.max(depthOf(camera, point), NEAREST * distanceOf(camera));
  setView(camera, { position: add(point, directions(camera).forward, -depth), target: point });
  if (view.spot) { view.spot = centre(); keep(); mark(); }
}

// The sides of the scene by the keys of a numeric pad: from the target to the eye. x is to the right in front, if it is not up.
const sides = {
  1: camera => scaled(cross(sides[3](camera), sides[7](camera)), -handOf(camera)),
  3: camera => sides[7](camera)[0] === 0 ? [1, 0, 0] : [0, 1, 0],
  7: ({ up }) => {
    const sizes = up.map(Math.abs), axis = sizes.indexOf(Math.max(...sizes));
    return up.map((number, index) => index === axis ? Math.sign(number) : 0);
  },
  9: ({ position, target }) => unit(add(target, position, -1)),
};

// Looks at the target from a side. Scenes must not have a view along `up`.
async function lookFrom(side) {
  const camera = state?.edits.possible ? await currentView() : null;
  if (!camera) return;
  const towards = side(camera), isSteep = Math.hypot(...cross(towards, unit(camera.up))) < TILT / 2;
  const away = isSteep ? unit(add(towards, sides[1](camera), TILT)) : towards;
  setView(camera, { position: add(camera.target, away, distanceOf(camera)), target: camera.target });
}

function beginDrag(event) {
  if (event.button > 2 || at("film").classList.contains("wipe") || !state?.edits.possible || flying) return;
  const kind = event.button === 2 ? "fly" : event.shiftKey || event.button === 1 ? "pan" : "orbit";
  dragged = { x: event.clientX, y: event.clientY, pixel: pixelOf(event), kind, begun: false, view: null };
  moved = false;
}

function drag(event) {
  hovered = pixelOf(event);
  if (flying) { if (flying.held && !(event.buttons & 2)) land(); else look(event); return; }
  if (!dragged) return;
  dragged.right = event.clientX - dragged.x;
  dragged.down = event.clientY - dragged.y;
  if (dragged.view) turn(dragged);
  if (dragged.begun || Math.hypot(dragged.right, dragged.down) < DRAG) return;
  dragged.begun = moved = true;
  at("film").setPointerCapture(event.pointerId);
  if (dragged.kind === "fly") fly(true);
  else beginView(dragged, turn);
}

function dolly(event) {
  if (view.zoom > 0 && !flying || !state?.edits.possible || event.ctrlKey) return;
  event.preventDefault();
  if (flying) { setFlightSpeed(flying.speed * Math.exp(-DOLLY * event.deltaY)); return; }
  const begins = wheeling === null, own = wheeling ??= { factor: 1, view: null };
  own.factor *= Math.exp(DOLLY * event.deltaY);
  clearTimeout(own.rest);
  own.rest = setTimeout(() => { if (wheeling === own) wheeling = null; }, WHEEL_REST);
  if (begins) beginView(own, approach);
  else if (own.view) approach(own);
}

at("film").addEventListener("pointerdown", beginDrag);
at("film").addEventListener("pointermove", drag);
at("film").addEventListener("pointerleave", () => { hovered = null; });
at("film").addEventListener("dblclick", event => { if (shown) focusOn(pixelOf(event)); });
for (const end of ["pointerup", "pointercancel"]) at("film").addEventListener(end, () => { dragged = null; });
// Where the menu opens at the press, it would end the flight before it begins.
at("film").addEventListener("contextmenu", event => { if (moved || dragged?.kind === "fly") event.preventDefault(); });
at("view").addEventListener("wheel", dolly, { passive: false });
