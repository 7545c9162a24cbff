"use strict";
// The rays of the marked pixel, as a tree and as a drawing. They are traced while the panel is open and the film rests.

const rayMagnifier = magnifier(at("ray-drawing"));
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
  const parsed = new DOMParser().parseFromString(svg, "text/html").body;
  // Thin lines are hard to hit.
  for (const line of parsed.querySelectorAll("[data-ray]")) {
    const wide = line.cloneNode();
    wide.setAttribute("class", "wide");
    line.after(wide);
  }
  at("ray-drawing").replaceChildren(...parsed.childNodes);
  rayMagnifier.show(`${view.spot} ${sample}`);
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
