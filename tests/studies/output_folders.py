#!/usr/bin/env python3
"""Runs the commands where files of others stand, where disks, limits and terminals take no more, and where a cell ends
its process: what is not the program's own is neither replaced nor deleted, files are whole or absent, and exit codes
are those of docs/commands.md.

    output_folders.py STICKSLIP SOURCE_DIR
"""
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROGRAM, SOURCE = sys.argv[1], Path(sys.argv[2])
SCENES = SOURCE / "studies" / "scenes"
RUN = ["result.json", "fields.pvd", "fields_0060.vtu", "solution.json", "picture.json", "report.html", "trace.csv",
       "cones.svg", "figures/mine.svg", "figures/mine.pdf", "figures/mine.pgf", "figures/mine.csv"]
STUDY = ["study.json", "results.jsonl", "timings.jsonl", "results.stale.jsonl", "fields.pvd", "fields_0001.vtu",
         "picture.json", "report.html", *RUN[-4:]]
EXPORT = ["K.mtx", "G.mtx", "lambda.mtx", "f.mtx", "u.mtx", "g.mtx", "rows.csv", "points.csv", "README"]
BESIDE = ["notes.txt", "fields.vtu", "fields_old.vtu", "figures/photo.png", "thesis.tex", "data.csv", ".hidden",
          "results.json", "report.html.999999.part"]


def run(*arguments, code=0, says="", timeout=60, **options):
    options.setdefault("stdout", subprocess.PIPE)
    options.setdefault("stderr", subprocess.PIPE)
    result = subprocess.run([PROGRAM, *map(str, arguments)], timeout=timeout, **options)
    told = (result.stderr or b"").decode(errors="replace")
    if result.returncode != code or says not in told or "bug in stickslip" in told:
        sys.exit(f"{arguments}: exit code {result.returncode}, wanted {code} and {says!r}:\n{told}")
    return told


def content(folder):
    """Of all files, links as such, and folders."""
    def of(path):
        return os.readlink(path) if path.is_symlink() else path.read_bytes() if path.is_file() else None
    return {str(path.relative_to(folder)): of(path) for path in sorted(folder.rglob("*"))}


def fill(folder, names):
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("mine: " + name)
    return content(folder)


def refused(folder, *arguments, names, cwd=None):
    """The command names these, and touches nothing."""
    before = content(folder)
    told = run(*arguments, code=2, cwd=cwd)
    missing = [name for name in names if f"  {name}: " not in told]
    if missing or content(folder) != before:
        sys.exit(f"{arguments}: not named: {missing}; touched: {content(folder).keys() ^ before.keys()}\n{told}")


def files_of_others(work):
    scene, study = work / "slider.json", work / "stop.study.json"
    folder = work / "run"
    fill(folder, RUN + BESIDE)
    refused(folder, "run", scene, "-o", folder, "--report", "--trace", names=RUN)
    refused(folder, "run", scene, "-o", folder, names=RUN[:4])
    for name in RUN[:4]:
        (folder / name).unlink()
    before = content(folder)  # of which a run without a report needs no name
    for _ in range(2):
        run("run", scene, "-o", folder)
    after = content(folder)
    if any(after[name] != before[name] for name in before) or set(after) - set(before) != {*RUN[:4], ".stickslip"}:
        sys.exit(f"a run touched files of others: {after.keys() ^ before.keys()}")

    folder = work / "study"
    before = fill(folder, STUDY + BESIDE)
    for option in ((), ("--resume",), ("--restart",)):
        refused(folder, "study", study, "-o", folder, *option, names=STUDY)
    whole = work / "whole"
    run("study", study, "-o", whole)
    for name in ("results.jsonl", "study.json"):
        (folder / name).unlink()
    refused(folder, "merge", whole, "-o", folder, names=[name for name in STUDY if (folder / name).exists()])
    shutil.copy(whole / "study.json", folder)
    shutil.copy(whole / "results.jsonl", folder)
    (folder / "picture.json").unlink()
    refused(folder, "report", folder, names=["report.html", *RUN[-4:]])
    folder = work / "export"
    fill(folder, EXPORT + BESIDE)
    refused(folder, "run", scene, "--json", "--export", folder, names=EXPORT)
    refused(work, "run", scene, "-o", work / "new", "--export", folder, names=EXPORT)  # nor is a folder made
    run("run", scene, "-o", work / "both", "--export", work / "both")
    if missing := [name for name in EXPORT if not (work / "both" / name).exists()]:
        sys.exit(f"exported beside the results: {missing} are missing")
    print("files of others stay as they are", flush=True)


def inputs(work):
    folder = work / "inputs"
    folder.mkdir()
    for name in ("result.json", "picture.json", "fields.pvd"):
        shutil.copy(work / "slider.json", folder / name)
    shutil.copy(work / "stop.json", folder)
    for name in ("result.json", "picture.json"):
        refused(folder, "run", name, "-o", ".", names=["result.json", "fields.pvd"], cwd=folder)
    (folder / "fields.pvd").unlink()
    (folder / "result.json").unlink()
    shutil.copy(work / "stop.study.json", folder / "study.json")
    refused(folder, "study", "study.json", "-o", ".", names=["study.json", "picture.json"], cwd=folder)
    (folder / "study.json").unlink()
    run("run", "picture.json", "-o", ".", cwd=folder)
    refused(folder, "run", "picture.json", "-o", ".", "--report", names=["picture.json"], cwd=folder)
    print("inputs are not overwritten", flush=True)


def edited_and_linked(work):
    scene, folder, elsewhere = work / "slider.json", work / "edited", work / "elsewhere"
    run("run", scene, "-o", folder, "--report")
    run("run", scene, "-o", folder, "--report")
    with open(folder / "figures" / "overview.svg", "a") as file:
        file.write("<!-- a word -->")
    refused(folder, "run", scene, "-o", folder, "--report", names=["figures/overview.svg"])
    run("run", scene, "-o", folder)
    if [path.name for path in folder.rglob("*.svg")] != ["overview.svg"] or (folder / "report.html").exists():
        sys.exit(f"an edited figure and what a run leaves: {list(folder.rglob('*'))}")
    fill(elsewhere, ["a.svg", "report.html"])
    before = content(elsewhere)
    linked = work / "linked"
    linked.mkdir()
    (linked / "figures").symlink_to(elsewhere)
    (linked / "report.html").symlink_to(elsewhere / "report.html")
    (linked / "fields.pvd").symlink_to(elsewhere / "nowhere")
    refused(linked, "run", scene, "-o", linked, "--report", names=["figures", "report.html", "fields.pvd"])
    (linked / "fields.pvd").unlink()
    run("run", scene, "-o", linked)
    if content(elsewhere) != before:
        sys.exit("a link was followed")
    locked = work / "locked"
    fill(locked, ["a"])
    locked.chmod(0o555)
    if not os.access(locked, os.W_OK):  # not of root
        told = run("run", scene, "-o", locked, code=2, says="cannot be written to")
        if content(locked).keys() != {"a"}:
            sys.exit(f"a folder without permission: {told}")
    print("edited files and links stay as they are", flush=True)


def whole_or_absent(folder):
    """No lock and no temporary file, and every file can be read to its end."""
    for path in folder.rglob("*"):
        if path.name == ".lock" or path.suffix == ".part":
            sys.exit(f"{path} was left behind")
        if path.suffix == ".json":
            json.loads(path.read_text())
        if path.suffix == ".jsonl":
            for line in path.read_text().splitlines(True):
                if not line.endswith("\n"):
                    sys.exit(f"{path}: half a line")
                json.loads(line)
        if path.suffix in (".vtu", ".pvd") and not path.read_text().endswith("</VTKFile>\n"):
            sys.exit(f"{path} is not whole")


def limits(work):
    def limited(size):
        return {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))}

    for size in (0, 500, 4000, 20000, 100000):
        folder = work / f"run of {size}"
        refusal = {"code": 2, "says": "File too large; raise the limit", **limited(size)}
        run("run", work / "slider.json", "-o", folder, "--report", **refusal)
        if folder.exists():
            whole_or_absent(folder)
        run("run", work / "slider.json", "-o", folder, "--report")
        folder = work / f"study of {size}"
        run("study", work / "stop.study.json", "-o", folder, **refusal)
        if folder.exists():
            whole_or_absent(folder)
        run("study", work / "stop.study.json", "-o", folder, "--resume")
        whole_or_absent(folder)
    print("a limit of the size of files", flush=True)


def streams(work):
    scene, study = work / "slider.json", work / "stop.study.json"
    with open("/dev/full", "w") as full:
        run("run", scene, "-o", work / "full", says="standard output cannot be written", stdout=full)
        run("run", scene, "-o", work / "full", "--trace", "--export", work / "full" / "system", stdout=full)
        run("study", study, "-o", work / "full study", stdout=full, stderr=full)
        run("run", scene, "--json", code=2, says="standard output cannot be written", stdout=full)
        run("explain", scene, code=2, says="standard output cannot be written", stdout=full)
    if not (work / "full" / "system" / "README").exists():
        sys.exit("what was asked for was not written")
    for closed in (">&-", "2>&-", ">&- 2>&-", "<&- >&- 2>&-"):
        folder = work / "closed" / str(len(closed))
        result = subprocess.run(["bash", "-c", f'"$0" run "$1" -o "$2" {closed}', PROGRAM, scene, folder],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        if result.returncode != 0:
            sys.exit(f"{closed}: exit code {result.returncode}")
        whole_or_absent(folder)
        run("run", scene, "-o", folder)  # its list is right
    piped = work / "piped"
    subprocess.run(["bash", "-c", '"$0" run "$1" -o "$2" --set /time/legs=[[3,3000]] | true', PROGRAM, scene, piped])
    whole_or_absent(piped)
    print("standard streams that are closed or full", flush=True)


def address_space(work):
    for megabytes in (100, 150, 200):
        limit = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20, megabytes << 20))}
        result = subprocess.run([PROGRAM, "run", SCENES / "greco_plate.json", "-o", work / "little"],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60, **limit)
        told = result.stderr.decode()
        if result.returncode not in (0, 2) or result.returncode == 2 and "memory" not in told and "shared" not in told:
            sys.exit(f"{megabytes} MB: exit code {result.returncode}: {told}")
    print("little address space", flush=True)


def long_study(work):
    methods = [{"penalty": {"stiffness": [1 + 0.01 * i for i in range(1500)]}}]
    (work / "long.study.json").write_text(json.dumps({"scene": "stop.json", "methods": methods}))
    return work / "long.study.json"


def crashed_study(work, folder):
    """The rows of a study whose process of cells is ended by a signal while it works, which are all."""
    process = subprocess.Popen([PROGRAM, "study", long_study(work), "-o", folder], stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE)
    children = ""
    while process.poll() is None and not ((folder / "results.jsonl").exists() and children):
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    os.kill(int(children[0]), signal.SIGSEGV)
    told = process.communicate(timeout=120)[1].decode()
    rows = [json.loads(line) for line in (folder / "results.jsonl").read_text().splitlines()]
    if process.returncode != 0 or len(rows) != 1500:
        sys.exit(f"a cell that crashed: {process.returncode}, {len(rows)} rows: {told[-500:]}")
    return rows


def crash(work):
    """A cell that ends its process is a row, without --jobs too; a study that is resumed leaves it at that."""
    for attempt in range(10):  # the signal may come between two cells, which loses none
        folder = work / f"crash {attempt}"
        failed = [row for row in crashed_study(work, folder) if row["status"] == "failed"]
        if failed:
            break
    if len(failed) != 1 or "signal 11" not in failed[0]["message"]:
        sys.exit(f"the cell that crashed: {failed}")
    said = subprocess.run([PROGRAM, "study", long_study(work), "-o", folder, "--resume"], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, timeout=120)
    if said.returncode != 0 or b"1500 cells, 0 run now" not in said.stdout:
        sys.exit(f"resumed: {said.returncode} {said.stdout} {said.stderr[-500:]}")
    print("a cell that crashes is a row", flush=True)


def two_at_once(work):
    folder = work / "two"
    first = subprocess.Popen([PROGRAM, "study", long_study(work), "-o", folder], stdout=subprocess.DEVNULL,
                             stderr=subprocess.DEVNULL)
    while first.poll() is None and not (folder / "results.jsonl").exists():
        time.sleep(0.002)
    for command in (("run", work / "slider.json"), ("study", work / "stop.study.json", "--restart"),
                    ("run", work / "slider.json", "--json", "--export", folder)):
        option = () if "--export" in command else ("-o", folder)
        told = run(*command, *option, code=2)
        if f"(process {first.pid})" not in told and "holds a study" not in told:
            sys.exit(f"{command} beside a study: {told}")
    if first.wait(timeout=120) != 0:
        sys.exit("the first of two did not finish")
    print("two at once", flush=True)


def earlier_versions(work):
    """Results of 0.1.0 are read; in their folders, which have no list of files, nothing is replaced."""
    for name in ("earlier_run", "earlier_study"):
        shutil.copytree(SOURCE / "tests" / "studies" / name, work / name)
    methods = [{"penalty": {"stiffness": [100, 1e4]}}, {"monolithic_al": {}}]
    study = work / "stop_bars.study.json"
    study.write_text(json.dumps({"scene": str(SCENES / "stop_bars.json"), "methods": methods,
                                 "reference": [{"method": {"monolithic_al": {}}}]}))
    refused(work / "earlier_study", "study", study, "-o", work / "earlier_study", "--resume",
            names=["study.json", "results.jsonl"])
    refused(work / "earlier_run", "run", work / "slider.json", "-o", work / "earlier_run", names=["result.json"])
    run("verify", work / "earlier_run", code=2, says="as of results of earlier versions; run the scene again")
    run("study", study, "-o", work / "now")
    run("compare", work / "earlier_study", work / "now", code=0)
    run("merge", work / "earlier_study", "-o", work / "joined", code=3, says="2 row(s) without a checksum were dropped")
    run("merge", work / "now", work / "earlier_study", "-o", work / "both", code=2, says="run all shards with one version")
    for name in ("earlier_run", "earlier_study"):
        run("report", work / name)
    print("results of earlier versions are read", flush=True)


def without_other_programs(work):
    """A report as PDF asks for the program that makes it, before anything is written."""
    folder, empty = work / "no_pdf", work / "empty"
    empty.mkdir()
    run("run", work / "slider.json", "-o", folder)
    before = content(folder)
    run("report", folder, "--pdf", code=2, env={**os.environ, "PATH": str(empty)},
        says="rsvg-convert makes the PDFs, and is not here; install it (Debian: apt install librsvg2-bin)")
    if content(folder) != before:
        sys.exit(f"without rsvg-convert: {content(folder).keys() ^ before.keys()}")
    print("a program that is missing is named", flush=True)


def main():
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        for name in ("slider.json", "stop.json", "stop.study.json"):
            shutil.copy(SCENES / name, work)
        for check in (files_of_others, inputs, edited_and_linked, limits, streams, address_space, crash, two_at_once,
                      earlier_versions, without_other_programs):
            check(work)


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    main()
