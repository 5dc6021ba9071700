#!/usr/bin/env python3
"""The hard cases: every scene of this folder by every method, held against what a correct program must do.

    python3 studies/hard/hard.py [PROGRAM] [-o results/hard] [--only GLOB]... [--jobs 2] [--timeout 60] [--compare OLD]

PROGRAM is the stickslip to test, by default the one on the PATH. Exit code: 0 all as expected, 3 not, 2 bad input.
docs/hard.md says how to read what it writes and how to add a case.
"""

import fnmatch
import json
import math
import shutil
import sys
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from time import monotonic

HERE = Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
from case_file import METHODS, CaseError, read_cases  # noqa: E402
from comparison import compare, read_earlier  # noqa: E402
from judge import judge, judge_relations  # noqa: E402
from page import write_page  # noqa: E402
from run_case import execute, has_command, run_case  # noqa: E402
from suite import InputError, find_program, parser_of  # noqa: E402

SUITE = "stickslip hard cases"


def arguments(argv):
    parser = parser_of("hard", __doc__)
    parser.add_argument("--only", action="append", metavar="GLOB", help="cases by name, several times")
    parser.add_argument("--timeout", type=float, default=60, metavar="SECONDS", help="of a run, by default 60")
    parser.add_argument("--compare", metavar="OLD", help="folder of an earlier suite: marks what changed since")
    parser.add_argument("--cases", default=str(HERE), metavar="DIR", help="folder of the cases, by default this one")
    chosen = parser.parse_args(argv)
    if chosen.jobs < 1 or not chosen.timeout > 0:
        raise InputError("--jobs must be at least 1 and --timeout more than 0")
    return chosen


def choose(cases, globs):
    if not globs:
        return cases
    for glob in globs:
        if not fnmatch.filter([case.name for case in cases], glob):
            raise InputError(f'--only {glob}: no case has such a name')
    return [case for case in cases if any(fnmatch.fnmatchcase(case.name, glob) for glob in globs)]


def prepare(folder):
    """Makes the folder; clears the runs that an earlier suite left in it, and refuses what is not its own."""
    record = folder / "results.json"
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file")
    if folder.is_dir() and any(folder.iterdir()):
        earlier = read_earlier(folder)
        if earlier is None or earlier.get("suite") != SUITE:
            raise InputError(f"{folder} is not empty and has no results.json of this suite; name another folder")
        for row in earlier["rows"]:
            run = folder / "runs" / f"{row['case']}.{row['method']}"
            if run.is_dir() and not run.is_symlink():
                shutil.rmtree(run)
    folder.mkdir(parents=True, exist_ok=True)
    record.write_text(json.dumps({"suite": SUITE, "rows": []}), encoding="utf-8")


def run_all(program, cases, folder, chosen):
    """The judged rows of all cases by all methods; progress on standard error."""
    verify = has_command(program, "verify")
    tasks = [(case, method) for case in cases for method in METHODS]
    start, done, rows = monotonic(), 0, {}
    with ThreadPoolExecutor(chosen.jobs) as pool:
        waiting = {pool.submit(run_case, program, case, method, folder / "runs" / f"{case.name}.{method}",
                               chosen.timeout, verify): (case, method) for case, method in tasks}
        for future in as_completed(waiting):
            case, method = waiting[future]
            row = future.result()
            judge(case, row)
            rows[case.name, method] = row
            done += 1
            show_progress(done, len(tasks), monotonic() - start, row)
    ordered = [rows[case.name, method] for case, method in tasks]
    judge_relations(cases, ordered)
    return ordered, verify


def show_progress(done, all_of_them, seconds, row):
    if sys.stderr.isatty():
        left = seconds / done * (all_of_them - done)
        text = f"{done}/{all_of_them}  {seconds:.0f} s, about {left:.0f} s left  {row['case']} {row['method']}"
        print(f"\r{text:100.100}", end="\n" if done == all_of_them else "", file=sys.stderr, flush=True)
    elif done == all_of_them or done * 10 // all_of_them > (done - 1) * 10 // all_of_them:
        print(f"{done}/{all_of_them} runs, {seconds:.0f} s", file=sys.stderr, flush=True)


def head(rows, seconds):
    """What the first line says."""
    def count(status):
        return sum(row["status"] == status for row in rows)
    green = sum(row["green"] for row in rows)
    return {"runs": len(rows), "cases": len({row["case"] for row in rows}), "green": green, "red": len(rows) - green,
            "crashes": count("crash"), "hangs": count("hang"), "seconds": seconds}


def head_line(summary):
    return (f"{summary['cases']} cases, {summary['runs']} runs: {summary['green']} green, {summary['red']} red, "
            f"{summary['crashes']} crashes, {summary['hangs']} hangs, {summary['seconds']:.0f} s")


def print_table(cases, rows, changes):
    """A line of each case, and below it the reasons of what is red."""
    colours = ("\033[32m", "\033[31m", "\033[0m") if sys.stdout.isatty() else ("", "", "")
    width = max(len(case.name) for case in cases)
    print(f"{'':{width}}  " + "  ".join(f"{method:26}" for method in METHODS))
    group = None
    for case in sorted(cases, key=lambda case: (case.group, case.name)):
        if case.group != group:
            group = case.group
            print(f"-- {group}")
        own = [row for row in rows if row["case"] == case.name]
        cells = []
        for row in own:
            error = "" if row["error"] is None else f"{row['error']:.0e}"
            text = f"{'ok ' if row['green'] else 'RED'} {row['status']:.13} {error:6} {sum(row.get('newton', [])):4}"
            cells.append(colours[not row["green"]] + f"{text:26}" + colours[2])
        print(f"{case.name:{width}}  " + "  ".join(cells).rstrip())
        for row in own:
            for fault in row["faults"]:
                print(f"{'':{width}}    {row['method']}: {fault}")
            change = changes.get(f"{row['case']}.{row['method']}")
            if change:
                print(f"{'':{width}}    {row['method']}: {change}")


def record(folder, cases, rows, summary, program_version, verify, changes):
    kept = [{key: value for key, value in row.items() if key != "path"} | {"responses": last_responses(row)}
            for row in rows]
    document = {"suite": SUITE, "program": program_version, "verify": verify, "summary": summary,
                "groups": {case.name: case.group for case in cases}, "changes": changes, "rows": kept}
    (folder / "results.json").write_text(json.dumps(finite(document), indent=1, allow_nan=False), encoding="utf-8")


def finite(value):
    """The same with null for numbers that JSON has not."""
    if isinstance(value, dict):
        return {key: finite(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def last_responses(row):
    return (row["path"][-1].get("responses") or {}) if row["path"] else {}


def version_of(program):
    try:
        code, output, _, _ = execute([program, "--version"], 30)
    except OSError:
        return ""
    return output.splitlines()[0] if code == 0 and output else ""


def run_suite(argv):
    chosen = arguments(argv)
    program = find_program(chosen.program)
    cases = choose(read_cases(chosen.cases), chosen.only)
    if not cases:
        raise InputError(f"{chosen.cases} has no cases")
    earlier = None
    if chosen.compare:
        earlier = read_earlier(Path(chosen.compare))
        if earlier is None or earlier.get("suite") != SUITE:
            raise InputError(f"{chosen.compare} has no results.json of this suite")
    folder = Path(chosen.output)
    prepare(folder)
    start = monotonic()
    rows, verify = run_all(program, cases, folder, chosen)
    summary = head(rows, monotonic() - start)
    changes = compare(earlier, rows) if earlier else {}
    version = version_of(program)
    record(folder, cases, rows, summary, version, verify, changes)
    write_page(folder, cases, rows, head_line(summary), version, verify, changes, bool(earlier))
    print_table(cases, rows, changes)
    print(head_line(summary))
    if earlier:
        print(f"since {chosen.compare}: {len(changes)} runs changed")
    print(f"page: {folder / 'index.html'}")
    return 0 if summary["red"] == 0 else 3


def main(argv=None):
    try:
        return run_suite(sys.argv[1:] if argv is None else argv)
    except (InputError, CaseError) as error:
        print(error, file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
