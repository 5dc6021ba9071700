#!/usr/bin/env python3
"""peers_test.py STICKSLIP SOURCE_DIR: the punch of studies/peers by GetFEM and CalculiX, which must be installed: both
certificates hold, and their responses are those of the exact enforcement, to what each program claims."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    for file in (source / "studies" / "peers").iterdir():
        shutil.copy(file, folder)
    subprocess.run(["/usr/bin/python3", "getfem_punch.py", "getfem.json"], cwd=folder, check=True, capture_output=True)
    subprocess.run([sys.executable, "calculix_punch.py", "calculix.json"], cwd=folder, check=True)
    subprocess.run([program, "study", "punch.study.json", "-o", "out"], cwd=folder, check=True, capture_output=True)
    rows = [json.loads(line) for line in (folder / "out" / "results.jsonl").read_text().splitlines()]
    page = (folder / "out" / "report.html").read_text()

peers = {row["label"]: row for row in rows if "peer" in row}
assert sorted(peers) == ["CalculiX", "GetFEM"], sorted(peers)
assert all(row["certificate"]["holds"] for row in rows), [row["certificate"] for row in rows]
for label, accuracy in (("GetFEM", 1e-11), ("CalculiX", 1e-5)):  # solved to rounding; six digits in its file
    errors = peers[label]["errors"]["enforcement"]
    assert {"response:press", "response:corner", "field:normal_traction"} <= set(errors), errors
    assert max(errors.values()) < accuracy, (label, errors)
    assert label in page
