#!/usr/bin/env python3
"""web_answers_test.py STICKSLIP SOURCE FOLDER [--times]: the module in FOLDER (the preset wasm) against the program:
the same status, the same responses and derivatives at each step to 1e-9, the same messages. --times prints how long
each took. Exit code 77, which ctest counts as skipped, where the module is not built."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
METHODS = ("penalty", "uzawa_al", "monolithic_al")
SCENES = [f"studies/scenes/{name}.json" for name in (
    "belt", "greco_plate", "ironing", "plastic_bar", "press_fit", "pull_out", "slider", "slope", "snap", "stop", "stop_bars",
    "tractrix", "truss", "turned_rings")] + [f"studies/hard/{name}.json" for name in (
    "friction-holds-small", "groove-smooth", "klarbring-mu-3-load-2.5", "klarbring-path", "pin-over-a-vertex",
    "plate-in-space", "slider-at-first-slip")] + ["studies/web/scenes/cylinders.json"]
ROUNDING = 1e-9  # of the largest response of a kind: what another order of elimination leaves
# Both mean that the equations hold as well as numbers can; which one depends on the last digit.
SAME = {"converged": "converged", "converged_at_roundoff": "converged"}


def by_program(program, source, scene, method):
    done = subprocess.run([program, "run", source / scene, "-m", method, "--json"], capture_output=True, text=True)
    return done.returncode, json.loads(done.stdout)


def by_module(node, module, requests):
    lines = "".join(json.dumps(request) + "\n" for request in requests)
    done = subprocess.run([node, pathlib.Path(__file__).with_name("web_module.cjs"), module],
                          input=lines, capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def value_of(parameter, scene):
    """The number that a parameter is, or the first of those that it changes."""
    at = scene
    for key in (parameter if isinstance(parameter, str) else next(iter(parameter))).split("/")[1:]:
        at = at[int(key) if isinstance(at, list) else key]
    return at


def difference(one, other, scene):
    """The largest difference of a response at a step, or of a derivative by a parameter, over the largest of its kind
    (forces by forces, and so on); of a derivative at least over that response by the value of the parameter, for
    derivatives that vanish are rounding."""
    largest, apart = {}, {}

    def see(of, value, twin):
        largest[of] = max(largest.get(of, 0.0), abs(value))
        apart[of] = max(apart.get(of, 0.0), abs(value - twin))

    kinds = {name: next(iter(response)) for name, response in scene["responses"].items()}
    for a, b in zip(one["steps"], other["steps"]):
        for name, value in (a.get("responses") or {}).items():
            see(kinds[name], value, b["responses"][name])
        for name, derivatives in (a.get("sensitivities") or {}).items():
            for parameter, value in derivatives.items():
                see((kinds[name], parameter), value, b["sensitivities"][name][parameter])
    for kind, parameter in (of for of in apart if isinstance(of, tuple)):
        if value := value_of(scene["parameters"][parameter], scene):
            largest[kind, parameter] = max(largest[kind, parameter], largest[kind] / abs(value))
    return max((apart[of] / (largest[of] or 1) for of in apart), default=0.0)


def compare(where, code, native, answer):
    """What differs, in words."""
    got = answer["answer"].get("result")
    if not got:
        return [f"{where}: {json.dumps(answer['answer'])[:300]}"]
    faults = []
    statuses = [SAME.get(result["status"], result["status"]) for result in (native, got)]
    if statuses[0] != statuses[1] or code != answer["code"]:
        faults.append(f"{where}: status {native['status']} and {got['status']}, codes {code} and {answer['code']}")
    if len(native["steps"]) != len(got["steps"]):
        faults.append(f"{where}: {len(native['steps'])} steps and {len(got['steps'])}")
    elif (apart := difference(native, got, answer["answer"]["document"])) > ROUNDING:
        faults.append(f"{where}: responses or derivatives differ by {apart:.1e}")
    return faults


def check_answers(program, source, node, module, runs):
    """What differs. `runs`: of each, whose fastest is printed; 1: nothing is."""
    cases = [(scene, method) for scene in SCENES for method in METHODS]
    requests = [{"scene": (source / scene).read_text(), "file": scene, "method": method} for scene, method in cases]
    answers = by_module(node, module, [request for request in requests for _ in range(runs)])
    faults, ratios = [], []
    for i, (scene, method) in enumerate(cases):
        natives = [by_program(program, source, scene, method) for _ in range(runs)]
        code, native = natives[-1]
        mine = answers[i * runs:(i + 1) * runs]
        faults += compare(f"{scene}, {method}", code, native, mine[-1])
        if runs > 1:
            fastest = [min(result["cost"]["seconds"]["total"] for result in results)
                       for results in ([one for _, one in natives], [one["answer"]["result"] for one in mine])]
            ratios.append(fastest[1] / fastest[0])
            print(f"{scene:45} {method:14} program {1e3 * fastest[0]:8.2f} ms  module {1e3 * fastest[1]:8.2f} ms  "
                  f"ratio {ratios[-1]:5.1f}")
    if ratios:
        print(f"median of the ratios: {sorted(ratios)[len(ratios) // 2]:.1f}")
    return faults


def check_messages(program, source, node, module):
    """A fault has the words and the place that the terminal shows; a run that is cancelled says where."""
    text = (source / "studies/scenes/slider.json").read_text()
    wrong = text.replace('"friction": 0.3', '"fricton": -1')
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "wrong.json"
        file.write_text(wrong)
        told = subprocess.run([program, "run", file], capture_output=True, text=True)
    fault, cancelled, fine = by_module(node, module, [{"scene": wrong, "file": str(file)},
                                                      {"scene": text, "file": "slider.json", "stop_at": 7},
                                                      {"scene": text, "file": "slider.json", "solve": False}])
    faults = []
    lines = [one["text"] for one in fault["answer"]["faults"]]
    if told.returncode != 2 or fault["code"] != 2 or lines != told.stderr.splitlines():
        faults.append(f"messages differ:\n{lines}\n{told.stderr}")
    if cancelled["code"] != 4 or cancelled["answer"] != {"cancelled": {"done": 7, "steps": 60}}:
        faults.append(f"cancelled: {json.dumps(cancelled)[:300]}")
    if fine["code"] != 0 or "result" in fine["answer"] or fine["answer"]["size"]["displacements"] != 2:
        faults.append(f"only read: {json.dumps(fine)[:300]}")
    return faults


def main():
    program, source, folder = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    node, module = shutil.which("node") or shutil.which("nodejs"), folder / "stickslip.js"
    if not node or not module.exists():
        print("skipped: the module is not built (./play.sh)")
        sys.exit(SKIPPED)
    faults = check_messages(program, source, node, module)
    faults += check_answers(program, source, node, module, 6 if "--times" in sys.argv else 1)
    if faults:
        sys.exit("\n".join(faults))
    print(f"{len(SCENES)} scenes by {len(METHODS)} methods")


if __name__ == "__main__":
    main()
