"""Runs one case by one method in a process of its own, and reads what it left."""

import base64
import json
import math
import os
import re
import shutil
import signal
import struct
import subprocess
import time

SOLVED = ("converged", "converged_at_roundoff")


def execute(command, timeout):
    """(exit code, output, errors, seconds); the exit code is None where the time ran out."""
    start = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL,
                               text=True, errors="replace", start_new_session=True)
    try:
        output, errors = process.communicate(timeout=timeout)
        code = process.returncode
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output, errors = process.communicate()
        code = None
    return code, output, errors, time.monotonic() - start


def has_command(program, name):
    """Whether the help of the program lists a command."""
    try:
        help_text = subprocess.run([program, "--help"], capture_output=True, text=True, timeout=30).stdout
    except (OSError, subprocess.TimeoutExpired):
        return False
    return re.search(rf"^\s+{name}\s", help_text, re.MULTILINE) is not None


def _read_result(path, faults):
    """The document of result.json, and a fault where a number in it is none."""
    wrong = []
    try:
        document = json.loads(path.read_text(encoding="utf-8"), parse_constant=lambda word: wrong.append(word))
    except (OSError, ValueError) as error:
        faults.append(f"result.json cannot be read: {error}")
        return None
    if wrong:
        faults.append(f"result.json holds {wrong[0]}")
    return document


def _vtu_arrays(text):
    """(name, numbers) of the Float64 arrays of a .vtu file."""
    for name, data in re.findall(r'<DataArray type="Float64" Name="([^"]+)"[^>]*format="binary">([^<]*)<', text):
        raw = base64.b64decode(data)
        yield name, struct.unpack(f"<{(len(raw) - 8) // 8}d", raw[8:])


def not_a_number(folder):
    """Sentences on numbers that are none in the files of a run; gaps of nodes that face nothing aside."""
    found = []
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder)
        if path.suffix == ".vtu":
            for array, numbers in _vtu_arrays(path.read_text(encoding="utf-8")):
                wrong = [x for x in numbers if math.isinf(x) or math.isnan(x) and not array.startswith("gap")]
                if wrong:
                    found.append(f"{name}: {array} holds {wrong[0]}")
        elif path.suffix in (".json", ".csv", ".svg") and path.name != "result.json":
            match = re.search(r"(?<![\w.])[-+]?(?:nan|inf|NaN|Infinity)(?![\w.])", path.read_text(encoding="utf-8"))
            if match:
                found.append(f"{name} holds {match.group()}")
    return found


def _certificate(program, folder, timeout):
    """`holds`, `fails` or `unknown`, and what verify says."""
    code, output, errors, _ = execute([program, "verify", str(folder)], timeout)
    return {0: "holds", 3: "fails"}.get(code, "unknown"), (output + errors).strip()


def _summary(document):
    """Of result.json what the table shows and answers are held against."""
    steps = document["steps"]
    cost = document.get("cost", {})
    return {
        "status": document["status"], "message": document.get("message", ""),
        "warnings": [{"code": w["code"], "text": w.get("text", "")} for w in document.get("warnings", [])],
        "newton": [step.get("newton", 0) for step in steps],
        "augmentations": [step.get("augmentations", 0) for step in steps],
        "cutbacks": sum(step.get("cutbacks", 0) for step in steps), "steps": len(steps),
        "condition": cost.get("condition_estimate"),
        "objectives": document.get("objectives", {}),
        "path": [{"time": step["time"], "responses": step.get("responses"), "sensitivities": step.get("sensitivities"),
                  "one_sided": step.get("one_sided")} for step in steps],
    }


def run_case(program, case, method, folder, timeout, verify):
    """The row of a case by a method; what is wrong with it apart from its answers is in `faults`."""
    if folder.exists():
        shutil.rmtree(folder)
    command = [program, "run", str(case.path), "-m", method, "-o", str(folder), "--report"]
    row = {"case": case.name, "method": method, "status": "", "message": "", "warnings": [], "faults": [],
           "certificate": "", "certificate_text": "", "path": []}
    try:
        code, output, errors, row["seconds"] = execute(command, timeout)
    except OSError as error:
        return {**row, "status": "crash", "message": str(error), "seconds": 0.0, "exit": None}
    row["exit"] = code
    said = errors.replace(str(case.path.parent) + os.sep, "").strip()[-4000:]
    if code is None:
        return {**row, "status": "hang", "message": f"no end within {timeout:g} s"}
    if code == 2:
        return {**row, "status": "refused", "message": said}
    if code not in (0, 3):
        return {**row, "status": "crash", "message": f"exit code {code}. {said}"}
    document = _read_result(folder / "result.json", row["faults"])
    try:
        row.update(_summary(document))
    except (TypeError, KeyError) as error:
        return {**row, "status": "crash", "message": f"exit code {code}, and no whole result.json ({error}). {said}"}
    if (code == 0) != (row["status"] in SOLVED):
        row["faults"].append(f"exit code {code} does not go with status {row['status']}")
    if row["status"] in SOLVED:
        row["faults"] += not_a_number(folder)
        if verify:
            row["certificate"], row["certificate_text"] = _certificate(program, folder, timeout)
    return row
