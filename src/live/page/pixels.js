"use strict";
// Pixels of pictures: a pinned picture, the difference between two pictures, and the loupe.

const GAINS = [1, 8, 64];  // amplifications of differences
const LOUPE = 9;           // pixels across the loupe

let pinned = null;         // { url, frame, film, coarse }: the pinned picture, a blob of this page
let differing = null;      // what the difference on the screen is of
let difference = "";       // in words
let magnifying = false;    // true while the key of the loupe is down

// The picture to compare with: the pinned one or else the one before the edit.
const reference = () => pinned ?? (state.before && { ...state.before, url: address(state.before) });

function canvasOf(image) {
  const canvas = element("canvas", undefined, { width: image.naturalWidth, height: image.naturalHeight });
  canvas.getContext("2d", { willReadFrequently: true }).drawImage(image, 0, 0);
  return canvas;
}

function bytesOf(image) {
  const canvas = canvasOf(image);
  return canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
}

// Pins the picture on the screen, or releases the pinned one.
async function pin() {
  if (pinned) {
    URL.revokeObjectURL(pinned.url);
    pinned = null;
  } else if (shown) {
    const { frame, film, coarse } = shown;
    const blob = await new Promise(done => canvasOf(at("now")).toBlob(done));
    pinned = { url: URL.createObjectURL(blob), frame, film, coarse };
  }
  draw();
}

// Turns the difference on, then through its amplifications, then off.
function setDifference() {
  if (!at("differ").disabled) compare({ gain: GAINS[view.gain ? GAINS.indexOf(view.gain) + 1 : 0] ?? null, wipe: null, swap: false });
}

// Draws the absolute difference of each channel, amplified. Returns it in words.
function drawDifference() {
  const [now, past] = [at("now"), at("before")], of = `${now.src} ${past.src} ${view.gain}`;
  if (differing === of) return difference;
  differing = null;
  if (!past.complete || !past.naturalWidth || !now.naturalWidth) return "loading";
  const [width, height] = [now.naturalWidth, now.naturalHeight];
  if (width !== past.naturalWidth || height !== past.naturalHeight) return `sizes differ: ${past.naturalWidth} × ${past.naturalHeight} and ${width} × ${height}`;
  const [one, other] = [bytesOf(now), bytesOf(past)];
  differing = of;
  at("difference").width = width;
  at("difference").height = height;
  let most = 0, count = 0;
  for (let start = 0; start < one.data.length; start += 4) {
    let largest = 0;
    for (let channel = start; channel < start + 3; channel++) {
      const apart = Math.abs(one.data[channel] - other.data[channel]);
      largest = Math.max(largest, apart);
      one.data[channel] = view.gain * apart;
    }
    most = Math.max(most, largest);
    count += largest > 0;
  }
  at("difference").getContext("2d").putImageData(one, 0, 0);
  const share = 100 * count / (width * height);
  return difference = most === 0 ? "same" : `at most ${most} of 255, in ${share < 0.1 ? "less than 0.1" : share.toFixed(1)} % of the pixels`;
}

// Shows the pixels around the one under the pointer, or around the marked one.
function magnify() {
  const pixel = hovered ?? view.spot ?? centre();
  at("loupe").hidden = !magnifying || !shown;
  if (at("loupe").hidden) return;
  const image = at("film").classList.contains("swap") ? at("before") : at("now"), [width, height] = film(), canvas = at("loupe").firstChild;
  const [x, y] = [Math.floor((pixel[0] + 0.5) * image.naturalWidth / width), Math.floor((pixel[1] + 0.5) * image.naturalHeight / height)];
  const context = canvas.getContext("2d", { willReadFrequently: true }), side = canvas.width / LOUPE, middle = (LOUPE - 1) / 2;
  context.imageSmoothingEnabled = false;
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.drawImage(image, x - middle, y - middle, LOUPE, LOUPE, 0, 0, canvas.width, canvas.height);
  const [red, green, blue] = context.getImageData(canvas.width / 2, canvas.height / 2, 1, 1).data;
  for (const [color, inset] of [["#000", 0], ["#fff", 1]]) {
    context.strokeStyle = color;
    context.strokeRect(middle * side + inset + 0.5, middle * side + inset + 0.5, side - 2 * inset - 1, side - 2 * inset - 1);
  }
  write(at("loupe").lastChild, `${pixel.join(", ")}: ${red} ${green} ${blue}`);
  const box = at("film").getBoundingClientRect(), stage = at("stage").getBoundingClientRect(), own = at("loupe").getBoundingClientRect();
  const left = box.left - stage.left + (pixel[0] + 0.5) / width * box.width + 16, top = box.top - stage.top + (pixel[1] + 0.5) / height * box.height + 16;
  at("loupe").style.left = Math.min(left, left + own.width > stage.width ? left - own.width - 32 : left) + "px";
  at("loupe").style.top = Math.min(top, top + own.height > stage.height ? top - own.height - 32 : top) + "px";
}

function holdLoupe(down) {
  magnifying = down;
  magnify();
}

at("pin").onclick = pin;
at("differ").onclick = setDifference;
at("before").onload = () => { if (state) draw(); };
at("film").addEventListener("pointermove", magnify);
document.addEventListener("keyup", event => { if (event.key.toLowerCase() === "z") holdLoupe(false); });
addEventListener("blur", () => holdLoupe(false));
