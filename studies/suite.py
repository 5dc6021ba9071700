"""What the suites of this folder share, hard/hard.py and windows/windows.py: the program that they run, and where to."""

import argparse
import shutil
from pathlib import Path


class InputError(Exception):
    """Bad arguments or files; exit code 2."""


def parser_of(name, about):
    """Arguments of studies/NAME/NAME.py, which are the same for all."""
    parser = argparse.ArgumentParser(prog=f"{name}.py", description=about.splitlines()[0])
    parser.add_argument("program", nargs="?", default="stickslip", metavar="PROGRAM")
    parser.add_argument("-o", "--output", default=f"results/{name}", metavar="DIR", help=f"by default results/{name}")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="runs at a time, by default 2")
    return parser


def find_program(name):
    path = shutil.which(name) or (name if Path(name).is_file() else None)
    if path is None:
        raise InputError(f'there is no program "{name}"; build it, and name its path')
    return str(Path(path).resolve())
