#!/usr/bin/env python3
"""calculix_punch.py FILE: the punch of punch.json by CalculiX (calculix-ccx), as a solution that stickslip verifies:

    stickslip run studies/peers/punch.json -o results/punch
    studies/peers/calculix_punch.py calculix.json
    stickslip verify results/punch --solution calculix.json

A slice of C3D20, of thickness 1, that may not move across its plane, on a block that stays where it is. The contact is by
springs, and its file has six digits: `accuracy` says so.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

E, NU, PRESSED, STEPS, STIFFNESS = 1000.0, 0.3, 0.01, 4, 1e9
ACROSS, UP = 8, 4  # elements

nodes = {}  # (column, row, layer) in halves of elements: number
for layer in range(3):
    for row in range(2 * UP + 1):
        for column in range(2 * ACROSS + 1):
            if (column % 2) + (row % 2) + (layer % 2) < 2:
                nodes[column, row, layer] = len(nodes) + 1


def at(place):
    return 2.0 * place[0] / (2 * ACROSS), 1.0 * place[1] / (2 * UP), 0.5 * place[2]


def brick(i, j):
    """The 20 nodes of an element: corners of both layers, middles of both, and what is between the layers."""
    corners = [(0, 0), (2, 0), (2, 2), (0, 2)]
    middles = [(1, 0), (2, 1), (1, 2), (0, 1)]
    places = [(a, b, 0) for a, b in corners] + [(a, b, 2) for a, b in corners]
    places += [(a, b, 0) for a, b in middles] + [(a, b, 2) for a, b in middles] + [(a, b, 1) for a, b in corners]
    return [nodes[2 * i + a, 2 * j + b, c] for a, b, c in places]


def numbered(rows):
    return "\n".join(", ".join(map(str, row)) for row in rows)


floor = [(-1, -1, -1), (3, -1, -1), (3, 0, -1), (-1, 0, -1), (-1, -1, 2), (3, -1, 2), (3, 0, 2), (-1, 0, 2)]
bricks = [(1 + i + ACROSS * j, *brick(i, j)) for j in range(UP) for i in range(ACROSS)]
front = [number for place, number in nodes.items() if place[2] == 0]
top = [number for place, number in nodes.items() if place[1] == 2 * UP]
text = f"""*NODE, NSET=all
{numbered((number, *at(place)) for place, number in nodes.items())}
*NODE, NSET=floor
{numbered((9001 + k, *x) for k, x in enumerate(floor))}
*ELEMENT, TYPE=C3D20, ELSET=punch
{numbered((*b[:15], chr(10) + " " + str(b[15]), *b[16:]) for b in bricks)}
*ELEMENT, TYPE=C3D8, ELSET=below
9001, {", ".join(str(9001 + k) for k in range(8))}
*NSET, NSET=front
{numbered((number,) for number in front)}
*NSET, NSET=top
{numbered((number,) for number in top)}
*MATERIAL, NAME=elastic
*ELASTIC
{E}, {NU}
*SOLID SECTION, ELSET=punch, MATERIAL=elastic
*SOLID SECTION, ELSET=below, MATERIAL=elastic
*SURFACE, NAME=sole
{numbered((1 + i, "S3") for i in range(ACROSS))}
*SURFACE, NAME=ground
9001, S5
*SURFACE INTERACTION, NAME=hard
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
{STIFFNESS}
*CONTACT PAIR, INTERACTION=hard, TYPE=SURFACE TO SURFACE
sole, ground
*BOUNDARY
floor, 1, 3
all, 3, 3
*STEP
*STATIC, DIRECT
{1 / STEPS}, 1
*BOUNDARY
top, 1, 1
top, 2, 2, {-PRESSED}
*NODE PRINT, NSET=front
U
*END STEP
"""
with tempfile.TemporaryDirectory() as folder:
    (pathlib.Path(folder) / "punch.inp").write_text(text)
    subprocess.run(["ccx", "punch"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    lines = [line.split() for line in (pathlib.Path(folder) / "punch.dat").read_text().splitlines()]
increments = []
for line in lines:
    if "time" in line:  # heads the displacements of an increment
        increments.append({"time": float(line[-1]), "displacement": []})
    elif len(line) == 4 and line[0].isdigit():  # in the order of `front`
        increments[-1]["displacement"] += [float(u) for u in line[1:3]]

places = {number: place for place, number in nodes.items()}
with open(sys.argv[1], "w") as file:
    json.dump({"schema": "stickslip_solution", "version": 1, "accuracy": 1e-5,
               "nodes": [at(places[number])[:2] for number in front],
               "increments": increments}, file)
