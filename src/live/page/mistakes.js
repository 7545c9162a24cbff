"use strict";
// The strip of mistakes at the bottom of the last good picture: the first of them with its line or, expanded, all.

let wrongText = null;    // that is shown
let isExpanded = false;

// A text with paths relative to the scene's folder.
function relative(text) {
  const folder = state.scene.slice(0, 1 + Math.max(state.scene.lastIndexOf("/"), state.scene.lastIndexOf("\\")));
  const isStart = before => before === "" || /[\s"'`(]$/.test(before);
  return folder ? text.split(folder).reduce((before, part) => before + (isStart(before) ? "" : folder) + part) : text;
}

function drawMistakes(wrong) {
  at("wrong").hidden = !wrong;
  if (!wrong) { wrongText = null; isExpanded = false; return; }
  if (wrongText === wrong.text) return;
  wrongText = wrong.text;
  const text = relative(wrong.text).trim(), [first] = text.split(/\n\s*\n(?=error: )/), [title, ...lines] = first.split("\n");
  const help = lines.filter(line => /^\s*= help: /.test(line)).map(line => line.replace(/^\s*= /, ""));
  const brief = [...excerpt(lines), ...help], isEmpty = line => /^\s*(\||--> .*)?\s*$/.test(line);
  const isWhole = first === text && lines.filter(line => !isEmpty(line)).length <= brief.length;
  const place = wrong.place ? [placeLink(wrong.place), " "] : [];
  const heading = isExpanded ? [wrong.count === 1 ? "1 mistake" : `${wrong.count} mistakes`] : [...place, title.replace(/^error: /, "")];
  at("wrong").querySelector("h2").replaceChildren(...heading);
  at("wrong").querySelector("h2").title = wrong.place ?? "";
  at("messages").replaceChildren(...messages(isExpanded ? text : brief.join("\n")));
  at("expand").hidden = isWhole && !isExpanded;
  at("expand").textContent = isExpanded ? "Show the first" : wrong.count === 1 ? "Show all of it" : `Show all ${wrong.count}`;
  at("expand").setAttribute("aria-expanded", isExpanded);
  at("wrong").classList.toggle("expanded", isExpanded);
  for (const lines of at("messages").querySelectorAll("pre")) lines.scrollLeft = caretLeft(lines);
}

// The line of the file that is marked first, with its mark, without indentation.
function excerpt(lines) {
  const marked = lines.findIndex(line => /^\s*\|.*\^/.test(line));
  const found = marked < 0 ? [] : lines.slice(Math.max(0, marked - 1), marked + 1);
  const indent = Math.min(...found.map(line => /\| ?( *)/.exec(line)?.[1].length ?? 0));
  return found.map(line => line.replace(/\|( ?) */, match => match.slice(0, match.length - indent)));
}

// Prose wraps; quoted lines of files, which have line numbers and bars, scroll on their own.
function messages(text) {
  const parts = [];
  for (const line of text.split("\n")) {
    const name = /^(\s*\d*\s*\||\.\.\.)/.test(line) ? "pre" : "p", last = parts.at(-1);
    if (last?.name === name) last.lines.push(line);
    else parts.push({ name, lines: [line] });
  }
  const made = ({ name, lines }) => element(name, lines.join("\n"), name === "pre" ? { tabIndex: 0 } : {});
  return parts.filter(({ lines }) => lines.some(line => line.trim())).map(made);
}

// Returns the horizontal offset of the first caret, if it is out of sight.
function caretLeft(text) {
  const lines = text.textContent.split("\n"), carets = lines.find(line => line.includes("^")) ?? "";
  const left = text.scrollWidth * carets.indexOf("^") / Math.max(...lines.map(line => line.length));
  return left < 0.7 * text.clientWidth ? 0 : left - text.clientWidth / 3;
}

at("expand").onclick = () => {
  isExpanded = !isExpanded;
  wrongText = null;
  drawMistakes(state.mistakes || state.frame_mistakes);
};
