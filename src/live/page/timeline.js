"use strict";
// The timeline, and the requests to the session.

let scrubbed = null;   // where the person has moved to while a frame was still requested

function seek(frame) {
  view.frame = Math.max(0, Math.min(frame, state ? state.frames - 1 : 0));
  keep();
  scrubbed = view.frame;
  follow();
  draw();
}

// One frame is requested at a time, so that every requested one is shown.
function follow() {
  if (scrubbed === null || requested !== null) return;
  const frame = scrubbed;
  scrubbed = null;
  const settled = shown && !shown.coarse && shown.reloads === state.reloads && !state.frame_mistakes;
  if (settled && !playing && shown.frame === frame && state.frame === frame) return;
  requested = frame;
  request({ seek: { frame, playing: playing !== null } });
}

// The requested frame has arrived, or, in a scene that is shorter now, its last frame.
function arrive(frame) {
  if (requested === null || frame !== Math.min(requested, state.frames - 1)) return;
  requested = null;
  if (scrubbed === null) view.frame = frame;
}

// The first and the last frame of playback.
function range() {
  const last = state.frames - 1, [first, end] = view.range ?? [0, last];
  return [Math.min(first, last), Math.min(end, last)];
}

// Sets the frame from which playback begins, or the one at which it ends.
function setRange(end, frame) {
  const [first, last] = range(), all = [0, state.frames - 1];
  const ends = end === "first" ? [frame, Math.max(frame, last)] : [Math.min(first, frame), frame];
  view.range = ends.every((frame, index) => frame === all[index]) ? null : ends;
  keep();
  draw();
}

function play() {
  if (!state || state.frames < 2) return;
  const [first, last] = range();
  const from = view.frame >= last || view.frame < first ? first : view.frame;
  playing = { since: performance.now(), from, local: false };
  draw();
  requestAnimationFrame(advance);
}

function pause() {
  if (!playing) return;
  playing = null;
  ahead.clear();
  // The frame at which playback stops gets a full picture.
  requested = null;
  seek(view.frame);
}

function advance(now) {
  if (!playing) return;
  const passed = Math.max(0, now - playing.since) / 1000 * state.rate * view.speed;
  const [first, last] = range();
  let frame = playing.from + Math.floor(passed);
  if (frame > last) {
    if (!view.loop) { view.frame = last; pause(); return; }
    frame = first + (frame - first) % (last - first + 1);
  }
  decodeAhead(frame);
  if (frame !== view.frame) {
    playing.local = showDecoded(frame);
    if (!playing.local && requested === null) seek(frame);
  }
  requestAnimationFrame(advance);
}

// After a change of the speed, playback continues from here.
function setSpeed(speed) {
  view.speed = speed;
  keep();
  if (playing) playing = { ...playing, since: performance.now(), from: view.frame };
  draw();
}

function drawTransport() {
  const seconds = view.frame / state.rate, last = state.frames - 1;
  const scrubber = at("scrubber");
  scrubber.max = last;
  scrubber.value = view.frame;
  scrubber.disabled = last === 0;
  scrubber.setAttribute("aria-valuetext", `frame ${view.frame}, ${seconds.toFixed(2)} seconds`);
  at("moment").replaceChildren(`frame ${view.frame}`, element("span", ` of 0–${last}`), ` · ${seconds.toFixed(2)} s`);
  for (const id of ["back", "play", "forth"]) at(id).disabled = last === 0;
  const [first, end] = range();
  at("range").hidden = view.range === null;
  at("range").style.marginLeft = percentage(first);
  at("range").style.width = percentage(end - first);
  at("range-clear").disabled = view.range === null;
  drawPlayhead();
  at("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  at("play").setAttribute("aria-pressed", playing !== null);
  at("play").querySelector("path").setAttribute("d", playing ? "M3 2h4v12H3zM9 2h4v12H9z" : "M4 2l10 6-10 6z");
  at("loop").setAttribute("aria-pressed", view.loop);
  at("speed").value = String(view.speed);
  at("detail").value = state.detail;
  at("finish").hidden = state.detail === "full";
  drawRuler();
  drawPath();
}

