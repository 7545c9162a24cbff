"""Draws the reports of `rayreel accuracy --json` as one SVG: for every scene the error against the time."""

import json
import math
import sys

WIDTH, HEIGHT, COLUMNS = 232, 176, 4
LEFT, RIGHT, TOP, BOTTOM = 30, 8, 22, 30
# Knobs that are drawn, and their colours, which do on white and on black.
KNOBS = {"samples": "#c2571a", "max error": "#2f7ed8"}


def points(report, knob):
    """The times, in milliseconds, and errors of a knob's values, by time."""
    usual = 1e3 * report["rows"][0]["seconds"]["median"]
    rows = [row for row in report["rows"] if row["knob"] == knob and row["error"]["rms"] > 0 and row["same_as"] is None]
    return sorted((usual * row["relative"]["median"], row["error"]["rms"]) for row in rows)


def ticks(low, high):
    """Powers of ten between two logarithms; with 2 and 5 where there are few."""
    digits = (1,) if high - low > 1.6 else (1, 2, 5)
    values = (digit * 10.0**power for power in range(math.floor(low), math.ceil(high) + 1) for digit in digits)
    return [value for value in values if low <= math.log10(value) <= high]


class Axis:
    """A logarithmic axis over values, from one coordinate to another."""

    def __init__(self, values, start, end):
        logarithms = [math.log10(value) for value in values]
        self.low, self.high = min(logarithms) - 0.08, max(logarithms) + 0.08
        self.start, self.end = start, end

    def at(self, value):
        share = (math.log10(value) - self.low) / (self.high - self.low)
        return self.start + share * (self.end - self.start)

    def ticks(self):
        return ticks(self.low, self.high)


def panel(report, x, y):
    curves = {knob: points(report, knob) for knob in KNOBS}
    places = [place for curve in curves.values() for place in curve]
    across = Axis([time for time, _ in places], x + LEFT, x + WIDTH - RIGHT)
    up = Axis([error for _, error in places], y + HEIGHT - BOTTOM, y + TOP)
    name = report["scene"].removeprefix("scenes/").removesuffix(".ron")
    yield f'<text x="{x + LEFT}" y="{y + 14}" class="name">{name}</text>'
    for tick in across.ticks():
        at = across.at(tick)
        yield f'<path class="grid" d="M{at:.1f} {y + TOP}V{y + HEIGHT - BOTTOM}"/>'
        yield f'<text x="{at:.1f}" y="{y + HEIGHT - BOTTOM + 12}" text-anchor="middle">{tick:g}</text>'
    for tick in up.ticks():
        at = up.at(tick)
        yield f'<path class="grid" d="M{x + LEFT} {at:.1f}H{x + WIDTH - RIGHT}"/>'
        yield f'<text x="{x + LEFT - 4}" y="{at + 3:.1f}" text-anchor="end">{tick:g}</text>'
    for knob, curve in curves.items():
        line = " ".join(f"{across.at(time):.1f},{up.at(error):.1f}" for time, error in curve)
        yield f'<polyline points="{line}" stroke="{KNOBS[knob]}"/>'
        for time, error in curve:
            yield f'<circle cx="{across.at(time):.1f}" cy="{up.at(error):.1f}" r="2.5" fill="{KNOBS[knob]}"/>'


def main(paths):
    reports = [json.load(open(path, encoding="utf-8")) for path in paths]
    width, height = COLUMNS * WIDTH, math.ceil(len(reports) / COLUMNS) * HEIGHT + 24
    print(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">')
    print(
        "<style>text { font: 10px sans-serif; fill: #808080; } .name { font-weight: bold; font-size: 11px; } "
        ".grid { stroke: #80808040; } polyline { fill: none; stroke-width: 1.5; }</style>"
    )
    for index, report in enumerate(reports):
        for line in panel(report, index % COLUMNS * WIDTH, index // COLUMNS * HEIGHT):
            print(line)
    legend = (("samples", "as many samples in all pixels"), ("max error", "as many as each pixel needs"))
    for index, (knob, words) in enumerate(legend):
        x = LEFT + 220 * index
        print(f'<circle cx="{x}" cy="{height - 12}" r="4" fill="{KNOBS[knob]}"/>')
        print(f'<text x="{x + 8}" y="{height - 8}">{words}</text>')
    print(f'<text x="{width - RIGHT}" y="{height - 8}" text-anchor="end">rms error in steps of 8 bits, over milliseconds a frame</text>')
    print("</svg>")


main(sys.argv[1:])
