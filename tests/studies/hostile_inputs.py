#!/usr/bin/env python3
"""Gives the program what users, disks and strangers give it: pipes and devices for files, names with control
characters, damaged records, meshes beyond all memory, directories that vanish. Each is answered in words, exit code 2
or 3, and in a bounded time; what cannot be answered is a row of its study.

    hostile_inputs.py STICKSLIP SOURCE_DIR
"""
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree
from pathlib import Path

PROGRAM, SOURCE = sys.argv[1], Path(sys.argv[2])

SCENE = {
    "bodies": {"block": {"mesh": {"box": {"min": [0, 0], "max": [4, 2], "cells": [4, 2]}},
                         "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}}},
    "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
    "contacts": {"sole": {"slave": "block.bottom", "master": "floor", "friction": 0.3}},
    "loads": [{"on": "block.top", "traction": [1, -5], "history": [[0, 0], [1, 1]]}],
    "time": {"end": 1, "steps": 2},
    "responses": {"shift": {"displacement": {"on": "block.top", "component": "x"}}},
    "parameters": {"mu": "/contacts/sole/friction"},
    "method": {"monolithic_al": {}},
}
STUDY = {"scene": "scene.json", "methods": [{"penalty": {"stiffness": [10, 100, 1000]}}, {"monolithic_al": {}}],
         "vary": {"/contacts/sole/friction": [0.2, 0.3]}, "reference": [{"method": {"monolithic_al": {}}}]}


def run(*arguments, code=None, says="", timeout=60, **options):
    """Runs it; the code and a part of what it says on standard error are asked for, and that it is no bug in stickslip."""
    result = subprocess.run([PROGRAM, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=timeout,
                            **options)
    told = result.stderr.decode(errors="replace")
    wrong = code is not None and result.returncode != code or says not in told or "bug in stickslip" in told
    if wrong or result.returncode not in (0, 2, 3):
        sys.exit(f"{arguments}: exit code {result.returncode}, not {code}, or not {says!r}:\n{told[-2000:]}")
    result.told = told
    return result


def changed(document, pointer, value):
    document = json.loads(json.dumps(document))
    *outer, last = pointer.strip("/").split("/")
    part = document
    for key in outer:
        part = part[int(key)] if isinstance(part, list) else part[key]
    part[last] = value
    return document


def write(path, document):
    path.write_text(document if isinstance(document, str) else json.dumps(document))
    return path


def rows(directory):
    return [json.loads(line) for line in (directory / "results.jsonl").read_text().splitlines()]


def files_that_are_none(work):
    pipe, secret = work / "pipe", write(work / "secret", "root:x:0:0:secret\nmore\n")
    os.mkfifo(pipe)
    for path, reason in ((pipe, "is a pipe"), ("/dev/zero", "is a device"), (work, "is a directory")):
        for command in ("run", "explain", "study", "gradcheck"):
            run(command, str(path), code=2, says=reason)
        mesh = {"gmsh": str(path), "body": "a"}
        run("run", str(write(work / "mesh.json", changed(SCENE, "/bodies/block/mesh", mesh))), code=2, says=reason)
    quoted = write(work / "quoted", '"a secret"')
    for path in (secret, quoted, write(work / "numbers", "12345secret\n")):
        for command in ("run", "study"):
            told = run(command, str(path), code=2).told
            if "secret" in told.replace(str(path), "") or "12345" in told:
                sys.exit(f"the content of a foreign file is told: {told}")
    mesh = {"gmsh": str(secret), "body": "a"}
    told = run("run", str(write(work / "mesh.json", changed(SCENE, "/bodies/block/mesh", mesh))), code=2).told
    if "root" in told:
        sys.exit(f"the content of a foreign file is told: {told}")
    directory = work / "records"
    directory.mkdir()
    for name in ("results.jsonl", "study.json", "picture.json", "timings.jsonl"):
        os.mkfifo(directory / name)
        run("report", str(directory), code=None if name == "timings.jsonl" else 2)
        run("compare", str(directory), str(directory), code=2 if name == "results.jsonl" else 0)  # of the rows alone
        run("merge", str(directory), "-o", str(work / "never"), code=2)
        run("study", str(work / "timed.study.json"), "-o", str(directory), "--resume",
            code=None if name == "results.jsonl" else 2)
        os.unlink(directory / name)
        if name == "results.jsonl":
            shutil.copy(work / "whole" / "results.jsonl", directory)
    print("pipes, devices, directories and foreign files", flush=True)


def names(work):
    for pointer, name in (("/bodies", "b\x1b[2J"), ("/contacts", "c\n"), ("/responses", "r\x07"), ("/parameters", "p\x9b")):
        broken = changed(SCENE, pointer + "/" + name, {"x": 1})
        told = run("run", str(write(work / "names.json", broken)), code=2).told
        if any(ord(c) < 32 and c != "\n" or 127 <= ord(c) < 160 for c in told):
            sys.exit(f"control characters on the terminal: {told!r}")
    titled = changed(changed(SCENE, "/title", "a\x1b[2J\ttitle\x00"), "/parameters", {"=1+1": "/contacts/sole/friction"})
    write(work / "titled.json", titled)
    study = write(work / "titled.study.json", dict(STUDY, scene="titled.json", title="=b\x01\x1b"))
    run("study", str(study), "-o", str(work / "titled"), code=0)
    for file in (work / "titled").rglob("*.svg"):
        xml.etree.ElementTree.parse(file)
    for file in (work / "titled").rglob("*.vtu"):
        xml.etree.ElementTree.parse(file)
    for file in (work / "titled").rglob("*.csv"):
        for cell in re.split(r"[,\r\n]", file.read_text()):
            if re.match(r'"?[=+@\t]|"?-[^0-9.i]', cell):
                sys.exit(f"{file}: a formula: {cell}")
    page = (work / "titled" / "report.html").read_text()
    if re.search(r"[\x00-\x08\x0b-\x1f]", page):
        sys.exit("control characters in the page")
    if "\x1b" in run("explain", str(work / "titled.json"), code=0).stdout.decode():
        sys.exit("explain writes escape sequences")
    bare = os.fsencode(work) + b"/\xff\xfe.json"
    shutil.copy(work / "scene.json", bare)
    run("run", bare, "-o", os.fsencode(work) + b"/\xff", code=0)
    for command in ("explain", "run", "gradcheck"):
        run(command, bare, "--json", code=0)
    run("run", bare, "--set", b"/title=\xff", code=2, says="is not UTF-8")
    run("run", bare, "-m", b"\xff", code=2)
    run("study", bare[:-5] + b"no\xff.json", code=2, says="\\xff")
    shutil.copy(work / "a.study.json", os.fsencode(work) + b"/\xfe.study.json")
    run("study", os.fsencode(work) + b"/\xfe.study.json", "-o", os.fsencode(work) + b"/\xfe", code=0)
    command = json.loads((work / "titled" / "study.json").read_text())["command"]
    if not command.startswith("stickslip study "):
        sys.exit(command)
    print("control characters, formulas and bytes that are no text", flush=True)


def what_is_mistaken(work):
    scene, study = write(work / "one.json", SCENE), write(work / "one.study.json", dict(STUDY, scene="one.json"))
    run("runn", str(scene), code=2, says='there is no command "runn"; did you mean "run"?')
    run("run", str(study), code=2, says="is a study, not a scene; `stickslip study` runs it")
    run("study", str(scene), code=2, says="is a scene, not a study; `stickslip run` runs it")
    for command in (("report",), ("compare", str(work / "whole"))):
        run(*command, str(work / "nowhere"), code=2, says="nowhere: there is no such directory; must be")
        run(*command, str(scene), code=2, says="one.json: is a file; must be a directory")
    run("study", str(study), "--jobs", "two", code=2, says='--jobs: is "two"; must be a whole number from 1 to 1024')
    run("compare", str(work / "whole"), str(work / "whole"), "--relative", "a", code=2, says="must be a number >= 0")
    print("commands and files that are mistaken for others", flush=True)


def damaged_records(work):
    study, whole = str(work / "timed.study.json"), work / "whole"
    for name, text in (("timings.jsonl", '{"id": 3}\n{"id": "a", "round": 1, "seconds": {"total": "x"}}\n\xff\n'),
                       ("results.jsonl", (whole / "results.jsonl").read_text().replace("penalty", "penalti", 1)),
                       ("results.jsonl", "[1]\n" * 1000), ("study.json", "{"), ("picture.json", "[1"),
                       ("picture.json", '{"points": [[0, 0], [1, 0], 7], "elements": [[0, 1], 3], "contact": 5}')):
        damaged = work / "damaged"
        shutil.copytree(whole, damaged)
        write(damaged / name, text)
        for command in (("report", str(damaged)), ("compare", str(whole), str(damaged)),
                        ("merge", str(damaged), "-o", str(work / "damaged merged")),
                        ("study", study, "-o", str(damaged), "--resume")):
            run(*command)
        if name == "results.jsonl" and len(rows(damaged)) != len(rows(whole)):
            sys.exit("damaged rows were not run anew")
        shutil.rmtree(damaged)
        shutil.rmtree(work / "damaged merged", ignore_errors=True)
    damaged = work / "damaged"
    shutil.copytree(whole, damaged)
    (damaged / "picture.json").unlink()
    (damaged / "picture.json").mkdir()
    run("report", str(damaged), code=2, says="s a directory")
    shutil.rmtree(damaged)
    shutil.copytree(whole, damaged)
    tiny = rows(damaged)
    for row in tiny:
        row["errors"]["enforcement"] = {"response:shift": 5e-324, "sensitivity:shift/mu": 2e-310}
        row["cost"]["seconds"]["total"] = 4e-320
        del row["provenance"]["checksum"]
    write(damaged / "results.jsonl", "".join(json.dumps(row) + "\n" for row in tiny))
    run("report", str(damaged), code=0)
    told = run("study", study, "-o", str(damaged), "--resume", code=0).told
    if "without a checksum" not in told:
        sys.exit(f"rows of another hand were kept in silence: {told}")
    print("damaged records", flush=True)


def sizes(work):
    gigabyte = 2**30
    limited = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_AS, (2 * gigabyte, 2 * gigabyte))}
    huge = write(work / "huge.json", changed(SCENE, "/bodies/block/mesh/box/cells", [3000, 3000]))
    start = time.monotonic()
    run("run", str(huge), code=2, says="GB of memory", **limited)
    run("explain", str(huge), code=2, says="try fewer cells", **limited)
    study = write(work / "huge.study.json", dict(STUDY, scene="scene.json", refine=[0, 10]))
    run("study", str(study), "-o", str(work / "huge"), code=2, says="of memory", **limited)
    steps = write(work / "steps.json", changed(SCENE, "/time/steps", 10_000_000))
    run("run", str(steps), code=2, says="10000000 steps need", timeout=120, **limited)
    for repeat in (1e7, 1001, 0, -1, 1.5, "a"):
        write(work / "repeat.study.json", dict(STUDY, timing={"repeat": repeat}))
        run("study", str(work / "repeat.study.json"), code=2, says="from 1 to 1000")
    if time.monotonic() - start > 60:
        sys.exit("sizes are estimated too slowly")
    for faults in ({"loads": [{"on": f"block.side{i}", "force": [0, 0]} for i in range(20000)]},
                   {"bodies": {f"body{i}": {"mesh": {"bxo": {}}} for i in range(20000)}},
                   {"supports": [{"on": f"block{i}.top", "move": {"x": "a"}} for i in range(20000)]},
                   {f"key{i}": i for i in range(20000)}):
        start = time.monotonic()
        told = run("run", str(write(work / "faults.json", {**SCENE, **faults})), code=2, says=" more faults").told
        if len(told) > 100000 or told.count("\n") > 110 or time.monotonic() - start > 20:
            sys.exit(f"20000 faults: {len(told)} bytes, {time.monotonic() - start} s: {told[:300]}")
    print("sizes beyond memory and faults by the thousand", flush=True)


def cells_that_fail(work):
    scene = changed(changed(SCENE, "/loads", [{"on": "block", "body_force": [3, -1], "history": [[0, 0], [1, 1]]}]),
                    "/linear_solver", {"engine": "sparse"})
    write(work / "lifted.json", scene)
    study = write(work / "lifted.study.json",
                  {"scene": "lifted.json", "methods": [{"penalty": {}}, {"uzawa_al": {}}, {"monolithic_al": {}}],
                   "vary": {"/contacts/sole/friction": [0.3, 1e3, 1e5]}})
    run("study", str(study), "-o", str(work / "lifted"), code=0)
    run("study", str(study), "-o", str(work / "lifted"), "--resume", code=0)
    if len(rows(work / "lifted")) != 9:
        sys.exit("a cell that failed has no row")
    print("cells that fail are rows", flush=True)


def long_study(work):
    cells = [round(0.1 + 0.001 * i, 6) for i in range(400)]
    write(work / "long.study.json", dict(STUDY, vary={"/contacts/sole/friction": cells}))
    return str(work / "long.study.json")


def started(*arguments, directory):
    process = subprocess.Popen([PROGRAM, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while process.poll() is None and not (directory / "results.jsonl").exists():
        time.sleep(0.002)
    return process


def directory_that_vanishes(work):
    directory = work / "vanishing"
    process = started("study", long_study(work), "-o", str(directory), directory=directory)
    directory.rename(work / "elsewhere")
    told = process.communicate(timeout=60)[1]
    if process.returncode not in (2, 3) or "was deleted or moved" not in told or "bug in stickslip" in told:
        sys.exit(f"a directory that vanished: {process.returncode} {told[-500:]}")
    print("a directory that vanishes", flush=True)


def worker_that_is_killed(work):
    directory = work / "killed worker"
    process = started("study", long_study(work), "-o", str(directory), "--jobs", "2", directory=directory)
    children = []  # (on a busy machine the file is there before the workers are)
    while not children and process.poll() is None:
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    os.kill(int(children[0]), signal.SIGKILL)
    told = process.communicate(timeout=120)[1]
    if process.returncode != 3 or "signal 9" not in told or "bug in stickslip" in told:
        sys.exit(f"a killed worker: {process.returncode} {told[-500:]}")
    if not 1590 <= len(rows(directory)) < 1600:
        sys.exit(f"a killed worker took {1600 - len(rows(directory))} cells with it")
    print("a worker that is killed loses its cell alone", flush=True)


def merges(work):
    study = str(work / "a.study.json")
    parts = [work / f"share {i}" for i in (1, 2, 3)]
    for i in (1, 2):
        run("study", study, "-o", str(parts[i - 1]), "--shard", f"{i}/3", code=0)
    merged = work / "joined"
    run("merge", *map(str, parts), "-o", str(merged), code=3, says="share 3: there is no study.json")
    if len(rows(merged)) != len(rows(parts[0])) + len(rows(parts[1])):
        sys.exit("the shares that are there were not joined")
    run("merge", *map(str, parts[:2]), "-o", str(merged), code=3, says="still missing")  # the same once more
    run("merge", str(parts[0]), "-o", str(merged), code=2, says="that are in none of the directories")
    run("merge", *map(str, parts[:2]), "-o", str(work / "titled"), code=2, says="holds another study")
    run("run", str(work / "scene.json"), "-o", str(work / "a run"), code=0)
    before = sorted(path.name for path in (work / "a run").iterdir())
    run("merge", *map(str, parts[:2]), "-o", str(work / "a run"), code=2, says="holds the result of a run")
    run("study", study, "-o", str(work / "a run"), code=2, says="holds the result of a run")
    if sorted(path.name for path in (work / "a run").iterdir()) != before:
        sys.exit("a run's directory was written to")
    run("merge", str(parts[2]), str(work / "nowhere"), "-o", str(work / "new"), code=2)
    if (work / "new").exists():
        sys.exit("merge made a directory of nothing")
    print("merge keeps what it was not given", flush=True)


def leftovers(work):
    directory = work / "fields"
    scene = write(work / "all.json", changed(SCENE, "/output", {"fields": "all"}))
    run("run", str(scene), "-o", str(directory), "--trace", "--set", "/time/steps=6", code=0)
    run("run", str(scene), "-o", str(directory), "--set", "/time/steps=3", code=0)
    found = sorted(path.name for path in directory.glob("fields*.vtu"))
    if found != [f"fields_000{i}.vtu" for i in range(4)] or (directory / "trace.csv").exists():
        sys.exit(f"left over from an earlier run: {found}")
    other = write(work / "other.json", changed(changed(SCENE, "/responses", {"sink": {"displacement": {
        "on": "block.top", "component": "y"}}}), "/contacts/sole/friction", 0.5))
    write(work / "other.study.json", dict(STUDY, scene=other.name, vary={}, methods=[{"uzawa_al": {}}]))
    run("study", str(work / "other.study.json"), "-o", str(work / "unlike"), code=0)
    run("compare", str(work / "whole"), str(work / "unlike"), code=2, says="are recordings of different studies")
    print("leftovers and unlike studies", flush=True)


def templates(work):
    """With a stand-in for parallel that replaces {} in its command, as that does, and runs it by bash."""
    tools = work / "tools"
    tools.mkdir()
    (tools / "parallel").write_text("""#!/bin/bash
while [[ $1 == --* ]]; do if [[ $1 == --env ]]; then shift; fi; shift; done
command=$1; shift 2
for i in "$@"; do bash -c "${command//\\{\\}/$i}" > /dev/null || true; done
""")
    (tools / "parallel").chmod(0o755)
    environment = dict(os.environ, PATH=f"{tools}:{os.environ['PATH']}", STICKSLIP=PROGRAM)
    template = SOURCE / "studies" / "templates" / "gnu_parallel.sh"
    odd = work / "it's {} {.} $HOME"
    odd.mkdir()
    shutil.copy(work / "scene.json", odd)
    shutil.copy(work / "a.study.json", odd)
    subprocess.run([template, odd / "a.study.json", odd / "out {}", "3"], env=environment, check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    if len(rows(odd / "out {}")) != 8:
        sys.exit("a template lost cells of a path with braces")
    for name in ("gnu_parallel.sh", "slurm_array.sh"):
        for count in ("x", "0", "-1", "1.5", "1e3", "$(touch no)"):
            refused = subprocess.run([template.with_name(name), odd / "a.study.json", odd / "no", count],
                                     env=environment, capture_output=True, text=True)
            if refused.returncode != 2 or "must be a whole number" not in refused.stderr:
                sys.exit(f"{name} with {count} shards: {refused.returncode} {refused.stderr}")
    for shard in ("x", "1", "1/", "/2", "0/2", "3/2", "1/2/3", "a/b", "1/99999999999999"):
        run("study", str(work / "a.study.json"), "--shard", shard, code=2, says="must be i/N")
    for jobs in ("0", "-3", "x", "1e3", "99999999999999", "100000"):
        run("study", str(work / "a.study.json"), "--jobs", jobs, code=2)
    print("templates and counts that are none", flush=True)


def main():
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        write(work / "scene.json", SCENE)
        study = write(work / "a.study.json", STUDY)
        timed = write(work / "timed.study.json", dict(STUDY, timing={"repeat": 2}))
        run("study", str(timed), "-o", str(work / "whole"), code=0)
        for part in (files_that_are_none, names, what_is_mistaken, damaged_records, sizes, cells_that_fail,
                     directory_that_vanishes, worker_that_is_killed, merges, leftovers, templates):
            part(work)


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    main()
