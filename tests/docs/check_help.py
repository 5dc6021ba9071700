#!/usr/bin/env python3
"""check_help.py STICKSLIP SOURCE: the man page and the completion know the commands and options that --help prints,
and no others. `--self-test` proves that a difference is seen."""
import pathlib
import re
import subprocess
import sys

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


def completed(completion, words):
    """What the completion offers for the last of the words."""
    script = (f"source {completion}; COMP_WORDS=({' '.join(w or repr('') for w in words)}); "
              f"COMP_CWORD={len(words) - 1}; _stickslip; printf '%s\\n' \"${{COMPREPLY[@]}}\"")
    return subprocess.run(["bash", "-c", script], check=True, capture_output=True, text=True).stdout.split()


def faults(commands, page, completion, methods):
    """`commands`: options by command, "" for those without one."""
    wrong = []

    def same(what, known, printed):
        if set(known) != set(printed):
            wrong.append(f"{what}: {sorted(known)}, but --help has {sorted(printed)}")

    names = [name for name in commands if name]
    same("commands of the man page", words_of(page, "COMMANDS"), names)
    every = {option: short for options in commands.values() for option, short in options.items()}
    in_page = {}
    for item in words_of(page, "OPTIONS"):
        found = re.findall(r"--[\w-]+", item)
        in_page[found[0]] = next(iter(re.findall(r"(?<!\S)-\w\b", item)), None)
    same("options of the man page", in_page.items(), every.items())
    for name in names:
        line = re.search(rf"^\.B stickslip {name}$(.*?)(?=^\.B stickslip|^\.SH)", page, re.M | re.S)
        shown = set(re.findall(r"--?\w+", line.group(1).replace("\\-", "-"))) if line else set()
        own = {short if short else option for option, short in commands[name].items() if option != "--help"}
        same(f"synopsis of {name}", shown, own)
        same(f"completion of {name}", completed(completion, ["stickslip", name, "--"]), commands[name])
    same("completion of the first word", completed(completion, ["stickslip", ""]), names + list(commands[""]))
    same("completion of --method", completed(completion, ["stickslip", "run", "--method", ""]), methods)
    return wrong


def self_test(source):
    page = (source / "docs/stickslip.1").read_text()
    known = {option: short for item in words_of(page, "OPTIONS") for option in re.findall(r"--[\w-]+", item)
             for short in [None]}
    if not known or not faults({"": known, "run": {"--help": "-h", "--unknown": None}}, page,
                               source / "tools/completion/stickslip.bash", ["penalty"]):
        sys.exit("a missing option is not seen")


def main():
    if sys.argv[1] == "--self-test":
        return self_test(pathlib.Path(sys.argv[2]))
    program, source = sys.argv[1], pathlib.Path(sys.argv[2])
    top = help_of(program)
    commands = {"": options_of(top), **{name: options_of(help_of(program, name)) for name in commands_of(top)}}
    methods = re.findall(r'^  "(\w+)"', subprocess.run([program, "methods", "--json"], check=True, capture_output=True,
                                                       text=True).stdout, re.M)
    wrong = faults(commands, (source / "docs/stickslip.1").read_text(), source / "tools/completion/stickslip.bash",
                   methods)
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
