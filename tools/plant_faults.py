#!/usr/bin/env python3
"""Plants named faults one at a time and says which test catches each: do the tests notice?

    tools/plant_faults.py [--only REGEX] [--tests FOLDER...] [--scratch DIR] [--compilers N]
    tools/plant_faults.py --check        the texts of all faults are still there, nothing is built

One build serves all: the sources are copied to build/faults/source, and at each place the original and the faulty text
stand beside each other; the environment variable STICKSLIP_FAULT=n chooses the n-th fault. Then the tests run for each
fault, the quickest first, up to the first that fails, crashes or exceeds ten times its time. Exit code 3: less than
95 % were caught. Heavy (some 40 minutes of CPU to build, seconds to minutes a fault), so not part of the tests.
"""

import argparse
import json
import os
import re
import resource
import subprocess
import sys
import time

from planted_faults import FAULTS

HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
FOLDERS = ("core", "sensitivity", "methods", "studies")
HEADER = "planted_fault.hpp"
SELECTOR = """#pragma once
#include <cstdlib>

/// The fault that is planted, from 1; 0: none.
inline const int planted_fault_number = [] {
  const char* text = std::getenv("STICKSLIP_FAULT");
  return text ? std::atoi(text) : 0;
}();
inline bool planted_fault(int n) { return planted_fault_number == n; }
"""
BUCKETS = (0.02, 0.2, 2, float("inf"))  # seconds of a test: the quick ones of all programs run first


def replacement(number, original, faulty):
    if not original.endswith(";"):
        return f"(planted_fault({number}) ? ({faulty}) : ({original}))"
    return f"if (planted_fault({number})) {{ {faulty} }} else {{ {original} }}"


def planted_sources():
    """{file: text with all its faults}; raises where a text does not stand there exactly once."""
    texts, missing = {}, []
    for number, (name, file, marked, faulty) in enumerate(FAULTS, 1):
        before, rest = marked.split("<<<")
        original, after = rest.split(">>>")
        if file not in texts:
            with open(os.path.join(HERE, file), encoding="utf-8") as f:
                texts[file] = f.read()
        with open(os.path.join(HERE, file), encoding="utf-8") as f:
            count = f.read().count(before + original + after)
        if count != 1:
            missing.append(f"{name}: the text stands {count} times in {file}: {before + original + after}")
            continue
        texts[file] = texts[file].replace(before + original + after,
                                          before + replacement(number, original, faulty) + after)
    if missing:
        sys.exit("\n".join(missing))
    for file, text in texts.items():
        texts[file] = f'#include "{HEADER}"\n' + text
    return texts


def write(path, text):
    """Only where it changes, so that a second build is short."""
    if os.path.exists(path):
        with open(path, "rb") as f:
            if f.read() == text:
                return
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as f:
        f.write(text)


def build(scratch, programs, compilers):
    source = os.path.join(scratch, "source")
    planted = planted_sources()
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=HERE, capture_output=True, text=True,
                            check=True).stdout.split("\n")
    for file in filter(None, listed):
        if not os.path.isfile(os.path.join(HERE, file)):
            continue
        with open(os.path.join(HERE, file), "rb") as f:
            text = f.read()
        write(os.path.join(source, file), planted[file].encode() if file in planted else text)
    write(os.path.join(source, HEADER), SELECTOR.encode())
    # (a build of its own kind: some planted expressions are constant, which is no error here)
    subprocess.run(["cmake", "--preset", "release", "-DSTICKSLIP_BUILD_BENCH=OFF"], cwd=source, check=True,
                   stdout=subprocess.DEVNULL)
    folder = os.path.join(source, "build", "release")
    subprocess.run(["ninja", "-k0", "-C", folder, f"-j{compilers}", *programs], check=True)
    return folder


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def start(folder, program, fault, *arguments, **options):
    """A test program with a fault, in the folder that ctest runs it in."""
    work = os.path.join(folder, "tests", program.split("_")[1])
    os.makedirs(work, exist_ok=True)
    environment = dict(os.environ, STICKSLIP_FAULT=str(fault), RC_PARAMS="seed=20240229 max_success=200")
    return subprocess.run([os.path.join(folder, program), *arguments], cwd=work, env=environment, capture_output=True,
                          text=True, errors="replace", check=False, preexec_fn=limit_memory, **options)


def run(folder, program, tests, fault, limit):
    """What the tests said: "" where they all passed; else the first that failed, crashed or did not end."""
    try:
        result = start(folder, program, fault, "--gtest_filter=" + ":".join(tests), "--gtest_fail_fast", timeout=limit)
        output, code = result.stdout, result.returncode
    except subprocess.TimeoutExpired as expired:
        output, code = (expired.stdout or b"").decode(errors="replace"), None
    if code == 0:
        return ""
    failed = re.findall(r"^\[  FAILED  \] ([\w/]+\.[\w/]+)", output, re.M)
    if failed:
        return failed[0]
    begun = re.findall(r"^\[ RUN      \] (\S+)", output, re.M)
    return f"{begun[-1] if begun else program} ({'time limit' if code is None else 'crash'})"


def baseline(folder, programs):
    """{program: {test: seconds}} without a fault; tests that fail so are named and left out."""
    times = {}
    for program in programs:
        file = os.path.join(folder, program + ".json")
        start(folder, program, 0, "--gtest_filter=-Slow*:*/Slow*", "--gtest_output=json:" + file)
        with open(file, encoding="utf-8") as f:
            suites = json.load(f)["testsuites"]
        times[program] = {}
        for suite in suites:
            for test in suite["testsuite"]:
                name = f"{suite['name']}.{test['name']}"
                if "failures" in test:
                    print(f"fails without a fault, and is left out: {name}")
                elif test.get("result") == "COMPLETED":
                    times[program][name] = float(test["time"].rstrip("s"))
        print(f"{program}: {len(times[program])} tests, {sum(times[program].values()):.0f} s", flush=True)
    return times


def catch(folder, times, fault):
    """The test that catches the fault, or ""."""
    least = 0
    for most in BUCKETS:
        for program, tests in times.items():
            chosen = [test for test, seconds in tests.items() if least <= seconds < most]
            if chosen:
                caught = run(folder, program, chosen, fault, 20 + 10 * sum(tests[test] for test in chosen))
                if caught:
                    return caught
        least = most
    return ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="faults whose \"FILE NAME\" matches")
    parser.add_argument("--tests", nargs="+", default=FOLDERS, choices=FOLDERS, help="the tests that are to notice")
    parser.add_argument("--scratch", default=os.path.join(HERE, "build", "faults"))
    parser.add_argument("--compilers", type=int, default=1)
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    if options.check:
        planted_sources()
        print(f"{len(FAULTS)} faults, all of their texts are there")
        return 0
    programs = [f"stickslip_{folder}_tests" for folder in options.tests]
    folder = build(options.scratch, programs, options.compilers)
    times = baseline(folder, programs)
    chosen = [n for n, fault in enumerate(FAULTS, 1) if re.search(options.only, f"{fault[1]} {fault[0]}")]
    survivors = 0
    for n in chosen:
        start = time.monotonic()
        caught = catch(folder, times, n)
        survivors += not caught
        print(f"{n:3} {FAULTS[n - 1][1]:34} {FAULTS[n - 1][0]:52} {caught or 'SURVIVES':70} "
              f"{time.monotonic() - start:5.0f} s", flush=True)
    share = 1 - survivors / max(1, len(chosen))
    print(f"{len(chosen) - survivors} of {len(chosen)} faults caught, {100 * share:.0f} %")
    return 0 if share >= 0.95 else 3


if __name__ == "__main__":
    sys.exit(main())
