"use strict";
// The ruler of the timeline: seconds and, where they are far enough apart, frames.

const LABEL_APART = 46;   // pixels between labels
const FRAME_APART = 12;   // pixels between frames from which on frames are numbered
const TICK_LEAST = 5;     // pixels between ticks
const SECOND_STEPS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 18000, 36000];

let ruled = null;  // the frames, the rate and the width for which the ruler is drawn

// Seconds as a clock has them from a minute on.
const clockTime = seconds => seconds < 60 ? `${Number(seconds.toFixed(1))} s` : `${Math.floor(seconds / 60)}:${String(Math.round(seconds % 60)).padStart(2, "0")}`;

// The labels of the ruler: frames and texts.
function rulerLabels(width) {
  const perFrame = width / lastFrame(), { rate } = state, labels = [], isFine = perFrame >= FRAME_APART;
  const step = SECOND_STEPS.find(step => step * rate * perFrame >= LABEL_APART && (!isFine || step >= 1)) ?? SECOND_STEPS.at(-1);
  for (let index = 0; index * step * rate <= lastFrame() + 1e-6; index++) labels.push({ frame: index * step * rate, text: clockTime(index * step), isFrame: false });
  if (!isFine) return labels;
  const frames = roundStep(LABEL_APART / perFrame), isFree = frame => labels.every(label => Math.abs(label.frame - frame) * perFrame >= 0.75 * LABEL_APART);
  const numbered = [];
  for (let frame = 0; frame <= lastFrame(); frame += Math.max(1, frames)) if (isFree(frame)) numbered.push({ frame, text: String(frame), isFrame: true });
  return [...labels, ...numbered];
}

function drawRuler() {
  const ruler = at("ruler"), width = ruler.clientWidth, of = `${state.frames} ${state.rate} ${width}`;
  ruler.hidden = state.frames < 2;
  if (ruled === of || width === 0) return;
  ruled = of;
  const perFrame = width / lastFrame(), labels = rulerLabels(width), parts = [];
  const place = (part, frame) => { part.style.left = percentage(frame); parts.push(part); };
  // Ticks at all frames or, if these are too close, at tenths of the labels' steps.
  const [first, second] = labels, apart = perFrame >= TICK_LEAST ? 1 : second ? (second.frame - first.frame) / (((second.frame - first.frame) * perFrame >= 10 * TICK_LEAST) ? 10 : 5) : Infinity;
  for (let index = 0; index * apart <= lastFrame() + 1e-6; index++) place(element("i"), index * apart);
  for (const { frame, text, isFrame } of labels) place(element("span", text, { className: isFrame ? "frame" : "" }), frame);
  ruler.replaceChildren(...parts);
}

const frameOnRuler = ({ clientX }) => {
  const { left, width } = at("ruler").getBoundingClientRect();
  return Math.round((clientX - left) / width * lastFrame());
};
const scrubTo = frame => { if (playing) pause(); seek(frame); };
at("ruler").onpointerdown = event => {
  if (event.button !== 0) return;
  const end = new AbortController(), { signal } = end;
  scrubTo(frameOnRuler(event));
  document.addEventListener("pointermove", event => scrubTo(frameOnRuler(event)), { signal });
  for (const name of ["pointerup", "pointercancel"]) document.addEventListener(name, () => end.abort(), { signal });
  event.preventDefault();
};
new ResizeObserver(() => { if (state) drawRuler(); }).observe(at("ruler"));
