#!/usr/bin/env python3
"""measured_numbers.py STICKSLIP [--check]: writes the measured numbers of README.md and docs/*.md.
measured_numbers.py --self-test: proves that a stale number is seen.

A number that was measured has a mark behind it, `1.9e-5<!--=penalty error at 1e3-->`, whose words are a name in
quantities() below. The sign says how it is held against what the shipped studies and scenes give now:

    =  rounded to the digits shown (counts: the same)
    ~  within a factor of three: what rounding decides differs between machines
    <  a bound, up to a thousand times what is measured: where rounding decides which augmentation is the last, an error
       differs between machines by what one augmentation takes off, a factor of a hundred

A `%` behind the mark makes it a percentage. With --check nothing is written: exit code 1 where a number is stale, a name
unknown, or a quantity on no page. Outputs in ```console blocks are not marked; tests/docs/replay.py compares those.
Seconds are never written this way: pages give ratios of them, and say where they are from.
"""
import functools
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENES = ROOT / "studies" / "scenes"
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
MARK = re.compile(r"(?P<number>[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?)<!--(?P<sign>[=~<])(?P<name>[^<>]+)-->(?P<percent> %)?")


# ---- what is measured ------------------------------------------------------------------------------------------------

class Program:
    """Runs of the program, each once; what they print beside the results is not looked at."""

    def __init__(self, path, folder):
        self.path, self.folder = str(pathlib.Path(path).resolve()), pathlib.Path(folder)

    def call(self, *arguments):
        done = subprocess.run([self.path, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True)
        if done.returncode not in (0, 3):  # 3: a run that did not converge is a result too
            sys.exit(f"stickslip {' '.join(map(str, arguments))}: {done.stderr}")
        return done.stdout

    @functools.lru_cache(maxsize=None)
    def run(self, scene, *options):
        """result.json of a shipped scene."""
        return json.loads(self.call("run", SCENES / f"{scene}.json", "--json", *options))

    def last(self, scene, response, *options):
        return self.run(scene, *options)["steps"][-1]["responses"][response]

    def slope(self, scene, response, parameter, *options):
        return self.run(scene, *options)["steps"][-1]["sensitivities"][response][parameter]

    @functools.lru_cache(maxsize=None)
    def study(self, name):
        """(rows by label, folder) of a shipped study, without its timing."""
        text = re.sub(r"^\s*//.*$", "", (SCENES / f"{name}.study.json").read_text(), flags=re.M)
        description = json.loads(text)
        description.pop("timing", None)
        return self.study_of(name, description)

    def study_of(self, name, description):
        scene = SCENES / description["scene"]
        file, out = self.folder / f"{name}.study.json", self.folder / name
        file.write_text(json.dumps({**description, "scene": str(scene)}))
        self.call("study", file, "-o", out)
        rows = [json.loads(line) for line in (out / "results.jsonl").read_text().splitlines()]
        return {row["label"]: row for row in rows}, out


def worst(row, kind, of="enforcement"):
    """Largest error of a row's responses or sensitivities."""
    return max(value for name, value in row["errors"][of].items() if name.startswith(kind + ":") and value is not None)


def of_the_figure(program):
    """The study of the README's first screen, and of the figure of docs/methods.md."""
    rows, folder = program.study("cattaneo_mindlin")

    def penalty(stiffness):
        return rows[f"penalty stiffness={stiffness}"]

    def uzawa(tolerance):
        return rows[f"uzawa_al scale=100 tolerance={tolerance}"]

    def count(row, name):
        return row["cost"]["counts"][name]

    def back_solves(row):
        """Those of the derivatives included."""
        return count(row, "backsolves") + count(row, "sensitivity_backsolves")

    exact = rows["monolithic_al scale=1"]
    x = exact["interface"]["touch"]["x"]
    middle = len(x) // 2
    penalties = {label: row for label, row in rows.items() if row["method"].get("penalty")}
    best = min(penalties.values(), key=lambda row: worst(row, "response"))
    scales = [row for label, row in rows.items() if row["method"].get("monolithic_al")]
    return {
        "nodes": len(json.loads((folder / "picture.json").read_text())["points"]),
        "contact points": exact["size"]["contact_points"],
        "half width in elements": exact["responses"]["width"] / (x[middle + 1] - x[middle]),
        "runs": len(rows),
        "penalty error at 1e3": worst(penalty(1000), "response"),
        "penalty derivative error at 1e3": worst(penalty(1000), "sensitivity"),
        "penalty derivatives over responses at 1e3": worst(penalty(1000), "sensitivity") / worst(penalty(1000), "response"),
        "penalty factorisations": count(penalty(1000), "factorizations"),
        "penalty back-solves": back_solves(penalty(1000)),
        "least penalty error": worst(best, "response"),
        "stiffness of the least penalty error": best["knobs"]["stiffness"],
        "penalty error at 1e10": worst(penalty(10000000000), "response"),
        "penalty derivatives over responses": max(worst(row, "sensitivity") / worst(row, "response")
                                                  for row in penalties.values()),
        "augmentations at 1e-3": count(uzawa("0.001"), "augmentations"),
        "augmentations at 1e-5": count(uzawa("1e-05"), "augmentations"),
        "uzawa error at 1e-3": worst(uzawa("0.001"), "response"),
        "uzawa error at 1e-5": worst(uzawa("1e-05"), "response"),
        "uzawa derivative error at 1e-3": worst(uzawa("0.001"), "sensitivity"),
        "uzawa derivative error at 1e-5": worst(uzawa("1e-05"), "sensitivity"),
        "uzawa error at 1e-7": worst(uzawa("1e-07"), "response"),
        "uzawa derivative error at 1e-7": worst(uzawa("1e-07"), "sensitivity"),
        "uzawa factorisations": count(uzawa("1e-07"), "factorizations"),
        "uzawa back-solves": back_solves(uzawa("1e-07")),
        "monolithic error at any scale": max(worst(row, "response") for row in scales),
        "monolithic derivative error at any scale": max(worst(row, "sensitivity") for row in scales),
        "monolithic back-solves": back_solves(exact),
        "monolithic Newton": count(exact, "newton"),
        "monolithic factorisations": count(exact, "factorizations"),
        "most monolithic Newton": max(count(row, "newton") for row in scales),
        "mesh error of the peak": exact["errors"]["discretization"]["response:peak"],
        "mesh error of the width": exact["errors"]["discretization"]["response:width"],
        "mesh error of the derivatives": worst(exact, "sensitivity", "discretization"),
    }


def of_schemes(program):
    """Uzawa's schemes of derivatives."""
    rows, _ = program.study("uzawa")
    passes = [step["sensitivity_scheme"]["passes"] for row in rows.values() for step in row["steps"]
              if row["method"].get("uzawa_al", {}).get("sensitivity") == "preconditioned"]
    shapes, _ = program.study_of("shapes", {
        "scene": "press_fit.json", "methods": [{"uzawa_al": {"sensitivity": "preconditioned"}}],
        "reference": [{"method": {"monolithic_al": {}}}], "errors": ["sensitivity:*"]})
    errors = next(iter(shapes.values()))["errors"]["enforcement"]
    return {
        "most preconditioned passes": max(passes),
        "preconditioned error by shape": max(error for name, error in errors.items()
                                             if name.rpartition("/")[2] in ("R", "Ri", "Ro")),
    }


def of_the_tutorial(program):
    """What the tutorial says of its scenes in words; it shows the outputs themselves, which are replayed."""
    last, slope = program.last, program.slope
    lame = 1.6484  # closed form, in the text
    pressure = last("press_fit", "pressure")
    soft = ("stop", "-m", "uzawa_al", "--set", "/method/uzawa_al/scale=10")
    uzawa, adapted = program.run("stop", "-m", "uzawa_al"), program.run(*soft)
    softer = program.run(*soft, "--set", "/method/uzawa_al/adapt=false")
    sixteen = ("--set", "/bodies/belt/mesh/arc/from_angle=-5.625", "--set", "/bodies/belt/mesh/arc/to_angle=185.625",
               "--set", "/bodies/belt/mesh/arc/cells=17")
    pull, pull_of_sixteen = -last("belt", "tight"), -last("belt", "tight", *sixteen)
    limit = math.exp(0.3 * math.pi)
    return {
        "penalty's loss of force": 1 - last("stop", "press", "-m", "penalty") / last("stop", "press"),
        "penalty's compliance": slope("stop", "u", "F", "-m", "penalty"),
        "augmentations at scale 10": softer["cost"]["counts"]["augmentations"],
        "augmentations at scale 10 with adapt": adapted["cost"]["counts"]["augmentations"],
        "augmentations at scale 100": uzawa["cost"]["counts"]["augmentations"],
        "place of the block": last("slider", "u"),
        "place at friction 0.4": last("slider", "u", "--set", "/contacts/sole/friction=0.4"),
        "heat at friction 0.4": last("slider", "heat", "--set", "/contacts/sole/friction=0.4"),
        "y of 155 steps": last("tractrix", "y", "--set", "/time/steps=155"),
        "y of 310 steps": last("tractrix", "y"),
        "y of 620 steps": last("tractrix", "y", "--set", "/time/steps=620"),
        "pull of the belt": pull,
        "pull of 16 corners": pull_of_sixteen,
        "distance of 8 corners": pull - limit,
        "distance of 16 corners": pull_of_sixteen - limit,
        "kkt of the press fit": max(program.run("press_fit")["steps"][-1]["kkt"].values()),
        "error of the facets": 1 - pressure / lame,
        "contact points of the press fit": program.run("press_fit")["size"]["contact_points"],
        "multipliers of the press fit": program.run("press_fit")["size"]["multipliers"],
        "pressure by interference": slope("press_fit", "pressure", "D"),
        "pressure of the press fit": pressure,
        "pressure at 0.02": last("press_fit", "pressure", "--set", "/contacts/fit/offset=-0.02"),
        "runs of the slider's study": len(program.study("slider")[0]),
    }


def quantities(program):
    return {**of_the_figure(program), **of_schemes(program), **of_the_tutorial(program)}


# ---- how pages show it -----------------------------------------------------------------------------------------------

def last_place(text):
    """Size of one unit in the last place of a number as it is written."""
    digits, _, exponent = text.partition("e")
    return 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))


def written(value, like):
    """A value with the digits and in the style of a number on the page."""
    digits = len(like.partition("e")[0].partition(".")[2])
    if "e" not in like:
        return f"{value:.{digits}f}"
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def bound_of(value):
    """The next of 1, 2, 5, 10, ... above three times a value: what rounding decides differs between machines."""
    power = 10.0 ** math.floor(math.log10(3 * value))
    return next(step * power for step in (1, 2, 5, 10) if step * power >= 3 * value)


def agrees(sign, shown, value):
    number = float(shown)
    if sign == "=":  # (a value halfway between two numbers may be rounded to either)
        return abs(number - value) <= 0.51 * last_place(shown) if set(".e") & set(shown) else number == round(value)
    if sign == "~":
        return abs(number) / 3 <= abs(value) <= 3 * abs(number)
    return value <= number <= 1000 * value


def renewed(text, values, faults, page=""):
    """The text with its stale numbers replaced; each is told in `faults`, as are unknown names."""
    def one(match):
        shown, sign, name, percent = match.group("number", "sign", "name", "percent")
        if name not in values:
            faults.append(f'{page}: no quantity is called "{name}"')
            return match.group()
        value = 100 * values[name] if percent else values[name]
        if agrees(sign, shown, value):
            return match.group()
        now = written(bound_of(value) if sign == "<" else value, shown)
        faults.append(f"{page}: {name} is shown as {shown}, but is {value:.6g}: {now}")
        return f"{now}<!--{sign}{name}-->{percent or ''}"

    return MARK.sub(one, text)


def self_test():
    values = {"a": 1.94e-5, "n": 17, "share": 0.0664, "tiny": 1.9e-14, "new": 1.0}
    cases = [("1.9e-5<!--=a-->", True), ("1.8e-5<!--=a-->", False), ("1.94e-5<!--=a-->", True), ("17<!--=n-->", True),
             ("18<!--=n-->", False), ("6.6<!--=share--> %", True), ("6.7<!--=share--> %", False),
             ("3e-14<!--~tiny-->", True), ("9e-14<!--~tiny-->", False), ("2e-14<!--<tiny-->", True),
             ("1e-14<!--<tiny-->", False), ("1e-9<!--<tiny-->", False), ("1<!--=unheard of-->", False)]
    for text, right in cases:
        faults = []
        new = renewed(text, values, faults)
        if (not faults) != right or (right and new != text):
            sys.exit(f"{text} is judged wrongly: {faults}")
        if not right and "unheard" not in text and renewed(new, values, []) != new:
            sys.exit(f"{text} is not mended: {new}")


def main():
    if sys.argv[1] == "--self-test":
        return self_test()
    with tempfile.TemporaryDirectory() as folder:
        values = quantities(Program(sys.argv[1], folder))
    faults, names = [], set()
    for page in PAGES:
        text = page.read_text()
        names.update(match.group("name") for match in MARK.finditer(text))
        new = renewed(text, values, faults, page.relative_to(ROOT))
        if "--check" not in sys.argv and new != text:
            page.write_text(new)
    unused = [f'no page shows "{name}"' for name in values if name not in names]
    if "--check" in sys.argv and faults + unused:
        sys.exit("\n".join(faults + unused + ["tools/measured_numbers.py build/release/stickslip writes them anew"]))
    print("\n".join(faults + unused))


if __name__ == "__main__":
    main()
