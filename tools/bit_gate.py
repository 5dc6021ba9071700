#!/usr/bin/env python3
"""Whether two builds say the same, to the last bit: the gate of a change that is to change nothing.

    tools/bit_gate.py OLD NEW [--only REGEX] [--keep DIR]     OLD, NEW: two stickslip programs
    tools/bit_gate.py --self-test STICKSLIP

Every scene of studies/scenes is run by both, with each method, each engine, and derivatives that are direct, adjoint
(of the sum of the first response, where the scene has no objective) or not asked for. Compared are result.json (states
of the steps, responses, derivatives, counts and memory; all but times and what describes the machine), the fields, bit
by bit, and how often memory was allocated, of which the new program may not do more. Exit code 3, and a line for each
run that differs, naming the first entry that does.
"""

import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
METHODS = ("penalty", "uzawa_al", "monolithic_al")
ENGINES = ("condensed", "sparse")
MODES = ("none", "direct", "adjoint")
MACHINE = {"provenance", "seconds", "peak_memory_mb", "date"}
AGAIN = 3  # tries where allocations differ: a time that is printed with more digits may take one
COUNTER = r"""
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
extern void* __libc_malloc(size_t);
static long count;
void* malloc(size_t size) { __atomic_add_fetch(&count, 1, __ATOMIC_RELAXED); return __libc_malloc(size); }
__attribute__((destructor)) static void tell(void) {
  const char* name = getenv("ALLOCATIONS");
  FILE* file = name ? fopen(name, "w") : NULL;
  if (file) { fprintf(file, "%ld", count); fclose(file); }
}
"""


def without_comments(text):
    """A scene's text as plain JSON: comments behind // outside of strings dropped."""
    return re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*', lambda m: m.group(1) or "", text)


def variants(scene):
    """(name, document) of each engine and mode."""
    for engine in ENGINES:
        for mode in MODES:
            document = json.loads(json.dumps(scene))
            document.setdefault("linear_solver", {})["engine"] = engine
            if mode == "none":
                document.pop("parameters", None)
            elif not document.get("parameters"):
                continue
            if mode == "adjoint":
                document.setdefault("objectives", {"first": {"of": next(iter(document["responses"])), "sum": True}})
                document["sensitivity"] = {"mode": "adjoint"}
            yield f"{engine} {mode}", document


class Gate:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        for part in ("scenes", "meshes"):
            shutil.copytree(ROOT / "studies" / part, self.folder / part, dirs_exist_ok=True)
        source, self.counter = self.folder / "counter.c", self.folder / "counter.so"
        source.write_text(COUNTER)
        made = subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-o", self.counter, source], check=False)
        if made.returncode:
            sys.exit("bit_gate: no C compiler to count allocations with")

    def run(self, program, side, name, method):
        """What a program makes of scenes/NAME: (result without times, {file: bytes}, allocations)."""
        output, counted = self.folder / side, self.folder / "allocations"
        shutil.rmtree(output, ignore_errors=True)
        counted.unlink(missing_ok=True)
        environment = dict(os.environ, LD_PRELOAD=str(self.counter), ALLOCATIONS=str(counted), OMP_NUM_THREADS="1",
                           OPENBLAS_NUM_THREADS="1")
        ended = subprocess.run([program, "run", self.folder / "scenes" / name, "-m", method, "-o", output],
                               capture_output=True, text=True, check=False, env=environment)
        files = {file.name: file.read_bytes() for file in sorted(output.glob("[!.]*"))} if output.is_dir() else {}
        result = json.loads(files.pop("result.json", b"null"))
        return {"exit": ended.returncode, "result": result}, files, int(counted.read_text())


def first_difference(old, new, at=""):
    """JSON pointer of the first entry that differs, with both; "" where none does. Times and the machine are left out."""
    if type(old) is not type(new):
        return f"{at}: {json.dumps(old)[:60]} -> {json.dumps(new)[:60]}"
    if isinstance(old, dict):
        for key in list(old) + [k for k in new if k not in old]:
            if key in MACHINE:
                continue
            if key not in old or key not in new:
                return f"{at}/{key}: {'gone' if key in old else 'new'}"
            found = first_difference(old[key], new[key], f"{at}/{key}")
            if found:
                return found
        return ""
    if isinstance(old, list):
        if len(old) != len(new):
            return f"{at}: {len(old)} entries -> {len(new)}"
        for i, (a, b) in enumerate(zip(old, new)):
            found = first_difference(a, b, f"{at}/{i}")
            if found:
                return found
        return ""
    return "" if old == new else f"{at}: {old!r} -> {new!r}"


def compare(old, new):
    """What differs between two runs, in a line; "" where nothing does."""
    found = first_difference(old[0], new[0])
    if found:
        return found
    for name in sorted(set(old[1]) | set(new[1])):
        if old[1].get(name) != new[1].get(name):
            return f"the file {name}"
    return f"{old[2]} allocations -> {new[2]}" if new[2] > old[2] else ""


def gate(folder, old, new, only=""):
    """Runs all; (number of runs, lines of those that differ)."""
    runs, lines = 0, []
    pair = Gate(folder)
    for file in sorted((ROOT / "studies" / "scenes").glob("*.json")):
        if file.name.endswith(".study.json"):
            continue
        for variant, document in variants(json.loads(without_comments(file.read_text(encoding="utf-8")))):
            name = "now.json"
            (pair.folder / "scenes" / name).write_text(json.dumps(document))
            for method in METHODS:
                title = f"{file.stem} {method} {variant}"
                if not re.search(only, title):
                    continue
                runs += 1
                found = compare(pair.run(old, "old", name, method), pair.run(new, "new", name, method))
                for _ in range(AGAIN if "allocations" in found else 0):
                    found = found and compare(pair.run(old, "old", name, method), pair.run(new, "new", name, method))
                if found:
                    lines.append(f"{title}: {found}")
                    print(lines[-1], flush=True)
    return runs, lines


def self_test(program):
    """A program equals itself; a changed bit, a missing entry, another file and one allocation more are seen."""
    with tempfile.TemporaryDirectory() as folder:
        runs, lines = gate(folder, program, program, "^(stop|slider) ")
        assert runs > 20 and not lines, lines
    run = ({"exit": 0, "result": {"steps": [{"u": 0.1, "seconds": 1}]}}, {"a.vtu": b"1"}, 10)
    assert compare(run, ({"exit": 0, "result": {"steps": [{"u": 0.1, "seconds": 2}]}}, {"a.vtu": b"1"}, 9)) == ""
    assert "/result/steps/0/u" in compare(run, ({"exit": 0, "result": {"steps": [{"u": 0.1 + 2e-17}]}}, run[1], 10))
    assert "/exit" in compare(run, ({"exit": 3, "result": run[0]["result"]}, run[1], 10))
    assert "a.vtu" in compare(run, (run[0], {"a.vtu": b"2"}, 10))
    assert "allocations" in compare(run, (run[0], run[1], 11))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+", metavar="STICKSLIP")
    parser.add_argument("--only", default="", help="runs whose \"SCENE METHOD ENGINE MODE\" matches")
    parser.add_argument("--keep", help="the folder that the last run's files stay in")
    parser.add_argument("--self-test", action="store_true")
    options = parser.parse_args()
    if options.self_test:
        self_test(options.programs[0])
        return 0
    if len(options.programs) != 2:
        parser.error("two programs are compared")
    old, new = options.programs
    if options.keep:
        runs, lines = gate(options.keep, old, new, options.only)
    else:
        with tempfile.TemporaryDirectory() as folder:
            runs, lines = gate(folder, old, new, options.only)
    print(f"{runs - len(lines)} of {runs} runs are the same")
    return 3 if lines or not runs else 0


if __name__ == "__main__":
    sys.exit(main())
