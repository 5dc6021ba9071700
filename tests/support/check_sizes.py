#!/usr/bin/env python3
"""check_sizes.py SOURCE_DIR: fails and names what is too long to read.
check_sizes.py --self-test: fails where it would go unseen.

In core, methods and sensitivity a function has at most 60 lines and a file at most 400. methods/penalty.hpp has at most
60 lines, methods/uzawa.hpp 160: they read as a page of a textbook. A chain of includes has at most 20 of them.
"""

import os
import re
import sys
import tempfile

FOLDERS = ("core", "methods", "sensitivity")
MOST_OF_A_FUNCTION, MOST_OF_A_FILE, MOST_INCLUDES = 60, 400, 20
MOST_OF = {"methods/penalty.hpp": 60, "methods/uzawa.hpp": 160}
NO_FUNCTION = re.compile(r"\b(namespace|struct|class|enum|union|if|for|while|switch|catch)\b[^()]*$|"
                         r"^\s*(else\s+)?(if|for|while|switch|catch)\b|=\s*$")


def without_texts(text):
    """The source without comments and strings, line by line."""
    parts = r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\''
    return re.sub(parts, lambda part: "\n" * part.group().count("\n"), text, flags=re.DOTALL)


def functions(text):
    """(first line, number of lines) of each function that is in no other one."""
    text = re.sub(r"^[ \t]*#.*$", "", without_texts(text), flags=re.MULTILINE)
    found, begin, stack = [], 0, []  # of each open brace: where the function began, or None
    for at, sign in enumerate(text):
        if sign == "{":
            head = text[begin:at]
            inside = any(first is not None for first in stack)
            is_function = not inside and ")" in head and not NO_FUNCTION.search(head)
            stack.append(begin + len(head) - len(head.lstrip()) if is_function else None)
        elif sign == "}" and stack:
            first = stack.pop()
            if first is not None:
                found.append((text.count("\n", 0, first) + 1, text.count("\n", first, at) + 1))
        if sign in "{};":
            begin = at + 1
    return found


def longest_chain(file, includes, known):
    """[file, what it includes, ...], the longest."""
    if file not in known:
        known[file] = [file]  # (a circle ends here)
        known[file] = [file] + max((longest_chain(of, includes, known) for of in includes.get(file, [])), key=len,
                                   default=[])
    return known[file]


def faults(root):
    said, includes = [], {}
    for folder in FOLDERS:
        for path, _, names in sorted(os.walk(os.path.join(root, folder))):
            for name in sorted(names):
                if not name.endswith((".hpp", ".cpp")):
                    continue
                file = os.path.relpath(os.path.join(path, name), root)
                with open(os.path.join(path, name), encoding="utf-8") as f:
                    text = f.read()
                includes[file] = re.findall(r'^\s*#\s*include\s+"([^"]+)"', text, re.MULTILINE)
                lines, most = text.count("\n"), MOST_OF.get(file, MOST_OF_A_FILE)
                if lines > most:
                    said.append(f"{file}: {lines} lines, at most {most}")
                said += [f"{file}:{first}: a function of {count} lines, at most {MOST_OF_A_FUNCTION}"
                         for first, count in functions(text) if count > MOST_OF_A_FUNCTION]
    known = {}
    chain = max((longest_chain(file, includes, known) for file in sorted(includes)), key=len, default=[])
    if len(chain) > MOST_INCLUDES + 1:
        said.append(f"{len(chain) - 1} includes in a chain, at most {MOST_INCLUDES}: " + " -> ".join(chain))
    return said


def self_test():
    def said_of(files):
        with tempfile.TemporaryDirectory() as root:
            for file, text in files.items():
                os.makedirs(os.path.dirname(os.path.join(root, file)), exist_ok=True)
                with open(os.path.join(root, file), "w", encoding="utf-8") as f:
                    f.write(text)
            return faults(root)

    def body(lines):
        return "template <class T>\nstruct A {\n  int f(int x) const {  // {\n" + "    x;\n" * lines + "  }\n};\n"

    chain = {f"core/h{k:02}.hpp": f'#include "core/h{k + 1:02}.hpp"\n' for k in range(MOST_INCLUDES)}
    good = [{"core/a.hpp": body(MOST_OF_A_FUNCTION - 2)}, chain, {"studies/a.cpp": body(100)},
            {"core/a.hpp": "const int table[] = {\n" + "  1,\n" * 100 + "};\n"}]
    bad = [{"core/a.hpp": body(MOST_OF_A_FUNCTION - 1)}, {"methods/a.cpp": "\n" * (MOST_OF_A_FILE + 1)},
           {"methods/penalty.hpp": "\n" * 61}, {**chain, "core/i.hpp": '#include "core/h00.hpp"\n'}]
    return ([f"refused: {list(files)}" for files in good if said_of(files)] +
            [f"unseen: {list(files)}" for files in bad if not said_of(files)])


said = self_test() if sys.argv[1:] == ["--self-test"] else faults(sys.argv[1])
sys.exit("\n".join(said) or 0)
