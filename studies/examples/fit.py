"""Fits friction and stiffness by scipy, where some trials have no solution.

    python3 studies/examples/fit.py        (needs the Python module of stickslip, numpy and scipy)

A block is pressed onto a rough floor and pushed by forces. With too little friction it slides away, and the run fails.
least_squares takes residuals that are infinite for that: it keeps the last point that solves and takes a shorter step.
Line searches, as of L-BFGS-B or SLSQP, do not: they stop at such a trial and may report success. Three things are on the
caller: a start that solves, bounds that keep the numbers valid, and a look at the cost in the end.
"""

import numpy as np
import stickslip
from scipy.optimize import least_squares

NAMES = {"mu": "/contacts/sole/friction", "E": "/bodies/block/material/linear_elastic/E"}
HIDDEN = {"mu": 0.27, "E": 1000.0}
SCENE = {
    "title": "Block that is pressed and pushed", "space": "plane_strain",
    "bodies": {"block": {"mesh": {"box": {"min": [0, 0], "max": [4, 2], "cells": [12, 6]}},
                         "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}}},
    "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
    "contacts": {"sole": {"slave": "block.bottom", "master": "floor", "friction": 0.3}},
    "loads": [{"on": "block.top", "traction": [0, -5]},
              {"on": "block.top", "traction": [1.2, 0], "history": [[0, 0], [1, 1]]}],
    "time": {"end": 1, "steps": 8},
    "responses": {"shift": {"displacement": {"on": "block.top", "component": "x"}}},
    "parameters": NAMES, "method": {"monolithic_al": {}}}


def simulate(x):
    return stickslip.run(SCENE, set=dict(zip(NAMES.values(), x)))


def fit(curve, start):
    """(what least_squares found, number of trials without a solution)."""
    size, failed = np.abs(curve).max(), []

    def residuals(x):
        try:
            return (simulate(x).responses["shift"] - curve) / size
        except (stickslip.NotConverged, stickslip.InputError):
            failed.append(x)
            return np.full(curve.size, np.inf)

    # the Jacobian is asked for only where the residuals were finite
    found = least_squares(residuals, start, jac=lambda x: simulate(x).jacobian("shift") / size,
                          bounds=([0.01, 1.0], [2.0, 1e6]), x_scale=start, xtol=1e-12, ftol=1e-12, gtol=1e-12)
    return found, len(failed)


def main():
    curve = simulate(HIDDEN.values()).responses["shift"]
    found, failed = fit(curve, [0.3, 3000.0])
    for name, value in zip(NAMES, found.x):
        print(f"{name}: {value:.6g} (hidden: {HIDDEN[name]:g})")
    print(f"cost {found.cost:.1e} after {found.nfev} trials, {failed} of them without a solution")
    return found, failed


if __name__ == "__main__":
    main()
