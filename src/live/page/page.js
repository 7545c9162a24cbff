"use strict";
// The state shared by all parts of the page, and the events of the session.

const at = id => document.getElementById(id);
const element = (name, text, attributes = {}) => {
  const made = Object.assign(document.createElement(name), attributes);
  if (text !== undefined) made.textContent = text;
  return made;
};

// A part of an SVG drawing.
function drawing(name, attributes, text) {
  const made = document.createElementNS(at("plot").namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

// The view: it survives reloads of the scene, of the page, and of the server.
const view = { zoom: 0, loop: true, speed: 1, detail: null, frame: null, range: null, lanes: null, spot: null, selected: null, outline: null, wipe: null, panels: {}, swap: false, gain: null, heat: false, heatKind: "rays", path: false, scene: null };
const storage = "rayreel" + location.host;
try { Object.assign(view, JSON.parse(sessionStorage.getItem(storage))); } catch { /* keep the defaults */ }
const keep = () => { try { sessionStorage.setItem(storage, JSON.stringify(view)); } catch { /* not kept */ } };

let state = null;      // of the session, as of the last event
let away = false;      // true if the server is unreachable
let shown = null;      // the picture on the screen
let loading = null;    // the picture that is being fetched
let compared = null;   // the picture from before the edit that is loaded
let requested = null;  // the requested frame that has not arrived yet
let playing = null;    // { since, from, local }: local while finished frames are shown without the session

const post = (path, body) => fetch(path, { method: "POST", body: JSON.stringify(body) });
// Requests are sent one after the other, so that the last one takes effect.
let queue = Promise.resolve();
const request = what => queue = queue.then(() => post("view", what)).then(answer => { if (!answer.ok) requested = null; }, () => { requested = null; });

// All pages of a browser share an event stream, because a browser opens few connections to one server. Without shared workers, each
// page has its own stream while it is visible.
function connect() {
  let worker;
  try { worker = new SharedWorker("stream.js"); } catch { listen(); return; }
  worker.port.onmessage = ({ data }) => receive(data);
  worker.onerror = listen;
  const join = () => worker.port.postMessage("join");
  join();
  addEventListener("pagehide", () => worker.port.postMessage("leave"));
  addEventListener("pageshow", event => { if (event.persisted) join(); });
}

function listen() {
  let events = null;
  const open = () => {
    if (document.hidden) { events?.close(); events = null; return; }
    if (events && events.readyState !== EventSource.CLOSED) return;
    events = new EventSource("events");
    events.onmessage = event => receive({ text: event.data, away: false });
    events.onerror = () => {
      receive({ away: true });
      // A browser stops reconnecting when the server refuses; this finds a restarted server.
      if (events?.readyState === EventSource.CLOSED) setTimeout(open, 1000);
    };
  };
  open();
  document.addEventListener("visibilitychange", open);
}

function receive(message) {
  away = message.away;
  if (message.text && !away) update(JSON.parse(message.text));
  else drawStatus();
}

function update(latest) {
  const other = state === null || state.session !== latest.session;
  state = latest;
  // Frames and pixels of another scene are meaningless in this one.
  if (view.scene !== state.scene) Object.assign(view, { scene: state.scene, frame: null, range: null, spot: null, selected: null });
  if (other) { shown = compared = loading = requested = null; }
  if (view.frame === null) view.frame = state.frame;
  if (other && view.detail && view.detail !== state.detail) request({ detail: view.detail });
  // Requests the picture again that stayed coarse while no page was visible.
  const left = state.picture && state.picture.coarse && !state.rendering;
  if (other && (view.frame !== state.frame || left)) scrubbed = view.frame;
  if (!other && requested === null && playing === null && scrubbed === null) view.frame = state.frame;
  // The frame will not arrive: it cannot be rendered, or another page has requested another one.
  const rests = !state.rendering && (!state.picture || state.picture.frame === state.frame);
  if (requested !== null && (state.frame_mistakes || rests && state.frame !== Math.min(requested, state.frames - 1))) requested = null;
  // Playback stops at a frame that could not be rendered, even if it has gone on meanwhile; the frame is not requested again.
  if (state.frame_mistakes && playing) {
    playing = scrubbed = null;
    view.frame = state.frame;
  }
  follow();
  fetchPicture();
  fetchTracks();
  fetchOutline();
  fetchPath();
  followEdit(other);
  draw();
}

// Written only if it differs, because screen readers read every change aloud.
function write(place, text) {
  if (place.textContent !== text) place.textContent = text;
}

function draw() {
  if (!state) return;
  const name = state.scene.split(/[\\/]/).pop();
  const wrong = state.mistakes || state.frame_mistakes;
  const frame = state.frames > 1 ? ` · frame ${view.frame}` : "";
  document.title = (wrong ? "✗ " : "") + name + frame + " · rayreel";
  at("scene").textContent = name;
  at("scene").title = state.scene;
  drawStatus();
  orient();
  drawTransport();
  drawKept();
  drawEdits();
  drawSelected();
  fetchPlacement();
  drawExport();
  drawComparison();
  drawMistakes(wrong);
  drawWarnings(wrong);
  drawTimes();
  drawPlan();
  drawCurve();
  showHeat();
  at("fit").setAttribute("aria-pressed", view.zoom === 0);
  at("whole").setAttribute("aria-pressed", view.zoom === 1);
  at("wipe").setAttribute("aria-pressed", view.wipe !== null);
  at("swap").setAttribute("aria-pressed", view.swap);
  at("differ").setAttribute("aria-pressed", view.gain !== null);
  at("heat").setAttribute("aria-pressed", view.heat);
  at("camera-path").setAttribute("aria-pressed", view.path);
  at("pin").setAttribute("aria-pressed", pinned !== null);
}

function drawStatus() {
  const wrong = away || Boolean(state && (state.mistakes || state.frame_mistakes));
  write(at("status"), status());
  at("status").classList.toggle("wrong", wrong);
  document.body.classList.toggle("away", away);
  at("status").title = away ? "Start `rayreel watch` again: the page connects by itself" : "";
  const waits = state !== null && state.rendering && !wrong && playing === null;
  at("progress").hidden = !waits;
  if (waits) at("progress").value = state.progress;
  const percent = 100 * state?.progress;
  at("percent").textContent = waits && percent > 0 ? `${percent.toFixed(percent < 9.95 ? 1 : 0)} %` : "";
}

function status() {
  if (away) return "the server is away";
  if (!state) return "connecting";
  if (state.mistakes || state.frame_mistakes) return shown ? "last good picture" : "nothing to show yet";
  if (!shown) return "reading";
  const size = `${shown.width} × ${shown.height}`;
  if (shown.full) return size;
  return state.rendering ? `${size}, rendering` : `${size}, draft`;
}
