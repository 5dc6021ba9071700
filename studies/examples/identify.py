"""Identifies a coefficient of friction and a stiffness from a measured force-displacement curve.

    python3 studies/examples/identify.py        (needs the Python module of stickslip, numpy and nlopt)

The "measurement" is a run of slider.json with other numbers, and noise of 0.2 % on it. First the gradients are held
against differences; then NLopt's SLSQP takes sum of squares and gradient, both of one run. Where a trial has no solution,
run() raises, the misfit is infinite, and the search takes a shorter step. At last an honest failure:
from a friction so large that the block never slips, the force does not know it, the gradient is zero, and no method
that goes by gradients can leave.
"""

import os

import nlopt
import numpy as np
import stickslip

SCENES = os.environ.get("STICKSLIP_SCENES", os.path.join(os.path.dirname(__file__), "..", "scenes"))
SCENE = os.path.join(SCENES, "slider.json")
NAMES = {"mu": "/contacts/sole/friction", "k": "/bodies/block/material/grounded_spring/stiffness/0/0"}
HIDDEN = {"mu": 0.42, "k": 137.0}


def simulate(values):
    """Force of the spring over the steps, and its derivatives by mu and k, a column each."""
    result = stickslip.run(SCENE, set={NAMES[name]: value for name, value in values.items()})
    return result.responses["pull"], np.column_stack([result.sensitivities["pull"][name] for name in NAMES])


def measured():
    force, _ = simulate(HIDDEN)
    return force + 0.002 * np.abs(force).max() * np.random.default_rng(1).standard_normal(force.size)


def identify(curve, start):
    """(values, sum of squares over that of the curve, runs) of the best fit from a start."""
    scale = np.array(list(start.values()))  # parameters of the size of one

    def objective(x, gradient):
        try:
            force, slopes = simulate(dict(zip(NAMES, x * scale)))
        except (stickslip.NotConverged, stickslip.InputError):
            gradient[:] = 0
            return np.inf
        misfit = force - curve
        if gradient.size:
            gradient[:] = 2 * misfit @ slopes * scale / (curve @ curve)
        return misfit @ misfit / (curve @ curve)

    search = nlopt.opt(nlopt.LD_SLSQP, len(NAMES))
    search.set_min_objective(objective)
    search.set_lower_bounds(0.05)
    search.set_upper_bounds(20.0)
    search.set_xtol_rel(1e-8)
    search.set_maxeval(200)
    x = search.optimize(np.ones(len(NAMES)))
    return dict(zip(NAMES, x * scale)), search.last_optimum_value(), search.get_numevals()


def main():
    check = stickslip.gradcheck(SCENE)
    print("gradients agree with differences:", check.passed)
    curve = measured()
    found, misfit, runs = identify(curve, {"mu": 0.2, "k": 60.0})
    for name, value in found.items():
        print(f"{name}: {value:.4g} (hidden: {HIDDEN[name]:g})")
    print(f"misfit {misfit:.1e} after {runs} runs")
    stuck, misfit, runs = identify(curve, {"mu": 5.0, "k": 60.0})
    print(f"from mu = 5, where nothing slips: mu stays {stuck['mu']:.4g}, misfit {misfit:.1e} after {runs} runs")
    return check.passed, found, stuck


if __name__ == "__main__":
    main()
