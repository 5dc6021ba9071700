"""The examples of uses, studies/examples: what they print is true.

PYTHONPATH=build/python/python STICKSLIP_SCENES=studies/scenes python3 tests/studies/python_examples_test.py
"""

import importlib.util
import pathlib
import sys
import unittest
import unittest.mock

import numpy as np

EXAMPLES = pathlib.Path(__file__).parents[2] / "studies" / "examples"
sys.path.insert(0, str(EXAMPLES))
needs_nlopt = unittest.skipUnless(importlib.util.find_spec("nlopt"), "python3-nlopt is not installed")


class Examples(unittest.TestCase):
    @needs_nlopt
    def test_friction_and_stiffness_are_identified_and_a_stuck_start_is_not_left(self):
        import identify
        agree, found, stuck = identify.main()
        self.assertTrue(agree)
        for name, value in found.items():  # the noise is 0.2 % of the force, of 60 steps
            self.assertLess(abs(value / identify.HIDDEN[name] - 1), 0.002, name)
        self.assertEqual(stuck["mu"], 5.0)

    @needs_nlopt
    def test_a_search_survives_trials_without_a_solution(self):
        import identify
        import stickslip
        simulate, lost = identify.simulate, []

        def fails_beyond(values):
            if values["mu"] > 0.45:  # the search passes 0.49 on its way to 0.42
                lost.append(values)
                raise stickslip.NotConverged(stickslip.run(identify.SCENE, check=False))
            return simulate(values)

        curve, _ = simulate(identify.HIDDEN)
        with unittest.mock.patch.object(identify, "simulate", fails_beyond):
            found, misfit, _ = identify.identify(curve, {"mu": 0.2, "k": 300.0})
        self.assertGreater(len(lost), 0)
        self.assertTrue(np.isfinite(misfit))
        for name, value in found.items():
            self.assertLess(abs(value / identify.HIDDEN[name] - 1), 1e-4, name)  # the search ends at 1e-8 of x

    @needs_nlopt
    def test_a_shaped_floor_evens_out_the_pressure(self):
        import even_pressure
        agree, before, after = even_pressure.main()
        self.assertTrue(agree)
        self.assertLess(after, before / 5)

    @unittest.skipUnless(importlib.util.find_spec("scipy"), "python3-scipy is not installed")
    def test_a_fit_by_scipy_survives_trials_without_a_solution(self):
        import fit
        found, failed = fit.main()
        self.assertGreater(failed, 0)
        self.assertTrue(found.success and np.isfinite(found.cost))
        np.testing.assert_allclose(found.x, list(fit.HIDDEN.values()), rtol=1e-6)

    def test_a_peak_is_as_sensitive_to_an_imperfection_as_differences_and_koiter_say(self):
        import imperfection
        rows, power = imperfection.main()
        for tilt, _, slope in rows:
            near = (imperfection.peak(1.01 * tilt)[0] - imperfection.peak(0.99 * tilt)[0]) / (0.02 * tilt)
            # of 400 steps the one at the peak is up to half a step beside it; and the difference has an error of its own
            self.assertLess(abs(slope / near - 1), 2e-3, tilt)
        self.assertLess(abs(power - 2 / 3), 0.05)


if __name__ == "__main__":
    unittest.main()
