"use strict";
// The text panels: the pixel, warnings, times and the plan.

function pixelOf(event) {
  const box = at("film").getBoundingClientRect(), [width, height] = film();
  const place = (from, size, count) => Math.max(0, Math.min(count - 1, Math.floor(from / size * count)));
  return [place(event.clientX - box.left, box.width, width), place(event.clientY - box.top, box.height, height)];
}

function mark() {
  at("mark").hidden = !view.spot;
  if (!view.spot) return;
  const [width, height] = film();
  at("mark").style.left = 100 * (view.spot[0] + 0.5) / width + "%";
  at("mark").style.top = 100 * (view.spot[1] + 0.5) / height + "%";
}

const numbers = list => list.map(number => String(Number(number.toPrecision(6)))).join(", ");

function describeSamples({ samples, all }) {
  if (samples && samples !== all) return all ? `The first of ${all} samples.` : "The first sample.";
  return `The colour is the mean of ${all ?? "several"} samples; the place is what the first of them sees.`;
}

// A place in a file, which opens the editor if there is one.
function placeLink(place) {
  const text = relative(place);
  if (!state.edits.opens) return text;
  const link = element("button", text, { className: "place", title: `Open ${place}` });
  link.onclick = async () => {
    const answer = await post("open", place).catch(() => null);
    write(at("refused"), answer?.ok ? "" : await answer?.text() ?? "the server is away");
  };
  return link;
}

// Marks a pixel, and selects what is there.
async function probe(pixel) {
  view.spot = pixel;
  keep();
  mark();
  const spot = await describe(pixel);
  if (spot) select(spot.surface ? { entity: spot.surface.entity } : { setting: "background" }, true);
}

// Describes the marked pixel.
async function describe(pixel) {
  const answer = await post("probe", pixel).catch(() => null);
  if (!answer || !answer.ok || view.spot !== pixel) return null;
  const spot = await answer.json();
  const rows = [["pixel", pixel.join(", ")]];
  if (spot) {
    if (spot.surface) {
      const { entity, material, place, point, normal, distance } = spot.surface;
      rows.push(["entity", entity]);
      if (material) rows.push(["material", material]);
      if (place) rows.push(["written in", placeLink(place), place]);
      rows.push(["point", numbers(point)], ["normal", numbers(normal)], ["distance", numbers([distance])]);
    } else {
      rows.push(["entity", "none: the background"]);
    }
    rows.push(["linear", numbers(spot.linear)], ["bytes", spot.bytes.join(", ")]);
  } else {
    rows.push(["entity", state.frame_mistakes ? "not known while this frame fails" : "outside the film"]);
  }
  const table = element("table");
  for (const [name, value, title = ""] of rows) {
    const row = table.insertRow();
    const cell = element("td", undefined, { title });
    cell.append(value);
    row.append(element("th", name), cell);
    if (name === "bytes") {
      const swatch = element("span", undefined, { className: "swatch" });
      swatch.style.background = `rgb(${value})`;
      row.lastChild.append(" ", swatch);
    }
  }
  const parts = [element("h2", "Pixel"), table];
  if (spot && spot.all !== 1) parts.push(element("small", describeSamples(spot)));
  at("spot").replaceChildren(...parts);
  traceRays();
  return spot;
}

// The parts of the panel that a person has opened stay open.
for (const id of ["path-panel", "time-panel", "plan-panel"]) {
  at(id).open = view.panels[id] ?? false;
  at(id).addEventListener("toggle", () => { view.panels[id] = at(id).open; keep(); });
}

// Warnings are about the picture, which mistakes replace by the last good one.
function drawWarnings(wrong) {
  const { list, unlisted } = state.warnings, count = list.length + unlisted;
  at("warnings").hidden = at("warned").hidden = Boolean(wrong) || count === 0;
  const text = JSON.stringify(state.warnings);
  if (warnedText === text) return;
  warnedText = text;
  const title = count === 1 ? "1 warning" : `${count} warnings`;
  at("warned").textContent = at("warnings").querySelector("h2").textContent = title;
  const items = list.map(({ name, message, help, place }) => {
    const item = element("li", message), where = element("small", undefined, { title: place ?? "" });
    if (place) where.append(placeLink(place), " · ");
    where.append(name);
    item.append(element("small", help), where);
    return item;
  });
  if (unlisted > 0) items.push(element("li", unlisted === 1 ? "one more" : `${unlisted} more`));
  at("warnings").querySelector("ul").replaceChildren(...items);
}

let warnedText = null;  // that is listed

// For 13 533 milliseconds "13.53 s".
const duration = time => time < 10 ? time.toFixed(2) + " ms" : time < 100 ? time.toFixed(1) + " ms" : time < 999.5 ? time.toFixed(0) + " ms" : (time / 1000).toFixed(2) + " s";

function drawTimes() {
  if (!state.picture) { at("times").replaceChildren(); return; }
  const names = { read: "read files", build: "build the world", animate: "animate", prepare: "prepare", trace: "trace rays", encode: "encode" };
  const most = Math.max(...Object.keys(names).map(name => state.times[name]), 1e-9);
  const rows = Object.entries(names).map(([name, words]) => {
    const reused = name === "trace" ? Math.floor(100 * state.times.reused) : 0;
    const time = state.times[name], row = element("tr"), first = element("td", words + (reused > 0 ? `, ${reused} % kept` : "")), bar = element("div", undefined, { className: "bar" });
    bar.style.width = 100 * time / most + "%";
    first.append(bar);
    row.append(first, element("td", duration(time)));
    return row;
  });
  const rays = element("tr");
  const count = state.rays < 1e6 ? (state.rays / 1e3).toFixed(0) + " k" : (state.rays / 1e6).toFixed(1) + " M";
  rays.append(element("td", "rays"), element("td", count));
  at("times").replaceChildren(...rows, rays);
}

function drawPlan() {
  const row = planned => {
    const made = element("tr"), first = element("td", planned.effect);
    first.append(element("small", planned.why));
    made.append(first, element("td", planned.cost === null ? "" : `${Math.round(100 * planned.cost)} %`));
    return made;
  };
  const needed = state.plan.filter(planned => planned.needed), others = state.plan.filter(planned => !planned.needed);
  write(at("plan-about"), state.plan.some(planned => planned.cost !== null) ? "Share of the frame's time" : "Effects of this frame");
  at("needed").replaceChildren(...needed.map(row));
  at("omitted").replaceChildren(...others.map(row));
  at("omitted").parentElement.hidden = others.length === 0;
  at("omitted-count").textContent = others.length === 1 ? "1 other is omitted" : `${others.length} others are omitted`;
  at("measure").disabled = state.rendering || state.plan.length === 0;
}

