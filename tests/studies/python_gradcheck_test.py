"""The Python module, gradcheck and explain: closed forms, faults, and what the commands print.

PYTHONPATH=build/python/python STICKSLIP_SCENES=studies/scenes python3 tests/studies/python_gradcheck_test.py
"""

import json
import os
import pathlib
import pickle
import subprocess
import unittest

from python_test import SCENES, plate

import stickslip

PROGRAM = pathlib.Path(os.environ.get("STICKSLIP_PROGRAM", ""))  # the preset builds the module alone
needs_program = unittest.skipUnless(PROGRAM.is_file(), "the program is not built")


class Derivatives(unittest.TestCase):
    def test_a_check_holds_what_a_run_computes_against_differences(self):
        check = stickslip.gradcheck(SCENES / "stop.json")
        self.assertTrue(check)
        self.assertEqual((check.status, check.faults), ("converged", ""))
        self.assertEqual(repr(check), f"<stickslip.Gradcheck: 6 of 6 derivatives agree, {check.runs} difference runs>")
        self.assertGreater(check.runs, 6)
        result = stickslip.run(SCENES / "stop.json")
        closed = {("press", "F"): 1, ("press", "k"): -0.01, ("press", "g0"): -1000,
                  ("u", "F"): 0, ("u", "k"): 0, ("u", "g0"): 1}
        self.assertEqual({(e["response"], e["parameter"]) for e in check.entries}, set(closed))
        for entry in check.entries:
            response, parameter = entry["response"], entry["parameter"]
            self.assertEqual(entry["computed"], result.sensitivities[response][parameter][-1])
            # what the check allows, 1e-8 of the largest derivative of the response or response / parameter
            self.assertAlmostEqual(entry["difference"], closed[response, parameter], delta=1e-8 * entry["scale"])
            self.assertEqual(entry["verdict"], "agrees")

    def test_a_check_survives_pickling_and_prints_its_table(self):
        check = stickslip.gradcheck(SCENES / "stop.json", method="penalty")
        copy = pickle.loads(pickle.dumps(check))
        self.assertEqual((copy.entries, str(copy)), (check.entries, str(check)))
        self.assertEqual(sum(line.endswith("agrees") for line in str(check).splitlines()), 6)

    def test_a_check_that_fails_says_why(self):
        scene = plate(3)
        scene["loads"][0]["traction"] = [2, -5]  # more than friction can hold
        check = stickslip.gradcheck(scene)
        self.assertFalse(check)
        self.assertNotIn(check.status, ("converged", "converged_at_roundoff"))
        self.assertIn(check.message, check.faults)

    def test_a_scene_without_parameters_is_an_input_error(self):
        scene = plate()
        del scene["parameters"]
        with self.assertRaises(stickslip.InputError) as caught:
            stickslip.gradcheck(scene)
        self.assertEqual(caught.exception.faults, ["scene: gradcheck needs parameters and responses"])

    @needs_program
    def test_a_check_is_that_of_the_command(self):
        for method in ("penalty", "uzawa_al", "monolithic_al"):
            command = subprocess.run([PROGRAM, "gradcheck", SCENES / "slider.json", "-m", method, "--json"],
                                     stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
            check = stickslip.gradcheck(SCENES / "slider.json", method=method)
            document = json.loads(command.stdout)
            # compilers may order sums otherwise in code that is independent of its place: a rounding of 1e-16 of the
            # responses over the smallest relative step of 1e-7
            for entry, other in zip(check.entries, document["entries"], strict=True):
                for key in ("response", "parameter", "time", "verdict"):
                    self.assertEqual(entry[key], other[key])
                for key in ("computed", "difference"):
                    self.assertAlmostEqual(entry[key], other[key], delta=1e-9 * entry["scale"])
            self.assertEqual((check.passed, check.runs), (document["passed"], document["runs"]))
            self.assertEqual(check.passed, command.returncode == 0)


class Explanation(unittest.TestCase):
    def test_it_names_what_the_scene_holds_and_follows_its_arguments(self):
        text = stickslip.explain(SCENES / "slider.json", method="penalty", set={"/contacts/sole/friction": 0.25})
        self.assertIn("sole", text)
        self.assertIn("0.25", text)
        self.assertIn("penalty", text)
        self.assertNotIn("monolithic_al", text)

    def test_faults_are_those_of_a_run(self):
        with self.assertRaises(stickslip.InputError) as caught:
            stickslip.explain(plate(), set={"/contacts/heel/friction": 0.1})
        self.assertIn("heel", caught.exception.faults[0])

    @needs_program
    def test_it_is_that_of_the_command(self):
        command = subprocess.run([PROGRAM, "explain", SCENES / "slider.json"], stdout=subprocess.PIPE, check=True)
        self.assertEqual(stickslip.explain(SCENES / "slider.json"), command.stdout.decode())


if __name__ == "__main__":
    unittest.main()
