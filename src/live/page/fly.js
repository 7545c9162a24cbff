"use strict";
// Flight of the camera: keys move it, and the pointer or the arrow keys turn it.

const FLIGHT = { KeyW: ["forward", 1], KeyS: ["forward", -1], KeyD: ["level", 1], KeyA: ["level", -1], KeyE: ["pole", 1], KeyQ: ["pole", -1] };
const LOOKS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const LOOK_SPEED = 0.8;   // radians per second, by an arrow key
const LONGEST_STEP = 0.1; // seconds of flight between pictures of the browser, so that a pause is no leap
const CALM_STEP = 0.2;    // seconds of flight per press of a key where less motion is preferred

let flying = null;        // { held, view, frame, pressed, speed, then, x, y }: held while the right button is down; the keys that are down
const calm = matchMedia("(prefers-reduced-motion: reduce)");

async function fly(held = false) {
  if (flying) { land(); return; }
  if (!state?.edits.possible || at("film").classList.contains("wipe")) return;
  const own = flying = { held, view: null, pressed: new Set(), x: held ? dragged.x : undefined, y: held ? dragged.y : undefined };
  const camera = await currentView();
  if (flying !== own) return;
  if (!camera) { land(); return; }
  Object.assign(own, { view: camera, frame: view.frame, then: performance.now() });
  setFlightSpeed(0.5 * distanceOf(camera));
  requestAnimationFrame(flight);
}

function land() {
  flying = null;
  at("flying").hidden = true;
}

function setFlightSpeed(speed) {
  if (!flying?.view) return;
  flying.speed = speed;
  at("flying").hidden = false;
  write(at("flying"), `flying at ${numbers([Number(speed.toPrecision(2))])} units per second; W A S D Q E, arrows or pointer; wheel: speed; Esc: end`);
}

function flight(now) {
  if (!flying?.view) return;
  if (view.frame !== flying.frame) { land(); return; }
  flyFor(Math.min(Math.max(0, now - flying.then) / 1000, LONGEST_STEP), [...flying.pressed]);
  flying.then = now;
  requestAnimationFrame(flight);
}

function flyFor(seconds, codes) {
  if (codes.length === 0 || seconds === 0) return;
  const { view, speed } = flying, axes = { ...directions(view), pole: unit(view.up) };
  let shift = [0, 0, 0], right = 0, down = 0;
  for (const code of codes) {
    if (LOOKS[code]) { right += LOOKS[code][0]; down += LOOKS[code][1]; continue; }
    const [axis, sign] = FLIGHT[code];
    shift = add(shift, axes[axis], sign * speed * seconds);
  }
  flyTo(add(view.position, shift), swung(view, add(view.target, view.position, -1), LOOK_SPEED * seconds * right, LOOK_SPEED * seconds * down));
}

function flyTo(position, ahead) {
  flying.view = { ...flying.view, position, target: add(position, ahead) };
  setView(flying.view, flying.view);
}

// Turns the view by a movement of the pointer.
function look({ clientX, clientY }) {
  const { view, x, y } = flying;
  if (!view) return;
  Object.assign(flying, { x: clientX, y: clientY });
  if (x !== undefined) flyTo(view.position, swung(view, add(view.target, view.position, -1), TURN * (clientX - x), TURN * (clientY - y)));
}

// Handles a key of the flight. Returns whether it is one.
function flyKey(event) {
  const isMove = event.code in FLIGHT, begins = !flying && dragged?.kind === "fly" && isMove;
  if (event.ctrlKey || event.metaKey || event.altKey || !flying && !begins) return false;
  if (begins) { moved = dragged.begun = true; fly(true); }
  if (event.key === "Escape") land();
  else if (!isMove && !(event.code in LOOKS)) return false;
  else if (!calm.matches) flying.pressed.add(event.code);
  else if (flying.view) flyFor(CALM_STEP, [event.code]);
  return true;
}

document.addEventListener("keyup", event => flying?.pressed.delete(event.code));
addEventListener("blur", () => flying?.pressed.clear());
at("film").addEventListener("pointerleave", () => { if (flying) flying.x = undefined; });
for (const end of ["pointerup", "pointercancel"]) at("film").addEventListener(end, () => { if (flying?.held) land(); });
