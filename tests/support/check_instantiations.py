#!/usr/bin/env python3
"""What STICKSLIP_SLOTS and its like instantiate for a scalar is compiled in one source, and in no other.

Without an extern declaration, a source that is joined to the definitions compiles them again. No result shows that;
the build takes minutes more.

usage: check_instantiations.py LIBRARY...
"""
import collections
import re
import subprocess
import sys

NAMES = ("kernels_of_shape", "bulk_forces", "make_slots", "evaluate_contact", "next_history", "point_tangent",
         "find_equilibrium", "solve_increment")


def defined_in(library):
    """(name, mangled name) of each function above that a member of the library defines."""
    listed = subprocess.run(["nm", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    for name in NAMES:
        for symbol in re.findall(rf" [TW] (_ZN9stickslip{len(name)}{name}I\S+)$", listed, re.MULTILINE):
            yield name, symbol


def main(libraries):
    counts = collections.Counter(found for library in libraries for found in defined_in(library))
    absent = [name for name in NAMES if not any(name == of for of, _ in counts)]
    if absent:
        sys.exit(f"no library defines {', '.join(absent)}: the list of this check is out of date")
    again = [(symbol, count) for (_, symbol), count in counts.items() if count > 1]
    for symbol, count in again:
        plain = subprocess.run(["c++filt", symbol], capture_output=True, text=True, check=True).stdout.strip()
        print(f"compiled in {count} sources: {plain}")
    sys.exit(1 if again else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
