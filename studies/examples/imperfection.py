"""How sensitive a buckling load is to an imperfection: derivatives of a peak, without differences.

    python3 studies/examples/imperfection.py        (needs the Python module of stickslip, and numpy)

A steep truss of two bars is pushed down by a plate. Pushed straight down it would buckle sideways at a bifurcation; a
plate that is not quite level (`tilt`) makes it lean from the start, and the force has a peak that is less, the more it
leans: Koiter's law of an even bifurcation says that it falls by a share of tilt^(2/3). The derivative of the peak by the
tilt is that of the force at the step of the peak, to first order, since there the force does not change along the path.
"""

import numpy as np
import stickslip


def scene(tilt, steps=400):
    return {
        "title": "Truss that buckles under a plate", "space": "plane_strain", "strain": "finite",
        "bodies": {"truss": {"mesh": {"arc": {"center": [0, 0], "radius": 1, "from_angle": -40, "to_angle": 220,
                                              "cells": 2}},
                             "element": "bar", "area": 1, "material": {"linear_elastic": {"E": 100, "nu": 0}}}},
        "obstacles": {"plate": {"plane": {"point": [0, 1], "normal": [tilt, -1]},
                                "move": {"y": [[0, 0], [1, -1.2]]}}},
        "contacts": {"top": {"slave": "truss.interior", "master": "plate"}},
        "supports": [{"on": "truss.start", "move": {"x": 0, "y": 0}}, {"on": "truss.end", "move": {"x": 0, "y": 0}}],
        "time": {"end": 1, "steps": steps},
        "responses": {"press": {"contact_force": {"contact": "top", "component": "normal"}},
                      "aside": {"displacement": {"on": "truss.interior", "component": "x"}}},
        "parameters": {"tilt": "/obstacles/plate/plane/normal/0"}, "method": {"monolithic_al": {}}}


def peak(tilt):
    """(peak of the force, its derivative by the tilt) of one run."""
    result = stickslip.run(scene(tilt))
    force = result.responses["press"]
    at = int(force.argmax())
    return force[at], result.sensitivities["press"]["tilt"][at]


def main():
    rows = [(tilt, *peak(tilt)) for tilt in (0.0025, 0.005, 0.01, 0.02, 0.04)]
    print("   tilt     peak   d peak / d tilt   by differences")
    for tilt, force, slope in rows:
        near = (peak(1.01 * tilt)[0] - peak(0.99 * tilt)[0]) / (0.02 * tilt)
        print(f"{tilt:7.4f} {force:8.4f} {slope:17.3f} {near:16.3f}")
    logs = np.log([[row[0], -row[2]] for row in rows[:3]])
    power = 1 + np.polyfit(*logs.T, 1)[0]
    print(f"the peak falls as tilt^{power:.2f} (Koiter: 2/3)")
    return rows, power


if __name__ == "__main__":
    main()
