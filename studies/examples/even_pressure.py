"""Evens out the pressure below a block by the shape of the floor that it is pressed on.

    python3 studies/examples/even_pressure.py        (needs the Python module of stickslip, numpy and nlopt)

On a flat floor the pressure of a block that is pressed by its top peaks at the edges. The floor is a polyline, whose
vertices may be lowered or raised, but for one in the middle. What is minimised is the sum of squares of the distances
of the nodal pressures from their mean, over that mean squared; NLopt's MMA is given it with its gradient, both of one
run.
"""

import nlopt
import numpy as np
import stickslip

CELLS = 12
NODES = np.linspace(-1, 1, CELLS + 1)
VERTICES = np.linspace(-1.1, 1.1, 8)  # no node lies on one of them
MOVED = [n for n in range(len(VERTICES)) if n != 3]


def scene(heights):
    """The block on a floor whose vertices have these heights: a pressure `p3` a node, a parameter `h3` a vertex."""
    floor = [[float(x), 0.0] for x in VERTICES]
    for n, height in zip(MOVED, heights):
        floor[n][1] = float(height)
    return {
        "title": "Block on a floor that is shaped", "space": "plane_strain",
        "bodies": {"block": {"mesh": {"box": {"min": [-1, 0], "max": [1, 1.5], "cells": [CELLS, 9]}},
                             "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}}},
        "obstacles": {"floor": {"polyline": {"points": floor}}},
        "contacts": {"sole": {"slave": "block.bottom", "master": "floor"}},
        "supports": [{"on": "block.top", "move": {"x": 0, "y": -0.01}}],
        "time": {"end": 1, "steps": 1},
        "responses": {f"p{n}": {"contact_pressure": {"contact": "sole", "at": [float(x), 0]}}
                      for n, x in enumerate(NODES)},
        "parameters": {f"h{n}": f"/obstacles/floor/polyline/points/{n}/1" for n in MOVED},
        "method": {"monolithic_al": {}}}


def pressures(heights):
    """Of the nodes, and their derivatives by the heights, a column each."""
    result = stickslip.run(scene(heights))
    values = np.array([result.responses[f"p{n}"][-1] for n in range(CELLS + 1)])
    slopes = np.array([[result.sensitivities[f"p{n}"][f"h{m}"][-1] for m in MOVED] for n in range(CELLS + 1)])
    return values, slopes


def unevenness(heights, gradient):
    try:
        p, slopes = pressures(heights)
    except (stickslip.NotConverged, stickslip.InputError):  # no optimiser is to walk on a run without a solution: it takes a shorter step
        gradient[:] = 0
        return np.inf
    mean, apart = p.mean(), p - p.mean()
    value = apart @ apart / mean ** 2
    if gradient.size:
        gradient[:] = 2 * apart @ slopes / mean ** 2 - 2 * value / mean * slopes.mean(axis=0)
    return value


def main():
    flat = np.zeros(len(MOVED))
    check = stickslip.gradcheck(scene(flat))
    print("gradients agree with differences:", check.passed)
    search = nlopt.opt(nlopt.LD_MMA, len(MOVED))
    search.set_min_objective(unevenness)
    search.set_lower_bounds(-0.005)
    search.set_upper_bounds(0.005)
    search.set_ftol_rel(1e-8)
    search.set_maxeval(100)
    shaped = search.optimize(flat)
    before, after = pressures(flat)[0], pressures(shaped)[0]
    spread = lambda p: (p.max() - p.min()) / p.mean()
    print(f"largest less least pressure over the mean: {spread(before):.3g} flat, {spread(after):.2g} shaped, "
          f"after {search.get_numevals()} runs" + (", the most allowed" if search.last_optimize_result() ==
                                                   nlopt.MAXEVAL_REACHED else ""))
    print("heights:", " ".join(f"{h:.5f}" for h in shaped))
    return check.passed, spread(before), spread(after)


if __name__ == "__main__":
    main()
