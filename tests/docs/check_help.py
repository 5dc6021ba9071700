#!/usr/bin/env python3
"""check_help.py STICKSLIP SOURCE: the man page and the completions of bash, and of zsh and fish where these are
installed, know the commands and options that --help prints, and no others; of files completions offer JSON alone.
`--self-test` proves that a difference is seen."""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

OPTION = re.compile(r"^\s+(?:(-\w),\s*)?(--[\w-]+)(?=\s|$|,)")


def help_of(program, *command):
    return subprocess.run([program, *command, "--help"], check=True, capture_output=True, text=True).stdout


def commands_of(text):
    """Names behind the heading "Subcommands:" of a help text."""
    return re.findall(r"^  (\w+) ", text.partition("Subcommands:")[2], re.M)


def options_of(text):
    """Options of a help text: {"--method": "-m", "--json": None, ...}."""
    return {m.group(2): m.group(1) for m in map(OPTION.match, text.splitlines()) if m}


def words_of(page, heading):
    """First lines of the .TP items of a section of a man page, as plain text."""
    section = page.partition(f".SH {heading}\n")[2].partition("\n.SH ")[0]
    items = re.findall(r"^\.TP\n\.BR? (.*)$", section, re.M)
    return [re.sub(r"\\f[IPBR]", "", item).replace("\\-", "-").replace('"', "") for item in items]


def in_bash(folder, words):
    script = (f"source {folder}/stickslip.bash; COMP_WORDS=({' '.join(w or repr('') for w in words)}); "
              f"COMP_CWORD={len(words) - 1}; _stickslip; printf '%s\\n' \"${{COMPREPLY[@]}}\"")
    return ["bash", "-c", script]


def in_zsh(folder, words):
    return ["zsh", "-f", str(pathlib.Path(__file__).with_name("complete.zsh")), str(folder), " ".join(words)]


def in_fish(folder, words):
    return ["fish", "--no-config", "-c", f"source {folder}/stickslip.fish; complete -C '{' '.join(words)}' | cut -f1"]


SHELLS = {"bash": in_bash, "zsh": in_zsh, "fish": in_fish}


def completed(shell, folder, words, at="."):
    """What a shell offers for the last of the words in the folder `at`; `folder` has the completions."""
    return subprocess.run(SHELLS[shell](folder, words), check=True, capture_output=True, text=True, cwd=at,
                          timeout=60).stdout.split()


def same(what, known, printed):
    """The difference between what is known and what --help prints, in a list; empty where there is none."""
    return [] if set(known) == set(printed) else [f"{what}: {sorted(known)}, but --help has {sorted(printed)}"]


def completion_faults(shell, folder, commands, methods):
    names = [name for name in commands if name]
    words = ["stickslip", "run", "--method", ""]
    wrong = same(f"first word in {shell}", {*completed(shell, folder, ["stickslip", ""])} - {*commands[""]}, names)
    wrong += same(f"first option in {shell}", {*completed(shell, folder, ["stickslip", "--"])} - {*names}, commands[""])
    wrong += same(f"completion of --method in {shell}", completed(shell, folder, words), methods)
    for name in names:
        offered = completed(shell, folder, ["stickslip", name, "--"])
        wrong += same(f"completion of {name} in {shell}", offered, commands[name])
    with tempfile.TemporaryDirectory() as at:
        for file in ("scene.json", "notes.txt"):
            (pathlib.Path(at) / file).touch()
        (pathlib.Path(at) / "results").mkdir()
        for command, wanted in (("run", {"scene.json", "results"}), ("report", {"results"})):
            offered = {name.rstrip("/") for name in completed(shell, folder, ["stickslip", command, ""], at)}
            if offered != wanted:
                wrong.append(f"files for {command} in {shell}: {sorted(offered)}")
    return wrong


def page_faults(commands, page):
    """`commands`: options by command, "" for those without one."""
    names = [name for name in commands if name]
    wrong = same("commands of the man page", words_of(page, "COMMANDS"), names)
    every = {option: short for options in commands.values() for option, short in options.items()}
    in_page = {}
    for item in words_of(page, "OPTIONS"):
        found = re.findall(r"--[\w-]+", item)
        in_page[found[0]] = next(iter(re.findall(r"(?<!\S)-\w\b", item)), None)
    wrong += same("options of the man page", in_page.items(), every.items())
    for name in names:
        line = re.search(rf"^\.B stickslip {name}$(.*?)(?=^\.B stickslip|^\.SH)", page, re.M | re.S)
        shown = set(re.findall(r"--?\w+", line.group(1).replace("\\-", "-"))) if line else set()
        own = {short if short else option for option, short in commands[name].items() if option != "--help"}
        wrong += same(f"synopsis of {name}", shown, own)
    return wrong


def self_test(page, folder):
    """An option that is in none of them, in each."""
    commands = {"": {"--help": "-h"}, "run": {"--help": "-h", "--unknown": None}}
    seen = [page_faults(commands, page)]
    seen += [completion_faults(shell, folder, commands, ["penalty"]) for shell in SHELLS if shutil.which(shell)]
    for wrong in seen:
        if not any("--unknown" in fault for fault in wrong):
            sys.exit(f"a missing option is not seen: {wrong}")


def main():
    source = pathlib.Path(sys.argv[2]).resolve()
    page, folder = (source / "docs/stickslip.1").read_text(), source / "tools/completion"
    if sys.argv[1] == "--self-test":
        return self_test(page, folder)
    program = sys.argv[1]
    top = help_of(program)
    commands = {"": options_of(top), **{name: options_of(help_of(program, name)) for name in commands_of(top)}}
    methods = json.loads(subprocess.run([program, "methods", "--json"], check=True, capture_output=True).stdout)
    wrong = page_faults(commands, page)
    for shell in SHELLS:
        if shutil.which(shell):
            wrong += completion_faults(shell, folder, commands, methods)
        else:
            print(f"{shell} is not installed: its completion is only held against --help (tools/completions.py)")
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
