#!/usr/bin/env python3
"""Breaks the inputs of stickslip at random and looks for exit code 1, signals and hangs.

    tools/fuzz.py STICKSLIP SOURCE_DIR [--kind scene|study|row|command]... [--count N] [--seconds S] [--seed N]
                  [--keep DIR]

N inputs of each kind (1000), S seconds in all at most (no limit). Inputs are shipped and small scenes, studies of these,
records of a finished study, and command lines; each is changed in its structure (values replaced, keys renamed, left
out, given twice, parts moved) or in its bytes. Every run has 2 GB and 20 seconds. The same seed gives the same inputs.
What failed is kept in DIR with the command that repeats it. Exit code 1 where something failed.
"""
import argparse
import collections
import copy
import json
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ALLOWED = (0, 2, 3)
SECONDS, BYTES = 20, 2 << 30

BLOCK = {
    "title": "a block",
    "bodies": {"block": {"mesh": {"box": {"min": [0, 0], "max": [4, 2], "cells": [3, 2]}},
                         "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}}},
    "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
    "contacts": {"sole": {"slave": "block.bottom", "master": "floor", "friction": 0.3}},
    "supports": [{"on": "block.top", "move": {"x": [[0, 0], [1, 0.01]], "y": -0.01}}],
    "time": {"end": 1, "steps": 2},
    "responses": {"pull": {"reaction": {"on": "block.top", "component": "x"}}},
    "objectives": {"J": {"of": "pull", "sum": True}},
    "parameters": {"mu": "/contacts/sole/friction", "height": "/bodies/block/mesh/box/max/1"},
    "output": {"fields": "all"},
    "linear_solver": {"engine": "auto"},
    "method": {"monolithic_al": {"scale": 1}},
}
PAIR = {
    "space": "plane_stress",
    "bodies": {"a": {"mesh": {"quad": {"corners": [[0, 0], [2, 0], [2, 1], [0, 1]], "cells": [2, 1]}}, "thickness": 2,
                     "material": {"linear_elastic": {"E": 1000, "nu": 0.2}}, "element": "Q8"},
               "b": {"mesh": {"half_disk": {"center": [1, 2], "radius": 1, "cells": [2, 2], "facing": "down"}},
                     "material": {"linear_elastic": {"E": 500, "nu": 0.3}}}},
    "contacts": {"touch": {"slave": "b.arc", "master": "a.top", "friction": 0.2, "discretization": "segment"}},
    "supports": [{"on": "a.bottom", "move": {"x": 0, "y": 0}}, {"on": "b.flat", "move": {"x": 0.001, "y": -0.01}}],
    "time": {"legs": [[1, 1], [2, 1]]},
    "responses": {"press": {"contact_force": {"contact": "touch", "component": "normal"}},
                  "width": {"contact_half_width": {"contact": "touch"}}},
    "parameters": {"E": {"/bodies/a/material/linear_elastic/E": 1},
                   "shape": {"shape": {"side": "a.top", "direction": [0, 1]}}},
    "sensitivity": {"mode": "direct"},
    "method": {"uzawa_al": {"tolerance": 1e-6, "acceleration": "anderson"}},
}
STUDY = {"title": "a study", "scene": "scene.json",
         "methods": [{"penalty": {"stiffness": [10, 1e3]}}, {"uzawa_al": {}}, {"monolithic_al": {"scale": [1]}}],
         "vary": {"/time/steps": [1]}, "refine": [0],
         "reference": [{"method": {"monolithic_al": {}}}, {"values": {"pull": 1}}], "errors": ["response:*", "kkt"],
         "timing": {"repeat": 1}}

NUMBERS = [0, -0.0, 1, -1, 2, 0.5, 1e-12, -1e-300, 5e-324, 1e16, 1e155, 1.7e308, -1e308, 1e7, 2**31, 2**63, 2**64, 3, 90,
           180, 360, 0.49999999, 1e-5, 7]
TEXTS = ["", "auto", "x", "block.top", "block.left & block.bottom", "a.top", "floor", "mean", "\u001b[2J", "=1+1", "\u0000",
         "\u202e", "a/b~0", "penalty", "all", "/contacts/sole/friction", "solid", "axisymmetric", "T6", "Q8", "é" * 50]
OTHERS = [None, True, False, [], {}, [0], [[0, 0], [1, 1]], {"x": 1}, {"absolute": 100}, {"table": [[0, 0], [1, 0]],
          "repeat": 3}, [1, 2, 3, 4, 5], "auto"]


class Fuzzer:
    def __init__(self, program, source, chance, work):
        self.program, self.chance, self.work = program, chance, work
        self.scenes = [BLOCK, PAIR] + [self.small(source / "studies" / "scenes" / f"{name}.json")
                                       for name in ("slider", "stop", "stop_bars", "belt", "tractrix", "greco_plate")]
        self.finished = None

    @staticmethod
    def small(path):
        """A shipped scene with few cells and steps."""
        text = "\n".join(re.sub(r"^\s*//.*|\s//.*", "", line) for line in path.read_text().splitlines())
        scene = json.loads(text)
        if "legs" in scene["time"]:
            scene["time"]["legs"] = [[end, 1] for end, _ in scene["time"]["legs"]]
        else:
            scene["time"]["steps"] = min(scene["time"]["steps"], 2)
        for body in scene["bodies"].values():
            for mesh in body["mesh"].values():
                if isinstance(mesh, dict) and "cells" in mesh:
                    cells = mesh["cells"]
                    mesh["cells"] = [min(n, 3) for n in cells] if isinstance(cells, list) else min(cells, 4)
        return scene

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
            container[key] = copy.deepcopy(other[at]) if at in (other if isinstance(other, dict) else range(len(other))) else 0
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
            if key == "refine":  # a level more is four times as much
                container[key] = json.loads(re.sub(r"\b([3-9]|1[0-2])\b", "2", json.dumps(container[key])))
        for container, key in self.places(node):
            n = container[key]
            if isinstance(n, (int, float)) and not isinstance(n, bool) and 12 < abs(n) < 1e6 and key != "E":
                inside = json.dumps(container)
                if key in ("cells", "steps", "repeat", "refine", "max_iterations", "max_augmentations") or (
                        isinstance(container, list) and all(isinstance(x, (int, float)) for x in container)) or "legs" in inside:
                    container[key] = 5
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
                data[at:at] = self.chance.choice([b"\x00", b"\xff", b"{", b"]", b",", b'"', b"1e999", b"-", b"//", b"\n"])
            elif kind == 3:
                del data[at:]
            else:
                end = min(len(data), at + self.chance.randrange(1, 40))
                data[at:at] = data[at:end]
        return bytes(data)

    def text(self, document):
        """A document changed in its structure, its bytes or both."""
        document = copy.deepcopy(document)
        for _ in range(self.chance.choice([0, 1, 1, 1, 2, 4])):
            self.change(document)
        text = json.dumps(self.bounded(document)).encode()
        return self.bytes_changed(text) if self.chance.random() < 0.3 else text

    # ---- kinds of input ----------------------------------------------------------------------------------------------

    def scene(self):
        path = self.work / "scene.json"
        path.write_bytes(self.text(self.chance.choice(self.scenes)))
        command = self.chance.choice([["run", "--json"]] * 4 + [["explain"], ["gradcheck", "--json"], ["run", "-o", "out"]])
        method = self.chance.choice([[], [], ["-m", self.chance.choice(["penalty", "uzawa_al", "monolithic_al"])]])
        return [command[0], str(path), *command[1:], *method]

    def study(self):
        scene = self.chance.choice(self.scenes)
        document = dict(copy.deepcopy(STUDY))
        names = list(scene.get("responses", {}))
        document["reference"][1]["values"] = {names[0]: 1}
        if self.chance.random() < 0.5:  # most changes of a study make it invalid: the cells of these run
            scene = copy.deepcopy(scene)
            for _ in range(self.chance.choice([1, 2, 3])):
                container, key = self.chance.choice([(c, k) for c, k in self.places(scene) if isinstance(c[k], float)
                                                     or isinstance(c[k], int) and k not in (True, False)])
                container[key] = self.chance.choice([0, -1, 1e3, 1e-6, 1e6, 0.5, 3]) * (container[key] or 1)
            (self.work / "scene.json").write_text(json.dumps(self.bounded(scene)))
            (self.work / "a.study.json").write_text(json.dumps(document))
        else:
            (self.work / "scene.json").write_text(json.dumps(scene))
            (self.work / "a.study.json").write_bytes(self.text(document))
        shutil.rmtree(self.work / "out", ignore_errors=True)
        return ["study", str(self.work / "a.study.json"), "-o", "out"]

    def row(self):
        if self.finished is None:
            self.finished = self.work / "finished"
            (self.work / "sound.json").write_text(json.dumps(BLOCK))
            (self.work / "sound.study.json").write_text(json.dumps(dict(STUDY, scene="sound.json")))
            subprocess.run([self.program, "study", self.work / "sound.study.json", "-o", self.finished], check=True,
                           capture_output=True)
        out = self.work / "out"
        shutil.rmtree(out, ignore_errors=True)
        shutil.copytree(self.finished, out)
        name = self.chance.choice(["results.jsonl"] * 4 + ["study.json", "picture.json", "timings.jsonl"])
        lines = (out / name).read_bytes().splitlines() if name.endswith("l") else [(out / name).read_bytes()]
        at = self.chance.randrange(len(lines))
        row = json.loads(lines[at])
        if self.chance.random() < 0.3 and "provenance" in row:
            row["provenance"].pop("checksum", None)  # as another version wrote it
        lines[at] = self.text(row)
        (out / name).write_bytes(b"\n".join(lines) + b"\n" * self.chance.choice([0, 1, 1, 1]))
        return self.chance.choice([
            ["report", "out"], ["report", "out"], ["compare", "finished", "out"], ["compare", "out", "finished", "--json"],
            ["merge", "out", "-o", "joined"], ["study", str(self.work / "sound.study.json"), "-o", "out", "--resume"]])

    def command(self):
        (self.work / "sound.json").write_text(json.dumps(self.chance.choice(self.scenes)))
        (self.work / "sound.study.json").write_text(json.dumps(dict(STUDY, scene="sound.json", reference=[])))
        words = ["run", "study", "explain", "gradcheck", "report", "merge", "compare", "methods", "schema", "--version",
                 "--help", "-m", "--set", "-o", "--json", "--resume", "--restart", "--shard", "-j", "--trace", "--export",
                 "sound.json", "sound.study.json", "out", "nowhere", "", "-", "--", "/dev/null", ".", "penalty", "1/2",
                 "2", "1", "scene", "--relative", "1e-3", "/time/steps=1", "/contacts/sole/friction=0.4", "/title=a",
                 "/method={}", "/bodies/block/mesh/box/cells/0=2", "/a~2=1", "=", "/=1", "/time=[", "/parameters/p=1"]
        good = [["run", "sound.json", "--json"], ["study", "sound.study.json", "-o", "out", "--restart"],
                ["explain", "sound.json"], ["gradcheck", "sound.json", "--json"], ["report", "out"], ["methods"],
                ["merge", "out", "-o", "joined"], ["compare", "out", "out"], ["schema", "study"]]
        arguments = list(self.chance.choice(good)) if self.chance.random() < 0.8 else []
        for _ in range(self.chance.choice([0, 1, 1, 2, 3, 6])):
            word = self.chance.choice(words)
            if self.chance.random() < 0.2:
                word = self.bytes_changed(word.encode()).replace(b"\x00", b"")
            at = self.chance.randint(0, len(arguments))
            arguments[at:at + self.chance.choice([0, 0, 1])] = [word]
        if self.chance.random() < 0.4:
            pointer, value = self.chance.choice(self.pointers()), self.chance.choice(NUMBERS[:8] + TEXTS[:8] + OTHERS)
            arguments += ["--set", f"{pointer}={json.dumps(value)}"]
        return [a for a in arguments if a not in ("-h",)]

    def pointers(self):
        def below(node, at):
            yield at
            for key, child in node.items() if isinstance(node, dict) else enumerate(node):
                if isinstance(child, (dict, list)):
                    yield from below(child, f"{at}/{key}")
                else:
                    yield f"{at}/{key}"
        return list(below(BLOCK, ""))

    # ---- runs --------------------------------------------------------------------------------------------------------

    def run(self, arguments):
        """What went wrong, or "", and the exit code."""
        limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
        try:
            result = subprocess.run([self.program, *arguments], cwd=self.work, stdin=subprocess.DEVNULL,
                                    capture_output=True, timeout=SECONDS, preexec_fn=limit)
        except subprocess.TimeoutExpired:
            return f"more than {SECONDS} seconds", "slow"
        code = result.returncode
        return "" if code in ALLOWED else f"exit code {code}: {result.stderr.decode(errors='replace')[-400:]}", code


def keep(work, directory, name, arguments, fault):
    target = directory / name
    shutil.copytree(work, target, ignore=shutil.ignore_patterns("finished"))
    (target / "command").write_bytes(b"stickslip " + b" ".join(a if isinstance(a, bytes) else a.encode() for a in arguments))
    (target / "fault").write_text(fault)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda p: str(Path(p).resolve()))
    parser.add_argument("source", type=Path)
    parser.add_argument("--kind", action="append", choices=["scene", "study", "row", "command"])
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path)
    options = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    end, failed = time.monotonic() + options.seconds, 0
    for kind in options.kind or ["scene", "study", "row", "command"]:
        codes = collections.Counter()
        with tempfile.TemporaryDirectory() as folder:
            chance = random.Random(f"{options.seed} {kind}")
            fuzzer = Fuzzer(options.program, options.source, chance, Path(folder))
            for i in range(options.count):
                if time.monotonic() > end:
                    break
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
