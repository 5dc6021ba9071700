#!/usr/bin/env python3
"""Compiler time of a build from nothing, in CPU seconds: of the program, of its tests, and of the ten dearest files.

    tools/compile_times.py [BUILD_DIR] [--target TARGET ...] [--each]
                                                       (default: build/compile_times, stickslip and all tests)

Builds with the ci preset's settings into a new directory and prints the tables of docs/development.md. Sources are joined
as the preset joins them, so the dearest are groups; --each compiles each by itself, so that they are files. CPU seconds
of the compiler itself are counted; a compiler cache is not used.
"""
import argparse
import os
import pathlib
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def launch(log, command):
    """Runs a compiler and appends what it took, and of what; returns its exit code."""
    child = subprocess.Popen(command)
    _, status, usage = os.wait4(child.pid, 0)
    output = command[command.index("-o") + 1] if "-o" in command else command[-1]
    with open(log, "a", encoding="utf-8") as lines:  # (one write a line: compilers run side by side)
        lines.write(f"{usage.ru_utime + usage.ru_stime:.2f} {output}\n")
    return os.waitstatus_to_exitcode(status)


def source_of(output):
    """The source of an object, as the project names it: CMakeFiles/stickslip.dir/studies/app/main.cpp.o."""
    parts = pathlib.PurePath(output).parts
    folder = next((i for i, part in enumerate(parts) if part.endswith(".dir")), -1)
    above = parts[: parts.index("CMakeFiles")] if "CMakeFiles" in parts else ()
    joined = (parts[folder][: -len(".dir")],) if "Unity" in parts else ()
    name = "/".join(above + joined + parts[folder + 1 :])
    return name[:-2] if name.endswith(".o") else name


def group_of(source):
    if source.endswith(".gch"):
        return "precompiled headers"
    return "tests" if source.startswith("tests/") else "benchmarks" if source.startswith("bench/") else "program"


def report(times):
    groups = {}
    for source, seconds in times.items():
        total, count = groups.get(group_of(source), (0.0, 0))
        groups[group_of(source)] = (total + seconds, count + 1)
    print("| part | files | compiler time |\n|---|---|---|")
    for group, (seconds, count) in sorted(groups.items()):
        print(f"| {group} | {count} | {seconds:.0f} s |")
    print("\n| dearest file | compiler time |\n|---|---|")
    for source, seconds in sorted(times.items(), key=lambda item: -item[1])[:10]:
        print(f"| {source} | {seconds:.1f} s |")


def main():
    if len(sys.argv) > 3 and sys.argv[1] == "--launch":
        return launch(sys.argv[2], sys.argv[3:])
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("build", nargs="?", default=str(ROOT / "build" / "compile_times"))
    parser.add_argument("--target", action="append", help="build this alone; may be repeated")
    parser.add_argument("--each", action="store_true", help="compile each source by itself")
    arguments = parser.parse_args()
    build = pathlib.Path(arguments.build).resolve()
    if build.exists():
        parser.error(f"{build} exists; give a directory that does not")
    log = build / "compile_times.log"
    build.mkdir(parents=True)
    launcher = ";".join([sys.executable, str(pathlib.Path(__file__).resolve()), "--launch", str(log)])
    environment = dict(os.environ, CCACHE_DISABLE="1")
    configure = ["cmake", "-S", str(ROOT), "-B", str(build), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                 "-DSTICKSLIP_BUILD_BENCH=OFF", f"-DCMAKE_UNITY_BUILD={'OFF' if arguments.each else 'ON'}",
                 f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}"]
    make = ["cmake", "--build", str(build), "--parallel", str(os.cpu_count() or 1)]
    if arguments.target:
        make += ["--target", *arguments.target]
    for command in (configure, make):
        if subprocess.run(command, env=environment, stdout=sys.stderr, check=False).returncode != 0:
            print(f"{shlex.join(command)} failed", file=sys.stderr)
            return 1
    times = {}
    for line in log.read_text(encoding="utf-8").splitlines():
        seconds, output = line.split(" ", 1)
        times[source_of(output)] = times.get(source_of(output), 0.0) + float(seconds)
    report(times)
    return 0


if __name__ == "__main__":
    sys.exit(main())
