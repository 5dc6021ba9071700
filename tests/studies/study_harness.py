#!/usr/bin/env python3
"""Treats the study command as people and schedulers do: kills it, resumes it, runs it in parallel and in shards, starts
it twice at once. Each time the rows must be those of one undisturbed run, apart from seconds and provenance.

    study_harness.py STICKSLIP SOURCE_DIR [SEED]
"""
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROGRAM, SOURCE = sys.argv[1], Path(sys.argv[2])
SEED = int(sys.argv[3]) if len(sys.argv) > 3 else random.randrange(10**6)

STUDY = {
    "title": "a study to be disturbed",
    "scene": "scene.json",
    "methods": [
        {"penalty": {"stiffness": [1, 10, 100, 1e3, 1e12]}},
        {"uzawa_al": {"scale": [1, 10], "tolerance": [1e-4, 1e-8]}},
        {"monolithic_al": {"scale": [1e-2, 1]}},
    ],
    "vary": {"/contacts/sole/friction": [0.2, 0.4, 1]},
    "reference": [{"method": {"monolithic_al": {}}}],
    "errors": ["response:*", "sensitivity:*", "kkt"],
}


def run(*arguments, check=True, **options):
    result = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, **options)
    if check and result.returncode != 0:
        sys.exit(f"{arguments}: exit code {result.returncode}\n{result.stdout}{result.stderr}")
    return result


def rows(directory):
    """The rows in order, without what no two runs share."""
    out = []
    for line in (directory / "results.jsonl").read_text().splitlines():
        row = json.loads(line)
        del row["provenance"], row["cost"]["seconds"], row["cost"]["peak_memory_mb"]
        row["cost"].pop("timing", None)
        out.append(row)
    return out


def same(directory, reference, what):
    if rows(directory) != rows(reference):
        ours, theirs = ({row["id"]: row for row in rows(d)} for d in (directory, reference))
        differing = [theirs[i]["label"] for i in theirs if ours.get(i) != theirs[i]]
        sys.exit(f"{what}: the rows differ from those of one run (seed {SEED}): {differing or 'in their order'}")
    print(f"{what}: {len(rows(directory))} rows, as those of one run", flush=True)


def killed_and_resumed(study, whole, work):
    """20 kills, each while cells are missing; a study that got through all the same starts anew."""
    directory, seconds, chance = work / "killed", duration(study, work), random.Random(SEED)
    finished, through, all_cells = 0, 0, len(rows(whole))
    for attempt in range(20):
        if finished == all_cells:
            run("study", study, "-o", directory, "--resume")  # puts the rows in order
            same(directory, whole, f"killed {attempt} times")
            shutil.rmtree(directory)
            finished, through = 0, through + 1
        process = subprocess.Popen([PROGRAM, "study", study, "-o", directory, "--resume", "--jobs",
                                    chance.choice("12")], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(chance.uniform(0, 0.2 * seconds))
        process.kill()
        process.wait()
        path = directory / "results.jsonl"
        lines = path.read_text().split("\n")[:-1] if path.exists() else []
        ids = [json.loads(line)["id"] for line in lines]
        if len(set(ids)) != len(ids):
            sys.exit(f"kill {attempt}: a cell was recorded twice (seed {SEED})")
        if len(ids) < finished:
            sys.exit(f"kill {attempt}: {finished - len(ids)} finished cells were lost (seed {SEED})")
        finished = len(ids)
    print(f"20 kills, {through} times through, {finished} of {all_cells} cells in the end", flush=True)
    directory.mkdir(exist_ok=True)
    with open(directory / "results.jsonl", "a") as file:
        file.write('{"id": "torn')
    said = run("study", study, "-o", directory, "--resume").stderr
    if "a torn last line (12 bytes) was dropped" not in said:
        sys.exit(f"the torn line was dropped in silence: {said}")
    same(directory, whole, "killed and resumed")
    if any(directory.glob("*.part")):
        sys.exit("a temporary file was left behind")
    again = run("study", study, "-o", directory, "--resume").stdout
    if " 0 run now" not in again:
        sys.exit(f"a finished study ran again: {again}")
    same(directory, whole, "resumed with nothing to do")


def duration(study, work):
    start = time.monotonic()
    run("study", study, "-o", work / "timed")
    return time.monotonic() - start


def one_at_a_time(study, work):
    directory = work / "shared"
    first = subprocess.Popen([PROGRAM, "study", study, "-o", directory], stdout=subprocess.DEVNULL,
                             stderr=subprocess.DEVNULL)
    while not (directory / "results.jsonl").exists():
        time.sleep(0.005)
    second = run("study", study, "-o", directory, "--resume", check=False)
    refused = run("report", directory, check=False)
    running = first.poll() is None
    if refused.returncode != 2 or "another stickslip writes here" not in refused.stderr:
        sys.exit(f"a report of a running study: exit code {refused.returncode}: {refused.stderr}")
    if not running or second.returncode != 2 or f"another stickslip writes here (process {first.pid})" not in second.stderr:
        sys.exit(f"two at once: first running: {running}, exit code {second.returncode}: {second.stderr}")
    if first.wait() != 0:
        sys.exit("the first of two did not finish")
    print("a second process is refused: " + second.stderr.strip(), flush=True)


def interrupted(study, work):
    directory = work / "interrupted"
    process = subprocess.Popen([PROGRAM, "study", study, "-o", directory, "--jobs", "2"], stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True, start_new_session=True)
    while not (directory / "results.jsonl").exists():
        time.sleep(0.005)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers too
    said = process.communicate()[1]
    if process.returncode != -signal.SIGINT or said.count(f"stickslip study {study} -o {directory} --resume\n") != 1:
        sys.exit(f"interrupted: {process.returncode} {said}")
    if (directory / ".lock").exists():
        sys.exit("an interrupted study left its .lock behind")
    print("an interrupted study says how to go on", flush=True)
    directory = work / "interrupted run"
    process = subprocess.Popen([PROGRAM, "run", SOURCE / "studies" / "scenes" / "tractrix.json", "--set",
                                "/time/steps=1000000", "-o", directory], stdout=subprocess.DEVNULL)
    while process.poll() is None and not (directory / ".lock").exists():
        time.sleep(0.005)
    process.terminate()
    if process.wait() != -signal.SIGTERM or any(directory.iterdir()):
        sys.exit(f"an interrupted run: {process.returncode}, left: {list(directory.iterdir())}")


def by_slurm(study, whole, work):
    """The array job by a stand-in for sbatch that runs its script at once, in a directory with an awkward name."""
    tools = work / "tools"
    tools.mkdir()
    (tools / "sbatch").write_text("""#!/bin/bash
script=$(cat)
for argument in "$@"; do case $argument in --array=1-*) tasks=${argument#--array=1-};; esac; done
for i in $(seq "${tasks:-1}"); do SLURM_ARRAY_TASK_ID=$i bash -c "$script" > /dev/null; done
echo 7
""")
    (tools / "sbatch").chmod(0o755)
    environment = dict(os.environ, PATH=f"{tools}:{os.environ['PATH']}", STICKSLIP=PROGRAM)
    template, output = SOURCE / "studies" / "templates" / "slurm_array.sh", work / "it's $HOME `now`"
    subprocess.run([template, study, output, "3"], env=environment, check=True, stdout=subprocess.DEVNULL)
    same(output, whole, "three tasks of an array job")
    for name in ("slurm_array.sh", "gnu_parallel.sh"):
        refused = subprocess.run([SOURCE / "studies" / "templates" / name], capture_output=True, text=True)
        if refused.returncode != 2 or "usage: " not in refused.stderr:
            sys.exit(f"{name} without arguments: {refused.returncode} {refused.stderr}")


def not_overwritten(study, whole, work):
    """What cannot be written, or would be lost, is refused before anything runs: exit code 2 and a plain reason."""
    (work / "file").write_text("mine")
    folder = work / "folder"
    (folder / "report.html").mkdir(parents=True)
    scene = study.parent / json.loads(study.read_text())["scene"]
    single = work / "single"
    run("run", scene, "-o", single)
    refusals = [
        (("study", study, "-o", whole), "--restart deletes them"),
        (("study", study, "-o", work / "file"), "is a file; must be a directory"),
        (("study", study, "-o", folder), "report.html: is a directory"),
        (("study", study, "-o", ""), "is empty; must be a name"),
        (("run", scene, "-o", whole), "holds a study"),
        (("study", study, "-o", single), "holds the result of a run"),
        (("run", scene, "-o", work / "file"), "is a file; must be a directory"),
        (("run", scene, "-o", work / ("x" * 300)), "cannot be made: File name too long"),
        (("run", scene, "--json", "--export", work / "file"), "is a file; must be a directory"),
        (("merge", whole, "-o", work / "file"), "is a file; must be a directory"),
        (("compare", whole, whole, "--relative", "-1"), "must be a number >= 0"),
        (("compare", whole, whole, "--rounding", "nan"), "must be a number >= 0"),
    ]
    for arguments, reason in refusals:
        refused = run(*arguments, check=False)
        if refused.returncode != 2 or reason not in refused.stderr or "bug in stickslip" in refused.stderr:
            sys.exit(f"{arguments}: {refused.returncode} {refused.stderr}")
    with open("/dev/full", "w") as full:
        lost = subprocess.run([PROGRAM, "run", scene, "--json"], stdout=full, stderr=subprocess.PIPE, text=True)
    if lost.returncode != 2 or "standard output cannot be written" not in lost.stderr:
        sys.exit(f"a full disk: {lost.returncode} {lost.stderr}")
    again = work / "again"
    shutil.copytree(whole, again)
    run("study", study, "-o", again, "--restart")
    same(again, whole, "restarted")
    for name, text in (("study.json", ""), ("picture.json", '{"torn')):
        damaged = work / "damaged"
        shutil.copytree(whole, damaged)
        (damaged / name).write_text(text)
        for arguments, reason in ((("report", damaged), f"{name}:1:"),
                                  (("study", study, "-o", damaged, "--resume"), f"{name}: was edited since")):
            refused = run(*arguments, check=False)
            if refused.returncode != 2 or reason not in refused.stderr:
                sys.exit(f"{name}: {arguments}: {refused.returncode} {refused.stderr}")
        shutil.rmtree(damaged)


def in_parallel(study, whole, work):
    run("study", study, "-o", work / "parallel", "--jobs", 3)
    same(work / "parallel", whole, "three jobs")


def in_shards(study, whole, work):
    parts = [work / f"part{i}" for i in range(1, 9)]
    for i, part in enumerate(parts, 1):
        run("study", study, "-o", part, "--shard", f"{i}/8")
    run("merge", *parts, "-o", work / "merged")
    same(work / "merged", whole, "eight shards merged")
    incomplete = run("merge", *parts[1:], "-o", work / "incomplete", check=False)
    if incomplete.returncode != 3 or "cells are still missing, in the study's order: 1, 9, 17" not in incomplete.stderr:
        sys.exit(f"a missing shard: {incomplete.returncode} {incomplete.stderr}")
    other = dict(STUDY, vary={"/contacts/sole/friction": [0.5]})
    (work / "other.study.json").write_text(json.dumps(other))
    run("study", work / "other.study.json", "-o", work / "other")
    refused = run("merge", parts[0], work / "other", "-o", work / "nothing", check=False)
    if refused.returncode != 2 or "are of different studies" not in refused.stderr or (work / "nothing").exists():
        sys.exit(f"another study: {refused.returncode} {refused.stderr}")
    print("another study is refused: " + refused.stderr.strip(), flush=True)
    both = work / "both"
    run("study", study, "-o", both, "--shard", "1/2")
    said = run("study", study, "-o", both, "--shard", "2/2", "--resume").stderr
    kept = (len(rows(whole)) + 1) // 2
    if f"{kept} row(s) of this study that are not of shard 2/2 stay as they are" not in said:
        sys.exit(f"rows of another shard: {said}")
    same(both, whole, "two shards in one directory")


def compared(whole, work):
    if run("compare", whole, work / "merged").returncode != 0:
        sys.exit("equal rows are found to be worse")
    worse = work / "worse"
    shutil.copytree(whole, worse)
    lines = [json.loads(line) for line in (worse / "results.jsonl").read_text().splitlines()]
    for line in lines:
        del line["provenance"]["checksum"]  # or the changes would be taken for damage
    lines[3]["cost"]["counts"]["newton"] += 1
    (worse / "results.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    told = run("compare", whole, worse, "--json", check=False)
    found = json.loads(told.stdout)
    if told.returncode != 3 or found["worse"] != 1 or found["cells"][0]["label"] != lines[3]["label"]:
        sys.exit(f"one more iteration: exit code {told.returncode}: {told.stdout}")
    if run("compare", worse, whole).returncode != 0:
        sys.exit("one iteration less is found to be worse")
    for line in lines:
        line["responses"] = {name: 2 * value for name, value in line["responses"].items()}
        line["scene_hash"] = "another"
    lines[3]["cost"]["counts"]["newton"] -= 1
    (worse / "results.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    told = run("compare", whole, worse).stdout
    if f"{len(lines)} cells: {len(lines)} changed, 0 of them" not in told or "ran another scene" not in told:
        sys.exit(f"all responses doubled: {told}")
    print("one more iteration is found", flush=True)


def timed(study, whole, work):
    """A timing pass that is killed goes on where it was, and leaves the rows as they were."""
    path = work / "timed.study.json"
    path.write_text(json.dumps(dict(STUDY, timing={"repeat": 3})))
    directory = work / "clocked"
    process = subprocess.Popen([PROGRAM, "study", path, "-o", directory], stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    while not (directory / "timings.jsonl").exists() or (directory / "timings.jsonl").read_text().count("\n") < 5:
        time.sleep(0.005)
    process.kill()
    process.wait()
    before = (directory / "timings.jsonl").read_text().split("\n")[:-1]
    run("study", path, "-o", directory, "--resume")
    after = (directory / "timings.jsonl").read_text().split("\n")[:-1]
    runs = [(json.loads(line)["id"], json.loads(line)["round"]) for line in after]
    converged = [row for row in rows(directory) if row["status"].startswith("converged")]
    if after[:len(before)] != before or len(set(runs)) != len(runs) or len(runs) != 3 * len(converged):
        sys.exit(f"{len(before)} timed runs, then {len(runs)} of {3 * len(converged)}")
    for line in (directory / "results.jsonl").read_text().splitlines():
        row = json.loads(line)
        if row["status"].startswith("converged") and row["cost"]["timing"]["repeat"] != 3:
            sys.exit(f"{row['label']} lacks its timing")
    same(directory, whole, f"timed, killed after {len(before)} of {len(runs)} runs")


def budgeted(work):
    """Error budgets are killed, resumed, and run by several processes, to the same rows. A study that asks for one
    later runs anew what has none, one that no longer asks shows none."""
    shutil.copy(SOURCE / "studies" / "scenes" / "pull_out.json", work)
    path, plain = work / "budget.study.json", work / "plain.study.json"
    study = {
        "scene": "pull_out.json",
        "methods": [{"penalty": {"stiffness": [1, 100, 1e4]}}, {"uzawa_al": {"tolerance": [1e-2, 1e-6]}},
                    {"monolithic_al": {}}],
        "reference": [{"values": {"u": 1 / 150, "heat": 2 / 45}}],
    }
    plain.write_text(json.dumps(study))
    path.write_text(json.dumps(dict(study, error_budget=True)))
    whole, directory, other = work / "budget", work / "budget killed", work / "budget later"
    run("study", path, "-o", whole)
    for each in rows(whole):
        budget = each["error_budget"]["quantities"]["response:u"]
        if not 0.8 < budget["sum"] / budget["error"] < 1.25:
            sys.exit(f"{each['label']}: the parts make {budget['sum']} of {budget['error']}")
    process = subprocess.Popen([PROGRAM, "study", path, "-o", directory], stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    while not (directory / "results.jsonl").exists():
        time.sleep(0.005)
    process.kill()
    process.wait()
    run("study", path, "-o", directory, "--resume", "--jobs", "2")
    same(directory, whole, "budgets, killed and resumed")
    run("study", plain, "-o", other)
    figures = list((other / "figures").glob("error-budget*"))
    if figures or any("error_budget" in row for row in rows(other)) or "Where the error comes" in (other / "report.html").read_text():
        sys.exit(f"a budget that nobody asked for: {figures}")
    without = rows(other)
    run("study", path, "-o", other, "--resume")
    same(other, whole, "budgets asked for later")
    if not (other / "figures" / "error-budget.csv").exists():
        sys.exit("the budget has no figure")
    run("study", plain, "-o", other, "--resume")
    if rows(other) != without or list((other / "figures").glob("error-budget*")):
        sys.exit("a budget that is no longer asked for stays")


def certified(work):
    """Solutions of other programs, which a study takes up later, and drops: the runs get certificates, and lose them."""
    plain, with_peer, directory = work / "uncertified.study.json", work / "certified.study.json", work / "certified"
    content = {"scene": "scene.json", "methods": [{"penalty": {"stiffness": [10, 1e3]}}, {"monolithic_al": {}}]}
    plain.write_text(json.dumps(content))
    run("run", work / "scene.json", "-m", "monolithic_al", "-o", work / "peer")
    with_peer.write_text(json.dumps({**content, "solutions": [{"name": "Peer", "file": "peer/solution.json"}]}))

    def lines():
        return [json.loads(line) for line in (directory / "results.jsonl").read_text().splitlines()]

    run("study", plain, "-o", directory)
    without = rows(directory)
    run("study", with_peer, "-o", directory, "--resume")
    if not all(row.get("certificate", {}).get("holds") for row in lines()) or len(lines()) != len(without) + 1:
        sys.exit("runs that a study with solutions took up have no certificate")
    if run("study", with_peer, "-o", directory, "--resume").stdout.find(" 0 run now") < 0:
        sys.exit("certificates are made again")
    run("study", plain, "-o", directory, "--resume")
    if rows(directory) != without:
        sys.exit("certificates that are no longer asked for stay")
    slid = json.loads((work / "peer" / "solution.json").read_text())
    for increment in slid["increments"]:
        increment["displacement"] = [1.01 * u for u in increment["displacement"]]
    (work / "slid.json").write_text(json.dumps(slid))
    with_peer.write_text(with_peer.read_text().replace("peer/solution.json", "slid.json"))
    for command in (("study", with_peer, "-o", directory, "--resume"), ("study", with_peer, "-o", directory, "--resume"),
                    ("merge", directory, "-o", work / "certified_merged")):
        said = run(*command, check=False)
        if said.returncode != 3 or "Peer: its certificate does not hold: " not in said.stderr:
            sys.exit(f"{command}: a certificate that does not hold: exit code {said.returncode}\n{said.stderr}")
    print("certified: with a solution of another program, and without again", flush=True)


def moved(work):
    """A study that is edited and resumed keeps the runs that it still asks for; each row then says where its cell stands
    in the study as it is now. Against another reference its errors are others: it runs again."""
    path, directory, anew = work / "moved.study.json", work / "moved", work / "moved_anew"
    content = {"scene": "scene.json", "methods": [{"monolithic_al": {}}]}
    lines = (work / "scene.json").read_text().splitlines()
    scene = json.loads("\n".join(line for line in lines if not line.lstrip().startswith("//")))
    friction = scene["contacts"]["sole"]["friction"]
    path.write_text(json.dumps(content))
    run("study", path, "-o", directory)
    path.write_text(json.dumps({**content, "vary": {"/contacts/sole/friction": [friction / 2, friction]}}))
    said = run("study", path, "-o", directory, "--resume").stdout
    if " 1 run now" not in said:
        sys.exit(f"a run that a study still asks for was made again: {said}")
    run("study", path, "-o", anew)
    same(directory, anew, "edited, resumed")
    path.write_text(json.dumps({**json.loads(path.read_text()), "reference": [{"method": {"penalty": {}}}]}))
    said = run("study", path, "-o", directory, "--resume")
    if " 2 run now" not in said.stdout or "2 rows are of another \"reference\"" not in said.stderr:
        sys.exit(f"rows keep the errors against another reference: {said.stdout}{said.stderr}")
    run("study", path, "-o", anew, "--restart")
    same(directory, anew, "another reference, resumed")


def main():
    print(f"seed {SEED}")
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        shutil.copy(SOURCE / "studies" / "scenes" / "greco_plate.json", work / "scene.json")
        study = work / "some.study.json"
        study.write_text(json.dumps(STUDY))
        whole = work / "whole"
        run("study", study, "-o", whole)
        killed_and_resumed(study, whole, work)
        one_at_a_time(study, work)
        interrupted(study, work)
        by_slurm(study, whole, work)
        not_overwritten(study, whole, work)
        in_parallel(study, whole, work)
        in_shards(study, whole, work)
        compared(whole, work)
        timed(study, whole, work)
        budgeted(work)
        certified(work)
        moved(work)


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    main()
