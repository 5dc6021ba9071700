"""Checks contact_reference.py itself: python3 check_references.py. Prints a line per check.

Closed forms and published numbers of the scenes, derivatives against differences of the whole path with free states,
and, where there are few points, all combinations of states tried one by one.
"""

import itertools
import math
import sys

import numpy as np

from contact_reference import Model, Path, differences, solve, weights_of
from make_references import belt, boxes, cases, changed, plate, points_plane, pull_out, shipped

FAILED = []


def check(what, got, expected, tolerance):
    """tolerance is relative to the expected number (to 1 where that is 0)."""
    error = abs(got - expected) / (abs(expected) or 1.0)
    ok = error <= tolerance
    print(f"{'ok  ' if ok else 'FAIL'} {what:60} {got:.12g}  expected {expected:.12g}  error {error:.1e}")
    if not ok:
        FAILED.append(what)


def last(document, law=None, derivatives=True):
    _, _, values, gradients, _ = solve(document, law, derivatives=derivatives)
    return values[-1], gradients[-1]


def stop():
    exact = 1e-12  # a few roundings
    for name in ("stop", "stop_bars"):
        v, g = last(shipped(name))
        check(name + ": u", v["u"], 0.01, exact)
        check(name + ": force", v["press"], 5, exact)
        check(name + ": d force / d g0", g["press"]["g0"], -1000, exact)
        check(name + ": d force / d F", g["press"]["F"], 1, exact)
        v, g = last(shipped(name), {"stiffness": 1e4})
        check(name + ", penalty: force", v["press"], 5e4 / 1.1e4, exact)
        check(name + ", penalty: du/dF", g["u"]["F"], 1 / 1.1e4, exact)
        check(name + ", penalty: d force / d eps", g["press"]["stiffness"], 1000 * 5 / 1.1e4 ** 2, exact)


def slider():
    _, _, values, gradients, _ = solve(shipped("slider"))
    for step, u, du_dmu, heat in ((11, 0.07, -0.1, 0.21), (35, -0.07, 0.1, 0.63), (59, 0.07, -0.1, 1.05)):
        check(f"slider: u at step {step + 1}", values[step]["u"], u, 1e-12)
        check(f"slider: du/dmu at step {step + 1}", gradients[step]["u"]["mu"], du_dmu, 1e-12)
        check(f"slider: dissipation at step {step + 1}", values[step]["heat"], heat, 1e-12)
    # back to U = 0 from 0.05 (sticks) and from 0.1 (slid back)
    for top, u, du_dmu in ((0.05, 0.02, -0.1), (0.1, 0.03, 0.1)):
        v, g = last(changed(shipped("slider"), {
            "/supports/0/move/x": [[0, 0], [1, top], [2, 0]], "/time": {"end": 2, "steps": 14},
            "/parameters/U0": "/supports/0/move/x/1/1"}))
        check(f"slider: back from {top}: u", v["u"], u, 1e-12)
        check(f"slider: back from {top}: du/dmu", g["u"]["mu"], du_dmu, 1e-12)


def tractrix():
    for steps, printed in ((30, 7.61e-3), (300, 7.72e-4)):
        v, g = last(shipped("tractrix", __time__steps=steps), derivatives=steps == 300)
        error = math.hypot(v["x"] - 2.0027245810, v["y"] + 0.6 - 0.0737681415)
        check(f"tractrix: error of {steps} increments", error, printed, 1e-2)
    check("tractrix: dx/dc (first order in 300 increments)", g["x"]["mu"] / 2, -0.98530359, 1e-2)
    check("tractrix: dy/dc (first order in 300 increments)", g["y"]["mu"] / 2, 0.23561588, 1e-2)
    for n, printed in ((20, 0.7116266437), (100, 0.7813755068)):
        turns = 4 if n == 20 else 3
        angle = lambda i: 2 * math.pi * i / n
        # the hand starts at (1, 0), the block on it; c = mu N / k = 0.6
        document = changed(shipped("tractrix"), {
            "/bodies/block/mesh/point/at": [0, 0, 0], "/contacts/sole/friction": 0.3,
            "/supports/0/move": {"x": [[i, math.cos(angle(i))] for i in range(turns * n + 1)],
                                 "y": [[i, math.sin(angle(i))] for i in range(turns * n + 1)], "z": 0},
            "/time": {"end": turns * n, "steps": turns * n}})
        v, _ = last(document, derivatives=False)
        check(f"circle of {n} increments: radius of the block", math.hypot(v["x"], v["y"]), printed,
              1e-9 if n == 20 else 1e-4)  # the transient still decays in the longer one


def bar():
    document = pull_out(30)
    _, _, values, gradients, _ = solve(document)
    u = lambda i: -values[i]["u0"]
    check("pull-out: u0 at P = 20", u(1), 20 ** 2 / (2 * 1000 * 30), 1e-12)
    check("pull-out: residual at P = 0", u(3), u(1) / 2, 1e-12)
    check("pull-out: du0/dmu", -gradients[1]["u0"]["mu"], -u(1) / 0.3, 2e-3)
    check("pull-out: du0/dP", -gradients[1]["u0"]["P"], 2 * u(1) / 20, 1e-12)
    check("pull-out: dissipation of first loading", values[1]["heat"], 0.0445, 1e-3)
    # P = 20 -> 0 -> -20 -> 20 closes a cycle
    check("pull-out: dissipation of a cycle", values[9]["heat"] - values[1]["heat"], 0.1780, 1e-3)


def capstan():
    for n, ratio, slope in ((8, 2.6010497114, 8.3076785), (16, 2.5748538567, 8.1223222),
                            (32, 2.5684531177, 8.0772751)):
        v, g = last(belt(n))
        check(f"belt, {n} nodes: T2/T1", -v["tight"], ratio, 1e-10)
        check(f"belt, {n} nodes: d(T2/T1)/dmu", -g["tight"]["mu"], slope, 1e-7)


def greco():
    printed = {16: (2.864, 2.725, 2.283, 1.978, 1.541), 32: (2.859, 2.722, 2.285, 1.980, 1.541)}
    for n, displacements in printed.items():
        v, g = last(plate(n))
        for i, u in enumerate(displacements):
            check(f"plate {n}: u{i + 1}", v[f"u{i + 1}"] * 100, u, 5e-4 / 1.5)
    check("plate 32: friction", -v["friction"], 1405.37, 1e-5)
    check("plate 32: du1/dmu", g["u1"]["mu"], -5.7028e-3, 1e-5)
    check("plate 32: du1/dpush", g["u1"]["push"], 2.86775e-4, 1e-5)
    check("plate 32: E du1/dE = -u1", g["u1"]["E"] * 130000, -v["u1"], 1e-10)
    check("plate 32: d friction / dmu", -g["friction"]["mu"], 475.65, 1e-4)
    # loads scale the solution: the contact is conical
    check("plate 32: Euler", 50 * g["u1"]["pressure"] + 150 * g["u1"]["push"], v["u1"], 1e-10)


def derivatives():
    """Complex step against differences with Richardson, states free in the differences."""
    for name, document, law in (("boxes", boxes("Q4"), None), ("boxes, penalty", boxes("T3"), {"stiffness": 2e4}),
                                ("points", points_plane(), None), ("plate 8", plate(8), None),
                                ("points in space", cases()["points_space"][0](), None)):
        _, g = last(document, law)
        worst, where = 0.0, ""
        for parameter, pointer in document["parameters"].items():
            for response, d in differences(document, weights_of(pointer), law, (1e-5, 5e-6, 2.5e-6)).items():
                scale = max(abs(g[response][q]) for q in g[response])
                error = abs(d - g[response][parameter]) / (abs(d) + 1e-3 * scale or 1.0)
                if error > worst:
                    worst, where = error, f"{response}/{parameter}"
        check(f"{name}: derivatives against differences, worst at {where}", worst, 0, 1e-5)


def enumeration():
    """One combination of states, and only one, satisfies every inequality at each step."""
    model = Model(points_plane())
    path = Path(model)
    result = path.run()
    counts = []
    for r_before, r in zip([None] + result, result):
        found = set()
        for states in itertools.product(*[[("open", None), ("stick", None), ("slip", np.array([1.0])),
                                           ("slip", np.array([-1.0]))]] * len(model.points)):
            twin = Path(model, states=[list(states)], guess=[(r["rN"], r["rT"], r["u"])])
            if r_before is not None:
                twin.u, twin.before = r_before["u"].astype(complex), {"time": r_before["time"]}
            try:
                t = twin.increment(0, r["time"])
            except RuntimeError:  # these states leave a mechanism
                continue
            columns = [t["gap"].real, t["rN"].real, t["rT"].real, t["slip"].real, twin.mu.real]
            if all(gap >= 0 if s == "open" else rN >= 0 and (abs(rT) <= mu * rN if s == "stick" else rT * slip <= 0)
                   for (s, _), gap, rN, rT, slip, mu in zip(states, *columns)):
                found.add(tuple(s for s, _ in states))
        counts.append(len(found))
        if found != {tuple(s for s, _ in r["states"])}:
            counts[-1] = -1
    check("points: combinations of states per step, least", min(counts), 1, 0)
    check("points: combinations of states per step, most", max(counts), 1, 0)


if __name__ == "__main__":
    for part in (stop, slider, tractrix, bar, capstan, greco, enumeration, derivatives):
        part()
    sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)
