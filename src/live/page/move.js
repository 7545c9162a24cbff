"use strict";
// The selected entity in the picture: its outline, and handles that move it along an axis or on the ground.

const ARROW = 76;        // length of an arrow that is not seen foreshortened, in pixels of the screen
const GAP = 0.18;        // share of an arrow that is left free around the position, and at which the square begins
const SQUARE = 0.3;      // side of the square, in lengths of an arrow
const PLANE_REACH = 2;  // half the side of the piece of a plane that is outlined, in lengths of an arrow
const EDGE_ON = 0.15;    // sine of the angle to the view, up to which an axis, or the ground, cannot be dragged
const TOUCHED = 0.35;    // share of an arrow from which on it can be taken, by a mouse
const ROUND_SIDES = 72;  // sides of the polygon that is drawn for a round outline
const NEAREST_CUT = 1e-3; // share of the camera's distance in front of it at which outlines are cut
const FARTHEST = 1e5;    // pixels from the picture beyond which outlines need not be exact
const STEP = 0.01;       // movement by an arrow key, in distances of the camera

let placement = null;    // of the selected entity at a frame, with `of`: the entity, the frame and the reload
let placing = false;     // true while a placement is being fetched
let grip = null;         // { handle, from, begun, delta }: the handle that is dragged, from a press on, or moved by keys; and the movement in the world since
let writing = 0;         // the number of moves that are being written

const coarse = matchMedia("(pointer: coarse)");
const handles = [...document.querySelectorAll("#selection .handle")];
const axisVector = axis => [0, 1, 2].map(index => Number(index === axis));
// The combination of vectors, one for each coordinate.
const combined = (vectors, coordinates) => vectors.reduce((sum, vector, index) => add(sum, vector, coordinates[index]), [0, 0, 0]);
const upAxis = ({ up }) => sides[7]({ up }).findIndex(part => part !== 0);
const depthAt = (camera, point) => camera.is_orthographic ? 1 : depthOf(camera, point);

// Pixels of the screen per scene unit at distance 1, to the right and upwards, and the middle of the picture.
function filmScale({ pixel_size }) {
  const box = at("film").getBoundingClientRect(), size = [box.width, box.height], count = film();
  return { size, perUnit: pixel_size.map((pitch, axis) => size[axis] / count[axis] / pitch), middle: scaled(size, 0.5) };
}

// The place of a point in the picture, in pixels of the screen from its corner; null behind the camera.
function onFilm(camera, point) {
  const { right, rise } = directions(camera), { perUnit, middle } = filmScale(camera), away = add(point, camera.position, -1), depth = depthAt(camera, point);
  if (depth <= 0) return null;
  return [middle[0] + dot(away, right) / depth * perUnit[0], middle[1] - dot(away, rise) / depth * perUnit[1]];
}

// The ray through a place in the picture.
function rayThrough(camera, [x, y]) {
  const { forward, right, rise } = directions(camera), { perUnit, middle } = filmScale(camera);
  const across = combined([right, rise], [(x - middle[0]) / perUnit[0], (middle[1] - y) / perUnit[1]]);
  return camera.is_orthographic ? { origin: add(camera.position, across), direction: forward } : { origin: camera.position, direction: add(forward, across) };
}

// The position of the point on a line nearest to a ray, in lengths of `axis`; null if it is behind the camera.
function alongLine(point, axis, { origin, direction }) {
  const away = add(point, origin, -1), slope = dot(axis, direction), square = dot(axis, axis), ahead = dot(direction, direction);
  const apart = square * ahead - slope * slope, along = (slope * dot(direction, away) - ahead * dot(axis, away)) / apart;
  const isSeen = (square * dot(direction, away) - slope * dot(axis, away)) / apart > 0;
  return isSeen && Number.isFinite(along) ? along : null;
}

// The movement of a handle at `anchor` that takes a place in the picture to another; null if there is none.
function pulledBy({ dataset }, camera, anchor, from, to) {
  const up = axisVector(upAxis(camera));
  if (dataset.axis === "ground") {
    const [start, end] = [from, to].map(place => {
      const { origin, direction } = rayThrough(camera, place), length = dot(add(anchor, origin, -1), up) / dot(direction, up);
      return length > 0 && Number.isFinite(length) ? add(origin, direction, length) : null;
    });
    return start && end && add(end, start, -1).map((part, axis) => part * (1 - up[axis]));
  }
  // The pointer counts where it is nearest to the axis in the picture.
  const axis = axisVector(Number(dataset.axis)), base = onFilm(camera, anchor), tip = onFilm(camera, add(anchor, axis, arrowLength(camera, anchor)));
  if (!base || !tip) return null;
  const line = unit(add(tip, base, -1));
  const [start, end] = [from, to].map(place => alongLine(anchor, axis, rayThrough(camera, add(base, line, dot(line, add(place, base, -1))))));
  return start !== null && end !== null ? scaled(axis, end - start) : null;
}

// The length in the world of an arrow at a point.
const arrowLength = (camera, point) => ARROW * depthAt(camera, point) / filmScale(camera).perUnit[1];

// Fetches the place of the selected entity whenever a picture may show another one.
async function fetchPlacement() {
  const part = view.selected?.entity && state ? view.selected : null, of = part && `${reload()} ${state.frame} ${part.entity}`;
  if (placement && placement.part !== part?.entity) placement = null;
  drawPlacement();
  const isLooking = trying !== null && (dragged?.begun || wheeling || flying), isShown = shown && shown.frame === state?.frame && shown.reloads === state.reloads;
  if (!part || !isShown || playing || placing || grip || writing || isLooking || placement?.of === of) return;
  placing = true;
  const answer = await post("placement", part).catch(() => null), found = answer?.ok ? await answer.json() : null;
  const anchor = found && await anchorOf(found, part);
  placing = false;
  if (!grip && !writing && isSelected(part)) placement = { ...found, of, part: part.entity, anchor };
  fetchPlacement();
}

// Where the handles are: at the position or, for one out of view, at the marked pixel if the entity is there.
async function anchorOf({ camera, position }, { entity }) {
  const place = onFilm(camera, position);
  if (place?.every((at, axis) => at >= 0 && at <= filmScale(camera).size[axis])) return position;
  const answer = view.spot && await post("probe", view.spot).catch(() => null), spot = answer?.ok ? await answer.json() : null;
  return spot?.surface?.entity === entity ? spot.surface.point : null;
}

// Follows a camera that is being moved.
function lookAtPlacement(camera) {
  if (!placement?.camera) return;
  placement.camera = camera;
  drawPlacement();
}

// The placement after a movement in the world.
function shifted(placement, delta) {
  const move = point => point && add(point, delta), { outline, values } = placement;
  return {
    ...placement, anchor: move(placement.anchor), position: move(placement.position),
    outline: outline && { ...outline, corners: outline.corners.map(move), rounds: outline.rounds.map(round => ({ ...round, center: move(round.center) })) },
    values: values.map(value => ({ ...value, value: add(value.value, combined(value.change, delta)) })),
  };
}

function drawPlacement() {
  const found = placement?.camera && !playing && shown ? placement : null;
  at("selection").toggleAttribute("hidden", !found);
  at("fixed").hidden = !placement?.fixed;
  write(at("fixed"), placement?.fixed ? `It cannot be moved in the picture: ${relative(placement.fixed)}.` : "");
  if (!found) return;
  const now = grip?.delta ? shifted(found, grip.delta) : found;
  const path = outlinePath(now);
  for (const drawn of at("selection").firstElementChild.children) drawn.setAttribute("d", path);
  for (const handle of handles) drawHandle(handle, now);
}

const pathOf = (places, isClosed = true) => places.length === 0 ? "" : "M" + places.map(place => place.map(part => part.toFixed(1)).join(" ")).join("L") + (isClosed ? "Z" : "");

// The outline in the picture; a ring for an entity without a shape, and a square piece of a plane.
function outlinePath({ camera, anchor, position, outline }) {
  if (!outline) return "";
  let { corners, rounds, normal } = outline;
  if (normal && anchor) {
    const side = unit(cross(normal, Math.abs(normal[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0])), reach = PLANE_REACH * arrowLength(camera, anchor);
    corners = [[1, 1], [1, -1], [-1, -1], [-1, 1]].map(signs => add(anchor, combined([side, cross(normal, side)], signs), reach));
  }
  if (corners.length === 0 && rounds.length === 0) {
    const place = normal ? null : onFilm(camera, position);
    return place ? pathOf(ringAround(place, [[9, 0], [0, 9]], 24)) : "";
  }
  const rims = rounds.map(round => rimOf(round, camera));
  // A camera inside sees no outline.
  return rims.includes(null) ? "" : pathOf(hullOf(visiblePart([...corners, ...rims.flat()], camera).map(point => onFilm(camera, point).map(part => Math.max(-FARTHEST, Math.min(FARTHEST, part))))));
}

const ringAround = (center, [one, other], count) => Array.from({ length: count }, (_, index) => {
  const angle = 2 * Math.PI * index / count;
  return add(add(center, one, Math.cos(angle)), other, Math.sin(angle));
});

// The points of a round part at which rays of the camera touch it: with the sphere as unit, those at a distance of 1 / d towards an eye at
// distance d. A flat part is its own outline.
function rimOf({ center, axes }, camera) {
  if (axes.length === 2) return ringAround(center, axes, ROUND_SIDES);
  const normals = axes.map((_, index) => cross(axes[(index + 1) % 3], axes[(index + 2) % 3])), size = dot(axes[0], normals[0]);
  const towards = camera.is_orthographic ? scaled(directions(camera).forward, -1) : add(camera.position, center, -1);
  const eye = normals.map(normal => dot(normal, towards) / size), distance = camera.is_orthographic ? Infinity : Math.hypot(...eye);
  if (!(distance > 1)) return null;
  const pole = unit(eye), side = unit(cross(pole, axisVector(pole.map(Math.abs).indexOf(Math.min(...pole.map(Math.abs)))))), radius = Math.sqrt(1 - 1 / distance ** 2);
  const ring = [side, cross(pole, side)].map(half => combined(axes, scaled(half, radius)));
  return ringAround(add(center, combined(axes, pole), 1 / distance), ring, ROUND_SIDES);
}

// Points whose hull is the visible part of the hull of others: those in front of the camera, and the cuts of all lines between the others and them.
function visiblePart(points, camera) {
  if (camera.is_orthographic) return points;
  const near = NEAREST_CUT * distanceOf(camera), depths = points.map(point => depthOf(camera, point) - near);
  const seen = points.filter((_, index) => depths[index] >= 0), hidden = points.map((_, index) => index).filter(index => depths[index] < 0);
  const cuts = hidden.flatMap(index => points.flatMap((point, other) => depths[other] > 0 ? [add(point, add(points[index], point, -1), depths[other] / (depths[other] - depths[index]))] : []));
  return [...seen, ...cuts];
}

// The convex hull of places, by Andrew's monotone chain.
function hullOf(places) {
  const sorted = [...places].sort((one, other) => one[0] - other[0] || one[1] - other[1]);
  const turnsLeft = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0;
  const chain = places => places.reduce((kept, place) => {
    while (kept.length > 1 && !turnsLeft(kept.at(-2), kept.at(-1), place)) kept.pop();
    return [...kept, place];
  }, []).slice(0, -1);
  return [...chain(sorted), ...chain(sorted.reverse())];
}

function drawHandle(handle, { anchor, camera, position, values, part }) {
  const up = upAxis(camera), isGround = handle.dataset.axis === "ground", axis = Number(handle.dataset.axis);
  const others = [0, 1, 2].filter(other => other !== up), towards = anchor && (camera.is_orthographic ? directions(camera).forward : unit(add(anchor, camera.position, -1)));
  const sine = anchor && (isGround ? Math.abs(towards[up]) : Math.hypot(...cross(towards, axisVector(axis))));
  const length = anchor && arrowLength(camera, anchor), place = (...steps) => onFilm(camera, steps.reduce((point, [axis, share]) => add(point, axisVector(axis), share * length), anchor));
  const places = !anchor || values.length === 0 ? [] : isGround
    ? [[GAP, GAP], [GAP + SQUARE, GAP], [GAP + SQUARE, GAP + SQUARE], [GAP, GAP + SQUARE]].map(([one, other]) => place([others[0], one], [others[1], other]))
    : arrowWithin(camera, share => place([axis, share]));
  const isSeen = places.length > 0 && !places.includes(null) && (sine > EDGE_ON || grip?.handle === handle);
  handle.toggleAttribute("hidden", !isSeen);
  if (!isSeen) return;
  const shaft = pathOf(places, isGround), middle = isGround ? scaled(add(places[0], places[2]), 0.5) : places[1];
  const ahead = isGround ? null : unit([...add(places[1], places[0], -1), 0]), across = ahead && [-ahead[1], ahead[0]];
  const tip = isGround ? "" : pathOf([add(middle, ahead, 7), add(add(middle, ahead, -6), across, 5.5), add(add(middle, ahead, -6), across, -5.5)]);
  // Fingers take an arrow at its end, where there is room around it.
  const touch = isGround ? pathOf([middle, add(middle, [0.1, 0])]) : pathOf([add(places[0], add(places[1], places[0], -1), coarse.matches ? 0.95 : TOUCHED), places[1]], false);
  const drawn = { halo: shaft + tip, shaft, tip, touch };
  for (const [name, path] of Object.entries(drawn)) handle.querySelector(`.${name}`)?.setAttribute("d", path);
  if (isGround) handle.style.setProperty("--axis", `var(--axis-${"xyz"[up]})`);
  const named = others.map(other => `${"xyz"[other]} ${formatted(Number(position[other].toPrecision(4)))}`).join(", ");
  handle.setAttribute("aria-label", isGround ? `Move ${part} on the ground` : `Move ${part} along ${"xyz"[axis]}`);
  handle.setAttribute("aria-valuenow", formatted(position[isGround ? others[0] : axis]));
  handle.setAttribute("aria-valuetext", isGround ? named : `${"xyz"[axis]} ${formatted(Number(position[axis].toPrecision(4)))}`);
}

// The ends of an arrow, which points against its axis where it would leave the picture.
function arrowWithin(camera, place) {
  const ends = sign => [place(sign * GAP), place(sign)], isInside = ([, tip]) => tip?.every((at, axis) => at > 0 && at < filmScale(camera).size[axis]);
  return !isInside(ends(1)) && isInside(ends(-1)) ? ends(-1) : ends(1);
}

// Numbers that a handle never changes keep their text, and the others are no finer than a tenth of a pixel.
function movedTexts(handle, { camera, anchor, values }, delta) {
  const up = upAxis(camera), moves = [0, 1, 2].filter(axis => handle.dataset.axis === "ground" ? axis !== up : axis === Number(handle.dataset.axis));
  const pixel = depthAt(camera, anchor) / filmScale(camera).perUnit[1];
  return values.flatMap(({ path, key, value, change, is_written }) => {
    const size = Math.max(...change.map(column => Math.hypot(...column))), now = add(value, combined(change, delta));
    const digits = Math.max(0, Math.min(12, Math.ceil(1 - Math.log10(pixel * size))));
    const changes = axis => moves.some(move => Math.abs(change[move][axis]) > 1e-9 * size);
    const text = axis => changes(axis) ? formatted(Number(now[axis].toFixed(digits))) : String(value[axis]);
    if (key || !is_written) return [{ path, key, text: `(${[0, 1, 2].map(text).join(", ")})` }];
    return [0, 1, 2].filter(changes).map(axis => ({ path: `${path}.${axis}`, key, text: text(axis) }));
  });
}

function moveBy(delta) {
  if (!delta) return;
  Object.assign(grip, { delta, begun: true });
  at("selection").classList.add("moving");
  grip.handle.classList.add("held");
  drawPlacement();
  attemptAt(grip.texts = movedTexts(grip.handle, placement, delta));
}

function letGo() {
  const own = grip;
  grip = null;
  at("selection").classList.remove("moving");
  own.handle.classList.remove("held");
  return own;
}

// Ends a move, which is then written.
async function releaseGrip() {
  const { begun, delta } = letGo();
  if (!begun) return;
  placement &&= shifted(placement, delta);
  writing += 1;
  await keepEdits();
  writing -= 1;
  if (placement) placement.of = null;
  fetchPlacement();
}

// Takes a move back. What else is tried stays.
async function cancelGrip() {
  const { texts } = letGo();
  drawPlacement();
  if (!texts) return;
  writing += 1;
  await settled();
  await edit({ drop_paths: texts.map(({ path, key }) => key ? key[0] : path) });
  unsaved = false;
  writing -= 1;
  if (placement) placement.of = null;
  fetchPlacement();
}

function takeHandle(handle, event) {
  if (event.button !== 0) return;
  event.stopPropagation();
  if (grip || !event.isPrimary) return;
  // As in the picture that was pressed: what else the page shows may move or scale it meanwhile.
  const pressed = at("film").getBoundingClientRect();
  const place = ({ clientX, clientY }) => scaled([clientX - pressed.left, clientY - pressed.top], at("film").getBoundingClientRect().width / pressed.width);
  const end = new AbortController(), { signal } = end, own = grip = { handle, from: event, begun: false, delta: null };
  handle.setPointerCapture(event.pointerId);
  // Not of the handle alone: not all browsers send what is captured to it at once.
  document.addEventListener("pointermove", event => {
    const [from, to] = [own.from, event].map(place);
    if (grip !== own || !placement || !event.isPrimary || event.buttons === 0 || !own.begun && Math.hypot(...add(to, from, -1)) < DRAG) return;
    moveBy(pulledBy(handle, placement.camera, placement.anchor, from, to));
  }, { signal });
  for (const name of ["pointerup", "pointercancel"]) document.addEventListener(name, event => {
    if (!event.isPrimary) return;
    end.abort();
    // The click that follows belongs to the handle, wherever it ends.
    moved = true;
    if (grip === own) releaseGrip();
  }, { signal });
}

// The direction of an arrow key: along an axis, or on the ground as it is seen.
function keyDirection({ dataset }, key, camera) {
  const sign = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[key], up = upAxis(camera);
  if (!sign || dataset.axis !== "ground") return sign && scaled(axisVector(Number(dataset.axis)), sign);
  const { forward, right, rise } = directions(camera), others = [0, 1, 2].filter(axis => axis !== up);
  const across = others.reduce((best, axis) => Math.abs(right[axis]) > Math.abs(right[best]) ? axis : best), away = others.find(axis => axis !== across);
  return key === "ArrowRight" || key === "ArrowLeft" ? scaled(axisVector(across), sign * Math.sign(right[across])) : scaled(axisVector(away), sign * (Math.sign(forward[away] + rise[away]) || 1));
}

function keyHandle(handle, event) {
  if (event.ctrlKey || event.altKey || event.metaKey || !placement) return;
  const direction = keyDirection(handle, event.key, placement.camera);
  if (!direction) return;
  event.stopPropagation();
  event.preventDefault();
  if (grip && (grip.handle !== handle || grip.from)) return;
  grip ??= { handle, from: null, begun: false, delta: null };
  const { camera, anchor } = placement, distance = camera.is_orthographic ? camera.pixel_size[1] * film()[1] : Math.hypot(...add(anchor, camera.position, -1));
  const step = Number((STEP * distance).toPrecision(1)) * (event.shiftKey ? 0.1 : 1);
  moveBy(add(grip.delta ?? [0, 0, 0], direction, step));
}

for (const handle of handles) {
  handle.addEventListener("pointerdown", event => takeHandle(handle, event));
  for (const name of ["click", "dblclick"]) handle.addEventListener(name, event => event.stopPropagation());
  handle.addEventListener("keydown", event => keyHandle(handle, event));
  for (const name of ["keyup", "blur"]) handle.addEventListener(name, () => { if (grip?.handle === handle && !grip.from) releaseGrip(); });
}
document.addEventListener("keydown", event => {
  if (!grip || event.key !== "Escape") return;
  cancelGrip();
  event.stopPropagation();
  event.preventDefault();
}, true);
at("view").addEventListener("wheel", event => { if (grip) { event.stopImmediatePropagation(); event.preventDefault(); } }, { capture: true, passive: false });
