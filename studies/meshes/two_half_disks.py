#!/usr/bin/env python3
"""Writes two_half_disks.msh (MSH 4.1 ASCII): meshes the quarter of two_half_disks.geo with gmsh and mirrors it.

The coordinates of mirror images are equal but for their sign, to the last bit: the nodes of the two contact curves
match exactly. Physical surfaces upper, lower; physical curves upper_contact, upper_rest, upper_flat and the same of lower.
"""
import pathlib
import subprocess
import tempfile

FOLDER = pathlib.Path(__file__).resolve().parent
CURVES = ("contact", "rest", "flat")
BODIES = (("upper", 1), ("lower", -1))


def quarter():
    """Nodes {tag: (x, y)} and elements [(kind, node tags)] of the quarter; kind 1..3 is a curve, 4 the surface."""
    with tempfile.TemporaryDirectory() as folder:
        mesh = pathlib.Path(folder) / "quarter.msh"
        subprocess.run(["gmsh", FOLDER / "two_half_disks.geo", "-2", "-format", "msh22", "-o", mesh],
                       check=True, stdout=subprocess.DEVNULL)
        lines = mesh.read_text().splitlines()
    first = lines.index("$Nodes") + 2
    nodes = {}
    for line in lines[first:lines.index("$EndNodes")]:
        tag, x, y, _ = line.split()
        nodes[int(tag)] = (float(x), float(y))
    first = lines.index("$Elements") + 2
    elements = []
    for line in lines[first:lines.index("$EndElements")]:
        _, _, _, physical, _, *tags = map(int, line.split())
        elements.append((physical, tags))
    return nodes, elements


def body(nodes, elements, up):
    """Points [(x, y)] and {kind: [node positions]} of a half disk: the quarter and its mirror image in x = 0."""
    points, position, cells = [], {}, {1: [], 2: [], 3: [], 4: []}
    for side in (1, -1):
        for tag, (x, y) in nodes.items():
            if side == -1 and x == 0:
                position[side, tag] = position[1, tag]
            else:
                position[side, tag] = len(points)
                points.append((side * x, up * y))
        for kind, tags in elements:
            cell = [position[side, tag] for tag in tags]
            cells[kind].append(cell if side * up == 1 else cell[::-1])
    return points, cells


def main():
    nodes, elements = quarter()
    bodies = [body(nodes, elements, up) for _, up in BODIES]
    names, curves, surfaces, node_blocks, element_blocks = [], [], [], [], []
    count = element_count = 0
    for number, ((name, _), (points, cells)) in enumerate(zip(BODIES, bodies), 1):
        box = "-8 -8 0 8 8 0"
        names.append(f'2 {number} "{name}"')
        surfaces.append(f"{number} {box} 1 {number} 0")
        first = count + 1
        node_blocks.append(f"2 {number} 0 {len(points)}")
        node_blocks += [str(first + i) for i in range(len(points))]
        node_blocks += [f"{x!r} {y!r} 0" for x, y in points]
        count += len(points)
        for kind, each in cells.items():
            tag = 10 * number + kind
            if kind < 4:
                names.append(f'1 {tag} "{name}_{CURVES[kind - 1]}"')
                curves.append(f"{tag} {box} 1 {tag} 0")
            element_blocks.append(f"2 {number} 2 {len(each)}" if kind == 4 else f"1 {tag} 1 {len(each)}")
            for cell in each:
                element_count += 1
                element_blocks.append(" ".join(map(str, [element_count] + [first + i for i in cell])))
    sections = (("MeshFormat", ["4.1 0 8"]),
                ("PhysicalNames", [len(names)] + sorted(names)),
                ("Entities", [f"0 {len(curves)} {len(surfaces)} 0"] + curves + surfaces),
                ("Nodes", [f"2 {count} 1 {count}"] + node_blocks),
                ("Elements", [f"8 {element_count} 1 {element_count}"] + element_blocks))
    text = "".join(f"${name}\n" + "".join(f"{line}\n" for line in lines) + f"$End{name}\n" for name, lines in sections)
    (FOLDER / "two_half_disks.msh").write_text(text)
    print(f"two_half_disks.msh: {count} nodes, {element_count} elements")


if __name__ == "__main__":
    main()
