#!/usr/bin/env python3
"""key_tables.py STICKSLIP [--check | --self-test]: prints the tables of keys in docs/*.md from `STICKSLIP schema`.

A table stands between the lines `<!-- keys FILE PATH -->` and `<!-- end of keys -->`; FILE is scene or study. PATH leads
to an object, as in bodies/NAME/mesh, loads/[], $defs/value; what has a table of its own is not repeated in the tables
around it. With --check nothing is written: exit code 1 where a table differs from the schema, or where a key has none.
"""
import json
import pathlib
import re
import subprocess
import sys

DOCS = pathlib.Path(__file__).resolve().parent.parent / "docs"
BLOCK = re.compile(r"(<!-- keys (\w+) ?(\S*) -->\n).*?(<!-- end of keys -->)", re.S)
AGAIN = {"swept_method", "mesh", "plane_mesh"}  # what has a table already: options as lists, meshes of other things


class Tables:
    """Tables of a schema; `own`: paths that have one. `shown` gathers the properties that were given a row."""

    def __init__(self, schema, own):
        self.schema, self.own, self.shown = schema, own, set()

    def resolved(self, node):
        """The node together with the definition that it refers to, and the name of that."""
        if "$ref" not in node:
            return node, None
        name = node["$ref"].rsplit("/", 1)[1]
        return {**self.resolved(self.schema["$defs"][name])[0], **node}, name

    def children(self, node):
        """(name, schema, when required) of what an object or a list holds, whichever alternative it is."""
        conditions = needs(node)
        for name, inner in node.get("properties", {}).items():
            self.shown.add(id(inner))
            yield name, inner, conditions.get(name, "")
        patterns = node.get("patternProperties", {})
        for name, inner in (*(("POINTER", inner) for inner in patterns.values()),
                            ("NAME", node.get("additionalProperties")), ("[]", node.get("items"))):
            if isinstance(inner, dict):
                yield name, inner, ""
        for alternative in node.get("anyOf", []):
            yield from self.children(alternative)

    def rows(self, path, node, prefix=""):
        """(key, schema, when required) of all below a path."""
        for name, inner, required in self.children(node):
            inner, definition = self.resolved(inner)
            for each in [inner] if name in node.get("properties", {}) else [inner, *inner.get("anyOf", [])]:
                if "description" in each:
                    yield prefix + name, each, required
            below = f"{path}/{name}".lstrip("/")
            if below not in self.own and definition not in AGAIN and f"$defs/{definition}" not in self.own:
                yield from self.rows(below, inner, f"{prefix}{name}/")

    def at(self, path):
        if path.startswith("$defs/"):
            return self.resolved(self.schema["$defs"][path.removeprefix("$defs/")])[0]
        node = self.schema
        for part in path.split("/") if path else []:
            node = self.resolved(next(inner for name, inner, _ in self.children(node) if name == part))[0]
        return node

    def table(self, path):
        lines = []  # neighbours of one object that differ in their names alone share a line
        for key, node, required in self.rows(path, self.at(path)):
            cells = [kind(node), standard(node, required), node["description"], example(key, node)]
            object_, _, name = f"{path}/{key}".strip("/").rpartition("/")
            if lines and lines[-1][0] == object_ and lines[-1][2][:3] == cells[:3]:
                lines[-1][1].append(name)
            else:
                lines.append((object_, [name], cells))
        head = "| key | where | type | default | meaning | example |\n|---|---|---|---|---|---|\n"
        return head + "".join(f"| {', '.join(f'`{name}`' for name in names)} | {place(object_)} | {' | '.join(cells)} |\n"
                              for object_, names, cells in lines)


def place(object_):
    """Which object holds a key, in the words of a table: one that several keys of a file lead to has a name of its own."""
    if not object_:
        return "top level"
    first, _, rest = object_.partition("/")
    if first != "$defs":
        return f"`{object_}`"
    name, _, inner = rest.partition("/")
    return f"`{inner}` of a {name.upper()}" if inner else f"a {name.upper()}"


def kind(node):
    if "enum" in node:
        return ", ".join(f"`{value}`" for value in node["enum"])
    if "title" in node:
        return node["title"].removeprefix("a ")
    return {"boolean": "true or false", "string": "text"}.get(node["type"], node["type"])


def shown(value):
    """A value as files hold it; 1000 for the 1000.0 that numbers become on the way."""
    return re.sub(r"(?<=\d)\.0(?=[,\]} ]|$)", "", json.dumps(value))


def standard(node, required):
    if "default" in node:
        return f"`{shown(node['default'])}`"
    return required


def needs(node):
    """When each key of an object is required, in words: always, beside another key, or where another is left out."""
    conditions = {}
    for word in ("oneOf", "anyOf"):
        alternatives = [each["required"] for each in node.get(word, []) if "required" in each]
        for keys in alternatives:
            others = [" and ".join(f"`{key}`" for key in other) for other in alternatives if other is not keys]
            for key in keys:
                if node.get("title") != "one of the following":
                    conditions[key] = f"required, or {', '.join(others)}"
                elif key != keys[0]:
                    conditions[key] = f"required with `{keys[0]}`"
    beside = node.get("if", {})
    for key in node.get("then", {}).get("required", []):
        conditions[key] = "required with " + ", ".join(
            [f"`{other}`" for other in beside.get("required", [])] +
            [f"`{other}` {value.get('const', 'a ' + value.get('type', ''))}"
             for other, value in beside.get("properties", {}).items()])
    for key in node.get("required", []):
        conditions[key] = "required"
    return conditions


def example(key, node):
    values = node.get("examples") or node.get("enum", [])[-1:]
    if not values and node.get("type") == "boolean":
        values = [not node["default"]]
    name = key.rsplit("/", 1)[-1]
    head = "" if name in ("NAME", "POINTER", "[]") else json.dumps(name) + ": "
    return ", ".join(f"`{head}{shown(value)}`" for value in values)


def described(node):
    """(name, schema) of all properties that are described, wherever they stand."""
    if isinstance(node, list):
        for each in node:
            yield from described(each)
    elif isinstance(node, dict):
        for name, inner in node.get("properties", {}).items():
            if isinstance(inner, dict) and "description" in inner:
                yield name, inner
        for name, inner in node.items():
            if name not in ("examples", "default"):
                yield from described(inner)


def compare(pages, schemas):
    """Pages with the tables of the schemas, and what was wrong with them."""
    own = {file: {m.group(3) for text in pages.values() for m in BLOCK.finditer(text) if m.group(2) == file}
           for file in schemas}
    # what both files may hold is explained with the scene
    shared = {path for path in own["scene"] if path.startswith("$defs/")}
    tables = {file: Tables(schema, own[file] | shared) for file, schema in schemas.items()}
    new = {path: BLOCK.sub(lambda m: m.group(1) + tables[m.group(2)].table(m.group(3)) + m.group(4), text)
           for path, text in pages.items()}
    wrong = [f"{path}: its tables are not those of the schema" for path in pages if new[path] != pages[path]]
    of_scene = {name: node for name, node in schemas["scene"]["$defs"].items() if name not in AGAIN}
    own_parts = {"scene": {**schemas["scene"], "$defs": of_scene}, "study": {**schemas["study"], "$defs": {}}}
    wrong += [f"the key {name} of a {file} is in no table" for file, parts in own_parts.items()
              for name, node in described(parts) if id(node) not in tables[file].shown]
    return new, wrong


def self_test(pages, schemas):
    """What must be seen: a changed word, a table that is gone."""
    path, text = next((path, text) for path, text in pages.items() if "<!-- keys scene loads/[] -->" in text)
    for changed in (text.replace("force per volume", "force"), text.replace("<!-- keys scene $defs/move -->", "")):
        if changed == text or not compare({**pages, path: changed}, schemas)[1]:
            sys.exit("a fault in the tables is not seen")


def main():
    program, mode = sys.argv[1], sys.argv[2:]
    pages = {path: path.read_text() for path in sorted(DOCS.glob("*.md"))}
    schemas = {file: json.loads(subprocess.run([program, "schema", file], check=True, capture_output=True).stdout)
               for file in ("scene", "study")}
    if mode == ["--self-test"]:
        return self_test(pages, schemas)
    new, wrong = compare(pages, schemas)
    if mode == ["--check"] and wrong:
        sys.exit("\n".join(wrong + ["tools/key_tables.py build/release/stickslip prints them anew"]))
    for path, text in new.items():
        if mode != ["--check"] and text != pages[path]:
            path.write_text(text)


if __name__ == "__main__":
    main()
