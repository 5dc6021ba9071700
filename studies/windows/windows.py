#!/usr/bin/env python3
"""Where each method works, and what its automatic choice costs: six ordinary scenes at small and at finite strain.

    python3 studies/windows/windows.py [PROGRAM] [-o results/windows] [--only NAME]... [--strain small] [--jobs 2]

PROGRAM is the stickslip to measure, by default the one on the PATH. Exit code: 0 if every automatic choice lies inside
its window and takes at most 1.5 times the least iterations, 3 if not, 2 bad input. docs/windows.md says how to read
what it writes.
"""

import csv
import json
import shutil
import subprocess
import sys
from pathlib import Path
from time import monotonic

HERE = Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
from suite import InputError, find_program, parser_of  # noqa: E402

SCENES = tuple(sorted(path.name.removesuffix(".study.json") for path in HERE.glob("*.study.json")))
STRAINS = ("small", "finite")
ALLOWED = 1.5
# Errors up to this count as none. Multipliers leave 1e-10 or rounding, and only penalties more.
ACCURATE = 1e-6
COLUMNS = ("scene", "strain", "method", "friction", "steps", "from", "to", "automatic", "inside", "iterations", "least",
           "times")


def arguments(argv):
    parser = parser_of("windows", __doc__)
    parser.add_argument("--only", action="append", choices=SCENES, metavar="NAME", help="a scene, several times")
    parser.add_argument("--strain", choices=STRAINS, help="one of the strains, by default both")
    return parser.parse_args(argv)


def write_scene(name, strain, folder):
    """The scene and its study; at finite strain rubber of the same constants stands in for linear elasticity."""
    text = (HERE / f"{name}.json").read_text(encoding="utf-8")
    if strain == "finite":
        text = text.replace('"linear_elastic"', '"neo_hookean"')
        text = text.replace('"space": "plane_strain",', '"space": "plane_strain",\n  "strain": "finite",')
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.json").write_text(text, encoding="utf-8")
    shutil.copy(HERE / f"{name}.study.json", folder)


def run_study(program, name, folder, jobs):
    """The rows of a study. Runs that fail are rows too (exit code 3)."""
    done = subprocess.run([program, "study", folder / f"{name}.study.json", "-o", folder / name, "--restart", "--jobs",
                           str(jobs)], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise InputError(f"{name}: {done.stderr.strip()}")
    lines = (folder / name / "results.jsonl").read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in lines]


def converged(row):
    return row["status"] in ("converged", "converged_at_roundoff")


def iterations(row):
    return row["cost"]["counts"]["newton"]


def error(row):
    """The worst of the responses, against exact contact conditions on the same mesh."""
    errors = row["errors"]["enforcement"]
    return max((value for name, value in errors.items() if name.startswith("response:")), default=0)


def knob(row):
    (value,) = row["knobs"].values()
    return row["automatic"] if value == "auto" else float(value)


def window_of(rows):
    """One line of the table: the runs of a method in a scene, one of them the automatic choice."""
    (automatic,) = [row for row in rows if "auto" in row["knobs"].values()]
    swept = sorted((row for row in rows if row is not automatic), key=knob)
    below = [row for row in swept if knob(row) <= knob(automatic)]
    above = [row for row in swept if knob(row) >= knob(automatic)]

    def reach(neighbours):
        """How far runs converge, from the automatic choice on."""
        value = None
        for row in neighbours:
            if not converged(row):
                break
            value = knob(row)
        return value

    low, high = reach(reversed(below)), reach(above)
    inside = converged(automatic) and low is not None and high is not None
    line = {"from": low, "to": high, "automatic": knob(automatic), "inside": inside, "iterations": None, "least": None,
            "times": None}
    if converged(automatic):
        no_worse = max(error(automatic), ACCURATE)
        line["iterations"] = iterations(automatic)
        line["least"] = min(iterations(row) for row in rows if converged(row) and error(row) <= no_worse)
        line["times"] = line["iterations"] / line["least"]
    return line


def lines_of(name, strain, rows):
    groups = {}
    for row in rows:
        (method,) = row["method"]
        friction, steps = (row["vary"][pointer] for pointer in sorted(row["vary"]))
        groups.setdefault((method, friction, steps), []).append(row)
    return [{"scene": name, "strain": strain, "method": method, "friction": friction, "steps": steps,
             **window_of(group)} for (method, friction, steps), group in groups.items()]


def is_good(line):
    return line["inside"] and line["times"] <= ALLOWED


def in_words(value):
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def write(folder, lines):
    with open(folder / "windows.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, COLUMNS)
        table.writeheader()
        table.writerows(lines)
    text = ["| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
    text += ["| " + " | ".join(in_words(line[column]) for column in COLUMNS) + " |" for line in lines]
    (folder / "windows.md").write_text("\n".join(text) + "\n", encoding="utf-8")


def summary(lines):
    """For each method and strain: how many choices lie inside and are cheap, and the dearest."""
    out = []
    for method in dict.fromkeys(line["method"] for line in lines):
        for strain in dict.fromkeys(line["strain"] for line in lines):
            of = [line for line in lines if (line["method"], line["strain"]) == (method, strain)]
            times = [line["times"] for line in of if line["times"] is not None]
            out.append(f"{method}, {strain} strain: {sum(line['inside'] for line in of)} of {len(of)} inside, "
                       f"{sum(is_good(line) for line in of)} at most {ALLOWED} of the least, the dearest "
                       f"{max(times, default=0):.2f}")
    return out


def main(argv):
    chosen = arguments(argv)
    try:
        program, folder = find_program(chosen.program), Path(chosen.output)
        start, lines = monotonic(), []
        for strain in [chosen.strain] if chosen.strain else STRAINS:
            for name in chosen.only or SCENES:
                write_scene(name, strain, folder / strain)
                lines += lines_of(name, strain, run_study(program, name, folder / strain, chosen.jobs))
                print(f"{strain} {name}: {monotonic() - start:.0f} s", file=sys.stderr, flush=True)
        write(folder, lines)
    except InputError as fault:
        print(f"windows.py: {fault}", file=sys.stderr)
        return 2
    print("\n".join(summary(lines)))
    for line in lines:
        if not is_good(line):
            print(f"  {line['scene']}, {line['strain']} strain, {line['method']}, friction {line['friction']}, "
                  f"{line['steps']} steps: " + ("not inside" if not line["inside"] else
                                                f"{line['iterations']} iterations, {line['times']:.2f} of the least"))
    print(f"table: {folder / 'windows.md'}")
    return 0 if all(map(is_good, lines)) else 3


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
