"use strict";
// The heat map: the number of rays per pixel, tile by tile, over the picture.

// Viridis, from few rays to many. It gets lighter all the way, also for colour-blind readers.
const HEAT = ["440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"].map(color => color.match(/../g).map(byte => parseInt(byte, 16)));
const RAY_KINDS = ["camera", "shadow", "reflection", "refraction"];

let heated = null;  // the address of the numbers that are shown or being fetched
let heat = null;    // { tile, columns, camera, shadow, reflection, refraction } and { width, height, film } of the picture; null if there are none

function setHeat() {
  view.heat = !view.heat;
  keep();
  draw();
}

async function showHeat() {
  // What covers the picture has no rays.
  const isCovered = reference() !== null && (view.swap || view.gain !== null);
  at("heat-legend").hidden = !view.heat || !shown || isCovered;
  describeHeat();
  // After local playback, the session's picture of the frame has the numbers.
  if (view.heat && !playing && shown?.isOther && shown.frame === state.picture?.frame) fetchPicture();
  const of = view.heat && !playing && shown && !shown.coarse && !shown.isOther ? `tiles/${state.session}/${shown.id}` : null;
  if (of === heated) return;
  heated = of;
  const { width, height, film } = shown ?? {}, answer = of && await fetch(of).catch(() => null);
  const rays = answer?.ok ? await answer.json() : null;
  if (of !== heated) return;
  heat = rays && { ...rays, width, height, film };
  drawHeat();
}

// Pixels of a tile: those at the right and at the bottom may be smaller.
function heatTile(index) {
  const { tile, columns, width, height } = heat, x = index % columns * tile, y = Math.floor(index / columns) * tile;
  return [x, y, Math.min(tile, width - x), Math.min(tile, height - y)];
}

const total = counts => counts.reduce((sum, count) => sum + count, 0);

// The rays per pixel, by kind, in a tile or in the whole picture.
function heatOf(index) {
  if (index === null) return RAY_KINDS.map(kind => total(heat[kind]) / (heat.width * heat.height));
  const [, , across, down] = heatTile(index);
  return RAY_KINDS.map(kind => heat[kind][index] / (across * down));
}

const rounded = count => String(count < 9.95 ? Number(count.toPrecision(2)) : Math.round(count));

// Equal steps of colour are equal ratios.
function heatColor(share) {
  const place = share * (HEAT.length - 1), index = Math.min(HEAT.length - 2, Math.floor(place));
  return `rgb(${HEAT[index].map((from, channel) => Math.round(from + (place - index) * (HEAT[index + 1][channel] - from)))})`;
}

function drawHeat() {
  at("film").classList.toggle("heat", heat !== null);
  at("heat-map").hidden = heat === null;
  at("heat-scale").hidden = heat === null;
  describeHeat();
  if (!heat) return;
  const map = Object.assign(at("heat-map"), { width: heat.width, height: heat.height }), context = map.getContext("2d");
  const counts = heat.camera.map((_, index) => total(heatOf(index))), low = Math.min(...counts), high = Math.max(...counts);
  counts.forEach((count, index) => {
    context.fillStyle = heatColor(high > low ? Math.log(count / low) / Math.log(high / low) : 0);
    context.fillRect(...heatTile(index));
  });
  map.setAttribute("aria-label", `Rays per pixel, from ${rounded(low)} to ${rounded(high)}`);
  at("heat-scale").firstElementChild.style.background = `linear-gradient(to right, ${HEAT.map(color => `rgb(${color})`)})`;
  [low, Math.sqrt(low * high), high].forEach((count, index) => { at("heat-scale").children[index + 1].textContent = rounded(count); });
}

// Describes the tile under the pointer, that of the marked pixel, or the whole picture.
function describeHeat() {
  if (!view.heat) return;
  const isRead = shown?.full && state.rays === 0;
  if (!heat) { write(at("heat-count"), playing ? "Pause to see the rays." : isRead ? "This picture is from a file: R renders it, with its rays." : "The rays come with the finished picture."); return; }
  const spot = hovered ?? view.spot, pixel = spot?.every((place, axis) => place < heat.film[axis]) ? spot : null;
  const [column, row] = [heat.width, heat.height].map((count, axis) => pixel && Math.floor((pixel[axis] + 0.5) / heat.film[axis] * count / heat.tile));
  const kinds = heatOf(pixel ? row * heat.columns + column : null);
  const parts = kinds.map((count, kind) => count > 0 && `${rounded(count)} ${RAY_KINDS[kind]}`).filter(Boolean);
  const count = rounded(total(kinds));
  write(at("heat-count"), `${count} ${count === "1" ? "ray" : "rays"} per pixel${pixel ? "" : " on average"}: ${parts.join(", ")}`);
}

at("heat").onclick = setHeat;
for (const kind of ["pointermove", "pointerleave"]) at("film").addEventListener(kind, describeHeat);
