"use strict";
// The drawing of a lane beneath its keys: the easing between keys as a curve, and the passes of keys that repeat.

const MAX_MARKS = 200;  // in a lane; more cannot be told apart

const timeOf = (track, index) => moving?.path === track.path && moving.index === index ? moving.time : track.keys[index].time;
const spanOf = track => [timeOf(track, 0), timeOf(track, track.keys.length - 1)];
const repeats = track => { const [first, last] = spanOf(track); return track.repeats && last > first; };

// The time in the first pass that has the value of a time.
function folded(track, time) {
  if (!repeats(track)) return time;
  const [first, last] = spanOf(track), span = last - first, period = track.alternates ? 2 * span : span;
  const since = ((time - first) % period + period) % period;
  return first + (since > span ? period - since : since);
}

// The passes on the timeline, the first of which has number 0. Each maps times of keys to frames.
function passesOf(track) {
  const frames = (time, pass) => {
    const [first, last] = spanOf(track), mirrored = track.alternates && pass % 2 !== 0;
    return frameOf(track, pass * (last - first) + (mirrored ? first + last - time : time));
  };
  const passOf = frame => { const [first, last] = spanOf(track); return Math.floor((keyTime(track, frame) - first) / (last - first)); };
  const ends = repeats(track) ? [passOf(0), passOf(lastFrame())].sort((a, b) => a - b) : [0, 0], passes = [];
  for (let pass = ends[0]; pass <= ends[1] && passes.length * track.keys.length < MAX_MARKS; pass++) passes.push({ pass, toFrame: time => frames(time, pass) });
  return passes;
}

// Draws the marks of the repeats and, in high lanes, the curves.
function drawPasses(track, row) {
  const passes = passesOf(track), places = new Set(track.keys.map((_, index) => percentage(frameOf(track, timeOf(track, index)))));
  const marks = [];
  for (const { pass, toFrame } of passes) {
    for (let index = 0; pass !== 0 && index < track.keys.length; index++) {
      const frame = toFrame(timeOf(track, index)), left = percentage(frame);
      if (frame < 0 || frame > lastFrame() || places.has(left)) continue;
      places.add(left);
      const mark = element("i");
      mark.style.left = left;
      marks.push(mark);
    }
  }
  row.querySelector(".passes").replaceChildren(...hasCurve(track) ? [curveOf(track, passes)] : [], ...marks);
}

// Shots, and values that are true or false, change at once. Lanes are high on narrow screens and where a key is selected.
const hasCurve = track => track.channel && track.keys.length > 1 && !/^(true|false)$/.test(track.keys[0].text) && (narrow.matches || picked?.path === track.path);

// Each stretch between keys rises from the bottom, its start, to the top, its end.
function curveOf(track, passes) {
  const svg = drawing("svg", { viewBox: `0 -0.25 ${lastFrame()} 1.5`, preserveAspectRatio: "none", "aria-hidden": "true" });
  for (const { pass, toFrame } of passes) {
    const lines = track.keys.slice(1).map((_, index) => {
      const [from, to] = [timeOf(track, index), timeOf(track, index + 1)], progress = tracks.easings[track.keys[index].easing] ?? [0, 1];
      return "M" + progress.map((share, step) => `${toFrame(from + (to - from) * step / (progress.length - 1)).toFixed(3)} ${(1 - share).toFixed(3)}`).join("L");
    });
    svg.append(drawing("path", { class: pass === 0 ? "" : "again", d: lines.join("") }));
  }
  return svg;
}

// Shows the time of a key above it while it is dragged.
function showKeyTime(button, track, index) {
  const bubble = at("key-time"), frame = frameOf(track, timeOf(track, index));
  const own = track.offset !== 0 || track.speed !== 1 ? ` · key at ${formatted(timeOf(track, index))} s` : "";
  bubble.hidden = false;
  write(bubble, `${(frame / state.rate).toFixed(2)} s · frame ${Math.round(frame)}${own}`);
  const box = button.getBoundingClientRect(), frames = at("transport").getBoundingClientRect(), half = bubble.offsetWidth / 2;
  bubble.style.left = Math.max(half, Math.min(frames.width - half, box.left + box.width / 2 - frames.left)) + "px";
  bubble.style.top = box.top - frames.top - bubble.offsetHeight - 2 + "px";
}
