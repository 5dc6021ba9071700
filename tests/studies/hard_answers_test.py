"""Numbers in the comments of studies/hard against enumerations, formulas and the independent solver.

python3 tests/studies/hard_answers_test.py
"""

import pathlib
import re
import sys
import unittest

SUITE = pathlib.Path(__file__).resolve().parents[2] / "studies" / "hard"
sys.path[:0] = [str(SUITE), str(SUITE.parents[1] / "tests" / "references")]

import case_file  # noqa: E402
import hard_answers  # noqa: E402

# What the independent solver measures otherwise, or cannot hold: another middle, a friction whose square is 0.
OTHERWISE = ("half-width-of-a-half-model", "friction-1e-300")


class Answers(unittest.TestCase):
    """Numbers in the comments of the scenes against what other code finds."""

    def solutions(self, name):
        case = case_file.read_case(SUITE / f"{name}.json")
        return [tuple(solution.values.values()) for solution in case.solutions]

    def assert_near(self, found, expected, name):
        self.assertEqual(len(found), len(expected), name)
        for one, other in zip(sorted(found), sorted(expected)):
            for a, b in zip(one, other):
                self.assertAlmostEqual(a, b, 9, name)

    def test_points_and_triangles_have_all_of_their_solutions(self):
        names = [path.stem for path in SUITE.glob("klarbring-mu-*.json")]
        self.assertGreater(len(names), 7)
        for name in names:
            friction, load = re.match(r"klarbring-mu-(\d+)-load-([\d.]+)", name).groups()
            expected = hard_answers.point_on_a_wall((1, 0.5, 1), (float(load), 1), float(friction))
            self.assert_near(self.solutions(name), [solution[1:] for solution in expected], name)
        for name, friction, held in (
                ("1.7-pressed-right", 1.7, (0.03, -0.01)), ("1.8-pressed-right", 1.8, (0.01, -0.01)),
                ("1.8-lifted-left", 1.8, (-0.1, 0.01)), ("3-pressed-right", 3, (0.04, -0.01)),
                ("3-lifted-left", 3, (-0.05, 0.01))):
            expected = hard_answers.triangle_on_a_floor(held, friction)
            self.assert_near(self.solutions(f"one-triangle-mu-{name}"), [one[1:] for one in expected], name)

    def answer(self, name, response):
        case = case_file.read_case(SUITE / f"{name}.json")
        return next(one.values[0] for one in case.answers if one.name == response and "monolithic_al" in one.methods)

    def test_formulas(self):
        w = hard_answers.truss_deflection(3.79)
        self.assertAlmostEqual(self.answer("truss-below-its-limit", "w"), -w, 10)
        self.assertAlmostEqual(self.answer("truss-below-its-limit", "w/F"), 2 * hard_answers.truss_slope(w), 8)
        self.assertAlmostEqual(self.answer("truss-snaps-1-step", "press"), (3.8 - hard_answers.truss_force(1.2)) / 2, 9)
        x, y = hard_answers.tractrix()
        self.assertAlmostEqual(self.answer("tractrix", "x"), x, 12)
        self.assertAlmostEqual(self.answer("tractrix", "y"), y - 0.6, 12)
        tension, slope = hard_answers.belt()
        self.assertAlmostEqual(self.answer("belt-over-a-drum", "tight"), -tension, 9)
        self.assertAlmostEqual(self.answer("belt-over-a-drum", "tight/mu"), -slope, 9)
        crowns = {one.time: one.values[0]
                  for one in case_file.read_case(SUITE / "beam-buckles-onto-itself.json").answers}
        self.assertEqual(len(crowns), 3)
        for time, crown in crowns.items():
            self.assertAlmostEqual(crown, hard_answers.elastica_crown(20, 19.8 * time), 9)

    def test_independent_solver_finds_the_answers(self):
        try:
            import contact_reference
        except ImportError:
            self.skipTest("no numpy or scipy")
        cases = [case for case in case_file.read_cases(SUITE)
                 if "contact_reference" in case.source and case.name not in OTHERWISE]
        self.assertGreater(len(cases), 7)
        for case in cases:
            scene = contact_reference.load_commented(case.path)
            scene.pop("parameters", None)
            values = contact_reference.solve(scene, None, str(SUITE), False)[2][-1]
            for answer in case.answers:
                if answer.name in values and "monolithic_al" in answer.methods:
                    scale = answer.scale or abs(answer.values[0]) or 1
                    error = abs(complex(values[answer.name]).real - answer.values[0]) / scale
                    self.assertLessEqual(error, answer.tolerance, f"{case.name}: {answer.name}")


if __name__ == "__main__":
    unittest.main()
