"use strict";
// The dialog that renders the film, or a part of it, into files, and the progress of that.

// Opens the dialog. By default, the range of playback is rendered into a folder with the name of the scene.
function offerFilm() {
  const [first, last] = range(), name = state.scene.split(/[\\/]/).pop().replace(/\.[^.]*$/, "");
  at("shot-first").value = first;
  at("shot-last").value = last;
  for (const id of ["shot-first", "shot-last"]) at(id).max = state.frames - 1;
  if (at("shot-target").value === "") at("shot-target").value = `out/${name}`;
  at("shot-refused").textContent = "";
  at("shooting").showModal();
}

at("shoot").onclick = offerFilm;
at("shot-close").onclick = () => at("shooting").close();

at("shooting").querySelector("form").onsubmit = async event => {
  if (event.submitter?.value !== "start") return;
  event.preventDefault();
  await settled();
  const number = id => Number(at(id).value), target = at("shot-target").value;
  const answer = await post("film", { first: number("shot-first"), last: number("shot-last"), target }).catch(() => null);
  if (answer?.ok) at("shooting").close();
  else at("shot-refused").textContent = answer ? await answer.text() : "the server is away";
};

// For 75 seconds "1:15".
const clock = seconds => `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, "0")}`;

let dismissed = null;  // the ended film that is no longer shown

function drawFilm() {
  const film = state.film_files, place = at("film-files"), key = film && JSON.stringify([state.session, film]);
  at("shoot").hidden = !state.edits.possible;
  place.hidden = film === null || key === dismissed;
  if (place.hidden) return;
  const [bar, text, link, button] = place.children, { target, done, total, left, end } = film, short = target.split(/[\\/]/).slice(-2).join("/");
  bar.hidden = end !== null;
  bar.value = done / total;
  const words = end === null ? `frame ${done} of ${total}${left === null ? "" : `, ${clock(left)} left`}, into ${short}`
    : end === "complete" ? `${total} ${total === 1 ? "frame is" : "frames are"} in ${short}`
      : end === "cancelled" ? `cancelled: ${film.is_movie ? "no movie was made" : `${done} of ${total} frames are in ${short}`}`
        : end.failed;
  write(text, words);
  text.title = target;
  text.classList.toggle("wrong", end !== null && typeof end === "object");
  link.hidden = end !== "complete" || !film.is_movie;
  link.href = `movie/${state.session}`;
  link.download = target.split(/[\\/]/).pop();
  button.textContent = end === null ? "Cancel" : "Close";
  button.onclick = () => { if (end === null) post("film", null); else { dismissed = key; drawFilm(); } };
}
