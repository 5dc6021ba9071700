"""The Python module, studies: rows as a table, resume, faults, Ctrl-C; figures and what is drawn in them.

PYTHONPATH=build/python/python STICKSLIP_SCENES=studies/scenes python3 tests/studies/python_study_test.py
"""

import builtins
import contextlib
import io
import json
import pathlib
import shutil
import signal
import tempfile
import unittest
import unittest.mock
import warnings

import numpy as np

import stickslip
from python_test import SCENES, interrupt_after

try:
    import pandas
except ImportError:
    pandas = None
try:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    from stickslip import plots
except ImportError:
    matplotlib = None

STIFFNESSES = (10, 100, 1000)
STUDY = {
    "scene": "stop.json",
    "methods": [{"penalty": {"stiffness": list(STIFFNESSES)}}, {"monolithic_al": {}}],
    "vary": {"/loads/0/force/0": [15, 25]},
    "reference": [{"method": {"monolithic_al": {}}}, {"values": {"press": 5, "press/F": 1}}],
}


class InFolder(unittest.TestCase):
    """A folder with the study of the stop, STUDY."""

    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        shutil.copy(SCENES / "stop.json", self.folder)
        self.file = self.write(STUDY)
        self.out = self.folder / "out"

    def write(self, study):
        path = self.folder / "stop.study.json"
        path.write_text(json.dumps(study))
        return path

    def study(self, **arguments):
        """As stickslip.study, with a list of rows, and what it says on standard error."""
        self.told = io.StringIO()
        with contextlib.redirect_stderr(self.told):
            table = stickslip.study(self.file, self.out, **arguments)
        return table.to_dict("records") if pandas else table


def without_pandas(call):
    """What it returns where pandas cannot be imported."""
    real = builtins.__import__

    def refuse(name, *rest):
        if name == "pandas":
            raise ImportError(name)
        return real(name, *rest)

    with unittest.mock.patch("builtins.__import__", refuse):
        return call()


class Studies(InFolder):
    def test_rows_hold_closed_forms(self):
        rows = self.study()
        self.assertEqual(len(rows), 8)
        self.assertTrue(all(row["converged"] for row in rows))
        for row in rows:
            force = row["/loads/0/force/0"]
            exact = force - 10  # of F - k g0
            if row["method"] == "penalty":
                # u = (F + s k g0) / (k + s k), press = F - k u
                given = force - (force + 10 * row["stiffness"]) / (1 + row["stiffness"])
                slope = 1 - 1 / (1 + row["stiffness"])
            else:
                given, slope = exact, 1
            # roundings of the force of 25, magnified by 1 / (1 + s) at most
            self.assertAlmostEqual(row["response:press"], given, delta=1e-11)
            self.assertAlmostEqual(row["sensitivity:press/F"], slope, delta=1e-11)
            self.assertAlmostEqual(row["enforcement:response:press"], abs(given - exact) / exact, delta=1e-11)
            self.assertAlmostEqual(row["discretization:sensitivity:press/F"], abs(slope - 1), delta=1e-11)
            self.assertGreater(row["factorizations"], 0)
            self.assertGreaterEqual(row["sensitivity_work"], row["work"])
            self.assertAlmostEqual(row["work"], row["factorizations"] - row.get("sensitivity_factorizations", 0)
                                   + row["r"] * row["backsolves"])
            self.assertLess(row["kkt:equilibrium"], 1e-10)
        self.assertEqual({row.get("stiffness") for row in rows if row["method"] == "penalty"}, set(STIFFNESSES))

    def test_a_study_leaves_its_report_and_tells_its_progress_to_python(self):
        self.study()
        self.assertTrue((self.out / "report.html").is_file())
        self.assertIn("8 of 8 done", self.told.getvalue())

    def test_what_is_loaded_is_what_was_returned(self):
        rows, loaded = self.study(), stickslip.load_study(self.out)
        loaded = loaded.to_dict("records") if pandas else loaded
        np.testing.assert_equal(loaded, rows)

    @unittest.skipUnless(pandas, "pandas is not here")
    def test_a_table_is_a_data_frame_with_missing_values(self):
        self.study()
        table = stickslip.load_study(self.out)
        self.assertIsInstance(table, pandas.DataFrame)
        self.assertEqual(table["converged"].dtype, bool)
        self.assertEqual(list(table.columns[:9]), ["id", "label", "method", "status", "converged", "message", "stiffness",
                                                   "/loads/0/force/0", "refine"])
        self.assertEqual(table["stiffness"].isna().tolist(), (table["method"] == "monolithic_al").tolist())
        worst = table.groupby("stiffness")["enforcement:response:press"].max()
        self.assertTrue(worst.is_monotonic_decreasing)

    def test_without_pandas_rows_are_dicts(self):
        self.study()
        rows = without_pandas(lambda: stickslip.load_study(self.out))
        self.assertEqual([type(row) for row in rows], [dict] * 8)
        self.assertEqual(sum("stiffness" in row for row in rows), 6)

    def test_processes_leave_the_same_rows(self):
        first = self.study()
        self.out = self.folder / "other"
        second = self.study(jobs=2)
        for one, other in zip(first, second, strict=True):
            for name in one:
                if "seconds" not in name and "work" not in name and name not in ("r", "peak_memory_mb"):
                    np.testing.assert_equal(one[name], other[name], name)

    def test_resume_runs_what_is_missing_alone(self):
        whole = self.study()
        lines = (self.out / "results.jsonl").read_text().splitlines(keepends=True)
        (self.out / "results.jsonl").write_text("".join(lines[:5]))
        with self.assertWarnsRegex(RuntimeWarning, "3 cells of the study have no row"):
            self.assertEqual(len(stickslip.load_study(self.out)), 5)
        with self.assertRaisesRegex(stickslip.InputError, "holds 5 finished cells"):
            self.study()
        rows = self.study(resume=True)
        self.assertEqual([row["id"] for row in rows], [row["id"] for row in whole])
        again = (self.out / "results.jsonl").read_text().splitlines(keepends=True)
        self.assertEqual(again[:5], lines[:5])
        self.assertNotEqual(again[5:], lines[5:])  # their seconds, or dates, at least

    def test_restart_deletes_what_is_there(self):
        self.study()
        self.write({**STUDY, "methods": [{"monolithic_al": {}}]})
        self.assertEqual(len(self.study(restart=True)), 2)
        self.assertFalse((self.out / "results.stale.jsonl").exists())  # where resume would keep them

    def test_a_shard_runs_its_share(self):
        with self.assertWarnsRegex(RuntimeWarning, "4 cells of the study have no row"):
            self.assertEqual(len(self.study(shard="2/2")), 4)

    def test_a_damaged_row_is_a_warning(self):
        self.study()
        path = self.out / "results.jsonl"
        path.write_text(path.read_text().replace('"status":"converged"', '"status":"Converged"', 1))
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            self.assertEqual(len(stickslip.load_study(self.out)), 7)
        self.assertIn("line 1 is no row", str(caught[0].message))

    def test_rows_of_an_earlier_version_are_loaded(self):
        rows = without_pandas(lambda: stickslip.load_study(pathlib.Path(__file__).with_name("earlier_study")))
        self.assertEqual([row["label"] for row in rows], ["Penalty stiffness=100", "Monolithic AL"])
        self.assertEqual([row["response:hold"] for row in rows], [-10.004995004995001, -9.99999999999999])

    def test_faults_of_the_study_have_their_lines_and_nothing_is_written(self):
        self.file.write_text('{"scene": "stop.json",\n "methods": [{"penalty": {"stifness": [1]}}]}')
        with self.assertRaises(stickslip.InputError) as caught:
            stickslip.study(self.file, self.out)
        (fault,) = caught.exception.faults
        self.assertTrue(fault.startswith(f"{self.file}:2:"), fault)
        self.assertIn("/methods/0/penalty/stifness", fault)
        self.assertIn('did you mean "stiffness"?', fault)
        self.assertFalse(self.out.exists())

    def test_what_is_no_study_is_an_input_error(self):
        with self.assertRaisesRegex(stickslip.InputError, "results.jsonl: there is no such file"):
            stickslip.load_study(self.folder)
        with self.assertRaisesRegex(stickslip.InputError, "nowhere.study.json"):
            stickslip.study(self.folder / "nowhere.study.json")

    @unittest.skipUnless(hasattr(signal, "setitimer"), "no interval timers here")
    def test_an_interrupt_keeps_the_cells_that_are_done(self):
        self.write({**STUDY, "timing": {"repeat": 1000}})  # minutes
        with self.assertRaises(KeyboardInterrupt), interrupt_after(1):
            self.study()
        self.assertEqual(len(stickslip.load_study(self.out)), 8)
        self.write(STUDY)
        self.assertEqual(len(self.study(resume=True)), 8)  # the folder is free again


@unittest.skipUnless(matplotlib, "matplotlib is not here")
class Figures(InFolder):
    def tearDown(self):
        pyplot.close("all")

    def test_tractions_are_those_of_the_contact_in_order(self):
        result = stickslip.run(SCENES / "cattaneo_mindlin.json")
        axes = plots.tractions(result)
        touch = result.contact("touch")
        x = result.coordinates[touch["nodes"], 0]
        order = np.argsort(x, kind="stable")
        lines = {line.get_label(): line for line in axes.get_lines()}
        self.assertEqual(set(lines), {"pressure", "shear", "slip"})
        np.testing.assert_array_equal(lines["pressure"].get_xdata(), x[order])
        np.testing.assert_array_equal(lines["pressure"].get_ydata(), touch["pressure"][order])
        along_x = np.sign(touch["tangent"][order, 0, 0])  # the tangent of the contact runs against x
        self.assertEqual(set(along_x), {-1.0})
        np.testing.assert_array_equal(lines["shear"].get_ydata(), touch["shear"][order, 0] * along_x)
        self.assertEqual(len(lines["slip"].get_xdata()), int((touch["state"] == 2).sum()))
        self.assertGreater(len(lines["slip"].get_xdata()), 0)
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("x", "force per area"))
        self.assertEqual({text.get_text() for text in axes.get_legend().get_texts()}, set(lines))

    def test_tractions_of_a_step_without_friction_go_into_given_axes(self):
        result = stickslip.run(SCENES / "stop.json")
        given = pyplot.subplots()[1]
        self.assertIs(plots.tractions(result, "stop", 0, ax=given), given)
        (line,) = given.get_lines()
        np.testing.assert_allclose(line.get_ydata(), [5], rtol=1e-13)  # the closed form's F - k g0
        self.assertEqual(given.get_title(), "stop, t = 1")

    def test_tractions_of_a_step_without_a_solution_are_drawn_on_request_alone(self):
        scene = json.loads(json.dumps(self.PUSHED))
        result = stickslip.run(scene, check=False)
        self.assertEqual(result.failed_at, 1)
        with self.assertRaisesRegex(ValueError, "there is no solution at t = 1 .*step 0 is the last that has one"):
            plots.tractions(result)
        self.assertEqual(plots.tractions(result, step=0).get_title(), "sole, t = 0.5")
        axes = plots.tractions(result, iterate=True)
        self.assertEqual(axes.get_title(), f"no solution ({result.status}), last iterate, t = 1")
        self.assertEqual({line.get_linestyle() for line in axes.get_lines() if line.get_label() != "slip"}, {"--"})

    def test_derivatives_have_a_gap_and_both_sides_where_there_are_two(self):
        scene = json.loads(json.dumps(self.DRAGGED))
        result = stickslip.run(scene)
        self.assertEqual(list(result.differentiable), [True, True, False, True])
        np.testing.assert_allclose(result.one_sided("u", "U"), [[0, 0], [0, 0], [0, 0.75], [1, 1]], atol=1e-12)
        axes = plots.derivative(result, "u", "U")
        curve, below, above = axes.get_lines()
        np.testing.assert_array_equal(np.isnan(curve.get_ydata()), [False, False, True, False])
        np.testing.assert_allclose([below.get_xdata()[0], below.get_ydata()[0]], [0.75, 0], atol=1e-12)
        np.testing.assert_allclose([above.get_xdata()[0], above.get_ydata()[0]], [0.75, 0.75], atol=1e-12)
        for name in (("none", "U"), ("u", "none")):
            with self.assertRaises(KeyError):
                plots.derivative(result, *name)

    DRAGGED = {"bodies": {"block": {"mesh": {"point": {"at": [0, 0]}},
                                    "material": {"grounded_spring": {"stiffness": [[100, 0], [0, 100]]}}}},
               "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
               "contacts": {"sole": {"slave": "block.node", "master": "floor", "friction": 0.3}},
               "supports": [{"on": "block.anchor", "move": {"x": [[0, 0], [1, 0.04]], "y": 0}}],
               "loads": [{"on": "block.node", "force": [0, -10]}], "time": {"end": 1, "steps": 4},
               "responses": {"u": {"displacement": {"on": "block.node", "component": "x"}}},
               "parameters": {"U": "/supports/0/move/x/1/1"}, "method": {"monolithic_al": {}}}

    PUSHED = {"bodies": {"block": {"mesh": {"box": {"min": [0, 0], "max": [4, 2], "cells": [6, 3]}},
                                   "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}}},
              "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
              "contacts": {"sole": {"slave": "block.bottom", "master": "floor", "friction": 0.3}},
              "loads": [{"on": "block.top", "traction": [0, -5]},
                        {"on": "block.top", "traction": [2, 0], "history": [[0, 0], [0.5, 0], [1, 1]]}],
              "time": {"end": 1, "steps": 2}, "method": {"monolithic_al": {}}}

    def test_work_precision_draws_each_method_against_its_work(self):
        rows = self.study()
        one = [row for row in rows if row["/loads/0/force/0"] == 15]
        axes = plots.work_precision(one, of="response:press")
        lines = {line.get_label(): line for line in axes.get_lines() if not line.get_label().startswith("_")}
        self.assertEqual(set(lines), {"Penalty", "Monolithic AL"})
        # along the stiffness: (given - exact) / exact = 1 / (1 + s) by F = 15, k g0 = 10; 1e-12: roundings of F over 5
        np.testing.assert_allclose(lines["Penalty"].get_ydata(), [1 / (1 + s) for s in STIFFNESSES], rtol=0, atol=1e-12)
        np.testing.assert_array_equal(lines["Penalty"].get_xdata(),
                                      [row["work"] for row in one if row["method"] == "penalty"])
        np.testing.assert_array_equal(lines["Monolithic AL"].get_ydata(), [plots.EXACT])  # it is the reference itself
        self.assertEqual((axes.get_xscale(), axes.get_yscale()), ("log", "log"))
        self.assertEqual(axes.get_xlabel(), "work (factorisations)")
        self.assertEqual(axes.get_ylabel(), "relative error of the response:press")
        self.assertEqual({text.get_text() for text in axes.get_legend().get_texts()}, set(lines))

    def test_work_precision_of_a_table_takes_the_worst_and_the_work_of_derivatives(self):
        rows = self.study()
        axes = plots.work_precision(stickslip.load_study(self.out), of="sensitivity", against="discretization",
                                    work="seconds")
        (line,) = [line for line in axes.get_lines()
                   if line.get_label() == "Penalty, /loads/0/force/0 = 25"]
        penalty = [row for row in rows if row["method"] == "penalty" and row["/loads/0/force/0"] == 25]
        self.assertEqual(sorted(line.get_xdata()), sorted(row["sensitivity_seconds"] for row in penalty))
        self.assertEqual(sorted(line.get_ydata()),
                         sorted(row["discretization:sensitivity:press/F"] for row in penalty))

    def test_curves_are_told_apart_by_what_varies(self):
        rows = self.study()
        for row in rows:
            row["/contacts/stop/friction"] = row.pop("/loads/0/force/0")
        labels = [line.get_label() for line in plots.work_precision(rows).get_lines()]
        self.assertIn("Penalty, friction = 25", labels)

    def test_runs_that_did_not_converge_are_crosses(self):
        rows = self.study()
        rows[0]["converged"] = False
        axes = plots.work_precision(rows)
        crosses = [line for line in axes.get_lines() if line.get_marker() == "x" and len(line.get_xdata())]
        self.assertEqual([line.get_xdata().tolist() for line in crosses], [[rows[0]["work"]]])

    def test_an_error_that_is_not_there_is_named(self):
        with self.assertRaisesRegex(ValueError, "discretization:response:pull"):
            plots.work_precision(self.study(), of="response:pull", against="discretization")


if __name__ == "__main__":
    unittest.main()
