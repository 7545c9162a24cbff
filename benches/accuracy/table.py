"""Prints one table of the reports of `rayreel accuracy --json`: what a picture's error costs in each scene."""

import json
import sys


def cheapest(rows, error):
    """The quickest setting, of samples or of an error, that is as good as that."""
    fitting = [row for row in rows if row["knob"] in (None, "samples", "max error")]
    fitting = [row for row in fitting if row["without"] is None and row["error"]["rms"] <= error]
    fitting = [row for row in fitting if row["capped"] is None]
    return min(fitting, key=lambda row: row["relative"]["median"], default=None)


def cell(row):
    return f'{row["seconds"]["median"]:.3f} s, {row["setting"]}' if row else "-"


ERRORS = (4, 2, 1, 0.5)
print("| scene | own: s, rms | off by at most " + " | ".join(map(str, ERRORS)) + " | samples: error falls as | f64, f32: pixels wrong |")
print("|---" * (len(ERRORS) + 4) + "|")
for path in sys.argv[1:]:
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    rows = report["rows"]
    own = rows[0]
    orders = [order for order in report["orders"] if order["knob"] == "samples"]
    order = f'n^{orders[0]["exponent"]:.2f} ± {orders[0]["uncertainty"]:.2f}' if orders else "-"
    wrong = [f'{100 * row["alone"]["share_off"]:.2f} %' for row in rows if row["knob"] == "precision"]
    name = report["scene"].removeprefix("scenes/").removesuffix(".ron")
    cells = [name, f'{own["seconds"]["median"]:.3f}, {own["error"]["rms"]:.2f}']
    cells += [cell(cheapest(rows, error)) for error in ERRORS] + [order, ", ".join(wrong)]
    print("| " + " | ".join(cells) + " |")
