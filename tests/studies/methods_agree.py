#!/usr/bin/env python3
"""Runs random scenes by the three methods. Where two of them converge to different answers, one of them must warn why.

    methods_agree.py STICKSLIP [--seed 1] [--count 1000] [--keep DIR] [--jobs 1]

Scenes: a point on springs, a chain of bars, a block of a few elements on a plane, a circle, a polyline or another block;
small and finite strain; Coulomb's friction of 0 to 2, with a limit, or Tresca's; nodes and segments, facets and smooth
masters; 1 to 6 steps, to and fro. Answers are forces, displacements and dissipation at the end of the last step.

The penalty method runs with springs of 1e5 nodal stiffnesses. Answers that differ by more than 1e-5 of the size of their
kind are explained if one of the runs warns with a code of `REASONS`; or, by the penalty method, if springs ten times as
stiff are nearer. Exit code 1, and the scene, for each difference that nothing explains. --keep writes these scenes.
"""
import argparse
import collections
import concurrent.futures
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile

# Warnings that tell of more solutions than one, of another path, or of a method that is far from its limit.
REASONS = {"non_unique", "branch_ends", "cut_steps", "soft_penalty", "folded_element",
           "unstable"}
ALIKE = 1e-5  # what is asked of answers, as a share of their kind's size
METHODS = {
    "penalty": {"penalty": {"stiffness": 1e5}},
    "uzawa_al": {"uzawa_al": {}},
    "monolithic_al": {"monolithic_al": {}},
}
STIFFER = {"penalty": {"stiffness": 1e6}}


def digits(x):
    return float(f"{x:.6g}")


def material(draw, finite):
    modulus, nu = 10 ** draw.uniform(2, 4), draw.choice([0, 0.2, 0.3, 0.45])
    if finite and draw.random() < 0.5:
        return {"neo_hookean": {"E": digits(modulus), "nu": nu}}
    return {"linear_elastic" if not finite else "neo_hookean": {"E": digits(modulus), "nu": nu}}


def friction(draw, scale):
    kind = draw.random()
    mu = digits(draw.choice([0, draw.uniform(0, 0.6), draw.uniform(0, 2)]))
    if kind < 0.15:
        return {"tresca": digits(scale * draw.uniform(0.01, 1))}
    if kind < 0.3:
        return {"coulomb": mu, "limit": digits(scale * draw.uniform(0.01, 1))}
    return mu


def to_and_fro(draw, size):
    """A table over the time 0 to 1 that begins at 0 and turns back, or not."""
    if draw.random() < 0.5:
        return [[0, 0], [1, digits(draw.uniform(-size, size))]]
    return [[0, 0], [0.5, digits(draw.uniform(-size, size))], [1, digits(draw.uniform(-size, size))]]


def obstacle(draw, width):
    """A rigid surface below y = 0 that touches it at the origin, or nearly."""
    kind = draw.choice(["plane", "plane", "circle", "polyline"])
    if kind == "plane":
        tilt = draw.choice([0, 0, draw.uniform(-0.2, 0.2)])
        return {"plane": {"point": [0, 0], "normal": [digits(math.sin(tilt)), digits(math.cos(tilt))]}}
    if kind == "circle":
        radius = digits(draw.uniform(1, 5) * width)
        return {"circle": {"center": [digits(draw.uniform(-0.2, 0.2) * width), -radius], "radius": radius}}
    xs = sorted(digits(draw.uniform(-3, 3) * width) for _ in range(draw.randint(0, 3)))
    inner = [[x, digits(draw.uniform(-0.05, 0) * width)] for x in xs]
    return {"polyline": {"points": [[4 * width, 0], *reversed(inner), [-4 * width, 0]]}}


def contact(draw, finite, master_has_facets, continuum, scale, slave, master):
    out = {"slave": slave, "master": master, "friction": friction(draw, scale)}
    if out["friction"] == 0 and draw.random() < 0.3:
        del out["friction"]
    if master_has_facets and continuum and draw.random() < 0.25:
        out["discretization"] = "segment"
    elif master_has_facets and finite and draw.random() < 0.4:
        out["surface"] = draw.choice(["smooth", {"smooth": "b_spline"}])
    return out


def common(draw, finite, scene, contact_name, on):
    scene["strain"] = "finite" if finite else "small"
    scene["time"] = {"end": 1, "steps": draw.randint(1, 6)}
    scene["responses"] = {
        "n": {"contact_force": {"contact": contact_name, "component": "normal"}},
        "fx": {"contact_force": {"contact": contact_name, "component": "x"}},
        "fy": {"contact_force": {"contact": contact_name, "component": "y"}},
        "ux": {"displacement": {"on": on, "component": "x"}},
        "uy": {"displacement": {"on": on, "component": "y"}},
    }
    if "friction" in scene["contacts"][contact_name]:
        scene["responses"]["heat"] = {"dissipation": {"contact": contact_name}}
    return scene


def a_point(draw, finite):
    k = 10 ** draw.uniform(1, 3)
    a, b = k * draw.uniform(0.5, 2), k * draw.uniform(0.5, 2)
    c = draw.uniform(-0.8, 0.8) * math.sqrt(a * b)
    ground = obstacle(draw, 1)
    scene = {
        "bodies": {"m": {"mesh": {"point": {"at": [digits(draw.uniform(-0.5, 0.5)), digits(draw.uniform(0, 0.1))]}},
                         "material": {"grounded_spring": {"stiffness": [[digits(a), digits(c)], [digits(c), digits(b)]]}}}},
        "obstacles": {"g": ground},
        "contacts": {"c": contact(draw, finite, False, False, k * 0.1, "m.node", "g")},
        "loads": [{"on": "m.node", "force": [digits(k * draw.uniform(-0.3, 0.3)), digits(-k * draw.uniform(0.05, 0.4))],
                   "history": to_and_fro(draw, 1)},
                  {"on": "m.node", "force": [0, digits(-k * draw.uniform(0.05, 0.4))]}],
    }
    return common(draw, finite, scene, "c", "m.node")


def bars(draw, finite):
    cells, length = draw.randint(1, 11), draw.uniform(0.5, 3)
    modulus, area = 1000, digits(draw.uniform(0.1, 1))
    lift = draw.choice([0, digits(draw.uniform(0, 0.05))])
    weight = modulus * area * 10 ** draw.uniform(-4, -2)
    scene = {
        "bodies": {"b": {"mesh": {"line": {"from": [0, 0], "to": [digits(length), lift], "cells": cells}},
                         "element": "bar", "area": area, "material": {"linear_elastic": {"E": modulus, "nu": 0}}}},
        "obstacles": {"g": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
        "contacts": {"c": contact(draw, finite, False, False, weight / area, "b.nodes", "g")},
        "supports": [{"on": "b.end", "move": {"x": to_and_fro(draw, 0.03), "y": 0}}],
        "loads": [{"on": "b.nodes", "force": [0, digits(-weight)], "history": [[0, 0.1], [1, 1]]}],
    }
    return common(draw, finite, scene, "c", "b.start")


def block_of(draw, finite, low, high, element):
    return {"mesh": {"box": {"min": low, "max": high, "cells": [draw.randint(1, 4), draw.randint(1, 2)]}},
            "element": element, "material": material(draw, finite)}


def block(draw, finite):
    width, height = digits(draw.uniform(0.5, 1.5)), digits(draw.uniform(0.4, 1))
    element = draw.choice(["Q4", "T3", "Q8"])
    gap = digits(draw.choice([0, draw.uniform(0, 0.01)]))
    body = block_of(draw, finite, [-width / 2, gap], [width / 2, gap + height], element)
    modulus = next(iter(body["material"].values()))["E"]
    deep = height * (0.1 if finite else 0.02)
    scene = {"space": draw.choice(["plane_strain", "plane_strain", "plane_stress"]), "bodies": {"b": body}, "contacts": {}}
    on_block = draw.random() < 0.5
    scale = modulus * deep / height
    if on_block:
        wide = width * draw.uniform(1, 2)
        low = block_of(draw, finite, [digits(-wide / 2), digits(-height)], [digits(wide / 2), 0],
                       element if element != "T3" else "Q4")
        scene["bodies"]["s"] = low
        slave, master = draw.choice([("b.bottom", "s.top"), ("s.top", "b.bottom")])
        scene["contacts"]["c"] = contact(draw, finite, True, element != "Q8", scale, slave, master)
        scene["supports"] = [{"on": "s.bottom", "move": {"x": 0, "y": 0}}]
    else:
        scene["obstacles"] = {"g": obstacle(draw, width)}
        has_facets = "polyline" in scene["obstacles"]["g"]
        scene["contacts"]["c"] = contact(draw, finite, has_facets, element != "Q8", scale, "b.bottom", "g")
        scene["supports"] = []
    if draw.random() < 0.7:
        down = [[0, 0], [0.5, digits(-deep - gap)], [1, digits(-deep * draw.uniform(0.3, 1) - gap)]]
        scene["supports"].append({"on": "b.top", "move": {"x": to_and_fro(draw, 2 * deep), "y": down}})
    else:
        scene["supports"].append({"on": "b.top", "move": {"x": to_and_fro(draw, deep)}})
        scene["loads"] = [{"on": "b.top", "traction": [0, digits(-scale)], "history": [[0, 0.2], [1, 1]]}]
    return common(draw, finite, scene, "c", "b.bottom")


KINDS = {"point": a_point, "bars": bars, "block": block}


def make(seed, number):
    draw = random.Random(f"{seed} {number}")
    kind = draw.choices(list(KINDS), [2, 1, 4])[0]
    finite = draw.random() < 0.5
    return f"{kind}, {'finite' if finite else 'small'}", KINDS[kind](draw, finite)


def solve(program, scene, method, folder):
    path = pathlib.Path(folder, "scene.json")
    path.write_text(json.dumps({**scene, "method": method}))
    out = pathlib.Path(folder, "out")
    try:
        done = subprocess.run([program, "run", str(path), "-o", str(out)], capture_output=True, text=True, timeout=120,
                              env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})
    except subprocess.TimeoutExpired:
        return {"status": "timeout", "warnings": [], "values": {}}
    if done.returncode not in (0, 3):
        return {"status": "refused: " + done.stderr[-300:], "warnings": [], "values": {}}
    result = json.loads((out / "result.json").read_text())
    last = result["steps"][-1] if result["steps"] else {}
    return {"status": result["status"], "warnings": sorted({w["code"] for w in result["warnings"]}),
            "values": last.get("responses", {}), "message": result.get("message", "")}


def converged(run):
    return run["status"] in ("converged", "converged_at_roundoff")


def sizes(runs):
    """Size of forces, displacements and heat in runs of one scene."""
    kinds = collections.defaultdict(float)
    for run in runs:
        for name, value in run["values"].items():
            kinds[name[0]] = max(kinds[name[0]], abs(value))
    kinds["f"] = kinds["n"] = max(kinds["f"], kinds["n"])
    kinds["h"] = max(kinds["h"], kinds["f"] * kinds["u"])
    return kinds


def apart(a, b, size):
    """The largest difference of two runs' answers, as a share of the size of their kind."""
    return max((abs(a["values"][name] - b["values"][name]) / size[name[0]]
                for name in a["values"] if size[name[0]] > 0), default=0)


def check(task):
    program, seed, number = task
    kind, scene = make(seed, number)
    with tempfile.TemporaryDirectory() as folder:
        runs = {name: solve(program, scene, method, folder) for name, method in METHODS.items()}
        solved = {name: run for name, run in runs.items() if converged(run)}
        size = sizes(solved.values())
        verdict, differences = "alike", {}
        names = list(solved)
        for i, a in enumerate(names):
            for b in names[i + 1:]:
                if (d := apart(solved[a], solved[b], size)) > ALIKE:
                    differences[f"{a} - {b}"] = d
        if differences:
            verdict = "warned" if any(REASONS & set(run["warnings"]) for run in solved.values()) else "silent"
        if verdict == "silent" and all("penalty" in pair for pair in differences):
            stiffer = solve(program, scene, STIFFER, folder)
            other = next(solved[name] for name in names if name != "penalty")
            if converged(stiffer) and apart(stiffer, other, size) < 0.5 * apart(solved["penalty"], other, size):
                verdict = "penalty"
        if len(solved) < 2:
            verdict = "fewer than two converged"
    refused = [run["status"] for run in runs.values() if run["status"].startswith(("refused", "timeout"))]
    if refused:
        verdict = "refused"
    return number, kind, verdict, differences, {name: (run["status"], run["warnings"]) for name, run in runs.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="number of the first scene")
    parser.add_argument("--keep", help="directory for scenes that nothing explains")
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    tasks = [(arguments.program, arguments.seed, arguments.first + n) for n in range(arguments.count)]
    verdicts, statuses, bad = collections.Counter(), collections.Counter(), 0
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for number, kind, verdict, differences, runs in pool.map(check, tasks):
            verdicts[kind, verdict] += 1
            for name, (status, _) in runs.items():
                statuses[name, status.split(":")[0]] += 1
            if verdict in ("silent", "refused"):
                bad += 1
                print(f"scene {number} ({kind}): {verdict}: {differences} {runs}", flush=True)
                if arguments.keep:
                    pathlib.Path(arguments.keep).mkdir(parents=True, exist_ok=True)
                    text = json.dumps(make(arguments.seed, number)[1], indent=1)
                    pathlib.Path(arguments.keep, f"{arguments.seed}-{number}.json").write_text(text)
    for (kind, verdict), count in sorted(verdicts.items()):
        print(f"{kind:16} {verdict:26} {count}")
    for (name, status), count in sorted(statuses.items()):
        print(f"{name:16} {status:26} {count}")
    print(f"{bad} of {arguments.count} scenes (seed {arguments.seed}) differ, or are refused, without a word why")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
