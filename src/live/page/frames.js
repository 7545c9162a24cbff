"use strict";
// Finished frames of the session, decoded ahead of playback, which then needs no answer of the session for each frame.

const AHEAD = 12;             // frames that are decoded in advance: half a second at 24 frames per second
const NOTICE_INTERVAL = 250; // milliseconds between notices of the frame to the session, which other pages show
const ahead = new Map();      // frame -> { generation, image }; the image is null until it is decoded
let failed = null;            // the reason why frames are not written, once it is shown
let noticed = 0;              // time of the last notice

const isKept = frame => state.cached.ranges.some(([first, last]) => first <= frame && frame <= last);

// Decodes the next frames, and forgets those that are over.
function decodeAhead(from) {
  const { generation } = state.cached, near = new Set(), [first, last] = range();
  for (let next = 0; next < Math.min(AHEAD, last - first + 1); next++) {
    const frame = from + next;
    if (frame <= last) near.add(frame);
    else if (view.loop) near.add(first + (frame - first) % (last - first + 1));
  }
  for (const [frame, decoded] of ahead) if (!near.has(frame) || decoded.generation !== generation) ahead.delete(frame);
  for (const frame of near) if (!ahead.has(frame) && isKept(frame)) decode(frame, generation);
}

async function decode(frame, generation) {
  const decoded = { generation, image: null }, image = new Image();
  ahead.set(frame, decoded);
  image.src = `frame/${state.session}/${generation}/${frame}`;
  try {
    await image.decode();
    decoded.image = image;
  } catch {
    // No longer kept; it is requested again unless it is over.
    if (ahead.get(frame) === decoded) ahead.delete(frame);
  }
}

// Shows a frame if it is decoded. Returns whether it is.
function showDecoded(frame) {
  const image = ahead.get(frame)?.image;
  if (!image) return false;
  ahead.delete(frame);
  const { naturalWidth: width, naturalHeight: height } = image;
  const { reloads, film, picture } = state, full = state.detail === "full";
  // The number may be that of another picture, since this one did not come from the session.
  const isOther = !picture || picture.coarse || picture.frame !== frame;
  display(image, { id: picture?.id ?? 0, frame, reloads, width, height, film, full, coarse: false, isOther });
  view.frame = frame;
  const now = performance.now();
  if (requested === null && now - noticed > NOTICE_INTERVAL) {
    noticed = now;
    request({ seek: { frame, playing: true } });
  }
  drawTransport();
  return true;
}

function drawKept() {
  const share = frame => (100 * frame / Math.max(state.frames, 1)).toFixed(3) + "%";
  const stops = state.cached.ranges.flatMap(([first, last]) => {
    const from = share(first), to = share(last + 1);
    return [`transparent ${from}`, `var(--kept) ${from}`, `var(--kept) ${to}`, `transparent ${to}`];
  });
  at("kept").style.backgroundImage = stops.length ? `linear-gradient(to right, ${stops.join(", ")})` : "none";
  const kept = state.cached.ranges.reduce((sum, [first, last]) => sum + last - first + 1, 0);
  const { cache_error } = state;
  if (cache_error && failed !== cache_error) { failed = cache_error; write(at("refused"), `no more frames are kept in the folder: ${cache_error}`); }
  at("kept").title = `${kept} of ${state.frames} frames are finished and play at full rate`;
}
