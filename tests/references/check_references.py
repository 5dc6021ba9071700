"""Checks contact_reference.py and finite_reference.py themselves: check_references.py [PART...]; without parts,
those of seconds. One line a check.

Closed forms and published numbers of the scenes, derivatives against differences of the whole path with free states,
all combinations of states tried one by one where there are few points, and the stored solutions, solved anew.
`check_references.py faults` plants an error at a time in the two solvers; the parts of seconds, and those of LONG_FINITE,
must see each.
"""

import itertools
import json
import math
import os
import subprocess
import sys
import tempfile

import numpy as np

import finite_reference as finite
from contact_reference import Model, Path, at_pointer, differences, reference, solve, weights_of
from make_references import (HERE, SCENES, belt, boxes, cases, changed, finite_cases, ironing, plate, points_plane,
                             pull_out, shipped)

FAILED = []


def check(what, got, expected, tolerance):
    """tolerance is relative to the expected number (to 1 where that is 0)."""
    error = abs(got - expected) / (abs(expected) or 1.0)
    ok = bool(error <= tolerance)  # (of a NaN: not)
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


def tractrix(all_increments=((30, 7.61e-3, 1e-1),), circles=((20, 4, 0.7116266437),)):
    """Increments with the printed error and the error of a derivative (both fall as the increment), and circles."""
    for steps, printed, first_order in all_increments:
        v, g = last(shipped("tractrix", __time__steps=steps))
        error = math.hypot(v["x"] - 2.0027245810, v["y"] + 0.6 - 0.0737681415)
        check(f"tractrix: error of {steps} increments", error, printed, 1e-2)
        check(f"tractrix: dx/dc of {steps} increments", g["x"]["mu"] / 2, -0.98530359, first_order)
        check(f"tractrix: dy/dc of {steps} increments", g["y"]["mu"] / 2, 0.23561588, first_order)
    for n, turns, printed in circles:
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


def slow_tractrix():
    tractrix(((300, 7.72e-4, 1e-2),), ((100, 3, 0.7813755068),))


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


def uniform():
    """A block under a uniform traction is stretched uniformly: H = (1 - nu^2) t / E along it, in plane strain."""
    young, nu, t = 1000, 0.3, 5
    for element, space in itertools.product(("Q4", "T3"), ("plane_strain", "plane_stress")):
        block = {"mesh": {"box": {"min": [0, 0], "max": [2, 1], "cells": [3, 2]}}, "element": element,
                 "material": {"linear_elastic": {"E": young, "nu": nu}}}
        v, g = last({
            "space": space, "bodies": {"block": block},
            "supports": [{"on": "block.left", "move": {"x": 0}}, {"on": "block.bottom", "move": {"y": 0}}],
            "loads": [{"on": "block.right", "traction": [t, 0]}], "time": {"end": 1, "steps": 1},
            "responses": {"u": {"displacement": {"on": "block.right", "component": "x"}},
                          "v": {"displacement": {"on": "block.top", "component": "y"}},
                          "hold": {"reaction": {"on": "block.left", "component": "x"}},
                          "energy": {"strain_energy": {}}},
            "parameters": {"nu": "/bodies/block/material/linear_elastic/nu"}})
        E, n = (young, nu) if space == "plane_stress" else (young / (1 - nu * nu), nu / (1 - nu))
        check(f"{element}, {space}: u", v["u"], 2 * t / E, 1e-12)
        check(f"{element}, {space}: v", v["v"], -n * t / E, 1e-12)
        check(f"{element}, {space}: reaction", v["hold"], -t, 1e-12)
        check(f"{element}, {space}: energy", v["energy"], t * 2 * t / E / 2, 1e-12)
        check(f"{element}, {space}: du/dnu", g["u"]["nu"], 0 if space == "plane_stress" else -4 * nu * t / young, 1e-12)


def balance():
    """A corner with a support across a slope that it presses on: reaction, push of the slope and load balance. The
    shear presses the corner down: lifted, it would have no contact force for the reaction to leave out."""
    t, p = -2, 5
    v, g = last({
        "space": "plane_strain",
        "bodies": {"block": {"mesh": {"box": {"min": [0, 0], "max": [2, 1], "cells": [3, 2]}},
                             "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}}},
        "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [-0.01, 1]}}},
        "contacts": {"sole": {"slave": "block.bottom", "master": "floor"}},
        "supports": [{"on": "block.left", "move": {"x": 0}}],
        "loads": [{"on": "block.top", "traction": [t, -p]}], "time": {"end": 1, "steps": 1},
        "responses": {"hold": {"reaction": {"on": "block.left", "component": "x"}},
                      "push": {"contact_force": {"contact": "sole", "component": "x"}},
                      "press": {"contact_force": {"contact": "sole", "component": "normal"}}},
        "parameters": {"tilt": "/obstacles/floor/plane/normal/0"}})
    length = math.hypot(0.01, 1)
    check("corner: normal force", v["press"], 2 * p * length, 1e-12)
    check("corner: push of the slope", v["push"], -0.01 * 2 * p, 1e-12)
    check("corner: reaction", v["hold"], -2 * t + 0.01 * 2 * p, 1e-12)
    check("corner: d reaction / d tilt", g["hold"]["tilt"], -2 * p, 1e-12)


def inequalities():
    """Forces of states that are not the solution's violate the law, and verify() says so."""
    document = shipped("slider")
    path = Path(Model(document))
    result = path.run()[0]
    twin = Path(Model(document))
    gap0, slip0, none = np.zeros(1), np.zeros(1), np.zeros(1)
    x, force = result["u"], np.abs(result["rN"]).max()
    gap, rubs = twin.BN @ x, twin.mu[0] * force
    for what, state, rN, rT, gap0 in (
            ("penetration", ("open", None), 0.0, 0.0, -gap - 0.1), ("tension", ("stick", None), -force, 0.0, -gap),
            ("stick beyond the cone", ("stick", None), force, 2 * rubs, -gap)):
        violation, _ = twin.verify([state], x, np.array([rN]), np.array([rT]), gap0, slip0, none)
        check(f"verify: {what}", float(violation > 1e-3), 1, 0)
    slip0 = 0.1 - twin.BT @ x
    violation, _ = twin.verify([("slip", np.ones(1))], x, np.array([force]), np.array([rubs]), -gap, slip0, none)
    check("verify: friction along the slip", float(violation > 1e-3), 1, 0)


def worst_difference(document, law, steps):
    """(error, response/parameter) of the largest relative error of the derivatives against differences; NaN counts."""
    _, g = last(document, law)
    worst, where = 0.0, ""
    for parameter, pointer in document["parameters"].items():
        for response, d in differences(document, weights_of(pointer), law, steps).items():
            scale = max(abs(g[response][q]) for q in g[response])
            error = abs(d - g[response][parameter]) / (abs(d) + 1e-3 * scale or 1.0)
            if not error <= worst:
                worst, where = error, f"{response}/{parameter}"
    return worst, where


def derivatives(documents=None):
    """Complex step against differences with Richardson, states free in the differences."""
    for name, document, law in documents or (("boxes", boxes("Q4"), None), ("plate 8", plate(8), None),
                                             ("boxes, penalty", boxes("T3"), {"stiffness": 2e4}),
                                             ("points in space", cases()["points_space"][0](), None)):
        worst, where = worst_difference(document, law, (1e-5, 5e-6, 2.5e-6))
        check(f"{name}: derivatives against differences, worst at {where}", worst, 0, 1e-5)


def few_derivatives():
    """The same on a short path, with three parameters: one of the law, one of the material, one of the shape."""
    document = changed(boxes("Q4"), {"/time": {"end": 2, "steps": 2}, "/bodies/upper/mesh/box/cells": [3, 2],
                                     "/bodies/lower/mesh/box/cells": [4, 2]})
    document["parameters"] = {name: document["parameters"][name] for name in ("mu", "nu_lower", "left")}
    derivatives((("small boxes", document, None), ("small boxes, penalty", document, {"stiffness": 2e4})))


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


def flattened(value, key=()):
    """(path, number or text) of everything in a step."""
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from flattened(inner, key + (name,))
    elif isinstance(value, list):
        for inner in value:
            yield from flattened(inner, key + ("*",))
    else:
        yield key, value


def natural_size(path, largest, document, law):
    """What a number of this kind is measured by where it vanishes: gaps and slips by the largest displacement, forces
    by the largest force, a derivative by its response over the parameter."""
    if path[0] == "displacement" or path[0] == "contacts" and path[2] in ("gap", "slip"):
        return max(v for p, v in largest.items() if p[0] == "displacement")
    if path[0] == "contacts" and path[2] == "force":
        return max(v for p, v in largest.items() if p[0] == "contacts" and p[2] == "force")
    if path[0] == "sensitivities":
        if path[2] == "stiffness":
            at = law["stiffness"]
        else:
            node, key = at_pointer(document, next(iter(weights_of(document["parameters"][path[2]]))))
            at = node[key]
        return largest["responses", path[1]] / abs(at) if at else 0.0
    return 0.0


def same_solution(name, law, document, stored, fresh):
    """Each number against the largest of its kind: both are solved to rounding, of conditions up to 1e6."""
    label = f"{name} {'penalty' if law else 'exact'}"
    check(f"{label}: steps", len(fresh["steps"]), len(stored["steps"]), 0)
    kinds, unlike = {}, 0
    for step, anew in zip(stored["steps"], fresh["steps"]):
        # margins are rounding where a point is at its limit
        both = [list(flattened({k: v for k, v in s.items() if k != "margins"})) for s in (step, anew)]
        unlike += len(both[0]) != len(both[1])
        for (path, a), (path_anew, b) in zip(*both):
            if path != path_anew or isinstance(a, str) and a != b:
                unlike += 1
            elif not isinstance(a, str):
                kinds.setdefault(path, []).append((a, b))
    check(f"{label}: states and layout that differ", unlike, 0, 0)
    largest = {path: np.abs(pairs).max() for path, pairs in kinds.items()}
    worst, where = 0.0, ()
    for path, pairs in kinds.items():
        difference = np.abs(np.subtract(*np.transpose(pairs))).max()
        size = max(largest[path], natural_size(path, largest, document, law))
        error = difference / size if difference else 0.0
        if not error <= worst:
            worst, where = error, path
    check(f"{label}: worst number, of {'/'.join(where)}", worst, 0, 1e-9)


def stored(names=("stop", "stop_bars", "slider", "belt_8", "pull_out_10", "plate_8", "points_plane")):
    for name in names:
        scene, stiffness, ratio = cases()[name]
        document = scene()
        with open(os.path.join(HERE, name + ".json"), encoding="utf-8") as f:
            file = json.load(f)
        check(f"{name}: scene as stored", file["scene"] == json.loads(json.dumps(document)), True, 0)
        for law in (None, {"stiffness": stiffness, "tangential_ratio": ratio}):
            fresh = json.loads(json.dumps(reference(document, law, SCENES)))
            same_solution(name, law, document, file["solutions"]["penalty" if law else "exact"], fresh)


def slow_stored():
    stored([name for name in cases() if name not in stored.__defaults__[0] + ("cattaneo_mindlin",)])


# --- finite strain ---------------------------------------------------------------------------------------------------


def finite_block(surface="faceted", down=0.3):
    """A block of 2 x 1, free to widen to the right, that is pressed on a block that is held everywhere."""
    neo_hookean = {"neo_hookean": {"E": 10, "nu": 0.3, "volumetric": "log"}}
    return {
        "space": "plane_strain", "strain": "finite",
        "bodies": {"block": {"mesh": {"box": {"min": [0, 0], "max": [2, 1], "cells": [2, 2]}}, "material": neo_hookean},
                   "base": {"mesh": {"box": {"min": [-1, -1], "max": [4, 0], "cells": [5, 1]}},
                            "material": neo_hookean}},
        "contacts": {"sole": {"slave": "block.bottom", "master": "base.top", "surface": surface}},
        "supports": [{"on": "base.bottom", "move": {"x": 0, "y": 0}}, {"on": "base.top", "move": {"x": 0, "y": 0}},
                     {"on": "block.left", "move": {"x": 0}}, {"on": "block.top", "move": {"y": [[0, 0], [1, -down]]}}],
        "time": {"end": 1, "steps": 3},
        "responses": {"hold": {"reaction": {"on": "block.top", "component": "y"}}, "energy": {"strain_energy": {}},
                      "press": {"contact_force": {"contact": "sole", "component": "normal"}},
                      "gap": {"gap": {"contact": "sole"}}},
        "parameters": {"down": {"/supports/3/move/y/1/1": -1}, "E": "/bodies/block/material/neo_hookean/E"}}


def curves():
    """A parabola, on which Catmull-Rom stays within and from which a B-spline is off by a sixth of the nodes' second
    difference; straight lines up to their ends; facets by the bisector of a concave and of a convex vertex."""
    n = 6
    facets = [(i, i + 1) for i in range(n - 1)]
    line = np.stack([np.arange(n), 2.0 * np.arange(n)], axis=1)
    parabola = np.stack([np.arange(n), np.arange(n) ** 2], axis=1).astype(float)
    for kind, shift in (("catmull_rom", 0), ("b_spline", 1 / 3), ("faceted", None)):
        curve = finite.Curve(kind, facets)
        place = lambda nodes, j, xi: finite.value(curve.powers[j] @ nodes[curve.nodes[j]], xi)[0]
        for j, xi in ((0, 0.0), (0, 0.3), (2, 0.6), (n - 2, 0.7), (n - 2, 1.0)):
            check(f"{kind}: line, {j + xi}", np.abs(place(line, j, xi) - (j + xi) * np.array([1, 2])).max(), 0, 1e-14)
            found = curve.locate(place(line, j, xi) + np.array([0.2, -0.1]), line)
            check(f"{kind}: foot on a line, {j + xi}", sum(found), j + xi, 1e-13)
        check(f"{kind}: past the end", curve.locate(line[-1] + np.array([0.1, 0.2]), line) is None, True, 0)
        if shift is not None:
            check(f"{kind}: parabola", place(parabola, 2, 0.6)[1], 2.6 ** 2 + shift, 1e-14)
    curve = finite.Curve("faceted", [(0, 1), (1, 2), (2, 3)])
    at = np.array([[3.0, 0], [2, 0], [1, 1], [0, 1]])
    bisector, across = np.array([math.cos(3 * math.pi / 8), math.sin(3 * math.pi / 8)]), np.array([-0.01, 0.0])
    for vertex_, inside in ((1, "concave"), (2, "convex")):
        for depth in (-0.2, 0.2):
            for side in (0, 1):
                x = at[vertex_] + depth * bisector + (2 * side - 1) * across
                check(f"facets: {inside} vertex, depth {depth}", curve.locate(x, at)[0], vertex_ - 1 + side, 0)


def finite_uniform():
    """Uniform compression: the stretch across from the traction that is zero there, then force and energy."""
    young, nu, down = 10, 0.3, 0.3
    G, La, l1 = young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu)), 1 - down
    l2 = 1.0
    for _ in range(50):
        l2 -= ((G * (l2 - 1 / l2) + La * math.log(l1 * l2) / l2)
               / (G * (1 + 1 / l2 ** 2) + La * (1 - math.log(l1 * l2)) / l2 ** 2))
    force = -2 * (G * (l1 - 1 / l1) + La * math.log(l1 * l2) / l1)
    energy = 2 * (G / 2 * (l1 ** 2 + l2 ** 2 - 2 - 2 * math.log(l1 * l2)) + La / 2 * math.log(l1 * l2) ** 2)
    for surface in ("faceted", "smooth", {"smooth": "b_spline"}):
        model, results, values, gradients, _ = finite.solve(finite_block(surface, down))
        v, g, name = values[-1], gradients[-1], f"block on a base, {surface}"
        corner = model.bodies["block"].sides["bottom"].nodes[-1]
        check(name + ": stretch across", 1 + results[-1]["u"][2 * corner] / 2, l2, 1e-12)
        check(name + ": force", v["press"], force, 1e-12)
        check(name + ": reaction", v["hold"], -force, 1e-12)
        check(name + ": energy", v["energy"], energy, 1e-12)
        check(name + ": d energy / d down", g["energy"]["down"], force, 1e-11)
        check(name + ": E d force / d E", g["press"]["E"] * young, force, 1e-11)
        document = changed(finite_block(surface, down - 0.05), {"/contacts/sole/offset": -0.05})
        document["parameters"]["offset"] = "/contacts/sole/offset"
        _, _, values, gradients, _ = finite.solve(document)
        check(name + ": force of an interference", values[-1]["press"], force, 1e-12)
        check(name + ": d force / d offset", gradients[-1]["press"]["offset"], -g["press"]["down"], 1e-11)


def finite_thin():
    """Uniform compression in plane stress: the block widens alike to its side and out of the plane. Rubber by the
    equation of its free sides; metal by its stress over logarithmic strain, straight from corner to corner."""
    young, nu, down, thickness = 10, 0.3, 0.3, 0.7
    G, La, l1 = young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu)), 1 - down
    l2 = 1.0
    for _ in range(50):
        J = l1 * l2 ** 2
        l2 -= (G * (l2 ** 2 - 1) + La * math.log(J)) / (2 * G * l2 + 2 * La / l2)
    force = -2 * thickness * (G * (l1 - 1 / l1) + La * math.log(J) / l1)
    energy = 2 * thickness * (G / 2 * (l1 ** 2 + 2 * l2 ** 2 - 3 - 2 * math.log(J)) + La / 2 * math.log(J) ** 2)
    document = finite_block(down=down)
    document["space"] = "plane_stress"
    document["bodies"]["block"]["thickness"] = thickness
    document["parameters"]["thickness"] = "/bodies/block/thickness"
    model, results, values, gradients, _ = finite.solve(document)
    corner = model.bodies["block"].sides["bottom"].nodes[-1]
    v, g = values[-1], gradients[-1]
    check("thin rubber: stretch to the side", 1 + results[-1]["u"][2 * corner] / 2, l2, 1e-12)
    check("thin rubber: force", v["press"], force, 1e-12)
    check("thin rubber: energy", v["energy"], energy, 1e-12)
    check("thin rubber: d energy / d down", g["energy"]["down"], force, 1e-11)
    check("thin rubber: E d force / d E", g["press"]["E"] * young, force, 1e-11)
    check("thin rubber: thickness d force / d thickness", g["press"]["thickness"] * thickness, force, 1e-11)
    for hardening in (2, [[0.1, 0.7], [0.2, 0.8]]):
        metal = {"j2_plastic": {"E": young, "nu": nu, "yield": 0.5, "hardening": hardening}}
        document["bodies"]["block"]["material"] = metal
        document["parameters"] = {"yield": "/bodies/block/material/j2_plastic/yield"}
        _, _, values, gradients, _ = finite.solve(document)
        rows = [[0.0, 0.5]] + (hardening if isinstance(hardening, list) else [[1, 0.5 + hardening]]) + [[2, 0.8]]
        strain, slope = -math.log(1 - down), None
        for (a, s), (b, r) in zip(rows, rows[1:]):  # strain = plastic strain + stress / E at the corners
            if slope is None and strain < b + r / young:
                slope = (r - s) / (b - a) / (1 + (r - s) / (b - a) / young)
                stress = s + slope * (strain - a - s / young)
        name = f"thin metal, hardening {hardening}"
        check(name + ": force", values[-1]["press"], 2 * thickness * stress / l1, 1e-11)
        if not isinstance(hardening, list):
            check(name + ": d force / d yield", gradients[-1]["press"]["yield"],
                  2 * thickness * (1 - slope / young) / l1, 1e-10)


def finite_balance():
    """Supports are in balance, moments in the current configuration included; without friction energy is a potential
    of the supports' forces, whatever was slid over, and their derivatives are symmetric."""
    for surface, friction in (("faceted", None), ("smooth", None), ({"smooth": "b_spline"}, None), ("smooth", 0.3)):
        model, results, values, gradients, worst = finite.solve(ironing(surface, friction))
        name = f"ironing, {surface}, friction {friction}"
        check(name + ": largest violation", worst, 0, 1e-13)
        total = finite.residual_forces(model, results[-1]).real
        place = model.X + results[-1]["u"].reshape(-1, 2)
        check(name + ": forces in balance", np.abs(total.sum(axis=0)).max(), 0, 1e-13)
        check(name + ": moments in balance", (place[:, 0] * total[:, 1] - place[:, 1] * total[:, 0]).sum(), 0, 1e-13)
        if friction is None:
            v, g = values[-1], gradients[-1]
            check(name + ": d energy / d down", g["energy"]["down"], -v["y"], 1e-10)
            check(name + ": d energy / d along", g["energy"]["along"], v["x"], 1e-10)
            check(name + ": symmetry", g["x"]["down"], -g["y"]["along"], 1e-10)


def vertex():
    """On facets, with friction, drawn along by 0.7: the leading node is between two facets at the end, each of which
    leaves it on the other; no step before has less than one solution."""
    document = ironing("faceted")
    model = finite.FiniteModel(document)
    path = finite.FinitePath(model)
    document["time"] = {"legs": [[1, 2], [1.75, 3]]}
    results = finite.FinitePath(finite.FiniteModel(document)).run()
    check("vertex: states and facets agree until then", len(results), 5, 0)
    check("vertex: reaction at time 1.5",
          finite.responses(finite.FiniteModel(document), results[3])["x"].real, 0.0450126625723, 1e-10)
    before, search, node = results[-1], model.locate, 4
    for facet, other in ((5, 4), (4, 5)):
        def held(u):
            feet, place, p = search(u), model.X + u.reshape(-1, 2), model.points[node]
            a, b = (place[p.curve.chain[facet + k]] for k in (0, 1))
            feet[node] = (facet, (place[p.slave] - a) @ (b - a) / ((b - a) @ (b - a)))
            return feet
        model.locate = held
        u = path.step(before["u"], before["p"], before["t"], before["feet"], 1.75, 2.0)[0]
        check(f"vertex: facet that the solution on facet {facet} is on", search(u)[node][0], other, 0)
    model.locate = search


def finite_derivatives(names=("finite_ironing_smooth",), parameters=("mu", "tip_y")):
    """Complex step against differences of the whole path, states free."""
    for name in names:
        document = finite_cases()[name]()
        gradients = finite.solve(document)[3]
        for parameter in parameters or document["parameters"]:
            if parameter not in document["parameters"]:
                continue
            # (1e-4 takes a point of the metal over its bound, of the height 2e-5 too; at 1e-5 rounding leaves up to
            # 1e-7 by hardening, at 2e-5 4e-8)
            step = 1e-4 if "metal" not in name else 1e-5 if parameter == "height" else 2e-5
            rows = finite.differences(document, document["parameters"][parameter], step)
            worst, where = 0.0, ""
            for response in rows[0]:
                size = max(abs(g[response][parameter]) for g in gradients) or 1.0
                error = max(abs(g[response][parameter] - row[response]) for g, row in zip(gradients, rows)) / size
                if not error <= worst:
                    worst, where = error, response
            check(f"{name}: d/d{parameter} against differences, worst at {where}", worst, 0, 1e-7)


def slow_finite_derivatives():
    """Of plane stress, each of whose runs takes long, by one number. (Not of tables, of which differences leave
    3e-7.)"""
    finite_derivatives([name for name in finite_cases() if "thin" not in name and "table" not in name], None)
    finite_derivatives(("finite_ironing_thin",), ("thin",))


def finite_stored(thin=False):
    for name, scene in finite_cases().items():
        if ("thin" in name) != thin:
            continue
        document = scene()
        with open(os.path.join(HERE, name + ".json"), encoding="utf-8") as f:
            file = json.load(f)
        check(f"{name}: scene as stored", file["scene"] == json.loads(json.dumps(document)), True, 0)
        fresh = json.loads(json.dumps(finite.finite_reference(document)))
        same_solution(name, None, document, file["solutions"]["exact"], fresh)


def slow_finite_stored():
    finite_stored(True)


def press_fit():
    """Rings by collocation against shooting, and their limit of small interference: Lame's rings, of displacements
    A R + B / R that vanish at the walls."""
    young, nu = 1000.0, 0.3
    for interference, pressure in ((0.001, 0.523865607559), (0.01, 5.24370805044), (0.1, 52.9471019151)):
        p = finite.press_fit(interference)
        check(f"rings, interference {interference}: pressure", p, finite.press_fit(interference, shooting=True), 1e-9)
        check(f"rings, interference {interference}: pressure as known", p, pressure, 1e-9)
    G, La = young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu))
    stiffness = lambda wall, R: (2 * (La + G) + 2 * G * wall ** 2 / R ** 2) / (R - wall ** 2 / R)  # P_R / u at R
    k = [abs(stiffness(wall, 2.0)) for wall in (1.0, 4.0)]
    small = 1e-5
    check("rings: stiffness of small interference", finite.press_fit(small) / small, k[0] * k[1] / (k[0] + k[1]), 1e-5)


# Errors that a reference solver may have: text of contact_reference.py, and what is planted in its place.
FAULTS = {
    "gap without its offset": ("n, gap + offset, a,", "n, gap, a,"),
    "tributary area of whole facets": ("area[b] += length / 2", "area[b] += length"),
    "penalty without the area": ('1 / (law["stiffness"] * self.area)', '1 / (law["stiffness"] * self.area ** 0)'),
    "penalty without its tangential ratio": ('self.CN / law.get("tangential_ratio", 1.0)', "self.CN"),
    "slip from the start, not from the last increment": ("- self.BT @ self.u", ""),
    "tangential force forgotten": ("self.u, self.rT_before, self.before = x, rT,", "self.u, self.before = x,"),
    "friction halved": ("rT[i] = self.mu[i] * rN[i] * states", "rT[i] = self.mu[i] / 2 * rN[i] * states"),
    "dissipation with the wrong sign": ("self.dissipation - np.where", "self.dissipation + np.where"),
    "inequalities not verified": ("return max(0.0, worst[0]), repaired", "return 0.0, repaired"),
    "shear modulus doubled": ("[0, 0, (1 - 2 * nu) / 2]", "[0, 0, (1 - 2 * nu)]"),
    "plane stress as plane strain": ("if plane_stress:", "if False:"),
    "weight of triangles": ("[0.0, 1.0]]), 0.5)]", "[0.0, 1.0]]), 0.45)]"),
    "reaction without the contact force": ("total[node] = total[node] - w * force", "pass"),
    "moving obstacle that stands": ("gap0 = self.gap0 - part(", "gap0 = self.gap0 - 0 * part("),
    "normal of a cup turned": ('sign = -1 if shape_.get("inside") else 1', "sign = 1"),
    "derivatives with real stiffness": ("values = [v if np.iscomplexobj(v) else v.astype(float) for v in values]",
                                        "values = [v.real.astype(float) for v in values]"),
}


FINITE_FAULTS = {
    "volume of plane stress": ("invariant - 3 - 2", "invariant - 2 - 2"),
    "logarithm not weighed by J": ("self.La * np.log(J) if self.log else self.La * (J - 1) * J",
                                   "self.La * np.log(J) * J if self.log else self.La * (J - 1) * J"),
    "gap without its offset": ("shared.shape[:-2] + (18,)), gap + self.model.offset[self.on]",
                               "shared.shape[:-2] + (18,)), gap + 0 * self.model.offset[self.on]"),
    "force on the master at its segment's start": ("-N[..., :, None] * force", "-np.eye(4)[0][:, None] * force"),
    "slip from the start, not from the last step": ("feet, dissipation, start = m.locate(u), result",
                                                    "dissipation, start = result"),
    "last foot without derivative": ("(feet[i][0], xi[k])", "(feet[i][0], xi[k].real)"),
    "places of the last foot of the first body alone": ("y_then = value(self.powers_then @ local[..., 5:9, :]",
                                                        "y_then = value(self.powers_then @ local[..., 1:5, :]"),
    "Catmull-Rom of half the slope": ("[-1, 6, 1, 0], [0, 1, 6, -1]", "[-0.5, 6, 0.5, 0], [0, 0.5, 6, -0.5]"),
    "free end without its ghost": ("share[c, 0], share[c, 1] = 2, -1", "share[c, 0] = 1"),
    "bisectors forgotten": ("(unit[j] + unit[j + 1]) > 0", "unit[j] > 0"),
    "dissipation with the wrong sign": ('"dissipation": dissipation - ', '"dissipation": dissipation + '),
    "plastic volume that changes": ("d, dz = e - third[..., None, None] * np.eye(2), z - third",
                                    "d, dz = e - third[..., None, None] * np.eye(2), z"),
    "memory of the first step": ("            m.settle(u)\n        return results", "        return results"),
    "no hardening": ("return e - share[..., None, None] * d, z - share * dz, hardened + grown",
                     "return e - share[..., None, None] * d, z - share * dz, hardened"),
    "plane stress as plane strain": ("if not self.plane_stress:", "if True:"),
    "corner of a table too late": ("slope, bound = self.piece(hardened + (low + high) / 2)",
                                   "slope, bound = self.piece(hardened)"),
    "hoop stress that is radial": ("hoop = self.G * (b - 1 / b)", "hoop = self.G * (a - 1 / a)"),
}


def faults(which=None):
    """Each fault in a copy of its file: a part of QUICK must fail there, or of FINITE and LONG_FINITE."""
    for module, planted, parts in (("contact_reference", FAULTS, QUICK),
                                   ("finite_reference", FINITE_FAULTS, FINITE + LONG_FINITE)):
        if which and module != which:
            continue
        with open(os.path.join(HERE, module + ".py"), encoding="utf-8") as f:
            sound = f.read()
        for name, (text, faulty) in planted.items():
            assert sound.count(text) == 1, f"the text of the fault is no longer there, or twice: {name}: {text}"
            with tempfile.TemporaryDirectory() as folder:
                with open(os.path.join(folder, module + ".py"), "w", encoding="utf-8") as f:
                    f.write(sound.replace(text, faulty))
                result = subprocess.run(
                    [sys.executable, "-c", "import sys; sys.path.insert(0, sys.argv[1]); sys.path.append(sys.argv[2]); "
                     f"import {module}; assert {module}.__file__.startswith(sys.argv[1]); import check_references; "
                     f"sys.exit(check_references.run({parts}, True))", folder, HERE],
                    capture_output=True, text=True, check=False)
                seen = next((line for line in result.stdout.split("\n") if line.startswith("FAIL")),
                            result.stderr.strip().split("\n")[-1])
                check(f"seen: {name}", result.returncode != 0, True, 0)
                print("     by", seen[:100])


def finite_faults():
    faults("finite_reference")


FINITE = ("press_fit", "curves", "finite_uniform", "finite_balance", "vertex")
LONG_FINITE = ("finite_thin", "finite_stored", "finite_derivatives")
QUICK = ("stop", "uniform", "balance", "inequalities", "bar", "capstan", "enumeration", "few_derivatives", "slider",
         "stored") + FINITE


def run(parts, until_one_fails=False):
    for part in parts:
        globals()[part]()
        if FAILED and until_one_fails:
            break
    return f"{len(FAILED)} failed: {FAILED}" if FAILED else 0


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:] or QUICK))
