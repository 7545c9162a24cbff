"use strict";
// Drawings of the scene in the panel, which are magnified and moved by the wheel, fingers and keys.

const MAX_ZOOM = 50;
const MOST_STEPS = 7;        // between the numbers of a magnified grid
let panelScrolled = 0;       // time at which the panel was scrolled last
document.querySelector("aside").addEventListener("scroll", () => { panelScrolled = performance.now(); });

// The least of 1, 2 and 5 times a power of ten that is not less than a number.
function roundStep(least) {
  const power = 10 ** Math.floor(Math.log10(least) + 1e-9), digit = [1, 2, 5, 10].find(digit => digit * power >= least * (1 - 1e-9));
  return digit * power;
}

// The multiples of a step from one number to another, with their texts.
function multiples(from, to, step) {
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), found = [];
  for (let index = Math.ceil(from / step - 1e-9); index * step <= to + 1e-9 * step; index++) found.push([index * step, (index * step + 0).toFixed(Math.min(decimals, 12))]);
  return found;
}

// The views of a drawing: the rectangle, the indices of the coordinates to the right and upwards, the place of the origin, and the scale.
function viewsOf(box) {
  return [...box.querySelectorAll(".plane")].map(plane => {
    const [left, top, width, height, across, upwards, x, y, scale] = plane.dataset.view.split(" ").map(Number);
    return { left, top, width, height, across, upwards, x, y, scale };
  });
}

// Lets a drawing be magnified. `part` is what is in view: its magnification, and its left upper corner from 0 to 1.
function magnifier(box) {
  const own = { part: { zoom: 1, x: 0, y: 0 }, place, moved: false, shown: () => {} };
  const touching = new Map();  // the pointers that press, with their places
  let pressed = [0, 0];  // the place of the last press on the page
  const clamp = (value, most) => Math.max(0, Math.min(most, value));

  // Shows a new drawing: the same part of it if it is of the same thing.
  own.show = of => showPart(of === own.part.of ? own.part : { of, zoom: 1, x: 0, y: 0 });

  // Shows a part of the drawing, within its edges.
  function showPart({ of, zoom, x, y }) {
    const svg = box.querySelector("svg");
    zoom = Math.max(1, Math.min(MAX_ZOOM, zoom));
    own.part = { of, zoom, x: clamp(x, 1 - 1 / zoom), y: clamp(y, 1 - 1 / zoom) };
    if (!svg) return;
    const [width, height] = svg.dataset.size?.split(" ") ?? svg.getAttribute("viewBox").split(" ").slice(2);
    svg.dataset.size = `${width} ${height}`;
    const seen = { left: own.part.x * width, top: own.part.y * height, width: width / zoom, height: height / zoom };
    svg.setAttribute("viewBox", [seen.left, seen.top, seen.width, seen.height].join(" "));
    svg.style.setProperty("--zoom", zoom);
    box.classList.toggle("zoomed", zoom > 1);
    svg.querySelector(".near")?.remove();
    if (zoom > 1) svg.append(nearGrid(viewsOf(box), seen, zoom));
    own.shown();
  }

  // The grids of the parts of views that are seen, with numbers at their edges.
  function nearGrid(views, seen, zoom) {
    const group = drawing("g", { class: "near", "aria-hidden": "true" });
    for (const { left, top, width, height, x, y, scale } of views) {
      const [from, to] = [Math.max(left, seen.left), Math.min(left + width, seen.left + seen.width)];
      const [low, high] = [Math.max(top, seen.top), Math.min(top + height, seen.top + seen.height)];
      if (from >= to || low >= high) continue;
      const step = roundStep(Math.max(to - from, high - low) / scale / MOST_STEPS);
      for (const [value, text] of multiples((from - x) / scale, (to - x) / scale, step)) {
        const at = x + scale * value;
        group.append(drawing("path", { class: "grid", d: `M${at} ${low}V${high}` }));
        if (at - from > 30 / zoom && to - at > 14 / zoom) group.append(drawing("text", { x: at, y: high - 4 / zoom, "text-anchor": "middle" }, text));
      }
      for (const [value, text] of multiples((y - high) / scale, (y - low) / scale, step)) {
        const at = y - scale * value;
        group.append(drawing("path", { class: "grid", d: `M${from} ${at}H${to}` }));
        if (high - at > 16 / zoom && at - low > 8 / zoom) group.append(drawing("text", { x: from + 3 / zoom, y: at + 4 / zoom }, text));
      }
    }
    return group;
  }

  // A place on the page as fractions of the drawing's box.
  function place({ clientX, clientY }) {
    const { left, top, width, height } = box.getBoundingClientRect();
    return [(clientX - left) / width, (clientY - top) / height];
  }

  // Magnifies the drawing by a factor; what was at one place of its box is at another one then.
  function zoomBy(factor, [x, y] = [0.5, 0.5], [toX, toY] = [x, y]) {
    const { part } = own, zoom = Math.max(1, Math.min(MAX_ZOOM, part.zoom * factor));
    showPart({ ...part, zoom, x: part.x + x / part.zoom - toX / zoom, y: part.y + y / part.zoom - toY / zoom });
  }

  const middle = () => [0, 1].map(axis => [...touching.values()].reduce((sum, place) => sum + place[axis], 0) / touching.size);
  const spread = () => { const [one, other] = touching.values(); return Math.hypot(one[0] - other[0], one[1] - other[1]); };
  box.onpointerdown = event => {
    if (event.button !== 0) return;
    own.moved = false;
    pressed = [event.clientX, event.clientY];
    touching.set(event.pointerId, place(event));
    if (event.pointerType !== "mouse" && (own.part.zoom > 1 || touching.size > 1)) box.setPointerCapture(event.pointerId);
  };
  box.onpointermove = event => {
    if (!touching.has(event.pointerId) || touching.size > 2) return;
    const from = middle(), apart = touching.size === 2 ? spread() : 1, here = place(event);
    if (Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) >= DRAG) own.moved = true;
    // Only a movement of the mouse is captured: its press is for what is drawn.
    if (own.moved && own.part.zoom > 1 && event.pointerType === "mouse") box.setPointerCapture(event.pointerId);
    touching.set(event.pointerId, here);
    zoomBy((touching.size === 2 ? spread() : 1) / Math.max(apart, 1e-3), from, middle());
  };
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) box.addEventListener(end, event => touching.delete(event.pointerId));
  box.onpointerleave = event => touching.delete(event.pointerId);
  box.ondblclick = () => showPart({ ...own.part, zoom: 1 });
  // The wheel scrolls the panel on as long as it does so already, and when there is nothing to make smaller.
  box.addEventListener("wheel", event => {
    if (performance.now() - panelScrolled < 200 || own.part.zoom === 1 && event.deltaY >= 0) return;
    zoomBy(Math.exp(-event.deltaY * (event.deltaMode === 0 ? 1 : 30) / (event.ctrlKey ? 100 : 400)), place(event));
    event.preventDefault();
  }, { passive: false });
  box.onkeydown = event => {
    const factor = { "+": 1.5, "=": 1.5, "-": 1 / 1.5, 0: 1 / MAX_ZOOM }[event.key], step = own.part.zoom > 1 && { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey || !factor && !step) return;
    if (factor) zoomBy(factor);
    else zoomBy(1, [0, 0], step.map(part => 0.1 * part));
    event.stopPropagation();
    event.preventDefault();
  };
  return own;
}
