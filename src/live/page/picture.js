"use strict";
// The picture on the screen, and the one before the edit.

let described = null;  // the picture of local playback whose pixel is described

const address = picture => `picture/${state.session}/${picture.id}`;

async function fetchPicture() {
  const { picture, session } = state;
  // Hidden pages leave the connections and the time to visible ones.
  if (!picture || document.hidden || loading !== null || (shown && shown.id === picture.id)) return;
  if (playing?.local) {
    arrive(picture.frame);
    if (view.spot && !picture.coarse && described !== picture.id) { described = picture.id; describe(view.spot); }
    return;
  }
  loading = picture.id;
  const image = new Image();
  image.fetchPriority = "high";
  image.src = address(picture);
  let good = true;
  await image.decode().catch(() => { good = false; });
  if (session !== state.session) return;
  loading = null;
  arrive(picture.frame);
  if (good && !(shown && shown.id > picture.id) && !playing?.local) {
    display(image, picture);
    if (!picture.coarse && view.spot) describe(view.spot);
  }
  follow();
  draw();
  if (state.picture && state.picture.id !== picture.id) fetchPicture();
}

function display(image, picture) {
  Object.assign(image, { id: "now", draggable: false, alt: `Frame ${picture.frame}` });
  at("now").replaceWith(image);
  // For measurements; only the latest pictures, because playback has many.
  if (playing || !shown || shown.reloads !== picture.reloads) performance.clearMarks("picture");
  performance.mark("picture", { detail: picture });
  const resized = !shown || String(shown.film) !== String(picture.film) || shown.full !== picture.full;
  shown = picture;
  if (resized) layout();
  if (view.gain !== null) drawComparison();
  magnify();
}

// Width and height of the film of the picture.
const film = () => shown ? shown.film : state.film;

function scale() {
  const stage = at("view"), [width, height] = film();
  const fitting = Math.min(stage.offsetWidth / width, stage.offsetHeight / height);
  return view.zoom > 0 ? view.zoom / devicePixelRatio : fitting;
}

function layout() {
  if (!state) return;
  const [width, height] = film();
  document.documentElement.style.setProperty("--aspect", height / width);
  const now = scale();
  at("view").style.overflow = view.zoom > 0 ? "auto" : "hidden";
  at("film").style.width = width * now + "px";
  at("film").style.height = height * now + "px";
  at("film").classList.toggle("pixels", view.zoom >= 2 && shown !== null && shown.full);
  mark();
  drawPlacement();
  drawPath();
}

function zoom(factor) {
  const stage = at("view"), across = (stage.scrollLeft + stage.clientWidth / 2) / stage.scrollWidth;
  const down = (stage.scrollTop + stage.clientHeight / 2) / stage.scrollHeight;
  view.zoom = factor;
  keep();
  layout();
  stage.scrollLeft = across * stage.scrollWidth - stage.clientWidth / 2;
  stage.scrollTop = down * stage.scrollHeight - stage.clientHeight / 2;
  draw();
}

const zoomBy = factor => state && zoom(Math.max(1 / 8, Math.min(32, scale() * devicePixelRatio * factor)));

function compare(change) {
  Object.assign(view, change);
  keep();
  draw();
}

function drawComparison() {
  const before = reference(), wiping = view.wipe !== null, what = pinned ? "pinned" : "before the edit";
  at("wipe").disabled = at("swap").disabled = at("differ").disabled = !before;
  at("swap").textContent = pinned ? "Pinned" : "Before";
  if (before && before.url !== compared) {
    compared = before.url;
    at("before").src = before.url;
  }
  if (before) keepShape(at("before"), before.film);
  at("film").classList.toggle("wipe", Boolean(before) && wiping && !view.swap);
  at("film").classList.toggle("swap", Boolean(before) && view.swap);
  at("film").style.setProperty("--wipe", 100 * (view.wipe ?? 0.5) + "%");
  const differs = Boolean(before) && view.gain !== null;
  at("difference").hidden = !differs;
  at("compared").hidden = !before || !(wiping || view.swap || differs);
  if (before) {
    const where = differs ? `difference × ${view.gain} from ${pinned ? "the pinned picture" : "before the edit"}` : wiping && !view.swap ? `left: ${what}` : what;
    const which = (before.frame === view.frame ? where : `${where}, frame ${before.frame}`) + (before.coarse ? ", unfinished" : "");
    at("compared").textContent = differs ? `${which}: ${drawDifference()}` : which;
    // There is no difference to show before both pictures are there, in the same size.
    if (differs) at("difference").hidden = differing === null;
  }
}

// As large as fits over the picture.
function keepShape(image, [width, height]) {
  const [across, down] = film(), scale = Math.min(across / width, down / height);
  image.style.width = 100 * scale * width / across + "%";
  image.style.height = 100 * scale * height / down + "%";
}

document.addEventListener("visibilitychange", () => { if (state) fetchPicture(); });
