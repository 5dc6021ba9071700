"""The suite of hard cases (studies/hard): what it reads, runs, judges, compares and writes.

STICKSLIP_PROGRAM=build/release/stickslip python3 tests/studies/hard_test.py
"""

import base64
import contextlib
import html.parser
import io
import json
import os
import pathlib
import re
import struct
import sys
import tempfile
import textwrap
import unittest

SUITE = pathlib.Path(__file__).resolve().parents[2] / "studies" / "hard"
sys.path.insert(0, str(SUITE))

import case_file  # noqa: E402
import hard  # noqa: E402
import judge  # noqa: E402
import run_case  # noqa: E402

PROGRAM = os.environ.get("STICKSLIP_PROGRAM", "")

HEADER = """\
// Hard: a wall is in the way.
// Must: stop at it.
// group: walls
// expect penalty: converged
// expect uzawa_al: converged
// expect monolithic_al: converged
"""
# A spring of 1000 that 15 pushes against a stop at 0.01: the stop bears 5.
STOP = {
    "bodies": {"mass": {"mesh": {"point": {"at": [0, 0]}},
                        "material": {"grounded_spring": {"stiffness": [[1000, 0], [0, 1000]]}}}},
    "obstacles": {"wall": {"plane": {"point": [0.01, 0], "normal": [-1, 0]}}},
    "contacts": {"stop": {"slave": "mass.node", "master": "wall"}},
    "loads": [{"on": "mass.node", "force": [15, 0]}],
    "time": {"end": 1, "steps": 1},
    "responses": {"u": {"displacement": {"on": "mass.node", "component": "x"}},
                  "press": {"contact_force": {"contact": "stop", "component": "normal"}}},
    "parameters": {"F": "/loads/0/force/0"},
}
ANSWERS = """\
// answer press uzawa_al monolithic_al: 5 within 1e-9
// answer press penalty: 5 within 2e-3
// answer press/F: 1 within 2e-3
// from: closed form
"""


class Folder(unittest.TestCase):
    """A folder of cases, and what is written beside it."""

    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        self.cases = self.folder / "cases"
        self.cases.mkdir()
        self.out = self.folder / "out"

    def write(self, name, header=HEADER, scene=STOP):
        path = self.cases / f"{name}.json"
        path.write_text(header + (scene if isinstance(scene, str) else json.dumps(scene)))
        return path

    def suite(self, program, *more):
        """(exit code, output, errors) of the suite."""
        output, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            code = hard.main([program, "-o", str(self.out), "--cases", str(self.cases), *more])
        return code, output.getvalue(), errors.getvalue()

    def rows(self):
        rows = json.loads((self.out / "results.json").read_text())["rows"]
        return {(row["case"], row["method"]): row for row in rows}

    def fake(self, body):
        """A program in Python that does as `body` says, `out` the folder of a run."""
        path = self.folder / "fake"
        path.write_text(f"#!{sys.executable}\n" + textwrap.dedent("""\
            import json, os, pathlib, sys, time
            if sys.argv[1] == "--help":
                sys.exit(print("  run    simulate"))
            if sys.argv[1] == "--version":
                sys.exit(print("fake 1"))
            out = pathlib.Path(sys.argv[sys.argv.index("-o") + 1])
            def result(status="converged", responses={"u": 0.01, "press": 5.0}, **more):
                out.mkdir(parents=True)
                steps = [{"time": 1.0, "newton": 2, "responses": responses,
                          "sensitivities": {"press": {"F": 1.0}}, **more}]
                (out / "result.json").write_text(json.dumps({"status": status, "message": "", "warnings": [],
                                                             "steps": steps, "cost": {}}))
            """) + textwrap.dedent(body))
        path.chmod(0o755)
        return str(path)


class Parser(Folder):
    def faults(self, header, scene=STOP):
        with self.assertRaises(case_file.CaseError) as caught:
            case_file.read_case(self.write("a", header, scene))
        return str(caught.exception).replace(str(self.cases) + os.sep, "").splitlines()

    def test_reads_all_that_a_case_may_say(self):
        header = HEADER.replace("uzawa_al: converged", 'uzawa_al: cap | cycle "a wall"')
        case = case_file.read_case(self.write("a", header + ANSWERS + textwrap.dedent("""\
            // case: C8
            // Note: this one
            //   goes on.
            // warns: non_unique | soft_penalty
            // answer one_sided u/F at 0.5 penalty: none, -1e-3 within 1e-6 of 2
            // answer u+press: at least -1
            // count newton: at most 3
            // solution open: u = 0, press = 0 within 1e-8
            // like a: press = 2e3 * u within 1e-6
            // like a: iterations
            // agree u press: within 1e-3 unless non_unique
            """)))
        self.assertEqual(case.expect["uzawa_al"], case_file.Expectation(("cap", "cycle"), "a wall"))
        self.assertEqual(case.notes, ["this one goes on."])
        self.assertEqual(case.warns["penalty"], [("non_unique", "soft_penalty")])
        sided = case.answers[3]
        self.assertEqual((sided.values, sided.time, sided.methods, sided.scale, sided.one_sided),
                         ((None, -1e-3), 0.5, ("penalty",), 2.0, True))
        self.assertEqual((case.answers[4].kind, case.answers[4].values), ("at least", (-1.0,)))
        self.assertEqual((case.counts[0].name, case.counts[0].values), ("newton", (3.0,)))
        self.assertEqual(case.solutions[0].values, {"u": 0.0, "press": 0.0})
        self.assertEqual((case.relations[0].factor, case.relations[0].other), (2000.0, "u"))
        self.assertEqual([(one.name, one.unless) for one in case.agreements],
                         [("u", ("non_unique",)), ("press", ("non_unique",))])

    def test_names_every_fault_with_its_line(self):
        header = "// Hard: x\n// expekt penalty: converged\n// expect uzawa: converged\n// just text\n"
        self.assertEqual(self.faults(header), [
            "a.json:2: expekt penalty: unknown key; allowed: Hard, Must, Note, group, case, from, expect, warns, "
            "answer, count, solution, agree, like; go on with a line by three blanks or more",
            'a.json:3: expect uzawa: unknown method "uzawa"; allowed: penalty, uzawa_al, monolithic_al',
            'a.json:4: expected "// KEY: VALUE" or an indented line that goes on, not "just text"',
            'a.json:1: has no "// Must: ..."', 'a.json:1: has no "// group: ..."',
            'a.json:1: has no "// expect penalty: ..."', 'a.json:1: has no "// expect uzawa_al: ..."',
            'a.json:1: has no "// expect monolithic_al: ..."'])

    def test_refuses_what_it_does_not_understand(self):
        for line, told in (
                ("// answer press: 5", 'expected "within TOLERANCE" or "within TOLERANCE of SCALE"'),
                ("// answer press: five within 1", '"five" is no number'),
                ("// answer one_sided u/F: 1 within 1", "expected one value, or two of one_sided"),
                ("// answer force: 1 within 1", 'the scene has no response "force"'),
                ("// answer u/E: 1 within 1", 'the scene has no parameter "E"'),
                ("// solution open: u 0 within 1", 'expected "RESPONSE = VALUE, ... within TOLERANCE"'),
                ("// count patience: at most 1", "expected one of: newton"),
                ("// like b: u is u", 'expected "RESPONSE = FACTOR * RESPONSE within TOLERANCE" or "iterations"'),
                ("// expect penalty: converged", "penalty is given twice"),
                ("// warns: Non-unique", "expected codes of warnings")):
            with self.subTest(line):
                self.assertIn(told, "\n".join(self.faults(HEADER + "// from: here\n" + line + "\n")))
        self.assertIn("has answers, and no", self.faults(HEADER + "// answer u: 1 within 1\n")[0])
        header = HEADER.replace("penalty: converged", "penalty: solved")
        self.assertIn('unknown status "solved"', self.faults(header)[0])

    def test_reads_every_case_of_the_suite(self):
        cases = case_file.read_cases(SUITE)
        self.assertGreater(len(cases), 100)
        for case in cases:
            self.assertEqual(sorted(case.expect), sorted(case_file.METHODS), case.name)
            for match in re.findall(r'"gmsh": "([^"]+)"', case.path.read_text()):
                self.assertTrue((SUITE / match).is_file(), f"{case.name}: {match}")


class Judgement(unittest.TestCase):
    def row(self, **more):
        return {"case": "a", "method": "penalty", "status": "converged", "message": "", "warnings": [], "faults": [],
                "certificate": "", "newton": [1, 3], "cutbacks": 0, **more,
                "path": [{"time": 0.5, "responses": {"u": 1.0}},
                         {"time": 1.0, "responses": {"u": 2.0, "v": 3.0}, "one_sided": {"u": {"F": [0, None]}}}]}

    def case(self, lines, header=HEADER):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "a.json"
            path.write_text(header + "// from: here\n" + lines + "{")
            return case_file.read_case(path)

    def green(self, lines, **more):
        row = self.row(**more)
        judge.judge(self.case(lines), row)
        return row["green"]

    def test_holds_values_against_answers(self):
        for lines, right in (
                ("// answer u: 2 within 1e-9\n", True), ("// answer u: 2.1 within 1e-2\n", False),
                ("// answer u at 0.5: 1 within 1e-9\n", True), ("// answer u at 0.7: 1 within 1e-9\n", False),
                ("// answer u: 2.1 within 1e-2 of 100\n", True), ("// answer u-v: -1 within 1e-9\n", True),
                ("// answer u: at most 1.9\n", False), ("// answer v uzawa_al: 0 within 0\n", True),
                ("// answer one_sided u/F: 0, none within 1e-9\n", True),
                ("// answer one_sided u/F: 0, 1 within 1e-9\n", False),
                ("// count newton: at most 3\n", True), ("// count newton: at most 2\n", False),
                ("// solution a: u = 0, v = 0 within 1e-6\n// solution b: u = 2, v = 3 within 1e-6\n", True),
                ("// solution a: u = 0, v = 3 within 1e-6\n", False), ("// warns: non_unique\n", False)):
            with self.subTest(lines):
                self.assertEqual(self.green(lines), right)
        self.assertTrue(self.green("// warns: non_unique\n", warnings=[{"code": "non_unique", "text": ""}]))
        self.assertFalse(self.green("", certificate="fails"))
        self.assertTrue(self.green("", status="converged_at_roundoff"))
        self.assertFalse(self.green("", status="cycle"))

    def test_holds_a_run_that_must_fail_to_its_answers_before(self):
        header = HEADER.replace("penalty: converged", "penalty: cycle")
        for answer, right in (("u at 0.5: 1", True), ("u at 0.5: 2", False), ("u: 7", True)):
            row = self.row(status="cycle")
            judge.judge(self.case(f"// answer {answer} within 1e-9\n", header), row)
            self.assertEqual(row["green"], right, answer)

    def test_holds_methods_against_one_another(self):
        case = self.case("// agree u: within 1e-3 unless non_unique\n")
        rows = [{**self.row(), "method": method} for method in case_file.METHODS]
        rows[1]["path"][-1]["responses"]["u"] = 2.1
        for row in rows:
            judge.judge(case, row)
        judge.judge_relations([case], rows)
        self.assertEqual([row["green"] for row in rows], [True, False, True])

    def test_sees_numbers_that_are_none(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            data = base64.b64encode(struct.pack("<Qd", 8, float("nan"))).decode()
            (folder / "fields_0001.vtu").write_text("\n".join(
                f'<DataArray type="Float64" Name="{name}" NumberOfComponents="1" format="binary">{data}</DataArray>'
                for name in ("gap", "stress")))
            (folder / "a.csv").write_text("x,y\n1,nan\n")
            (folder / "b.csv").write_text("x,infinite\n1,2\n")
            self.assertEqual(run_case.not_a_number(folder), ["a.csv holds nan", "fields_0001.vtu: stress holds nan"])


class Suite(Folder):
    @unittest.skipUnless(PROGRAM, "STICKSLIP_PROGRAM names no program")
    def test_runs_cases_end_to_end(self):
        self.write("stop", HEADER + ANSWERS)
        fails = HEADER.replace(": converged", ": infeasible")
        held = {**STOP, "supports": [{"on": "mass.node", "move": {"x": 0.02, "y": 0}}]}
        del held["parameters"]
        self.write("held", fails, held)
        self.write("misspelt", HEADER.replace(": converged", ': refused "lods"'), {**STOP, "lods": []})
        code, output, _ = self.suite(PROGRAM)
        self.assertEqual(code, 0, output)
        self.assertIn("3 cases, 9 runs: 9 green, 0 red, 0 crashes, 0 hangs", output)
        row = self.rows()["stop", "monolithic_al"]
        self.assertLess(row["error"], 1e-9)
        self.assertAlmostEqual(row["responses"]["press"], 5, 9)
        self.check_page()
        self.write("stop", HEADER + ANSWERS.replace(": 5 within", ": 4 within"))
        code, output, _ = self.suite(PROGRAM, "--only", "st*", "--compare", str(self.out))
        self.assertEqual(code, 3)
        self.assertIn("press is 5, expected 4 within 1e-09", output)
        self.assertIn("red, was green", output)
        self.assertIn("since", (self.out / "index.html").read_text())

    def check_page(self):
        """That every element of the page is closed, in order, and nothing is fetched."""
        open_ones, void = [], {"meta", "img", "br"}

        class Reader(html.parser.HTMLParser):
            def handle_starttag(reader, tag, attributes):
                source = dict(attributes).get("src", "data:")
                self.assertTrue(source.startswith("data:"), source)
                if tag not in void:
                    open_ones.append(tag)

            def handle_endtag(reader, tag):
                if tag not in void:
                    self.assertEqual(open_ones.pop(), tag)

        page = (self.out / "index.html").read_text()
        Reader(convert_charrefs=True).feed(page)
        self.assertEqual(open_ones, [])
        self.assertFalse("url(" in page.split("</style>")[0])
        for text in ("a wall is in the way", "stop at it", "<details", "closed form"):
            self.assertTrue(text in page, text)

    def test_crash_and_hang_are_rows(self):
        self.write("a")
        code, output, _ = self.suite(self.fake("os.abort() if 'penalty' in sys.argv else sys.exit(1)"))
        self.assertEqual(code, 3)
        self.assertIn("1 cases, 3 runs: 0 green, 3 red, 3 crashes, 0 hangs", output)
        self.assertIn("exit code -6", self.rows()["a", "penalty"]["message"])
        code, output, _ = self.suite(self.fake("time.sleep(60)"), "--timeout", "0.3", "--jobs", "3")
        self.assertIn("0 green, 3 red, 0 crashes, 3 hangs", output)
        self.assertEqual(self.rows()["a", "penalty"]["status"], "hang")

    def test_result_that_is_not_whole_is_a_crash(self):
        self.write("a")
        _, output, _ = self.suite(self.fake("out.mkdir(parents=True); (out / 'result.json').write_text('{')"))
        self.assertIn("3 crashes", output)
        _, output, _ = self.suite(self.fake("result(); sys.exit(3)"))
        self.assertIn("exit code 3 does not go with status converged", output)

    def test_number_that_is_none_is_red(self):
        self.write("a")
        _, output, _ = self.suite(self.fake("result(responses={'u': float('nan'), 'press': 5.0})"))
        self.assertIn("result.json holds NaN", output)
        json.loads((self.out / "results.json").read_text(), parse_constant=self.fail)

    def test_certificate_of_verify(self):
        self.write("a", HEADER + ANSWERS)
        program = self.fake("""\
            if sys.argv[1] == "verify":
                sys.exit(print("slip against its traction") or 3)
            result()""")
        text = pathlib.Path(program).read_text().replace("  run    simulate", "  run    simulate\\n  verify    check")
        text = text.replace('out = pathlib.Path(sys.argv[sys.argv.index("-o") + 1])',
                            'out = pathlib.Path(sys.argv[sys.argv.index("-o") + 1] if "-o" in sys.argv else ".")')
        pathlib.Path(program).write_text(text)
        _, output, _ = self.suite(program)
        self.assertIn("its certificate does not hold", output)
        self.assertEqual(self.rows()["a", "penalty"]["certificate"], "fails")
        self.assertIn("slip against its traction", (self.out / "index.html").read_text())

    def test_compare_marks_what_changed(self):
        self.write("a", HEADER + ANSWERS)
        code, _, _ = self.suite(self.fake("result()"))
        self.assertEqual(code, 0)
        first, self.out = self.out, self.folder / "second"
        _, output, _ = self.suite(self.fake("result(newton=4)"), "--compare", str(first))
        self.assertIn("3 runs changed", output)
        self.assertIn("monolithic_al: 4 iterations, was 2", output)
        self.out = self.folder / "third"
        _, output, _ = self.suite(self.fake("result()"), "--compare", str(first))
        self.assertIn("0 runs changed", output)

    def test_bad_input_is_refused(self):
        program = self.fake("result()")
        self.assertEqual(self.suite(program)[0], 2)  # no cases
        self.write("a")
        self.assertIn("no case has such a name", self.suite(program, "--only", "b*")[2])
        self.assertEqual(self.suite(program, "--jobs", "0")[0], 2)
        self.assertIn("there is no program", self.suite(str(self.folder / "nothing"))[2])
        self.assertIn("no results.json of this suite", self.suite(program, "--compare", str(self.folder))[2])
        self.out.mkdir()
        (self.out / "thesis.tex").write_text("mine")
        code, _, errors = self.suite(program)
        self.assertEqual(code, 2)
        self.assertIn("is not empty", errors)
        self.assertEqual(os.listdir(self.out), ["thesis.tex"])


if __name__ == "__main__":
    unittest.main()
