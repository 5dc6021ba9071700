"""Mesh files of Gmsh for fuzz.py: a box in MSH 2.2 and 4.1, sound, and changed in its structure."""


def grid(chance):
    """(nodes, elements): nodes (x, y), elements (type, group, nodes) of a box with all its sides."""
    columns, rows = chance.choice([(1, 1), (2, 1), (2, 2), (3, 2)])
    kind = chance.choice(["T3", "Q4", "Q4", "T6", "Q8"])
    middles = kind in ("T6", "Q8")
    nodes, at = [], {}

    def node(x, y):
        if (x, y) not in at:
            at[x, y] = len(nodes) + 1
            nodes.append((x / 2, y / 2))
        return at[x, y]

    def line(a, b):
        middle = [node((a[0] + b[0]) // 2, (a[1] + b[1]) // 2)] if middles else []
        return (8 if middles else 1), [node(*a), node(*b), *middle]

    def cell(corners):
        ends = [node(*c) for c in corners]
        edges = list(zip(corners, corners[1:] + corners[:1]))
        between = [node((a[0] + b[0]) // 2, (a[1] + b[1]) // 2) for a, b in edges] if middles else []
        return {(3, False): 2, (4, False): 3, (3, True): 9, (4, True): 16}[len(corners), middles], ends + between

    elements = []
    width, height = 2 * columns, 2 * rows
    for x in range(0, width, 2):
        elements.append((line((x, 0), (x + 2, 0)), 1))
        elements.append((line((x + 2, height), (x, height)), 2))
    for y in range(0, height, 2):
        elements.append((line((0, y + 2), (0, y)), 4))
        for x in range(0, width, 2):
            square = [(x, y), (x + 2, y), (x + 2, y + 2), (x, y + 2)]
            for corners in [square] if kind[0] == "Q" else [square[:3], [square[0], *square[2:]]]:
                elements.append((cell(corners), 3))
    return nodes, [(kind_, group, of) for (kind_, of), group in elements]


NAMES = [(1, 1, "bottom"), (1, 2, "top"), (2, 3, "block"), (1, 4, "left")]
DIMENSION = {1: 1, 2: 1, 3: 2, 4: 1}


def head(version):
    lines = ["$MeshFormat", f"{version} 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(NAMES))]
    return lines + [f'{d} {n} "{name}"' for d, n, name in NAMES] + ["$EndPhysicalNames"]


def msh2(nodes, elements):
    lines = head("2.2") + ["$Nodes", str(len(nodes))]
    lines += [f"{i} {x:g} {y:g} 0" for i, (x, y) in enumerate(nodes, 1)]
    lines += ["$EndNodes", "$Elements", str(len(elements))]
    for i, (kind, group, of) in enumerate(elements, 1):
        lines.append(f"{i} {kind} 2 {group} {group} {' '.join(map(str, of))}")
    return lines + ["$EndElements"]


def msh4(nodes, elements):
    """Each group is an entity with its number; all nodes are of the surface."""
    xs, ys = [x for x, _ in nodes], [y for _, y in nodes]
    span = f"{min(xs):g} {min(ys):g} 0 {max(xs):g} {max(ys):g} 0"
    lines = head("4.1") + ["$Entities", "0 3 1 0"]
    lines += [f"{group} {span} 1 {group} 0" for group in (1, 2, 4)] + [f"3 {span} 1 3 3 1 2 4", "$EndEntities"]
    lines += ["$Nodes", f"1 {len(nodes)} 1 {len(nodes)}", f"2 3 0 {len(nodes)}"]
    lines += [str(i) for i in range(1, len(nodes) + 1)] + [f"{x:g} {y:g} 0" for x, y in nodes] + ["$EndNodes"]
    blocks = {}
    for kind, group, of in elements:
        blocks.setdefault((group, kind), []).append(of)
    lines += ["$Elements", f"{len(blocks)} {len(elements)} 1 {len(elements)}"]
    number = 0
    for (group, kind), all_of in blocks.items():
        lines.append(f"{DIMENSION[group]} {group} {kind} {len(all_of)}")
        for of in all_of:
            number += 1
            lines.append(f"{number} {' '.join(map(str, of))}")
    return lines + ["$EndElements"]


VALUES = ["0", "-1", "1", "2", "3", "4", "7", "99999", "2147483648", "-9223372036854775809", "1e308", "nan", "inf",
          "1e999", "0.5", "x", "", "1e-300", '"', "$EndNodes", "16", "15", "8"]


def change(lines, chance):
    """One change of the structure, in place."""
    kind = chance.randrange(9)
    at = chance.randrange(len(lines))
    if kind <= 3:  # a word
        words = lines[at].split(" ")
        words[chance.randrange(len(words))] = chance.choice(VALUES)
        lines[at] = " ".join(words)
    elif kind == 4:
        del lines[at]
    elif kind == 5:
        lines.insert(chance.randrange(len(lines) + 1), lines[at])
    elif kind == 6:
        other = chance.randrange(len(lines))
        lines[at], lines[other] = lines[other], lines[at]
    elif kind == 7:  # a section twice, gone, or elsewhere
        begins = [i for i, line in enumerate(lines) if line.startswith("$") and not line.startswith("$End")]
        if begins:
            first = chance.choice(begins)
            last = next((i for i in range(first, len(lines)) if lines[i].startswith("$End")), len(lines) - 1)
            section = lines[first:last + 1]
            if chance.random() < 0.7:
                del lines[first:last + 1]
            to = chance.randrange(len(lines) + 1)
            lines[to:to] = section * chance.choice([0, 1, 1])
    else:  # nodes in another order, moved, or two in one place
        words = lines[at].split(" ")
        chance.shuffle(words)
        lines[at] = " ".join(words)
    if not lines:
        lines.append("")


def mesh(chance):
    """A mesh file as lines."""
    lines = chance.choice([msh2, msh4])(*grid(chance))
    for _ in range(chance.choice([0, 1, 1, 1, 2, 4])):
        change(lines, chance)
    return lines
