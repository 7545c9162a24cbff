"use strict";
// The dialog that renders frames into files, and the progress of that.

const frameTimes = new Map();  // of frames at full quality, in milliseconds by frame
let timedReload = null;        // the reload to which they belong

// Notes the time of the shown frame. Of a partly reused picture, all of it would have taken longer.
function noteFrameTime() {
  if (timedReload !== reload()) frameTimes.clear();
  timedReload = reload();
  const { picture, times } = state;
  if (picture?.full && picture.reloads === state.reloads && times.reused < 0.9) frameTimes.set(picture.frame, times.animate + times.prepare + times.trace / (1 - times.reused));
}

// For 41 300 milliseconds "about 40 s".
function estimate(milliseconds) {
  const seconds = milliseconds / 1000, rounded = seconds < 10 ? Math.round(seconds) : 5 * Math.round(seconds / 5);
  return seconds < 1 ? "less than a second" : seconds < 100 ? `about ${rounded} s` : seconds < 6000 ? `about ${Math.round(seconds / 60)} minutes` : `about ${Math.round(seconds / 3600)} hours`;
}

const extensionOf = path => /\.(mp4|webm|mov|mkv|gif|apng)$/i.exec(path)?.[1].toLowerCase() ?? "";
const absolutePath = path => /^([\\/]|[A-Za-z]:)/.test(path) ? path : `${state.folder.replace(/[\\/]$/, "")}/${path}`;
const sceneName = () => state.scene.split(/[\\/]/).pop().replace(/\.[^.]*$/, "");

// A long path without the folders in its middle.
function shortened(path) {
  const parts = path.split(/[\\/]/), middle = Math.min(2, parts.length - 3);
  while (parts.join("/").length > 52 && parts.length > middle + 3) parts.splice(middle, 1);
  return path.length > 52 && middle > 0 ? [...parts.slice(0, middle), "…", ...parts.slice(middle)].join("/") : path;
}

// Opens the dialog. By default, the range of playback is rendered into a folder with the name of the scene.
function offerExport() {
  [at("export-first").value, at("export-last").value] = range();
  for (const id of ["export-first", "export-last"]) at(id).max = state.frames - 1;
  if (at("export-target").dataset.scene !== state.scene) at("export-target").value = `out/${sceneName()}`;
  at("export-target").dataset.scene = state.scene;
  at("export-refused").textContent = "";
  describeExport();
  at("export-dialog").showModal();
}

// Says what will be rendered.
function describeExport() {
  const target = at("export-target").value, extension = extensionOf(target), [first, last] = ["export-first", "export-last"].map(id => Number(at(id).value));
  const count = Math.max(0, last - first + 1), times = [...frameTimes.values()], mean = times.reduce((sum, time) => sum + time, 0) / times.length;
  const isEven = extension !== "" && !["gif", "apng"].includes(extension), size = state.film.map(side => isEven ? side + side % 2 : side);
  const rate = `${(count / state.rate).toFixed(2)} s at ${formatted(state.rate)} per second`, isRange = view.range && String([first, last]) === String(range());
  const path = absolutePath(target), file = frame => `${sceneName()}.${String(frame).padStart(4, "0")}.png`;
  at("export-format").value = extension;
  at("export-target-label").textContent = extension ? "File" : "Folder";
  const facts = [
    ["Size", `${size.join(" × ")} pixels`],
    ["Length", `${count} ${count === 1 ? "frame" : "frames"}, ${rate}${isRange ? ", the range of the timeline" : ""}`],
    ["Time", times.length ? estimate(count * mean) : "known once a frame is rendered in full"],
    extension ? ["Into", shortened(path), path]
      : ["Files", `${shortened(path)}: ${file(first)}${count > 1 ? ` to ${file(last)}` : ""}. Existing frames are kept.`, path],
  ];
  at("export-facts").replaceChildren(...facts.map(([name, text, title = ""]) => {
    const row = element("tr");
    const cell = element("td", undefined, { title });
    // Names of files and folders stay whole: lines break between them.
    cell.append(...text.split(/(?<=[/\\ ])/).flatMap(word => [element("span", word, { className: "whole" }), element("wbr")]));
    row.append(element("th", name), cell);
    return row;
  }));
}

at("export-open").onclick = offerExport;
at("export-cancel").onclick = () => at("export-dialog").close();
at("export-all").onclick = () => {
  [at("export-first").value, at("export-last").value] = [0, state.frames - 1];
  describeExport();
};
at("export-format").onchange = event => {
  const target = at("export-target"), extension = event.target.value;
  target.value = target.value.replace(/\.(mp4|webm|mov|mkv|gif|apng)$/i, "") + (extension && `.${extension}`);
  describeExport();
};
for (const id of ["export-first", "export-last", "export-target"]) at(id).oninput = describeExport;

at("export-dialog").querySelector("form").onsubmit = async event => {
  if (event.submitter?.value !== "start") return;
  event.preventDefault();
  await settled();
  const number = id => Number(at(id).value), target = at("export-target").value;
  const answer = await post("export", { first: number("export-first"), last: number("export-last"), target }).catch(() => null);
  if (answer?.ok) at("export-dialog").close();
  else at("export-refused").textContent = answer ? await answer.text() : "the server is away";
};

// For 75 seconds "1:15".
const clock = seconds => `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, "0")}`;

let dismissed = null;  // the ended export that is no longer shown

function drawExport() {
  noteFrameTime();
  const exported = state.export, place = at("export"), key = exported && JSON.stringify([state.session, exported]);
  at("export-open").hidden = !state.edits.possible;
  place.hidden = exported === null || key === dismissed;
  if (place.hidden) return;
  const [bar, text, link, button] = place.children, { target, done, total, left, end } = exported, short = target.split(/[\\/]/).slice(-2).join("/");
  bar.hidden = end !== null;
  bar.value = done / total;
  const words = end === null ? `frame ${done} of ${total}${left === null ? "" : `, ${clock(left)} left`}, into ${short}`
    : end === "complete" ? `${total} ${total === 1 ? "frame is" : "frames are"} in ${short}`
      : end === "cancelled" ? `cancelled: ${exported.is_movie ? "no movie was made" : `${done} of ${total} frames are in ${short}`}`
        : end.failed;
  write(text, words);
  text.title = target;
  text.classList.toggle("wrong", end !== null && typeof end === "object");
  link.hidden = end !== "complete" || !exported.is_movie;
  link.href = `movie/${state.session}`;
  link.download = target.split(/[\\/]/).pop();
  button.textContent = end === null ? "Cancel" : "Close";
  button.onclick = () => { if (end === null) post("export", null); else { dismissed = key; drawExport(); } };
}
