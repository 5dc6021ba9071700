#!/usr/bin/env python3
"""completions.py STICKSLIP [--check | --self-test]: writes tools/completion/ from what `--help` prints.

One reading of the help texts makes the scripts of bash, zsh and fish. What an argument is stands in its description:
a file where it ends in "(JSON)", a directory where it begins with that word; --method takes a method. With --check
nothing is written: exit code 1 where a script is not the one that the program makes.
"""
import dataclasses
import json
import pathlib
import re
import subprocess
import sys

FOLDER = pathlib.Path(__file__).resolve().parent / "completion"
NOTE = "made by tools/completions.py from what --help prints"
# "  -m,--method TEXT   description", which follows on the next line where the head is long
ITEM = re.compile(r"^  (?:(?P<short>-\w),)?(?P<name>--[\w-]+|\w+)(?P<kind> [^\n]*?)?(?:\n? {2,}(?P<text>\S.*))$", re.M)


@dataclasses.dataclass
class Item:
    """A command, an argument or an option of a help text."""
    name: str
    short: str  # "-m"; "" where there is none
    text: str
    kind: str  # "none", "file", "directory", "method", "text" or "a b c", one of these
    excludes: str = ""  # an option that it does not go with
    many: bool = False  # may stand again


@dataclasses.dataclass
class Command:
    name: str
    text: str
    options: list
    arguments: list


def help_of(program, *command):
    return subprocess.run([program, *command, "--help"], check=True, capture_output=True, text=True).stdout


def kind_of(name, given, text):
    """What the value of an argument or option is; `given` is how its help names the type."""
    one_of = re.search(r"\{(.*?)\}", given)
    if one_of:
        return one_of.group(1).replace(",", " ")
    if not given.replace("Excludes:", "").split("--")[0].strip():
        return "none"
    if name == "--method":
        return "method"
    if text.endswith("(JSON)"):
        return "file"
    return "directory" if text.startswith("director") else "text"


def items(text, heading):
    """Items below a heading of a help text."""
    part = re.search(rf"^{heading}:\n(.*?)(?=\n\n|\Z)", text, re.M | re.S)
    for match in ITEM.finditer(part.group(1) if part else ""):
        given = match.group("kind") or ""
        excludes = re.search(r"Excludes: (--[\w-]+)", given)
        yield Item(match.group("name"), match.group("short") or "", match.group("text"),
                   kind_of(match.group("name"), given, match.group("text")), excludes.group(1) if excludes else "",
                   "..." in given or "may be given again" in match.group("text"))


def read_commands(program):
    """Commands of the program; the first, of no name, has the options that stand without one."""
    top = help_of(program)
    out = [Command("", "", list(items(top, "Options")), [])]
    for each in items(top, "Subcommands"):
        text = help_of(program, each.name)
        out.append(Command(each.name, each.text, list(items(text, "Options")), list(items(text, "Positionals"))))
    return out


def read_methods(program):
    return list(json.loads(subprocess.run([program, "methods", "--json"], check=True, capture_output=True).stdout))


def quoted(text):
    """A text as one word of a shell."""
    return "'" + text.replace("'", "'\\''") + "'"


# ---- bash ------------------------------------------------------------------------------------------------------------

BASH_VALUE = {"directory": 'compgen -d -- "$word"',
              "file": """compgen -d -- "$word"; compgen -f -X '!*.json' -- "$word\""""}


def bash_value(kind, methods):
    """The command that lists values of a kind; None where there is nothing to offer."""
    if kind in ("none", "text"):
        return None
    return BASH_VALUE.get(kind) or f'compgen -W "{" ".join(methods) if kind == "method" else kind}" -- "$word"'


def bash(commands, methods):
    words = [each.name for each in commands[1:]] + [option.name for option in commands[0].options]
    options = "".join(f'    {each.name}) options="{" ".join(option.name for option in each.options)}" ;;\n'
                      for each in commands[1:])
    valued = {}  # options that take a value, by what lists it
    for each in commands[1:]:
        for option in each.options:
            if option.kind != "none":
                names = valued.setdefault(bash_value(option.kind, methods), [])
                names += [name for name in (option.short, option.name) if name and name not in names]
    values = "".join(f"    {' | '.join(names)})\n" +
                     (f"      mapfile -t COMPREPLY < <({lister})\n" if lister else "") + "      return ;;\n"
                     for lister, names in valued.items())
    arguments = {}
    for each in commands[1:]:
        lister = bash_value(each.arguments[0].kind, methods) if each.arguments else None
        if lister:
            arguments.setdefault(lister, []).append(each.name)
    offered = "".join(f"    {' | '.join(names)})\n" +
                      ("      compopt -o filenames 2>/dev/null\n" if "compgen -d" in lister else "") +
                      f"      mapfile -t COMPREPLY < <({lister}) ;;\n" for lister, names in arguments.items())
    return f"""# Completion of stickslip in bash: {NOTE}.

_stickslip() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} command=${{COMP_WORDS[1]:-}} options=
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "{' '.join(words)}" -- "$word")
    return
  fi
  case $command in
{options}  esac
  case $before in
{values}  esac
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
    return
  fi
  case $command in
{offered}  esac
}}
complete -F _stickslip stickslip
"""


# ---- zsh -------------------------------------------------------------------------------------------------------------

def zsh_action(kind, methods):
    """What follows the name of a value in a specification of _arguments."""
    known = {"file": "_files -g \"*.json(-.)\"", "directory": "_files -/", "text": " ",
             "method": f"({' '.join(methods)})"}
    return known.get(kind, f"({kind})")


def zsh_text(text):
    return re.sub(r"([\[\]:])", r"\\\1", text)


def zsh_option(option, methods):
    """One option, with its short form, as a word for _arguments."""
    value = "" if option.kind == "none" else f":{option.kind}:{zsh_action(option.kind, methods)}"
    rest = f"[{zsh_text(option.text)}]{value}"
    if option.short:
        alone = "- *" if option.name == "--help" else f"{option.short} {option.name}"
        return f"'({alone})'{{{option.short},{option.name}}}{quoted(rest)}"
    before = "*" if option.many else f"({option.excludes})" if option.excludes else ""
    return quoted(before + option.name + rest)


def zsh(commands, methods):
    names = "".join(f"        {quoted(each.name + ':' + zsh_text(each.text))}\n" for each in commands[1:])
    cases = ""
    for each in commands[1:]:
        words = [zsh_option(option, methods) for option in each.options]
        for place, argument in enumerate(each.arguments, 1):
            where = "*" if argument.many else str(place)
            words.append(quoted(f"{where}:{argument.name.lower()}:{zsh_action(argument.kind, methods)}"))
        cases += " \\\n            ".join([f"        {each.name})\n          _arguments", *words]) + " ;;\n"
    first = " \\\n    ".join(zsh_option(option, methods) for option in commands[0].options)
    return f"""#compdef stickslip
# Completion of stickslip in zsh: {NOTE}.

_stickslip() {{
  local curcontext="$curcontext" state line
  typeset -A opt_args
  _arguments -C \\
    {first} \\
    '1:command:->command' '*::arguments:->arguments'
  case $state in
    command)
      local -a commands=(
{names}      )
      _describe command commands ;;
    arguments)
      case $line[1] in
{cases}      esac ;;
  esac
}}

_stickslip "$@"
"""


# ---- fish ------------------------------------------------------------------------------------------------------------

def fish_value(kind, methods):
    # (it offers other files too, behind those)
    files = """ -x -a "(__fish_complete_suffix .json | string match -r '.*(?:/|[.]json)\$')\""""
    known = {"none": "", "text": " -x", "file": files,
             "directory": " -x -a '(__fish_complete_directories)'", "method": f" -x -a {quoted(' '.join(methods))}"}
    return known.get(kind, f" -x -a {quoted(kind)}")


def fish(commands, methods):
    out = f"# Completion of stickslip in fish: {NOTE}.\n\ncomplete -c stickslip -f\n"

    def option_line(condition, option):
        short = f" -s {option.short[1:]}" if option.short else ""
        text = option.text.replace("\\", "\\\\").replace("'", "\\'")
        return (f"complete -c stickslip -n {condition}{short} -l {option.name[2:]}"
                f"{fish_value(option.kind, methods)} -d '{text}'\n")

    for option in commands[0].options:
        out += option_line("__fish_use_subcommand", option)
    for each in commands[1:]:
        out += f"complete -c stickslip -n __fish_use_subcommand -a {each.name} -d {quoted(each.text)}\n"
    for each in commands[1:]:
        condition = f"'__fish_seen_subcommand_from {each.name}'"
        if each.arguments and each.arguments[0].kind != "text":
            out += f"complete -c stickslip -n {condition}{fish_value(each.arguments[0].kind, methods)}\n"
        out += "".join(option_line(condition, option) for option in each.options)
    return out


def scripts(commands, methods):
    """The files of tools/completion/, by name."""
    return {"stickslip.bash": bash(commands, methods), "_stickslip": zsh(commands, methods),
            "stickslip.fish": fish(commands, methods)}


def stale(made, folder):
    """Names of scripts that are not as made."""
    return [name for name, text in made.items() if not (folder / name).exists() or (folder / name).read_text() != text]


def main():
    program, mode = sys.argv[1], sys.argv[2:]
    commands, methods = read_commands(program), read_methods(program)
    made = scripts(commands, methods)
    if mode == ["--self-test"]:  # an option more, and every script must differ
        commands[1].options.append(Item("--another", "", "is new", "none"))
        if set(stale(scripts(commands, methods), FOLDER)) != set(made):
            sys.exit("a new option is not seen")
    elif mode == ["--check"]:
        if wrong := stale(made, FOLDER):
            sys.exit(f"not what --help says: {', '.join(wrong)}; tools/completions.py build/release/stickslip mends it")
    else:
        for name, text in made.items():
            (FOLDER / name).write_text(text)


if __name__ == "__main__":
    main()
