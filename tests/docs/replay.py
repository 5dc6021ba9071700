#!/usr/bin/env python3
"""replay.py STICKSLIP SOURCE PAGE...: runs the commands that pages show and compares what they print.

A command is a line `$ ...` of a block that opens with ```console; what follows it is what it prints, standard output
and error together, in the order of the page. Commands of a page begin in a new folder, in which `studies` is that of the
sources, SCENES its folder of scenes, and the program is found by its name; `cd` holds for the commands after it. `...` stands for any text within a line, and alone for any lines. A block that opens with ```LANGUAGE NAME is the file NAME, written when its turn comes.

Numbers agree to 1e-6 of themselves or to the last place shown; those below 1e-8 are rounding, and agree with one
another. Whole numbers, and all else, must be the same. `--self-test` proves that a fault is seen.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
ROUNDING = 1e-8


def commands(text):
    """(line number, command, lines expected) of each command of a page; a file is a command that writes it."""
    found, inside, name, lines = [], False, "", []
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            if name:
                found.append((number, f"cat >{name} <<'END OF FILE'\n" + "\n".join([*lines, "END OF FILE"]), []))
            inside, name, lines = line == "```console", line[3:].partition(" ")[2], []
        elif name:
            lines.append(line)
        elif inside and line.startswith("$ "):
            found.append((number, line[2:], []))
        elif inside and found:
            found[-1][2].append(line)
    return found


def last_place(text):
    """Size of one unit in the last place of a number as it is written."""
    digits, _, exponent = text.lower().partition("e")
    decimals = len(digits.partition(".")[2])
    return 10.0 ** (int(exponent or 0) - decimals)


def numbers_agree(shown, printed):
    if shown == printed:
        return True
    if not set(shown + printed) & set(".e"):
        return False  # whole numbers
    a, b = float(shown), float(printed)
    if abs(a) < ROUNDING and abs(b) < ROUNDING:
        return True
    return abs(a - b) <= max(1e-6 * abs(a), 1.001 * last_place(shown))


def pieces(line):
    """A line as words and numbers, without the width of columns."""
    line = " ".join(line.split())
    out, at = [], 0
    for match in NUMBER.finditer(line):
        out += [(False, line[at:match.start()].strip()), (True, match.group())]
        at = match.end()
    return [piece for piece in out + [(False, line[at:].strip())] if piece[1]]


def lines_agree(shown, printed):
    if "..." in shown:
        parts = shown.split("...")
        starts = [printed[:len(printed) - i] for i in range(len(printed) + 1)]
        return any(lines_agree(parts[0].rstrip(), start.rstrip()) and
                   ends_agree(parts[1:], printed[len(start):]) for start in starts)
    a, b = pieces(shown), pieces(printed)
    return len(a) == len(b) and all(
        x[0] == y[0] and (numbers_agree(x[1], y[1]) if x[0] else x[1] == y[1]) for x, y in zip(a, b))


def ends_agree(parts, printed):
    """Whether the text ends on the last part; parts between two `...` are not looked at."""
    return any(lines_agree(parts[-1].lstrip(), printed[i:].lstrip()) for i in range(len(printed) + 1))


def output_agrees(shown, printed):
    """Index of the first line shown that is not there; None where all are."""
    at, skipping = 0, False
    for index, line in enumerate(shown):
        if line.strip() == "...":
            skipping = True
            continue
        if skipping:
            while at < len(printed) and not lines_agree(line, printed[at]):
                at += 1
        if at == len(printed) or not lines_agree(line, printed[at]):
            return index
        at, skipping = at + 1, False
    return None if at == len(printed) or skipping else len(shown)


def stripped(lines):
    """Without empty lines at the ends."""
    while lines and not lines[0].strip():
        lines = lines[1:]
    while lines and not lines[-1].strip():
        lines = lines[:-1]
    return lines


def ran(command, folder, environment):
    """What a command prints, and the folder that it leaves the shell in."""
    with tempfile.NamedTemporaryFile("r") as left:
        run = subprocess.run(["bash", "-c", f'{command}\npwd >"{left.name}"'], cwd=folder, env=environment, text=True,
                             timeout=600, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        return run.stdout, left.read().strip() or folder


def replay(program, source, page):
    environment = {"SCENES": str(source / "studies" / "scenes"), **os.environ,
                   "PATH": f"{pathlib.Path(program).resolve().parent}:{os.environ['PATH']}"}
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(source / "studies", pathlib.Path(folder) / "studies")
        at = folder
        for number, command, shown in commands(page.read_text()):
            output, at = ran(command, at, environment)
            printed, shown = stripped(output.splitlines()), stripped(shown)
            wrong = output_agrees(shown, printed)
            if wrong is not None:
                expected = shown[wrong] if wrong < len(shown) else "(nothing more)"
                faults.append(f"{page}:{number}: $ {command}\n  the page shows: {expected}\n  it printed:\n    " +
                              "\n    ".join(printed[-60:]))
    return faults


def self_test():
    cases = [(["u 7.00e-02"], ["u   7.00e-02"], True), (["u 7.00e-02"], ["u 7.03e-02"], False),
             (["steps 12"], ["steps 13"], False), (["error 1.1e-16"], ["error 3e-13"], True),
             (["error 1.1e-16"], ["error 3e-5"], False), (["a", "...", "c"], ["a", "b", "b", "c"], True),
             (["a", "...", "c"], ["a", "b"], False), (["a"], ["a", "b"], False), (["a ... 2.0"], ["a x y 2.0"], True),
             (["a ... 2.0"], ["a x y 3.0"], False), (["open 1"], ["slip 1"], False),
             (["1.000001e+00"], ["1.000002e+00"], True), (["k"], [], False)]
    wrong = [case for case in cases if (output_agrees(case[0], case[1]) is None) != case[2]]
    found = commands("```console\n$ a\nb\n$ c\n```\n$ d\n```json\n$ e\n```\n```json f.json\n$ g\n```\n")
    with tempfile.TemporaryDirectory() as folder:
        os.mkdir(pathlib.Path(folder) / "below")
        printed, at = ran("echo said; cd below", folder, os.environ)
        moved = printed == "said\n" and os.path.samefile(at, pathlib.Path(folder) / "below")
    if wrong or not moved or found != [
            (2, "a", ["b"]), (4, "c", []), (12, "cat >f.json <<'END OF FILE'\n$ g\nEND OF FILE", [])]:
        sys.exit(f"the replay does not see what it should: {wrong} {found}")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    faults = []
    for page in sys.argv[3:]:
        faults += replay(sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(page))
    if faults:
        sys.exit("\n".join(faults))


if __name__ == "__main__":
    main()
