"use strict";
// Changes of the scene: values are tried at once, then written into the file. Controls of a program are tried and kept in the same way.

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

// Tries values and changes of keys.
const attempt = (values, keys = []) => attemptEdit({ try: [values, keys] });

// Tries texts of values at the shown frame: those with a track become keys.
function attemptAt(list) {
  const fields = list.filter(({ key }) => !key), keyed = list.filter(({ key }) => key);
  return attempt(fields.map(({ path, text }) => `${path}=${text}`), keyed.map(({ key, text }) => ({ set: [...key, text] })));
}

// Makes an edit, the last of those that arrive while another one is under way.
async function attemptEdit(next) {
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

const isUnsaved = () => unsaved || state.edits.tried.length > 0 || state.edits.look !== null;

// Writes what is tried into the files.
async function keepEdits() {
  await settled();
  if (isUnsaved()) await edit("keep");
}

async function dropEdits() {
  await settled();
  if (isUnsaved()) await edit("drop");
}

const undo = () => { if (!at("undo").disabled) edit("undo"); };
const redo = () => { if (!at("redo").disabled) edit("redo"); };

// Numbers as one would write them.
const formatted = number => { const text = String(Number(number.toPrecision(7))); return text.includes("e") ? number.toFixed(12).replace(/0+$/, "0") : text; };
const triple = vector => `(${vector.map(formatted).join(", ")})`;

function drawEdits() {
  const { tried, undoable, redoable, last, look, notice, possible } = state.edits, isLook = tried.length === 0 && look !== null;
  at("undo").disabled = undoable === 0;
  at("redo").disabled = redoable === 0;
  at("undo").hidden = at("redo").hidden = !possible && undoable + redoable === 0;
  // What is dragged is written when it is dropped; controls are in no file.
  at("unsaved").hidden = !possible || moving !== null || grip !== null || tried.length === 0 && !isLook;
  write(at("unsaved").firstChild, isLook ? "Only a look, not in the file" : `Not in the file yet: ${triedParts(tried)}`);
  at("unsaved").title = isLook ? look : tried.join("\n");
  at("keep").hidden = isLook;
  write(at("drop"), isLook ? "Reset" : "Discard");
  at("drop").title = isLook ? "Back to the camera in the file (Esc)" : "As it is in the file (Esc)";
  drawWritten(last);
  if (notice) write(at("refused"), notice);
}

// What is tried, as `camera: position, target`.
function triedParts(tried) {
  const parts = new Map();
  for (const value of tried) {
    const path = value.split("=")[0].trim(), track = tracks?.tracks.find(track => path.startsWith(track.path));
    const [, list, rest] = /^(\w+)\.?(.*)$/.exec(path) ?? [path, path, ""], isNamed = ["cameras", "entities", "materials"].includes(list);
    const [, own, field] = isNamed ? /^("[^"]*"|[^.]*)\.?(.*)$/.exec(rest) : [rest, list, rest];
    const [part, name] = track ? [track.target, track.channel] : [own.replaceAll('"', ""), field.split(".").at(-1)];
    if (!parts.has(part)) parts.set(part, new Set());
    if (name) parts.get(part).add(name);
  }
  const texts = [...parts].map(([part, names]) => [part, [...names].join(", ")].filter(Boolean).join(": "));
  return texts.length > 2 ? `${texts.slice(0, 2).join("; ")} and ${texts.length - 2} more` : texts.join("; ");
}

// The line of the last change of a file, as a link to it.
function drawWritten(last) {
  const text = last && `${last.is_undone ? "Taken back" : "Written"}: `, of = JSON.stringify(last);
  if (at("written").dataset.of === of) return;
  at("written").dataset.of = of;
  at("written").replaceChildren(...last ? [text, placeLink(last.place)] : []);
}

at("undo").onclick = undo;
at("redo").onclick = redo;
at("keep").onclick = keepEdits;
at("drop").onclick = dropEdits;
