#!/usr/bin/env python3
"""Random slides: a block is pressed onto a longer slab with friction and drawn along it, past ends too, on every kind of
surface and by every method. Prints, per class, how many runs do not converge, and how far the methods are apart.

    random_slides.py STICKSLIP [--count 100] [--seed 1] [--slaves slab block] [--surfaces ...] [--methods ...]
                     [--keep DIR] [--most-failures N]

The scene of a number is the same on every machine; surface and method do not change it. With --most-failures the exit
code is 1 where the monolithic method fails in more runs of one class.
"""
import argparse
import json
import random
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SURFACES = {
    "facets": {},
    "catmull_rom": {"surface": "smooth"},
    "b_spline": {"surface": {"smooth": "b_spline"}},
    "segment": {"discretization": "segment"},
}
METHODS = ["monolithic_al", "uzawa_al", "penalty"]


def slide(number, slaves, surface):
    """Scene `number`. The block is [0, width] x [0, height], the slab longer by `beyond` at both ends."""
    rng = random.Random(f"slide {number}")
    width, height = rng.uniform(0.8, 2), rng.uniform(0.5, 1.2)
    beyond, depth = rng.uniform(0.3, 1.2), rng.uniform(0.5, 1.2)
    block_cells = [rng.randint(3, 10), rng.randint(2, 4)]
    slab_cells = [rng.randint(4, 14), rng.randint(2, 3)]
    stiffness = 10 ** rng.uniform(2.5, 3.5)
    poisson = [rng.uniform(0.2, 0.45) for _ in range(2)]
    friction = rng.uniform(0.05, 0.6)
    press = rng.uniform(0.01, 0.12) * min(height, depth)
    along = rng.choice([-1, 1]) * rng.uniform(0.05, 1.3) * (beyond + 0.3 * width)
    steps = [rng.randint(4, 10), rng.randint(4, 10)]
    contact = {"slave": "slab.top", "master": "block.bottom", "friction": friction}
    if slaves == "block":
        contact["slave"], contact["master"] = contact["master"], contact["slave"]
    contact.update(SURFACES[surface])

    def body(low, high, cells, E, nu):
        return {"mesh": {"box": {"min": low, "max": high, "cells": cells}}, "material": {"neo_hookean": {"E": E, "nu": nu}}}
    return {
        "title": f"slide {number}", "space": "plane_strain", "strain": "finite",
        "bodies": {"block": body([0, 0], [width, height], block_cells, 1000, poisson[0]),
                   "slab": body([-beyond, -depth], [width + beyond, 0], slab_cells, stiffness, poisson[1])},
        "contacts": {"c": contact},
        "supports": [{"on": "slab.bottom", "move": {"x": 0, "y": 0}},
                     {"on": "block.top", "move": {"x": [[0, 0], [1, 0], [2, along]], "y": [[0, 0], [1, -press]]}}],
        "time": {"legs": [[1, steps[0]], [2, steps[1]]]},
        "responses": {"press": {"reaction": {"on": "slab.bottom", "component": "y"}},
                      "pull": {"reaction": {"on": "slab.bottom", "component": "x"}}},
    }


def solve(program, scene, method, seconds, keep):
    """Status, message, and the responses of each step."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(keep or folder) / f"{scene['title'].replace(' ', '_')}.json"
        path.write_text(json.dumps(dict(scene, method={method: {}}), indent=1))
        try:
            out = subprocess.run([program, "run", str(path), "--json", "-o", folder], stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, text=True, timeout=seconds)
        except subprocess.TimeoutExpired:
            return f"more than {seconds} s", "", []
        if out.returncode < 0:
            return f"signal {-out.returncode}", "", []
        try:
            result = json.loads(out.stdout)
        except json.JSONDecodeError:
            return f"exit {out.returncode}", out.stderr.strip(), []
        return result["status"], result["message"], [step["responses"] for step in result["steps"] if "responses" in step]


def values_of(steps):
    """(press, pull) of each step."""
    def number(x):
        return x["value"] if isinstance(x, dict) else x
    return [(number(step["press"]), number(step["pull"])) for step in steps]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=100, help="scenes of each class")
    parser.add_argument("--seed", type=int, default=1, help="number of the first scene")
    parser.add_argument("--slaves", nargs="+", default=["slab", "block"], choices=["slab", "block"])
    parser.add_argument("--surfaces", nargs="+", default=list(SURFACES), choices=list(SURFACES))
    parser.add_argument("--methods", nargs="+", default=METHODS, choices=METHODS)
    parser.add_argument("--seconds", type=float, default=60, help="limit of one run")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", help="folder for the scenes that fail")
    parser.add_argument("--most-failures", type=int)
    asked = parser.parse_args()
    worst = 0
    for slaves in asked.slaves:
        for surface in asked.surfaces:
            scenes = [slide(asked.seed + n, slaves, surface) for n in range(asked.count)]
            results = {}
            for method in asked.methods:
                with ThreadPoolExecutor(asked.jobs) as pool:
                    results[method] = list(pool.map(lambda s: solve(asked.program, s, method, asked.seconds, None),
                                                    scenes))
            report(slaves, surface, scenes, results, asked)
            failed = [status for status, *_ in results.get("monolithic_al", []) if not status.startswith("converged")]
            worst = max(worst, len(failed))
    return 1 if asked.most_failures is not None and worst > asked.most_failures else 0


def report(slaves, surface, scenes, results, asked):
    print(f"nodes of the {slaves} are the slaves, {surface}:", flush=True)
    for method, of in results.items():
        failed = [(scene, status, message) for scene, (status, message, _) in zip(scenes, of)
                  if not status.startswith("converged")]
        print(f"  {method}: {len(failed)} of {len(of)} fail")
        for scene, status, message in failed:
            print(f"    {scene['title']}: {status}: {message}")
            if asked.keep:
                name = f"{scene['title'].replace(' ', '_')}_{slaves}_{surface}_{method}.json"
                (Path(asked.keep) / name).write_text(json.dumps(dict(scene, method={method: {}}), indent=1))
    for one, other in (("monolithic_al", "uzawa_al"), ("monolithic_al", "penalty")):
        if one not in results or other not in results:
            continue
        apart = []
        for scene, a, b in zip(scenes, results[one], results[other]):
            if not (a[0].startswith("converged") and b[0].startswith("converged")):
                continue
            at_a, at_b = values_of(a[2]), values_of(b[2])
            size = max(abs(x) for pair in at_a for x in pair)
            apart.append((max(abs(x - y) for p, q in zip(at_a, at_b) for x, y in zip(p, q)) / size, scene["title"]))
        bound = 1e-6 if other == "uzawa_al" else 0.03
        far = sorted((x for x in apart if x[0] > bound), reverse=True)
        print(f"  {other} against {one}: {len(far)} of {len(apart)} apart by more than {bound:g} of the largest force"
              + "".join(f"; {title} {x:.2g}" for x, title in far[:20]), flush=True)


if __name__ == "__main__":
    sys.exit(main())
