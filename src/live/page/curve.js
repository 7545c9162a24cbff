"use strict";
// The error curve: the frame's error against its time, on logarithmic axes.

const steps = error => error < 0.095 ? error.toPrecision(1) : error < 9.5 ? error.toFixed(1) : error.toFixed(0);
const samplesOf = place => place.samples === null ? "as many samples as it takes" : place.samples === 1 ? "1 sample" : `${place.samples} samples`;

function drawCurve() {
  const places = state.curve.filter(place => place.error > 0 && place.milliseconds > 0);
  at("curve").hidden = places.length < 2;
  if (at("curve").hidden) return;
  const [own, ...others] = places[0] === state.curve[0] ? places : [null, ...places];
  const [left, right, top, bottom] = [34, 292, 8, 148];
  const axis = (values, from, to) => {
    const [low, high] = [Math.log10(Math.min(...values)) - 0.1, Math.log10(Math.max(...values)) + 0.1];
    const at = value => from + (Math.log10(value) - low) / (high - low) * (to - from);
    const ticks = [];
    for (let power = Math.floor(low); power <= high; power++)
      for (const digit of high - low < 1.5 ? [1, 2, 5] : [1])
        if (digit * 10 ** power >= 10 ** low && digit * 10 ** power <= 10 ** high) ticks.push(digit * 10 ** power);
    return { at, ticks };
  };
  const x = axis(places.map(place => place.milliseconds), left, right), y = axis(places.map(place => place.error), bottom, top);
  const unit = Math.max(...x.ticks) < 1000 ? 1 : 1000, drawn = [];
  const draw = (name, attributes, text) => {
    drawn.push(drawing(name, attributes, text));
    return drawn.at(-1);
  };
  for (const tick of x.ticks) {
    draw("path", { class: "grid", d: `M${x.at(tick)} ${top}V${bottom}` });
    draw("text", { x: x.at(tick), y: bottom + 13, "text-anchor": "middle" }, String(Number((tick / unit).toPrecision(1))));
  }
  for (const tick of y.ticks) {
    draw("path", { class: "grid", d: `M${left} ${y.at(tick)}H${right}` });
    draw("text", { x: left - 4, y: y.at(tick) + 4, "text-anchor": "end" }, String(Number(tick.toPrecision(1))));
  }
  draw("text", { x: right, y: bottom + 27, "text-anchor": "end" }, unit === 1 ? "milliseconds" : "seconds");
  draw("polyline", { points: others.map(place => `${x.at(place.milliseconds)},${y.at(place.error)}`).join(" ") });
  const mark = (place, name) => {
    const dot = draw("circle", { cx: x.at(place.milliseconds), cy: y.at(place.error), r: name ? 5 : 3.5, class: name });
    dot.append(drawing("title", {}, `${samplesOf(place)}: off by ${steps(place.error)} steps, ${duration(place.milliseconds)}`));
  };
  for (const place of others) mark(place, "");
  if (own) mark(own, "own");
  at("plot").replaceChildren(...drawn);
  const said = own ? `As it is, with ${samplesOf(own)}, the frame is off by about ${steps(own.error)} of 255 steps.` : "";
  at("worth").textContent = said;
}
