#!/usr/bin/env python3
"""first_chart.py STICKSLIP [--check]: takes the chart of README.md, error against work, from the report of a run of
studies/scenes/cattaneo_mindlin.study.json, as docs/figures/first-chart.svg.
first_chart.py --self-test: proves that a stale chart is seen.

The file holds the points that it shows, in a comment; their work is factorisations + RATIO times back-solves, those of
the derivatives included. RATIO is fixed, so that they are the same on every machine; the report measures it. With
--check nothing is written: exit code 1 if these points are not what the study gives now.
"""
import json
import re
import sys
import tempfile

from measured_numbers import ROOT, Program, worst

FILE = ROOT / "docs" / "figures" / "first-chart.svg"
RATIO = 1 / 30  # cost of a back-solve over that of a factorisation: three runs of this study measured 1/30 to 1/33
CURVES = ["penalty stiffness=", "uzawa_al scale=1 tolerance=", "uzawa_al scale=10 tolerance=",
          "uzawa_al scale=100 tolerance=", "monolithic_al scale="]  # labels of the rows, without the option's value


def points_of(rows):
    """{curve: [[option, work, error, solved], ...]}."""
    curves = {}
    for curve in CURVES:
        for label, row in rows.items():
            if label.startswith(curve):
                counts = row["cost"]["counts"]
                work = counts["factorizations"] + RATIO * (counts["backsolves"] + counts["sensitivity_backsolves"])
                curves.setdefault(curve, []).append([float(label[len(curve):]), round(work, 2),
                                                     float(f"{worst(row, 'sensitivity'):.3g}"),
                                                     row["status"].startswith("converged")])
    return curves


def faults(shown, now):
    """What differs by more than rounding does from machine to machine: errors below 1e-6, and the work to get there.
    Uzawa's method with a tolerance of 1e-5 ends, one back-solve earlier or later, at 1.69e-6 by OpenBLAS' kernels for
    Haswell and Zen, and at 1.07e-6 by those for SkylakeX: below 1e-5 its errors may differ by a factor of two."""
    found = []
    for curve in CURVES:
        a, b = shown.get(curve, []), now.get(curve, [])
        if [point[0] for point in a] != [point[0] for point in b]:
            found.append(f"{curve}: other points are shown than there are")
            continue
        for old, new in zip(a, b):
            rounding = max(old[2], new[2]) < 1e-6 or (curve.startswith("penalty") and old[0] > 1e5)
            allowed = 1000 if rounding else 2 if curve.startswith("uzawa") and max(old[2], new[2]) < 1e-5 else 1.1
            ratio = max(old[2], 1e-16) / max(new[2], 1e-16)  # the reference's own error is 0
            if not 1 / allowed <= ratio <= allowed or not 0.75 <= old[1] / new[1] <= 1.33 or \
                    (old[3] != new[3] and not rounding):
                found.append(f"{curve}{old[0]:g} is shown at {old[1:]}, but is at {new[1:]}")
    return found


def self_test():
    def data(error, work=20.0, option=1.0):
        return {"penalty stiffness=": [[option, work, error, True]]}
    right = [(data(0.9), data(0.9)), (data(0.9), data(0.91)), (data(1e-12), data(1e-11)), (data(0.0), data(0.0))]
    wrong = [(data(0.9), data(0.5)), (data(0.9), data(0.9, 40.0)), (data(1e-12), data(1e-5)), (data(0.0), data(1e-5)),
             (data(0.9), data(0.9, 20.0, 2.0)), (data(0.9), {})]
    if any(faults(*pair) for pair in right) or not all(faults(*pair) for pair in wrong):
        sys.exit("a stale chart is not seen, or a fresh one is")


def main():
    if sys.argv[1] == "--self-test":
        return self_test()
    with tempfile.TemporaryDirectory() as folder:
        rows, study = Program(sys.argv[1], folder).study("cattaneo_mindlin")
        chart = (study / "figures" / "enforcement-sensitivities-against-work-factorisations.svg").read_text()
    now = points_of(rows)
    if "--check" not in sys.argv:
        FILE.write_text(chart.replace("<desc>", f"<!-- {json.dumps(now)} --><desc>"))
    elif found := faults(json.loads(re.search(r"<!-- (.*) -->", FILE.read_text()).group(1)), now):
        sys.exit("\n".join([*found, "tools/first_chart.py build/release/stickslip makes it anew"]))


if __name__ == "__main__":
    main()
