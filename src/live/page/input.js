"use strict";
// Buttons, pointers and keys.

const step = frames => { pause(); seek(view.frame + frames); };
const toggle = () => playing ? pause() : play();
const setLoop = () => { view.loop = !view.loop; keep(); draw(); };
const setWipe = () => { if (!at("wipe").disabled) compare({ wipe: view.wipe === null ? 0.5 : null, swap: false, gain: null }); };
const setSwap = () => { if (!at("swap").disabled) compare({ swap: !view.swap, gain: null }); };
const setLanes = () => { if (!at("keyed").hidden) at("keyed").click(); };
const clearRange = () => { view.range = null; keep(); draw(); };
const moveEdge = by => { if (view.wipe !== null) compare({ wipe: Math.max(0, Math.min(1, view.wipe + by)) }); };
const centre = () => film().map(count => count >> 1);
const markPixel = pixel => { probe(pixel); describeHeat(); };
// Moves the mark to a pixel relative to the marked one, or to the centre.
function moveSpot(right, down) {
  const [width, height] = film(), [i, j] = view.spot ?? centre();
  const inside = (place, count) => Math.max(0, Math.min(count - 1, place));
  hovered = null;
  if (shown) markPixel([inside(i + right, width), inside(j + down, height)]);
}
const finish = () => request("finish");
const measure = () => { if (!at("measure").disabled) { at("plan-panel").open = true; at("plan-panel").scrollIntoView({ block: "nearest" }); pause(); request("measure"); } };
const faster = by => {
  const options = [...at("speed").options].map(option => Number(option.value));
  setSpeed(options[Math.max(0, Math.min(options.length - 1, options.indexOf(view.speed) + by))]);
};

at("scrubber").oninput = event => { const frame = Number(event.target.value); if (playing) { playing = null; requested = null; } seek(frame); };
at("back").onclick = () => step(-1);
at("forth").onclick = () => step(1);
at("play").onclick = toggle;
at("loop").onclick = setLoop;
at("range-first").onclick = () => setRange("first", view.frame);
at("range-last").onclick = () => setRange("last", view.frame);
at("range-clear").onclick = clearRange;
at("speed").onchange = event => setSpeed(Number(event.target.value));
at("detail").onchange = event => { view.detail = event.target.value; keep(); request({ detail: view.detail }); };
at("finish").onclick = finish;
at("measure").onclick = measure;
at("fit").onclick = () => zoom(0);
at("whole").onclick = () => zoom(1);
at("larger").onclick = () => zoomBy(2);
at("smaller").onclick = () => zoomBy(1 / 2);
at("wipe").onclick = setWipe;
at("swap").onclick = setSwap;
at("warned").onclick = () => { at("warnings").scrollIntoView({ block: "nearest" }); at("warnings").focus(); };
at("tools").onclick = () => at("tools").setAttribute("aria-expanded", document.querySelector("header").classList.toggle("open"));
at("help").onclick = () => at("keys").showModal();

let wiping = false, wiped = false;  // at it; the click that follows belongs to it
const moveWipe = event => {
  const box = at("film").getBoundingClientRect();
  compare({ wipe: Math.max(0, Math.min(1, (event.clientX - box.left) / box.width)) });
};
at("film").onpointerdown = event => {
  const box = at("film").getBoundingClientRect();
  const near = Math.abs(event.clientX - box.left - view.wipe * box.width) < 16;
  wiping = wiped = event.isPrimary && event.button === 0 && near && at("film").classList.contains("wipe");
  if (wiping) { at("film").setPointerCapture(event.pointerId); event.preventDefault(); }
};
at("film").onpointermove = event => { if (wiping) moveWipe(event); };
at("film").onpointerup = at("film").onlostpointercapture = () => { wiping = false; };
at("film").onclick = event => { if (!wiped && !moved && state && shown) markPixel(pixelOf(event)); wiped = moved = false; };

const keys = {
  " ": toggle, ArrowLeft: event => step(event.shiftKey ? -10 : -1), ArrowRight: event => step(event.shiftKey ? 10 : 1),
  i: () => setRange("first", view.frame), o: () => setRange("last", view.frame), x: clearRange, t: setLanes, Home: () => step(-Infinity), End: () => step(Infinity), l: setLoop, "[": () => faster(-1), "]": () => faster(1),
  f: event => event.shiftKey ? fly() : shown && focusOn(hovered ?? view.spot ?? centre()), 0: () => zoom(0), 1: () => zoom(1), "+": () => zoomBy(2), "=": () => zoomBy(2), "-": () => zoomBy(1 / 2),
  w: setWipe, b: setSwap, d: setDifference, p: pin, h: setHeat, c: setPath, z: () => holdLoupe(true), ",": () => moveEdge(-0.02), ".": () => moveEdge(0.02), r: event => event.shiftKey ? at("export-open").click() : finish(), m: measure, k: keepEdits, Escape: dropEdits, "?": () => at("keys").showModal(),
};
const marks = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
// The space bar presses a button that was reached by keys. On one that was clicked, it plays.
let isTabbed = false;
const presses = event => event.key === " " && ["BUTTON", "SUMMARY"].includes(event.target.tagName);
addEventListener("pointerdown", () => { isTabbed = false; }, true);
document.onkeydown = event => {
  if (event.key === "Tab") isTabbed = true;
  if (!state || document.querySelector("dialog[open]")) return;
  if (event.target.tagName !== "INPUT" && flyKey(event)) { event.preventDefault(); return; }
  const letter = event.ctrlKey || event.metaKey ? event.key.toLowerCase() : null, changes = letter === "z" ? event.shiftKey ? redo : undo : letter === "y" ? redo : null;
  if (changes && event.target.tagName !== "INPUT") { changes(); event.preventDefault(); }
  if (event.ctrlKey || event.metaKey) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key, tag = event.target.tagName;
  if (event.altKey) {
    if (!marks[key]) return;
    moveSpot(...marks[key].map(step => step * (event.shiftKey ? 10 : 1)));
    event.preventDefault();
    return;
  }
  const digit = /^(Numpad|Digit)([1379])$/.exec(event.code);
  if (digit && (digit[1] === "Digit" ? event.shiftKey && !/\d/.test(key) : key === digit[2])) { lookFrom(sides[digit[2]]); event.preventDefault(); return; }
  // Lists, buttons and text fields handle their own keys.
  if (tag === "SELECT" || (tag === "INPUT" && event.target.id !== "scrubber") || (isTabbed && presses(event)) || (tag === "PRE" && key.length > 1)) return;
  if (!keys[key]) return;
  keys[key](event);
  event.preventDefault();
};
// Firefox presses a button when the space bar is released.
document.onkeyup = event => {
  if (!isTabbed && presses(event) && !document.querySelector("dialog[open]")) event.preventDefault();
};
new ResizeObserver(layout).observe(at("view"));
connect();
