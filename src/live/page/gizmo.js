"use strict";
// The axes of the scene in a corner of the picture, as the camera sees them. A click on an end looks from there.

const ARM = 34;             // length of an axis, in units of the drawing
const GIZMO_TIME = 1500;    // milliseconds for which the axes stay after the camera was moved

let oriented = null;        // the frame and the reload whose axes are drawn
let gizmoRest;              // the timer after which they are hidden

const ends = [...at("gizmo").querySelectorAll("g")];
const endOf = ({ dataset }) => [0, 1, 2].map(axis => axis === Number(dataset.axis) ? Number(dataset.sign) : 0);

function drawGizmo(camera) {
  seenFrom = { camera, frame: shown?.frame };
  drawPath();
  const { forward, right, rise } = directions(camera), focused = document.activeElement;
  const far = end => dot(endOf(end), forward);
  for (const end of ends) {
    const x = ARM * dot(endOf(end), right), y = -ARM * dot(endOf(end), rise), line = end.querySelector("line");
    end.classList.toggle("facing", far(end) < -0.94);
    end.setAttribute("transform", `translate(${x.toFixed(2)} ${y.toFixed(2)})`);
    if (line) for (const [name, value] of [["x2", -x], ["y2", -y]]) line.setAttribute(name, value.toFixed(2));
  }
  // Nearer ends cover farther ones.
  at("gizmo").append(...ends.sort((one, other) => far(other) - far(one)));
  if (at("gizmo").contains(focused)) focused.focus();
}

// Draws the axes of a view that is being moved.
function showGizmo(camera) {
  drawGizmo(camera);
  at("gizmo").toggleAttribute("hidden", false);
  at("gizmo").classList.add("moving");
  clearTimeout(gizmoRest);
  gizmoRest = setTimeout(() => at("gizmo").classList.remove("moving"), GIZMO_TIME);
}

// Draws the axes of the frame while they are visible.
async function orient() {
  const of = `${reload()} ${state?.frame}`, seen = view.path || at("stage").matches(":hover, :focus-within") || matchMedia("(hover: none)").matches;
  if (!state?.edits.possible || !shown || !seen || playing || oriented === of || trying !== null || shown.coarse || shown.frame !== state.frame) return;
  oriented = of;
  const answer = await post("camera").catch(() => null);
  const camera = answer?.ok ? await answer.json() : null;
  if (oriented !== of || trying !== null) return;
  at("gizmo").toggleAttribute("hidden", !camera);
  if (camera) drawGizmo(camera);
}

for (const end of ends) {
  const go = () => lookFrom(() => endOf(end));
  end.onclick = go;
  end.onkeydown = event => {
    if (event.key !== "Enter" && event.key !== " ") return;
    go();
    event.stopPropagation();
    event.preventDefault();
  };
}
for (const event of ["pointerenter", "focusin"]) at("stage").addEventListener(event, orient);
