"use strict";
// The path of the camera over the frames of its shot: over the picture, as seen from the current view, and on a map in the panel.

const MOST_KEY_FRAMES = 500;  // in a request
const TICK_APART = 7;         // least mean distance of ticks in pixels
const HIT = 12;               // distance in pixels at which a click hits the path

const pathMagnifier = magnifier(at("path-drawing"));
let path = null;         // { of, ... }: the samples, as in the scene after the reload `of`
let fetchingPath = null; // what is being fetched
let seenFrom = null;     // { camera, frame }: the camera of the view on the screen, and the frame that it is of

// With the path, the view is only looked from, so that the camera can be seen from elsewhere.
const looksFree = () => view.path && state.edits.possible;

// The frames of the keys of cameras, with the names of the channels.
function cameraKeys() {
  const frames = new Map(), cameras = new Set(["camera", ...tracks?.cameras ?? []]);
  for (const track of tracks?.tracks ?? []) {
    if (!track.channel || !cameras.has(track.target)) continue;
    for (const { toFrame } of passesOf(track)) {
      for (let index = 0; index < track.keys.length; index++) {
        const frame = Math.round(toFrame(timeOf(track, index)));
        if (frame < 0 || frame >= state.frames) continue;
        if (!frames.has(frame)) frames.set(frame, []);
        frames.get(frame).push({ camera: track.target, channel: track.channel });
      }
    }
  }
  return frames;
}

// Samples the path after every change of the scene, and in another shot. It is not sampled while values are dragged or the film plays.
async function fetchPath() {
  at("path-panel").hidden = !view.path;
  // Tracks that arrive ask for the path again.
  if (!view.path || playing || state.reloads === 0 || fetching !== null) return;
  if (trying !== null) { settled().then(fetchPath); return; }
  const of = `${reload()} ${tracks?.of}`, isInside = path?.of === of && path.frames[0] <= state.frame && state.frame <= path.frames[1];
  const wanted = `${of} ${state.frame}`;
  if (isInside || fetchingPath === wanted) return;
  fetchingPath = wanted;
  const frame = state.frame, keys = cameraKeys();
  const answer = await post("path", { keys: [...keys.keys()].sort((one, other) => one - other).slice(0, MOST_KEY_FRAMES) }).catch(() => null);
  const found = answer?.ok ? await answer.json() : null;
  if (fetchingPath !== wanted) return;
  fetchingPath = null;
  path = found ? { ...found, of } : { of, frames: [frame, frame], samples: [], notes: ["There is no camera, or this frame fails."], svg: "" };
  path.keys = path.samples.flatMap(sample => {
    const channels = (keys.get(sample.frame) ?? []).filter(({ camera }) => camera === path.camera).map(({ channel }) => channel);
    return channels.length ? [{ sample, channels }] : [];
  });
  drawMap();
  drawPath();
}

function drawMap() {
  const { camera, frames: [first, last], is_still, about, notes, svg, samples } = path;
  const still = is_still ? "The camera stands still: there is no path. " : "";
  const hint = view.path && state.edits.possible ? "Drag the picture to look from elsewhere; the camera stays." : "";
  at("path-about").replaceChildren(...samples.length ? [element("p", `${still}${camera}, frames ${first} to ${last}: ${about}.`)] : [], ...[...notes, hint].filter(Boolean).map(note => element("p", note, { className: "faint" })));
  const parsed = new DOMParser().parseFromString(svg.replace(/(id="|url\(#)frame/g, "$1path-frame"), "text/html").body;
  // Its keys are buttons, which an image has not.
  parsed.querySelector("svg")?.setAttribute("role", "group");
  at("path-drawing").replaceChildren(...parsed.childNodes);
  pathMagnifier.show(camera);
}

// The camera at a frame, between samples by interpolation.
function sampleAt(frame) {
  const { samples } = path, next = samples.findIndex(sample => sample.frame >= frame);
  if (next <= 0) return samples[next === 0 ? 0 : samples.length - 1];
  const [one, other] = [samples[next - 1], samples[next]], share = (frame - one.frame) / (other.frame - one.frame);
  const between = (a, b) => add(scaled(a, 1 - share), b, share);
  return { ...one, eye: between(one.eye, other.eye), axes: one.axes.map((axis, index) => unit(between(axis, other.axes[index]))), half_size: between(one.half_size, other.half_size) };
}

// The edges of what a camera sees, up to the reach.
function frustum({ eye, axes: [right, up, forward], half_size: [width, height], is_orthographic }, reach) {
  const corners = [[-1, 1], [1, 1], [1, -1], [-1, -1]], across = ([x, y]) => add(scaled(right, x * width), up, y * height);
  const far = corners.map(corner => add(is_orthographic ? add(eye, across(corner)) : add(eye, across(corner), reach), forward, reach));
  const near = corners.map(corner => is_orthographic ? add(eye, across(corner)) : eye);
  return [[...far, far[0]], ...is_orthographic ? [[...near, near[0]]] : [], ...near.map((corner, index) => [corner, far[index]])];
}

// Projects lines of the scene to the picture. What is behind the eye is cut off.
const throughView = camera => points => {
  const { position, pixel_size, is_orthographic } = camera, { forward, right, rise } = directions(camera), [width, height] = film();
  const near = 1e-3 * path.reach, depth = point => dot(add(point, position, -1), forward);
  const place = point => {
    const from = add(point, position, -1), far = is_orthographic ? 1 : dot(from, forward);
    return [width / 2 + dot(from, right) / (far * pixel_size[0]), height / 2 - dot(from, rise) / (far * pixel_size[1])];
  };
  const lines = [[]];
  points.forEach((point, index) => {
    const before = points[index - 1], here = depth(point), there = before && depth(before);
    if (before && here > near !== there > near) lines.at(-1).push(place(add(before, add(point, before, -1), (near - there) / (here - there))));
    if (here > near) lines.at(-1).push(place(point));
    else if (lines.at(-1).length > 0) lines.push([]);
  });
  return lines.filter(line => line.length > 0);
};

const throughMap = ({ across, upwards, x, y, scale }) => points => [points.map(point => [x + scale * point[across], y - scale * point[upwards]])];

const lengthOf = line => line.slice(1).reduce((sum, [x, y], index) => sum + Math.hypot(x - line[index][0], y - line[index][1]), 0);
const outlineOf = lines => lines.map(line => "M" + line.map(place => place.map(number => Math.max(-1e5, Math.min(1e5, number)).toFixed(2)).join(" ")).join("L")).join("");

// Strokes across the path at equal steps of frames, as many as there is room for.
function ticks(project, pixel) {
  const even = path.samples.filter(({ frame }) => (frame - path.frames[0]) % path.step === 0), eyes = even.map(({ eye }) => eye);
  const length = project(eyes).reduce((sum, line) => sum + lengthOf(line), 0) / pixel;
  const stride = Math.max(1, roundStep(Math.max(1, TICK_APART * even.length / Math.max(length, 1))));
  const strokes = [];
  for (let index = 0; index < eyes.length; index += stride) {
    const [line] = project([eyes[Math.max(0, index - 1)], eyes[index], eyes[Math.min(eyes.length - 1, index + 1)]]);
    if (line?.length !== 3) continue;
    const [[fromX, fromY], [x, y], [toX, toY]] = line, apart = Math.hypot(toX - fromX, toY - fromY);
    if (apart < 1e-6) continue;
    const [right, down] = [3 * pixel * (toX - fromX) / apart, 3 * pixel * (toY - fromY) / apart];
    strokes.push([[x - down, y + right], [x + down, y - right]]);
  }
  return strokes;
}

// The path through a projection, where `pixel` is the size of one: lines, keys and the frustum of the shown frame. The keyboard reaches the
// keys of the first view.
function pathParts(project, pixel, isFirst) {
  const { samples, reach, keys, frames: [first, last] } = path, eyes = samples.map(({ eye }) => eye);
  const frame = shown?.frame ?? view.frame, now = frame < first || frame > last ? null : sampleAt(frame);
  const line = (name, lines) => lines.length ? [drawing("path", { class: name, d: outlineOf(lines) })] : [];
  const targets = samples.filter(({ target }) => target).map(({ target }) => target);
  const parts = [...line("target", targets.length ? project(targets) : []), ...line("eye", project(eyes)), ...line("ticks", ticks(project, pixel))];
  parts.push(...line("wide", project(eyes)));
  // From within, the frustum is the edge of the picture.
  const isWithin = now && project.isPicture && Math.hypot(...add(seenFrom.camera.position, now.eye, -1)) < 1e-6 * reach;
  if (now && !isWithin) {
    parts.push(...line("view", frustum(now, reach).flatMap(project)));
    for (const [[x, y]] of project([now.eye])) parts.push(drawing("circle", { class: "eye-dot", cx: x, cy: y, r: 3.5 * pixel }));
  }
  for (const { sample, channels } of keys) {
    const { frame, eye, target } = sample, isTarget = target && channels.every(channel => channel === "Target");
    for (const [[x, y]] of project([isTarget ? target : eye])) {
      const label = `Key of ${path.camera} at frame ${frame}, ${(frame / state.rate).toFixed(2)} s: ${[...new Set(channels)].join(", ")}`;
      const dot = drawing("circle", { class: "path-key", cx: x, cy: y, r: 4.5 * pixel, "data-frame": frame, ...isFirst ? { role: "button", "aria-label": label, tabindex: 0 } : {} });
      dot.append(drawing("title", {}, label));
      parts.push(dot);
    }
  }
  return parts;
}

// Draws the path over the picture and on the map.
function drawPath() {
  const over = at("path-view"), isLook = state.edits.look !== null, isSeen = view.path && path?.samples.length > 0;
  const isKnown = seenFrom && shown && (isLook || !playing && seenFrom.frame === shown.frame);
  over.toggleAttribute("hidden", !isSeen || !isKnown);
  if (!isSeen) return;
  if (isKnown) {
    const [width, height] = film(), project = throughView(seenFrom.camera);
    project.isPicture = true;
    over.setAttribute("viewBox", `0 0 ${width} ${height}`);
    over.setAttribute("aria-label", `Path of ${path.camera}: ${path.about}`);
    replaceParts(over, pathParts(project, 1 / scale(), false));
  }
  const svg = at("path-drawing").querySelector("svg");
  if (!svg || !at("path-panel").open) return;
  viewsOf(svg).forEach((place, index) => {
    const group = svg.querySelector(`.path-${index}`) ?? svg.appendChild(drawing("g", { class: `path-${index}`, "clip-path": `url(#path-frame${index + 1})` }));
    replaceParts(group, pathParts(throughMap(place), 1 / pathMagnifier.part.zoom, index === 0));
  });
}

// Replaces parts that differ: what is pressed must stay until the click. The key that has the keyboard's focus keeps it.
function replaceParts(place, parts) {
  const text = parts.map(part => part.outerHTML).join("");
  if (place.drawn === text) return;
  place.drawn = text;
  const frame = place.contains(document.activeElement) ? document.activeElement.dataset.frame : undefined;
  place.replaceChildren(...parts);
  if (frame !== undefined) place.querySelector(`[data-frame="${frame}"]`)?.focus();
}

// The frame of the path that is nearest to a place in a drawing; undefined beyond a distance.
function frameNear([x, y], projections, most) {
  let found, least = most;
  for (const project of projections) {
    for (let index = 0; index < path.samples.length; index++) {
      const [one, other] = [path.samples[index], path.samples[Math.min(index + 1, path.samples.length - 1)]], [line] = project([one.eye, other.eye]);
      if (line?.length !== 2) continue;
      const [[fromX, fromY], [toX, toY]] = line, [right, down] = [toX - fromX, toY - fromY];
      const share = Math.max(0, Math.min(1, ((x - fromX) * right + (y - fromY) * down) / Math.max(right * right + down * down, 1e-12)));
      const apart = Math.hypot(x - fromX - share * right, y - fromY - share * down);
      if (apart < least) { least = apart; found = Math.round(one.frame + share * (other.frame - one.frame)); }
    }
  }
  return found;
}

// Seeks to the key or to the part of the path that was clicked. Returns whether there is one.
function seekPath(event, place, projections, most) {
  const key = event.target.dataset?.frame, frame = key === undefined ? frameNear(place, projections, most) : Number(key);
  if (frame === undefined) return false;
  if (playing) pause();
  seek(frame);
  return true;
}

function setPath() {
  view.path = !view.path;
  if (view.path) at("path-panel").open = true;
  oriented = null;
  keep();
  if (!state) return;
  fetchPath();
  at("path-panel").scrollIntoView({ block: "nearest" });
  draw();
}

// Clicks that end a drag of the picture are not for the path.
at("path-view").onclick = event => {
  const box = at("film").getBoundingClientRect(), pixel = 1 / scale();
  const place = [(event.clientX - box.left) * pixel, (event.clientY - box.top) * pixel];
  if (!moved && seekPath(event, place, [throughView(seenFrom.camera)], HIT * pixel)) event.stopPropagation();
};
at("path-view").ondblclick = event => event.stopPropagation();
at("path-drawing").onclick = event => {
  const svg = at("path-drawing").querySelector("svg");
  if (!svg || pathMagnifier.moved || !path?.samples.length) return;
  const { x, y, zoom } = pathMagnifier.part, [width, height] = (svg.dataset.size ?? "1 1").split(" ").map(Number), [across, down] = pathMagnifier.place(event);
  const views = viewsOf(svg), place = [(x + across / zoom) * width, (y + down / zoom) * height];
  const within = views.filter(({ left, top, width, height }) => place[0] >= left && place[0] <= left + width && place[1] >= top && place[1] <= top + height);
  seekPath(event, place, within.map(throughMap), HIT / zoom);
};
for (const id of ["path-view", "path-drawing"]) at(id).addEventListener("keydown", event => {
  if (event.target.dataset.frame === undefined || event.key !== "Enter" && event.key !== " ") return;
  seekPath(event);
  event.stopPropagation();
  event.preventDefault();
});
pathMagnifier.shown = () => { if (state) drawPath(); };
at("path-panel").addEventListener("toggle", () => { if (state) drawPath(); });
at("camera-path").onclick = setPath;
