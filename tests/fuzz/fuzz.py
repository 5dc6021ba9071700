#!/usr/bin/env python3
"""Breaks the inputs of stickslip at random and looks for what no input may cause.

    tests/fuzz/fuzz.py STICKSLIP SOURCE_DIR [--kind scene|study|mesh|result|command]... [--count N] [--seconds S]
                       [--seed N] [--keep DIR]

N inputs of each kind (1000), S seconds in all at most (no limit). Inputs are shipped scenes, those of tests/cases and
small ones (scenes.py), studies of these, mesh files (meshes.py), the folder of a finished run and of a finished study,
and command lines. Each is changed in its structure (values replaced, keys renamed, left out, given twice, parts moved),
in its numbers and choices alone, so that it mostly stays valid, or in its bytes. Every run has 2 GB and 20 seconds,
of many runs (study, gradcheck) 100.
The same seed and sources give the same inputs. A fault is

    a signal, exit code 1, more than that time
    exit code 0 of a run that did not converge, or 3 of one that did
    after exit code 0 a number that is none in any file (gaps of points that face nothing aside, and fields of a study,
    whose last cell may have failed)
    a control character in what is printed or written
    a scene, study or mesh that is changed, a lock or a half-written file that is left

What failed is kept in DIR with the command that repeats it. Exit code 1 where something failed.
"""
import argparse
import base64
import collections
import copy
import json
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from meshes import mesh as changed_mesh
from scenes import BLOCK, MESHED, STUDY, starting_scenes

ALLOWED = (0, 2, 3)
SECONDS, BYTES = 20, 2 << 30  # of the processor, as other work may take the machine; in all up to ten times as many

NUMBERS = [0, -0.0, 1, -1, 2, 0.5, 1e-12, -1e-300, 5e-324, 1e16, 1e155, 1.7e308, -1e308, 1e7, 2**31, 2**63, 2**64, 3,
           90, 180, 360, 0.49999999, 1e-5, 7]
TEXTS = ["", "auto", "x", "block.top", "block.left & block.bottom", "a.top", "floor", "mean", "\u001b[2J", "=1+1",
         "\u0000", "\u202e", "a/b~0", "penalty", "all", "/contacts/sole/friction", "solid", "axisymmetric", "T6", "Q8",
         "é" * 50]
OTHERS = [None, True, False, [], {}, [0], [[0, 0], [1, 1]], {"x": 1}, {"absolute": 100}, {"table": [[0, 0], [1, 0]],
          "repeat": 3}, [1, 2, 3, 4, 5], "auto"]


CHOICES = [
    ("strain", ["small", "finite"]), ("space", ["plane_strain", "plane_stress", "axisymmetric"]),
    ("surface", ["faceted", "smooth", {"smooth": "b_spline"}, {"smooth": "catmull_rom", "corner": 60}]),
    ("discretization", ["node", "segment"]), ("engine", ["auto", "sparse", "condensed"]),
    ("backend", ["auto", "eigen", "mumps", "cholmod"]), ("fields", ["all", "last", 2]),
    ("element", ["Q4", "T3", "Q8", "T6", "Q4_mean_dilatation"]),
    ("friction", [0, 0.3, 1, 20, {"coulomb": 0.3, "limit": 1}, {"tresca": 1}])]
METHODS = [
    {"penalty": {}}, {"penalty": {"stiffness": 10}}, {"penalty": {"stiffness": 1e7, "tangential_ratio": 0.1}},
    {"uzawa_al": {}}, {"uzawa_al": {"sensitivity": "truncated"}}, {"uzawa_al": {"sensitivity": "oversized"}},
    {"uzawa_al": {"sensitivity": "preconditioned"}}, {"uzawa_al": {"acceleration": "anderson"}},
    {"uzawa_al": {"acceleration": "aitken"}}, {"uzawa_al": {"cone": "frozen", "adapt": False}},
    {"monolithic_al": {}}, {"monolithic_al": {"scale": 100}}, {"monolithic_al": {"cone": "multiplier"}}]


def pointers(node, at=""):
    """JSON pointers of all below a node."""
    found = [at]
    for key, child in node.items() if isinstance(node, dict) else enumerate(node):
        below = f"{at}/{str(key).replace('~', '~0').replace('/', '~1')}"
        found += pointers(child, below) if isinstance(child, (dict, list)) else [below]
    return found


MANY_RUNS = 5  # a command of many runs has so many times the seconds


class Fuzzer:
    def __init__(self, program, source, chance, work):
        self.program, self.chance, self.work = program, chance, work
        self.scenes = starting_scenes(source)
        self.finished = None

    # ---- changes -----------------------------------------------------------------------------------------------------

    def value(self):
        return copy.deepcopy(self.chance.choice(self.chance.choice([NUMBERS, NUMBERS, TEXTS, OTHERS])))

    @staticmethod
    def places(node):
        """(container, key) of everything below."""
        found = []
        for key, child in list(node.items()) if isinstance(node, dict) else list(enumerate(node)):
            found.append((node, key))
            if isinstance(child, (dict, list)):
                found += Fuzzer.places(child)
        return found

    def change(self, document):
        """One change of the structure, in place."""
        places = self.places(document)
        if not places:
            return
        numbers = [(c, k) for c, k in places if isinstance(c[k], (int, float)) and not isinstance(c[k], bool)]
        container, key = self.chance.choice(numbers if numbers and self.chance.random() < 0.5 else places)
        kind = self.chance.choice([0, 1, 2, 3, 4, 5, 6, 6, 6, 6, 6, 7, 8])
        child = container[key]
        if kind <= 2:
            container[key] = self.value()
        elif kind == 3:
            del container[key]
        elif kind == 4 and isinstance(container, dict):
            container[self.chance.choice(TEXTS + [key + "x", key[1:]])] = container.pop(key)
        elif kind == 5:
            other, at = self.chance.choice(places)
            there = other if isinstance(other, dict) else range(len(other))
            container[key] = copy.deepcopy(other[at]) if at in there else 0
        elif kind == 6 and isinstance(child, (int, float)) and not isinstance(child, bool):
            container[key] = child * 10.0 ** self.chance.randint(-9, 9) * self.chance.choice([1, 1, -1])
        elif kind == 7 and isinstance(container, list):
            container.insert(self.chance.randint(0, len(container)), copy.deepcopy(child))
        elif isinstance(container, dict):
            container[self.chance.choice(["method", "extra", "move", "fields", "grade", "take"])] = self.value()
        else:
            container.append(self.value())

    def bounded(self, node):
        """Counts that would only take long, as 5000 steps, made small; those beyond memory stay."""
        for container, key in self.places(node):
            n = container[key]
            if isinstance(n, (int, float)) and not isinstance(n, bool) and 12 < abs(n) < 1e6 and key != "E":
                inside = json.dumps(container)
                numbers = isinstance(container, list) and all(isinstance(x, (int, float)) for x in container)
                counts = ("cells", "steps", "repeat", "refine", "max_iterations", "max_augmentations")
                if key in counts or numbers or "legs" in inside:
                    container[key] = 5
        for container, key in self.places(node):
            if key == "refine":  # a level more is four times as much
                container[key] = json.loads(re.sub(r"\b([3-9]|1[0-2])\b", "2", json.dumps(container[key])))
        return node

    def bytes_changed(self, text):
        data = bytearray(text)
        for _ in range(self.chance.choice([1, 1, 2, 5])):
            at = self.chance.randrange(len(data) + 1)
            kind = self.chance.randrange(5)
            if kind == 0 and data:
                data[min(at, len(data) - 1)] = self.chance.randrange(256)
            elif kind == 1:
                data[at:at + self.chance.choice([1, 3, 20])] = b""
            elif kind == 2:
                data[at:at] = self.chance.choice([b"\x00", b"\xff", b"{", b"]", b",", b'"', b"1e999", b"-", b"//",
                                                  b"\n"])
            elif kind == 3:
                del data[at:]
            else:
                end = min(len(data), at + self.chance.randrange(1, 40))
                data[at:at] = data[at:end]
        return bytes(data)

    def varied(self, scene):
        """A scene with other numbers and choices, most of them allowed."""
        scene, choose = copy.deepcopy(scene), self.chance.choice
        bodies, contacts = scene["bodies"], scene.get("contacts", {})
        meshes = [of for body in bodies.values() for of in body["mesh"].values() if isinstance(of, dict)]
        solids = [body for body in bodies.values() if set(body["mesh"]) & {"box", "quad", "ring", "disk", "half_disk"}]
        for _ in range(choose([1, 1, 2, 3])):
            container, key = choose([(c, k) for c, k in self.places(scene)
                                     if isinstance(c[k], (int, float)) and not isinstance(c[k], bool)])
            if key in ("steps", "cells") or any(container is of.get("cells") for of in meshes):
                container[key] = choose([1, 2, 3, 5])
            else:
                container[key] *= choose([0.5, 0.8, 0.9, 1.1, 1.2, 1.5, 2, 3, 1 + 1e-9, 0, -1, 10, 1e-3, 1e3, 1e-9,
                                          1e9])
        for leg in scene["time"].get("legs", []):
            leg[1] = max(1, round(leg[1])) if isinstance(leg[1], float) and leg[1] < 1e6 else leg[1]
        for _ in range(choose([0, 1, 2])):
            name, values = choose(CHOICES)
            of = {"strain": [scene], "space": [scene], "engine": [scene.setdefault("linear_solver", {})],
                  "backend": [scene.setdefault("linear_solver", {})], "fields": [scene.setdefault("output", {})],
                  "element": solids}.get(name, list(contacts.values()))
            for each in of if choose([True, False]) else of[:1]:
                each[name] = copy.deepcopy(choose(values))
        for body in solids:  # the material that goes with the strain
            if set(body["material"]) <= {"linear_elastic", "neo_hookean"}:
                (numbers,) = body["material"].values()
                body["material"] = {"neo_hookean" if scene.get("strain") == "finite" else "linear_elastic": numbers}
        if choose([True, False]):
            scene["method"] = copy.deepcopy(choose(METHODS))
        if contacts and solids and self.chance.random() < 0.2:
            alone = len(solids) == 1
            scene["contacts"] = {"all": {"between": "all", "friction": 0.2, "self": alone or choose([True, False])}}
            scene["responses"] = {"energy": {"strain_energy": {}}}
            scene.pop("objectives", None)
            scene["parameters"] = {"mu": "/contacts/all/friction"}
        if scene.get("responses") and scene.get("parameters") and self.chance.random() < 0.3:
            scene["objectives"] = {"J": {"of": choose(list(scene["responses"])), "sum": True}}
            scene["sensitivity"] = {"mode": "adjoint", "memory": choose([1e-6, 1e-3, 1])}
        return scene

    def text(self, document):
        """A document changed in its structure, its bytes or both."""
        document = copy.deepcopy(document)
        for _ in range(self.chance.choice([0, 1, 1, 1, 2, 4])):
            self.change(document)
        text = json.dumps(self.bounded(document)).encode()
        return self.bytes_changed(text) if self.chance.random() < 0.3 else text

    # ---- kinds of input ----------------------------------------------------------------------------------------------

    def fresh(self):
        """The folder of a run that begins: nothing of the last is left."""
        for path in self.work.iterdir():
            if path.name in KEPT:
                continue
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            else:
                path.unlink()

    def scene(self):
        path = self.work / "scene.json"
        scene = self.chance.choice(self.scenes)
        if self.chance.random() < 0.5:
            path.write_text(json.dumps(self.varied(scene)))
        else:
            path.write_bytes(self.text(scene))
        command = self.chance.choice([["run", "--json"]] * 3 + [
            ["explain"], ["gradcheck", "--json"], ["run", "-o", "out"], ["run", "-o", "out", "--report"],
            ["run", "-o", "out", "--trace"], ["run", "-o", "out", "--export", "system"]])
        method = self.chance.choice([[], [], ["-m", self.chance.choice(["penalty", "uzawa_al", "monolithic_al"])]])
        return [command[0], str(path), *command[1:], *method]

    def mesh(self):
        lines = changed_mesh(self.chance)
        data = "\n".join(lines).encode() + b"\n" * self.chance.choice([0, 1, 1])
        if self.chance.random() < 0.2:
            data = self.bytes_changed(data)
        if self.chance.random() < 0.1:
            data = data.replace(b"\n", b"\r\n")
        (self.work / "mesh.msh").write_bytes(data)
        scene = copy.deepcopy(MESHED)
        if self.chance.random() < 0.2:
            scene["bodies"]["body"]["mesh"]["body"] = self.chance.choice(["bottom", "3", "", "nothing"])
        if self.chance.random() < 0.2:
            scene["strain"] = "finite"
            scene["bodies"]["body"]["material"] = {"neo_hookean": {"E": 1000, "nu": 0.3}}
        (self.work / "scene.json").write_text(json.dumps(scene))
        return self.chance.choice([["run", "scene.json", "--json"]] * 3 + [["explain", "scene.json"]])

    def study(self):
        scene = self.chance.choice(self.scenes)
        document = copy.deepcopy(STUDY)
        names = list(scene.get("responses", {}))
        document["reference"][1]["values"] = {name: 1 for name in names[:1]}
        if self.chance.random() < 0.3:
            document["error_budget"] = True
        if self.chance.random() < 0.5:  # most changes of a study make it invalid: the cells of these run
            (self.work / "scene.json").write_text(json.dumps(self.varied(scene)))
            (self.work / "a.study.json").write_text(json.dumps(document))
        else:
            (self.work / "scene.json").write_text(json.dumps(scene))
            (self.work / "a.study.json").write_bytes(self.text(document))
        return ["study", "a.study.json", "-o", "out"]

    def finish(self):
        """What hand-edited results begin from: a finished run, and a finished study."""
        self.finished = self.work / "finished"
        (self.work / "sound.json").write_text(json.dumps(BLOCK))
        (self.work / "sound.study.json").write_text(json.dumps(dict(STUDY, scene="sound.json")))
        for command in (["run", "sound.json", "-o", "finished/run", "--report", "--trace"],
                        ["study", "sound.study.json", "-o", "finished/study"]):
            subprocess.run([self.program, *command], check=True, capture_output=True, cwd=self.work)

    def result(self):
        if self.finished is None:
            self.finish()
        kind = self.chance.choice(["run", "study", "study"])
        out = self.work / "out"
        shutil.copytree(self.finished / kind, out)
        for _ in range(self.chance.choice([1, 1, 1, 2])):
            self.edit(out, kind)
        run = [["report", "out"], ["report", "out"], ["run", "sound.json", "-o", "out"],
               ["compare", "out", "finished/study"], ["run", "out/result.json", "--json"],
               ["run", "sound.json", "-o", "out", "--report"]]
        study = [["report", "out"], ["report", "out"], ["compare", "finished/study", "out"],
                 ["compare", "out", "finished/study", "--json"], ["merge", "out", "-o", "joined"],
                 ["merge", "out", "finished/study", "-o", "joined"],
                 ["study", "sound.study.json", "-o", "out", "--resume"],
                 ["study", "sound.study.json", "-o", "out", "--restart"], ["run", "sound.json", "-o", "out"]]
        return self.chance.choice(run if kind == "run" else study)

    def edit(self, out, kind):
        """A record that is changed by hand: its numbers, its bytes, or what kind of file it is."""
        likely = {"run": ["result.json"] * 3 + ["picture.json"] * 3,
                  "study": ["results.jsonl"] * 4 + ["study.json", "picture.json", "timings.jsonl"]}[kind]
        files = sorted(path.name for path in out.iterdir() if path.is_file() and not path.is_symlink())
        name = self.chance.choice(likely if self.chance.random() < 0.8 else files)
        if not (out / name).is_file():
            return
        how = self.chance.random()
        if how < 0.1:  # no file any more, or another
            (out / name).unlink()
            other = self.chance.choice(["none", "folder", "loop", "link"])
            if other == "folder":
                (out / name).mkdir()
            elif other != "none":
                (out / name).symlink_to(name if other == "loop" else "/dev/null")
            return
        data = (out / name).read_bytes()
        if how < 0.25 or not name.endswith(("json", "jsonl")):
            (out / name).write_bytes(self.bytes_changed(data))
            return
        lines = data.splitlines() if name.endswith("l") else [data]
        if not lines:
            return
        at = self.chance.randrange(len(lines))
        try:
            row = json.loads(lines[at])
        except ValueError:
            return
        if self.chance.random() < 0.5 and isinstance(row, dict) and isinstance(row.get("provenance"), dict):
            row["provenance"].pop("checksum", None)  # as another version wrote it
        lines[at] = self.text(row)
        if self.chance.random() < 0.1:
            lines.insert(self.chance.randrange(len(lines) + 1), lines[at])
        (out / name).write_bytes(b"\n".join(lines) + b"\n" * self.chance.choice([0, 1, 1, 1]))

    def command(self):
        scene = self.chance.choice(self.scenes)
        (self.work / "sound.json").write_text(json.dumps(scene))
        (self.work / "sound.study.json").write_text(json.dumps(dict(STUDY, scene="sound.json", reference=[])))
        words = ["run", "study", "explain", "gradcheck", "report", "merge", "compare", "methods", "schema", "--version",
                 "--help", "-m", "--set", "-o", "--json", "--resume", "--restart", "--shard", "-j", "--trace",
                 "--export", "sound.json", "sound.study.json", "out", "nowhere", "", "-", "--", "/dev/null", ".",
                 "penalty", "1/2",
                 "2", "1", "scene", "--relative", "1e-3", "/time/steps=1", "/contacts/sole/friction=0.4", "/title=a",
                 "/method={}", "/bodies/block/mesh/box/cells/0=2", "/a~2=1", "=", "/=1", "/time=[", "/parameters/p=1"]
        good = [["run", "sound.json", "--json"], ["study", "sound.study.json", "-o", "out", "--restart"],
                ["explain", "sound.json"], ["gradcheck", "sound.json", "--json"], ["report", "out"], ["methods"],
                ["merge", "out", "-o", "joined"], ["compare", "out", "out"], ["schema", "study"]]
        arguments = list(self.chance.choice(good)) if self.chance.random() < 0.8 else []
        for _ in range(self.chance.choice([0, 0, 0, 1, 1, 2, 3, 6])):
            word = self.chance.choice(words)
            if self.chance.random() < 0.2:
                word = self.bytes_changed(word.encode()).replace(b"\x00", b"")
            at = self.chance.randint(0, len(arguments))
            arguments[at:at + self.chance.choice([0, 0, 1])] = [word]
        if self.chance.random() < 0.4:
            pointer, value = self.chance.choice(pointers(scene)), self.chance.choice(NUMBERS[:8] + TEXTS[:8] + OTHERS)
            arguments += ["--set", f"{pointer}={json.dumps(value)}"]
        return arguments

    # ---- runs --------------------------------------------------------------------------------------------------------

    def run(self, arguments):
        """What went wrong, or "", and the exit code."""
        seconds = SECONDS * (MANY_RUNS if arguments[:1] in (["gradcheck"], ["study"]) else 1)
        inputs = {path: path.read_bytes() for path in self.work.glob("*.*") if path.is_file()}

        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))

        try:
            result = subprocess.run([self.program, *arguments], cwd=self.work, stdin=subprocess.DEVNULL,
                                    capture_output=True, timeout=10 * seconds, preexec_fn=limit)
        except subprocess.TimeoutExpired:
            return f"more than {10 * seconds} seconds in all", "slow"
        code = result.returncode
        if code == -signal.SIGXCPU:
            return f"more than {seconds} seconds", "slow"
        if code not in ALLOWED:
            return f"exit code {code}: {result.stderr.decode(errors='replace')[-400:]}", code
        for path, data in inputs.items():
            if not path.is_file() or path.read_bytes() != data:
                return f"{path.name} was changed", code
        return self.false_answer(arguments, code, result) or self.bad_output(code, result, set(inputs.values())), code

    def false_answer(self, arguments, code, result):
        """Where the exit code of a run is not that of its status."""
        if arguments[:1] != ["run"] or code == 2:
            return ""
        path = self.work / "out" / "result.json"
        try:
            document = json.loads(result.stdout) if "--json" in arguments else json.loads(path.read_bytes())
        except (OSError, ValueError):
            return ""
        status = document.get("status") if isinstance(document, dict) else None
        converged = status in ("converged", "converged_at_roundoff")
        return f"status {status} with exit code {code}" if converged != (code == 0) else ""

    def bad_output(self, code, result, given):
        """`given`: contents of the inputs, of which merge copies some as they are."""
        for name, text in (("standard output", result.stdout), ("standard error", result.stderr)):
            if found := CONTROL.search(text):
                return f"a control character in {name}: {text[max(0, found.start() - 60):found.end() + 20]!r}"
        for path in self.written():
            if path.name == ".lock" or path.name.endswith(".part"):
                return f"{path.name} is left"
            data = path.read_bytes()
            if data not in given and path.suffix in TEXT_FILES and (found := CONTROL.search(data)):
                return f"a control character in {path.name}: {data[max(0, found.start() - 60):found.end() + 20]!r}"
            if code == 0 and path.suffix in (".json", ".jsonl", ".csv", ".svg") and (found := NO_NUMBER.search(data)):
                return f"no number in {path.name}: {data[max(0, found.start() - 60):found.end() + 20]!r}"
            if code == 0 and self.kind == "scene" and path.suffix == ".vtu" and (name := array_with_no_number(data)):
                return f"no number in {name} of {path.name}"
        if code == 0 and (found := NO_NUMBER.search(result.stdout)):
            return f"no number in standard output: {result.stdout[max(0, found.start() - 60):found.end() + 20]!r}"
        return ""

    def written(self):
        """Files of the folders that commands write to, but for those that were edited."""
        for name in ("joined", "system") if self.kind == "result" else ("out", "joined", "system"):
            if (self.work / name).is_dir():
                copied = ("picture.json",) if self.kind == "result" else ()  # as it was edited
                yield from (path for path in sorted((self.work / name).rglob("*"))
                            if path.is_file() and path.name not in copied)


KEPT = ("finished", "sound.json", "sound.study.json")
TEXT_FILES = (".json", ".jsonl", ".csv", ".svg", ".html", ".pgf", ".vtu", ".pvd", ".mtx", "")
CONTROL = re.compile(rb"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]|\r(?!\n)")
NO_NUMBER = re.compile(rb"(?<![\w\"'./-])[-+]?(?:nan|inf|infinity)(?![\w\"'./-])", re.IGNORECASE)
ARRAY = re.compile(rb'<DataArray type="Float64" Name="([^"]*)"[^>]*format="binary"[^>]*>\s*([^<]*)</DataArray>')


def array_with_no_number(data):
    """Name of an array of a .vtu file, base 64 with a head of bytes, that holds NaN or infinity; gaps may."""
    for name, text in ARRAY.findall(data):
        content = base64.b64decode(text)
        numbers = struct.unpack(f"<{(len(content) - 8) // 8}d", content[8:8 + (len(content) - 8) // 8 * 8])
        if not name.startswith(b"gap") and any(x != x or abs(x) == float("inf") for x in numbers):
            return name.decode(errors="replace")
    return ""


def keep(work, directory, name, arguments, fault):
    target = directory / name
    shutil.copytree(work, target, symlinks=True, ignore=shutil.ignore_patterns("finished"), dirs_exist_ok=True)
    words = [a if isinstance(a, bytes) else a.encode() for a in arguments]
    (target / "command").write_bytes(b"stickslip " + b" ".join(words))
    (target / "fault").write_text(fault)


KINDS = ("scene", "study", "mesh", "result", "command")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda p: str(Path(p).resolve()))
    parser.add_argument("source", type=Path)
    parser.add_argument("--kind", action="append", choices=KINDS)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path)
    options = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    end, failed = time.monotonic() + options.seconds, 0
    for kind in options.kind or KINDS:
        codes = collections.Counter()
        with tempfile.TemporaryDirectory() as folder:
            chance = random.Random(f"{options.seed} {kind}")
            fuzzer = Fuzzer(options.program, options.source.resolve(), chance, Path(folder))
            fuzzer.kind = kind
            for i in range(options.count):
                if time.monotonic() > end:
                    break
                if kind != "command":  # these meet what others left
                    fuzzer.fresh()
                arguments = getattr(fuzzer, kind)()
                fault, code = fuzzer.run(arguments)
                codes[code] += 1
                if fault:
                    failed += 1
                    print(f"{kind} {i}: {arguments}: {fault}", flush=True)
                    if options.keep:
                        keep(fuzzer.work, options.keep, f"{kind}-{options.seed}-{i}", arguments, fault)
        print(f"{kind}: {sum(codes.values())} inputs, by exit code {dict(codes)}", flush=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
