"use strict";
// Changes of the scene: values are tried at once, then written into the file.

const PATIENCE = 250;  // milliseconds to wait for the picture of a try before the next one

let trying = null;     // the try that waits, or true while one is under way and none waits
let unsaved = false;   // true after a try, of which the state may not tell yet

async function edit(what) {
  const answer = await post("edit", what).catch(() => null);
  const refused = answer === null ? "the server is away" : answer.ok ? "" : await answer.text();
  write(at("refused"), refused.split("\n")[0]);
  at("refused").title = refused;
  if (refused === "") unsaved = typeof what === "object";
  return refused === "";
}

// Tries values and changes of keys, the last of those that arrive while another try is under way.
async function attempt(values, keys = []) {
  let next = keys.length > 0 ? { try_keys: [values, keys] } : { try: values };
  if (trying !== null) { trying = next; return; }
  trying = true;
  while (next) {
    await edit(next);
    const reloads = state.reloads, start = performance.now();
    while (!(shown && shown.reloads >= reloads) && performance.now() - start < PATIENCE) await new Promise(requestAnimationFrame);
    next = trying === true ? null : trying;
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
  if (unsaved || state.edits.tried.length > 0) await edit("keep");
}

async function dropEdits() {
  await settled();
  if (unsaved || state.edits.tried.length > 0) await edit("drop");
}

const undo = () => { if (!at("undo").disabled) edit("undo"); };

// Numbers as one would write them.
const formatted = number => { const text = String(Number(number.toPrecision(7))); return text.includes("e") ? number.toFixed(12).replace(/0+$/, "0") : text; };
const triple = vector => `(${vector.map(formatted).join(", ")})`;

function drawEdits() {
  const { tried, undoable, notice, possible } = state.edits;
  at("undo").disabled = undoable === 0;
  at("undo").hidden = !possible;
  at("unsaved").hidden = tried.length === 0;
  if (notice) write(at("refused"), notice);
}

at("undo").onclick = undo;
at("keep").onclick = keepEdits;
at("drop").onclick = dropEdits;
