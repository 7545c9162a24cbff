"use strict";
// The rays of the marked pixel, as a tree and as a drawing. They are traced while the panel is open and the film rests.

let traced = null;  // the pixel, sample, frame and reload of the rays

async function traceRays() {
  const panel = at("rays");
  panel.hidden = !view.spot;
  if (!view.spot || !panel.open || playing) return;
  const sample = Number(at("ray-sample").value), of = `${view.spot} ${sample} ${reload()} ${state.frame}`;
  if (traced === of) return;
  traced = of;
  const answer = await post("rays", [view.spot, sample]).catch(() => null);
  if (traced !== of) return;
  const rays = answer?.ok ? await answer.json() : null;
  if (traced !== of) return;
  if (!rays) traced = null;
  drawRays(rays ?? { sample: 0, samples: 1, rows: [], notes: ["There are no rays."], svg: "" });
}

function drawRays({ sample, samples, rows, notes, svg }) {
  at("ray-sample").parentElement.hidden = samples === 1;
  at("ray-sample").max = samples - 1;
  at("ray-sample").value = sample;
  const drawing = new DOMParser().parseFromString(svg, "text/html").body;
  // Thin lines are hard to hit.
  for (const line of drawing.querySelectorAll("[data-ray]")) {
    const wide = line.cloneNode();
    wide.setAttribute("class", "wide");
    line.after(wide);
  }
  at("ray-drawing").replaceChildren(...drawing.childNodes);
  showPart(`${view.spot} ${sample}` === inView.of ? inView : { of: `${view.spot} ${sample}`, zoom: 1, x: 0, y: 0 });
  const lists = [at("ray-tree")];
  lists[0].replaceChildren();
  for (const row of rows) {
    while (lists.length <= row.depth) {
      const list = element("ul");
      lists.at(-1).lastChild.append(list);
      lists.push(list);
    }
    lists.length = row.depth + 1;
    lists.at(-1).append(rayRow(row));
  }
  at("ray-notes").replaceChildren(...notes.map(note => element("p", note)));
}

const short = number => String(Number(number.toPrecision(4)));

function rayRow({ key, kind, text, place, distance, share, adds }) {
  const item = element("li"), row = element("div", text, { tabIndex: 0, title: place ?? "" });
  const percent = share && [...new Set(share.map(part => short(100 * part)))].join(", ");
  const facts = [distance !== null && `distance ${short(distance)}`, percent && `${percent} % of its light`, adds && `adds ${adds.map(short).join(", ")}`].filter(Boolean);
  if (facts.length > 0) row.append(element("small", facts.join(" · ")));
  row.dataset.ray = key;
  row.classList.add("row", kind ?? "none");
  item.append(row);
  return item;
}

const MAX_ZOOM = 50;
let inView = { zoom: 1, x: 0, y: 0 };  // the part of the drawing in view: its magnification, and its left upper corner from 0 to 1
let panelScrolled = 0;                 // time at which the panel was scrolled last

// Shows a part of the drawing, within its edges.
function showPart({ of, zoom, x, y }) {
  const svg = at("ray-drawing").querySelector("svg"), clamp = (value, most) => Math.max(0, Math.min(most, value));
  zoom = Math.max(1, Math.min(MAX_ZOOM, zoom));
  inView = { of, zoom, x: clamp(x, 1 - 1 / zoom), y: clamp(y, 1 - 1 / zoom) };
  if (!svg) return;
  const [width, height] = svg.dataset.size?.split(" ") ?? svg.getAttribute("viewBox").split(" ").slice(2);
  svg.dataset.size = `${width} ${height}`;
  svg.setAttribute("viewBox", [inView.x * width, inView.y * height, width / zoom, height / zoom].join(" "));
  svg.style.setProperty("--zoom", zoom);
  at("ray-drawing").classList.toggle("zoomed", zoom > 1);
}

// A place on the page as fractions of the drawing's box.
function placeIn({ clientX, clientY }) {
  const box = at("ray-drawing").getBoundingClientRect();
  return [(clientX - box.left) / box.width, (clientY - box.top) / box.height];
}

// Magnifies the drawing by a factor; what was at one place of its box is at another one then.
function zoomDrawing(factor, [x, y] = [0.5, 0.5], [toX, toY] = [x, y]) {
  const zoom = Math.max(1, Math.min(MAX_ZOOM, inView.zoom * factor));
  showPart({ ...inView, zoom, x: inView.x + x / inView.zoom - toX / zoom, y: inView.y + y / inView.zoom - toY / zoom });
}

const touching = new Map();  // the pointers that press the drawing, with their places in it
const middleOfTouch = () => [0, 1].map(axis => [...touching.values()].reduce((sum, place) => sum + place[axis], 0) / touching.size);
const spreadOfTouch = () => { const [one, other] = touching.values(); return Math.hypot(one[0] - other[0], one[1] - other[1]); };

at("ray-drawing").onpointerdown = event => {
  if (event.button !== 0) return;
  touching.set(event.pointerId, placeIn(event));
  if (inView.zoom > 1 || touching.size > 1) at("ray-drawing").setPointerCapture(event.pointerId);
};
at("ray-drawing").onpointermove = event => {
  if (!touching.has(event.pointerId) || touching.size > 2) return;
  const from = middleOfTouch(), apart = touching.size === 2 ? spreadOfTouch() : 1;
  touching.set(event.pointerId, placeIn(event));
  zoomDrawing((touching.size === 2 ? spreadOfTouch() : 1) / Math.max(apart, 1e-3), from, middleOfTouch());
};
for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) at("ray-drawing").addEventListener(end, event => touching.delete(event.pointerId));
at("ray-drawing").onpointerleave = event => touching.delete(event.pointerId);
at("ray-drawing").ondblclick = () => showPart({ ...inView, zoom: 1 });
// The wheel scrolls the panel on as long as it does so already, and when there is nothing to make smaller.
document.querySelector("aside").addEventListener("scroll", () => { panelScrolled = performance.now(); });
at("ray-drawing").addEventListener("wheel", event => {
  if (performance.now() - panelScrolled < 200 || inView.zoom === 1 && event.deltaY >= 0) return;
  zoomDrawing(Math.exp(-event.deltaY * (event.deltaMode === 0 ? 1 : 30) / (event.ctrlKey ? 100 : 400)), placeIn(event));
  event.preventDefault();
}, { passive: false });
at("ray-drawing").onkeydown = event => {
  const factor = { "+": 1.5, "=": 1.5, "-": 1 / 1.5, 0: 1 / MAX_ZOOM }[event.key], step = inView.zoom > 1 && { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
  if (event.ctrlKey || event.metaKey || event.altKey || !factor && !step) return;
  if (factor) zoomDrawing(factor);
  else zoomDrawing(1, [0, 0], step.map(part => 0.1 * part));
  event.stopPropagation();
  event.preventDefault();
};

// Highlights a ray in the tree and in the drawing, or none.
function highlight(key) {
  for (const part of at("rays").querySelectorAll("[data-ray]")) part.classList.toggle("lit", part.dataset.ray === key);
  at("rays").classList.toggle("lit", key !== undefined);
  return at("ray-tree").querySelector(".lit");
}

const keyOf = event => event.target.closest("[data-ray]")?.dataset.ray;
at("ray-tree").onpointerover = event => highlight(keyOf(event));
at("ray-tree").addEventListener("focusin", event => highlight(keyOf(event)));
at("ray-drawing").onpointerover = event => {
  const row = highlight(keyOf(event)), tree = at("ray-tree");
  if (row) tree.scrollTop = row.offsetTop - tree.clientHeight / 2;
};
at("rays").onpointerleave = () => highlight();
at("rays").addEventListener("focusout", () => highlight());
at("rays").ontoggle = traceRays;
at("ray-sample").onchange = traceRays;
