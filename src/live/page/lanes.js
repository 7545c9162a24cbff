"use strict";
// The shots and the keys of tracks below the timeline: a lane for each track, in the order of the file.

const EASINGS = ["Linear", "Hold", "EaseIn", "EaseOut", "EaseInOut", "Cubic", "CatmullRom", "Monotone",
  ...["Sine", "Quad", "Cubic", "Quart", "Quint", "Expo", "Circ", "Back", "Elastic", "Bounce"].flatMap(curve => ["In", "Out", "InOut"].map(end => end + curve))];

let tracks = null;     // { of, tracks, unlisted, cameras, easings }, as in the file after the reload `of`
let fetching = null;   // the reload whose tracks are being fetched
let changing = false;  // true while a key is added, removed or eased
let picked = null;     // { path, index }: the key in the panel
let moving = null;     // { path, index, time } while a key is moved
let added = null;      // { path, time }: the new key, which is selected once it is listed

// Without a choice, keys are shown unless there is little room.
const narrow = matchMedia("(max-width: 760px)");
const showsLanes = () => view.lanes ?? !narrow.matches;
const lastFrame = () => Math.max(state.frames - 1, 1);
const frameOf = (track, time) => (track.offset + time / track.speed) * state.rate;
const keyTime = (track, frame) => (frame / state.rate - track.offset) * track.speed;
const trackAt = path => tracks?.tracks.find(track => track.path === path);
const nameOf = track => track.channel ? `${track.target} · ${track.channel}` : track.target;
const percentage = frame => (100 * Math.max(0, Math.min(1, frame / lastFrame()))).toFixed(4) + "%";

const reload = () => `${state.session} ${state.reloads}`;
// Keys that are out of date are not changed: their places may be those of others.
const canChange = () => tracks.of === reload() && !changing && !moving && trying === null && state.edits.tried.length === 0;

// Fetches the tracks after every change of the file.
async function fetchTracks() {
  const of = reload();
  if (tracks?.of === of || fetching === of || state.edits.tried.length > 0 || !state.edits.possible) return;
  fetching = of;
  const answer = await post("tracks", null).catch(() => null), found = answer?.ok ? await answer.json() : null;
  if (fetching !== of) return;
  fetching = null;
  if (found) tracks = { ...found, of };
  fetchPath();
  if (!found) return;
  if (picked && !trackAt(picked.path)?.keys[picked.index]) picked = null;
  if (!pickAdded()) { drawLanes(); drawKey(); }
}

function drawLanes() {
  const count = tracks?.tracks.length ?? 0, focused = document.activeElement?.dataset.key;
  at("keyed").hidden = count === 0 || state.frames < 2;
  at("keyed").setAttribute("aria-pressed", showsLanes());
  at("lanes").hidden = at("keyed").hidden || !showsLanes();
  at("transport").classList.toggle("laned", !at("lanes").hidden);
  if (at("lanes").hidden) { at("transport").style.removeProperty("--gutter"); drawRuler(); return; }
  const rows = tracks.tracks.map(track => {
    const row = element("div", undefined, { className: "lane", title: "Double click for a new key" });
    const name = track.channel ? nameOf(track) : "shots";
    row.append(element("div", undefined, { className: "passes" }), element("span", name, { title: name }), ...track.keys.flatMap((key, index) => keyButton(track, index)));
    row.ondblclick = event => { if (event.target === row) addKey(track, Math.round(frameAt(event))); };
    drawPasses(track, row);
    return row;
  });
  if (tracks.unlisted > 0) rows.push(element("p", tracks.unlisted === 1 ? "1 track with more keys is not shown" : `${tracks.unlisted} tracks with more keys are not shown`, { className: "faint" }));
  const playhead = element("div", undefined, { id: "playhead" });
  at("lanes").replaceChildren(playhead, ...rows);
  fitNames();
  // The lanes end where the scrubber does, whatever the width of the scroll bar.
  at("lanes").style.setProperty("--bar", `${at("lanes").offsetWidth - at("lanes").clientWidth}px`);
  if (focused) at("lanes").querySelector(`[data-key="${focused}"]`)?.focus();
  drawPlayhead();
}

// Names get the room that the longest needs, within limits, and longer ones a second line.
function fitNames() {
  const names = [...at("lanes").querySelectorAll(".lane > span")], { style } = at("transport");
  style.removeProperty("--gutter");
  const room = names[0]?.clientWidth ?? 0, longest = Math.max(...names.map(name => name.scrollWidth)), em = parseFloat(getComputedStyle(at("transport")).fontSize);
  const most = Math.min(18 * em, 0.32 * at("transport").clientWidth), gutter = parseFloat(getComputedStyle(at("scrubber")).marginLeft);
  if (longest > room) style.setProperty("--gutter", `${Math.max(gutter, Math.min(most, gutter + longest - room + 2))}px`);
  for (const name of names) name.classList.toggle("long", name.scrollWidth > name.clientWidth);
  drawRuler();
}

function drawPlayhead() {
  const playhead = at("playhead"), row = at("lanes").querySelector(".lane");
  if (!playhead || !row) return;
  playhead.style.left = row.offsetLeft + row.clientWidth * Math.min(1, view.frame / lastFrame()) + "px";
  playhead.style.height = at("lanes").scrollHeight + "px";
}

// The frame under the pointer.
function frameAt(event) {
  const box = at("lanes").querySelector(".lane").getBoundingClientRect();
  return (event.clientX - box.left) / box.width * lastFrame();
}

// A key and, for a shot, its camera.
function keyButton(track, index) {
  const { time, text, easing } = track.keys[index], button = element("button", undefined, { className: "key" });
  const place = () => {
    const frame = frameOf(track, timeOf(track, index));
    for (const part of parts) part.style.left = percentage(frame);
    button.classList.toggle("outside", frame < 0 || frame > lastFrame() + 1);
  };
  const parts = track.channel ? [button] : [button, element("small", text.slice(1, -1))];
  button.dataset.key = `${track.path}.${index}`;
  button.title = `${formatted(time)} s: ${text}${easing ? ", " + easing : ""}`;
  button.setAttribute("aria-label", `Key of ${nameOf(track)} at ${formatted(time)} seconds`);
  button.setAttribute("aria-pressed", picked?.path === track.path && picked.index === index);
  button.onclick = () => {
    const part = track.channel ? track.part : { camera: text.slice(1, -1) };
    pick(track, index);
    if (part) select(part, true);
  };
  button.onpointerdown = event => {
    if (event.button !== 0 || !canChange()) return;
    const from = frameAt(event), end = new AbortController(), { signal } = end;
    button.setPointerCapture(event.pointerId);
    // Not of the button alone: not all browsers send what is captured to it at once.
    document.addEventListener("pointermove", event => {
      const by = Math.round(frameAt(event) - from);
      if (by === 0 && !moving) return;
      moveKey(track, index, by);
      place();
      drawPasses(track, button.parentElement);
      showKeyTime(button, track, index);
      seekKey(track, moving.time);
    }, { signal });
    for (const name of ["pointerup", "pointercancel"]) document.addEventListener(name, () => { end.abort(); at("key-time").hidden = true; if (moving) dropKey(); }, { signal });
  };
  button.onkeydown = event => {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const removes = event.key === "Delete" || event.key === "Backspace";
    if (!by && !removes) return;
    if (by && canChange()) { moveKey(track, index, by); seekKey(track, moving.time); dropKey(); }
    if (removes && !event.repeat) removeKey(track, index);
    event.stopPropagation();
    event.preventDefault();
  };
  place();
  return parts;
}

// Tries a key some frames later, at a whole frame and between its neighbours.
function moveKey(track, index, by) {
  const { keys } = track, frame = Math.round(frameOf(track, keys[index].time) + by), step = Math.abs(track.speed) / state.rate;
  const low = index > 0 ? keys[index - 1].time + Math.min(step, 0.5 * (keys[index].time - keys[index - 1].time)) : -Infinity;
  const high = index < keys.length - 1 ? keys[index + 1].time - Math.min(step, 0.5 * (keys[index + 1].time - keys[index].time)) : Infinity;
  const time = Math.max(low, Math.min(high, keyTime(track, frame)));
  moving = { path: track.path, index, time };
  attempt([`${track.path}.${index}.0=${formatted(time)}`]);
}

async function dropKey() {
  await keepEdits();
  moving = null;
  if (!at("refused").textContent) return;
  await dropEdits();
  drawLanes();
}

async function change(what) {
  if (changing) return;
  changing = true;
  await keepEdits();
  const done = await edit({ try_key: what });
  if (done) await keepEdits();
  changing = false;
  return done;
}

// Adds a key at a frame or, where keys repeat, at the time in the first pass.
async function addKey(track, frame) {
  const time = folded(track, keyTime(track, frame));
  added = { path: track.path, time };
  if (!await change({ add: [track.path, time] })) added = null;
}

// Selects the new key, if it is listed. Returns whether it is.
function pickAdded() {
  const track = added && trackAt(added.path), index = track ? track.keys.findIndex(({ time }) => Math.abs(time - added.time) < 1e-5) : -1;
  if (index < 0) return false;
  added = null;
  pick(track, index);
  at("lanes").querySelector(`[data-key="${track.path}.${index}"]`)?.focus();
  return true;
}

const removeKey = (track, index) => { picked = null; change({ remove: [track.path, track.keys[index].time] }); };

// Shows a key in the panel, and its frame.
function pick(track, index) {
  picked = { path: track.path, index };
  seekKey(track, moving?.time ?? track.keys[index].time);
  drawLanes();
  drawKey();
  // On phones, where all of the page scrolls, a dragged key would move away.
  const panel = at("key").parentElement;
  if (panel.scrollHeight > panel.clientHeight) at("key").scrollIntoView({ block: "nearest" });
}

// Selects the key of a track at the shown frame or, without one, the last before it. Returns whether the track has a lane.
function pickAtFrame(path) {
  const track = trackAt(path);
  if (!track) return false;
  if (!showsLanes()) setLanes();
  const latest = folded(track, keyTime(track, view.frame + 0.5 * Math.sign(track.speed)));
  picked = { path, index: Math.max(0, track.keys.findLastIndex(({ time }) => time <= latest)) };
  drawLanes();
  drawKey();
  const button = at("lanes").querySelector(`[data-key="${path}.${picked.index}"]`);
  button?.focus();
  button?.scrollIntoView({ block: "nearest" });
  return true;
}

// Shows the frame of a time of keys, if there is one.
function seekKey(track, time) {
  const frame = Math.round(frameOf(track, time));
  if (playing) pause();
  if (frame >= 0 && frame < state.frames && frame !== view.frame) seek(frame);
}

function drawKey() {
  const track = picked && trackAt(picked.path), key = track?.keys[picked.index];
  at("key").hidden = !key;
  if (!key || trying !== null) return;
  const focused = at("key").contains(document.activeElement) ? document.activeElement.getAttribute("aria-label") : null;
  const { path, index } = picked, row = (name, input) => {
    const made = element("label", undefined, { className: "value" });
    input.setAttribute("aria-label", name);
    made.append(element("span", name), input);
    return made;
  };
  const options = (names, current, set) => {
    const select = element("select");
    select.append(...[...new Set([current, ...names])].map(name => element("option", name, { value: name, selected: name === current })));
    select.onchange = () => set(select.value);
    return select;
  };
  const time = element("input", undefined, { type: "number", step: "any", value: key.time });
  time.onchange = async () => { if (time.value !== "") { await attempt([`${path}.${index}.0=${formatted(Number(time.value))}`]); keepEdits(); } };
  const rows = [element("h3", track.channel ? `key of ${nameOf(track)}` : "shot"), row("time", time)];
  if (!track.channel) {
    rows.push(row("camera", options(tracks.cameras, key.text.slice(1, -1), async name => { await attempt([`${path}.${index}.1=${quoted(name)}`]); keepEdits(); })));
  } else {
    if (key.value) rows.push(valueRow(key.value, "value"));
    const easing = options(EASINGS, key.easing ?? "Linear", name => change({ ease: [path, key.time, name] }));
    easing.disabled = index === track.keys.length - 1;
    rows.push(row("easing", easing));
  }
  const remove = element("button", "Delete", { title: "Remove this key (delete)" });
  remove.onclick = () => removeKey(track, index);
  const add = element("button", track.channel ? "New key here" : "New shot here", { title: "New key at the shown frame, with the value there" });
  add.onclick = () => addKey(track, view.frame);
  const foot = element("p");
  foot.append(remove, " ", add, " ", placeLink(track.place));
  at("key").replaceChildren(...rows, foot);
  if (focused) [...at("key").querySelectorAll("input, select")].find(input => input.getAttribute("aria-label") === focused)?.focus();
}

at("keyed").onclick = () => { view.lanes = !showsLanes(); keep(); drawLanes(); };

// On narrow screens, undoing is at hand below the picture, and what is needed less is behind a button.
function placeControls() {
  if (narrow.matches) at("forth").after(at("undo"), at("redo"));
  else at("help").before(at("undo"), at("redo"));
  for (const [id, sign, name] of [["undo", "↶", "Undo"], ["redo", "↷", "Redo"]]) {
    at(id).textContent = narrow.matches ? sign : name;
    at(id).setAttribute("aria-label", name);
  }
  if (state) drawLanes();
}
narrow.onchange = placeControls;
placeControls();
at("more").onclick = () => at("more").setAttribute("aria-expanded", at("transport").classList.toggle("open"));
new ResizeObserver(() => document.documentElement.style.setProperty("--transport-height", `${at("transport").offsetHeight}px`)).observe(at("transport"));
