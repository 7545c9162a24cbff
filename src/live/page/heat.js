"use strict";
// The heat map: rays, samples or the error of the picture, tile by tile, over it.

// Viridis, from little to much. It gets lighter all the way, also for colour-blind readers.
const HEAT = ["440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"].map(color => color.match(/../g).map(byte => parseInt(byte, 16)));
const RAY_KINDS = ["camera", "shadow", "reflection", "refraction"];

// The quantities: their name, their value in a tile or in the whole picture (null), and its description.
const HEAT_KINDS = {
  rays: {
    name: "Rays per pixel",
    of: index => total(raysOf(index)),
    describe: index => {
      const rays = raysOf(index), parts = rays.map((count, kind) => count > 0 && `${rounded(count)} ${RAY_KINDS[kind]}`).filter(Boolean);
      return `${counted(total(rays), "ray")} per pixel${average(index)}: ${parts.join(", ")}`;
    },
  },
  samples: {
    name: "Samples per pixel",
    of: index => raysOf(index)[0],
    describe: index => `${counted(raysOf(index)[0], "sample")} per pixel${average(index)}`,
  },
  error: {
    name: "RMS error",
    of: index => index !== null ? heat.error[index] : (heat.is_measured && state.curve[0]?.error) || rootMeanSquare(),
    describe: index => `${heat.is_measured ? "measured" : "estimated"} error ${rounded(HEAT_KINDS.error.of(index))} of 255${index === null ? " in the whole picture" : " in this tile"}`,
  },
};

let heated = null;  // the address of the numbers that are shown or being fetched
let heat = null;    // { tile, columns, camera, shadow, reflection, refraction, error, is_measured } and { width, height, film } of the picture; null if there are none

function setHeat() {
  view.heat = !view.heat;
  keep();
  draw();
}

async function showHeat() {
  // What covers the picture has no numbers.
  const isCovered = reference() !== null && (view.swap || view.gain !== null);
  at("heat-legend").hidden = !view.heat || !shown || isCovered;
  at("heat-kind").value = view.heatKind;
  describeHeat();
  // After local playback, the session's picture of the frame has the numbers.
  if (view.heat && !playing && shown?.isOther && shown.frame === state.picture?.frame) fetchPicture();
  const query = state.curve.length > 0 ? "?measured" : "";
  const of = view.heat && !playing && shown && !shown.coarse && !shown.isOther ? `tiles/${state.session}/${shown.id}${query}` : null;
  if (of === heated) return;
  heated = of;
  const { width, height, film } = shown ?? {}, answer = of && await fetch(of).catch(() => null);
  const tiles = answer?.ok ? await answer.json() : null;
  if (of !== heated) return;
  heat = tiles && { ...tiles, width, height, film };
  drawHeat();
}

// Pixels of a tile: those at the right and at the bottom may be smaller.
function heatTile(index) {
  const { tile, columns, width, height } = heat, x = index % columns * tile, y = Math.floor(index / columns) * tile;
  return [x, y, Math.min(tile, width - x), Math.min(tile, height - y)];
}

const total = counts => counts.reduce((sum, count) => sum + count, 0);

function pixelsOf(index) {
  const [, , across, down] = heatTile(index);
  return across * down;
}

// The rays per pixel, by kind, in a tile or in the whole picture.
function raysOf(index) {
  if (index === null) return RAY_KINDS.map(kind => total(heat[kind]) / (heat.width * heat.height));
  return RAY_KINDS.map(kind => heat[kind][index] / pixelsOf(index));
}

const rootMeanSquare = () => Math.sqrt(total(heat.error.map((error, index) => error * error * pixelsOf(index))) / (heat.width * heat.height));

const rounded = count => String(count < 9.95 ? Number(count.toPrecision(2)) : Math.round(count));
const counted = (count, name) => `${rounded(count)} ${rounded(count) === "1" ? name : `${name}s`}`;
const average = index => index === null ? " on average" : "";

// Whether the picture has numbers of the quantity.
const hasHeat = () => heat !== null && (view.heatKind !== "error" || heat.error !== null);

// Equal steps of colour are equal ratios.
function heatColor(share) {
  const place = share * (HEAT.length - 1), index = Math.min(HEAT.length - 2, Math.floor(place));
  return `rgb(${HEAT[index].map((from, channel) => Math.round(from + (place - index) * (HEAT[index + 1][channel] - from)))})`;
}

function drawHeat() {
  const has = hasHeat(), { name, of } = HEAT_KINDS[view.heatKind];
  at("film").classList.toggle("heat", has);
  at("heat-map").hidden = !has;
  at("heat-scale").hidden = !has;
  describeHeat();
  if (!has) return;
  const map = Object.assign(at("heat-map"), { width: heat.width, height: heat.height }), context = map.getContext("2d");
  // A flat tile has no error at all: values below a thousandth of the largest share the first colour.
  const values = heat.camera.map((_, index) => of(index)), high = Math.max(...values), least = Math.min(...values), low = Math.max(least, high / 1000);
  values.forEach((value, index) => {
    context.fillStyle = heatColor(high > low ? Math.max(0, Math.log(value / low) / Math.log(high / low)) : 0);
    context.fillRect(...heatTile(index));
  });
  map.setAttribute("aria-label", `${name}, from ${rounded(least)} to ${rounded(high)}`);
  at("heat-scale").firstElementChild.style.background = `linear-gradient(to right, ${HEAT.map(color => `rgb(${color})`)})`;
  // Equal values have one mark.
  const marks = high > low ? [low, Math.sqrt(low * high), high].map(rounded) : ["", rounded(high), ""];
  if (least < low) marks[0] = `≤ ${marks[0]}`;
  marks.forEach((mark, index) => { at("heat-scale").children[index + 1].textContent = mark; });
}

// Describes the tile under the pointer, that of the marked pixel, or the whole picture.
function describeHeat() {
  if (!view.heat) return;
  const isRead = shown?.full && state.rays === 0;
  Object.assign(at("heat-measure"), { hidden: heat === null || hasHeat() || !shown?.full, disabled: at("measure").disabled });
  if (!heat) { write(at("heat-count"), playing ? "Pause to see the numbers." : isRead ? "This picture is from a file: R renders it, with its numbers." : "The numbers come with the finished picture."); return; }
  if (!hasHeat()) { write(at("heat-count"), shown?.full ? "Not measured yet. Measure renders the frame again, and compares." : "Known for pictures in full quality."); return; }
  const spot = hovered ?? view.spot, pixel = spot?.every((place, axis) => place < heat.film[axis]) ? spot : null;
  const [column, row] = [heat.width, heat.height].map((count, axis) => pixel && Math.floor((pixel[axis] + 0.5) / heat.film[axis] * count / heat.tile));
  write(at("heat-count"), HEAT_KINDS[view.heatKind].describe(pixel ? row * heat.columns + column : null));
}

at("heat-kind").append(...Object.entries(HEAT_KINDS).map(([value, { name }]) => element("option", name, { value })));
at("heat-kind").onchange = event => {
  view.heatKind = event.target.value;
  if (!isTabbed) event.target.blur();
  keep();
  drawHeat();
};
at("heat").onclick = setHeat;
at("heat-measure").onclick = () => measure();
for (const kind of ["pointermove", "pointerleave"]) at("film").addEventListener(kind, describeHeat);
