#!/usr/bin/env python3
"""check_help.py STICKSLIP SOURCE: the manual page and the completion of bash know the commands and options that --help
prints, and no others; of files completion offers JSON alone. `--self-test` proves that a difference is seen."""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

OPTION = re.compile(r"^\s+(?:-\w,\s*)?(--[\w-]+)(?=\s|$)", re.M)


def printed(*command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=60, **options).stdout


def commands_of(text):
    """Names behind the heading "Subcommands:" of a help text."""
    return re.findall(r"^  (\w+) ", text.partition("Subcommands:")[2], re.M)


def completed(program, source, words, at="."):
    """What bash offers for the last of the words in the folder `at`."""
    line = " ".join(word or "''" for word in words)
    before = f"'{words[-2]}'" if len(words) > 1 else "''"
    script = (f"source {source}/tools/stickslip.bash; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; "
              f"_stickslip {program} '{words[-1]}' {before}; printf '%s\\n' \"${{COMPREPLY[@]}}\"")
    return set(printed("bash", "-c", script, cwd=at).split())


def same(what, known, wanted):
    """The difference between what is known and what --help prints, in a list; empty where there is none."""
    return [] if set(known) == set(wanted) else [f"{what}: {sorted(known)}, but --help has {sorted(wanted)}"]


def completion_faults(program, source, commands, methods):
    names = [name for name in commands if name]
    wrong = same("first word", completed(program, source, ["stickslip", ""]), [*names, *commands[""]])
    wrong += same("completion of -m", completed(program, source, ["stickslip", "run", "-m", ""]), methods)
    wrong += same("completion of schema", completed(program, source, ["stickslip", "schema", ""]), ["scene", "study"])
    for name in names:
        wrong += same(f"completion of {name}", completed(program, source, ["stickslip", name, "--"]), commands[name])
    with tempfile.TemporaryDirectory() as at:
        for file in ("scene.json", "notes.txt"):
            (pathlib.Path(at) / file).touch()
        (pathlib.Path(at) / "results").mkdir()
        for words, wanted in ((["run", ""], {"scene.json", "results"}), (["report", ""], {"results"}),
                              (["run", "scene.json", "-o", ""], {"results"}), (["run", "--set", ""], set())):
            wrong += same(f"files for {words}", completed(program, source, ["stickslip", *words], at), wanted)
    return wrong


def page_faults(commands, page):
    """`commands`: options by command, "" for those without one."""
    every = {option for options in commands.values() for option in options}
    plain = re.sub(r"\\f[IPBR]", "", page).replace("\\-", "-")
    wrong = same("options of the manual", {o for o in re.findall(r"--[a-z]+(?:-[a-z]+)*", plain)}, every)
    headings = re.findall(r'^\.S[SH] "?stickslip (\w+)', plain, re.M | re.I)
    return wrong + same("commands of the manual", {name.lower() for name in headings}, [n for n in commands if n])


def main():
    if sys.argv[1] == "--self-test":
        page = '.SH "STICKSLIP RUN"\n\\fB\\-\\-help\\fR'
        assert not page_faults({"": ["--help"], "run": []}, page)
        assert page_faults({"": ["--help"], "run": ["--unknown"]}, page) and page_faults({"": ["--help"]}, page)
        assert same("words", ["a"], ["a", "b"])
        return
    program, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    top = printed(program, "--help")
    commands = {"": OPTION.findall(top), **{name: OPTION.findall(printed(program, name, "--help"))
                                            for name in commands_of(top)}}
    methods = json.loads(printed(program, "methods", "--json"))
    wrong = completion_faults(program, source, commands, methods)
    if shutil.which("help2man"):
        wrong += page_faults(commands, printed("bash", source / "tools/manual.sh", program))
    else:
        print("help2man is not here: the manual page is not checked")
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
