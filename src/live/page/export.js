"use strict";
// The dialog that renders frames into files, and the progress of that.

// Opens the dialog. By default, the range of playback is rendered into a folder with the name of the scene.
function offerExport() {
  const [first, last] = range(), name = state.scene.split(/[\\/]/).pop().replace(/\.[^.]*$/, "");
  at("export-first").value = first;
  at("export-last").value = last;
  for (const id of ["export-first", "export-last"]) at(id).max = state.frames - 1;
  if (at("export-target").value === "") at("export-target").value = `out/${name}`;
  at("export-refused").textContent = "";
  at("export-dialog").showModal();
}

at("export-open").onclick = offerExport;
at("export-close").onclick = () => at("export-dialog").close();

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
