"""Windows of robustness (studies/windows): how they are read; that automatic choices lie inside and are cheap.

STICKSLIP_PROGRAM=build/release/stickslip python3 tests/studies/windows_test.py [--all]

--all: every scene at both strains, by every method, and each automatic choice held against `stickslip verify`, which
shares no code with the solver; else the block at small strain alone.
"""

import contextlib
import csv
import io
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SUITE = pathlib.Path(__file__).resolve().parents[2] / "studies" / "windows"
sys.path.insert(0, str(SUITE))

import windows  # noqa: E402

PROGRAM = os.environ.get("STICKSLIP_PROGRAM", "")
ALL = "--all" in sys.argv

# Iterations of the automatic choice over the least, by method and strain, where it is more than the aim of 1.5: those
# of docs/windows.md may not grow. They are counts, alike on every machine but for rounding, which may add one iteration
# to the 28 and 13 of the dearest by Uzawa, and to the 15 and 21 of the others.
MOST = {("uzawa_al", "small"): 2.64, ("uzawa_al", "finite"): 2.34, ("monolithic_al", "small"): 1.78,
        ("penalty", "finite"): 1.7}


def row(value, newton, status="converged", error=0.0, automatic=10.0):
    """A row of a study as the suite reads it."""
    return {"knobs": {"scale": value}, "automatic": automatic, "status": status,
            "cost": {"counts": {"newton": newton}}, "errors": {"enforcement": {"response:u": error, "field:p": 1.0}}}


class Window(unittest.TestCase):
    def test_reaches_to_the_first_failure_on_both_sides(self):
        rows = [row("auto", 6)] + [row(10.0 ** p, 5, "cap" if p in (-3, 3) else "converged") for p in range(-4, 5)]
        self.assertEqual(windows.window_of(rows), {"from": 0.01, "to": 100.0, "automatic": 10.0, "inside": True,
                                                   "iterations": 6, "least": 5, "times": 1.2})

    def test_does_not_hold_a_choice_that_failed_or_stands_beside_a_failure(self):
        for bad in (1.0, 100.0):
            rows = [row("auto", 6, automatic=10.0)] + [row(v, 5, "cap" if v == bad else "converged")
                                                       for v in (1.0, 100.0)]
            self.assertFalse(windows.is_good(windows.window_of(rows)), bad)
        rows = [row("auto", 6, "cycle")] + [row(v, 5) for v in (1.0, 100.0)]
        self.assertFalse(windows.is_good(windows.window_of(rows)))

    def test_holds_a_penalty_against_those_that_err_no_more(self):
        rows = [row(1.0, 2, error=0.5), row("auto", 6, error=1e-3), row(100.0, 5, error=1e-5)]
        self.assertEqual(windows.window_of(rows)["least"], 5)
        rows = [row(1.0, 2, error=9e-7), row("auto", 6, error=1e-9), row(100.0, 5, error=1e-5)]
        self.assertEqual(windows.window_of(rows)["least"], 2)  # an error within 1e-6 counts as none


@unittest.skipUnless(PROGRAM, "STICKSLIP_PROGRAM names no program")
class AutomaticChoice(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def measure(self, *options):
        """The table of a run of the suite, with the code that it ended with."""
        said = io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            code = windows.main([PROGRAM, "-o", str(self.folder / "out"), *options])
        self.assertIn(code, (0, 3), said.getvalue())
        with open(self.folder / "out" / "windows.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file)), code

    def hold(self, lines, code):
        for line in lines:
            self.assertEqual(line["inside"], "True", line)
            most = MOST.get((line["method"], line["strain"]), windows.ALLOWED)
            self.assertLessEqual(float(line["times"]), most, line)
        self.assertEqual(code, 0 if all(float(line["times"]) <= windows.ALLOWED for line in lines) else 3)

    def test_lies_inside_and_is_cheap_for_a_block(self):
        lines, code = self.measure("--only", "block", "--strain", "small")
        self.assertEqual(len(lines), 12)
        self.assertEqual({line["automatic"] for line in lines}, {"1000.0", "100.0", "1.0"})
        self.hold(lines, code)

    @unittest.skipUnless(ALL, "--all")
    def test_lies_inside_and_is_cheap_everywhere(self):
        lines, code = self.measure()
        self.assertEqual(len(lines), 144)
        self.hold(lines, code)

    @unittest.skipUnless(ALL, "--all")
    def test_solves_what_the_checker_accepts(self):
        for strain in windows.STRAINS:
            for name in windows.SCENES:
                windows.write_scene(name, strain, self.folder)
                for method in ("penalty", "uzawa_al", "monolithic_al"):
                    with self.subTest(name, strain=strain, method=method):
                        out = self.folder / f"{strain}.{name}.{method}"
                        for command in (["run", self.folder / f"{name}.json", "-m", method, "-o", out],
                                        ["verify", out]):
                            done = subprocess.run([PROGRAM, *command], capture_output=True, text=True)
                            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[argument for argument in sys.argv if argument != "--all"])
