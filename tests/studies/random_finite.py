#!/usr/bin/env python3
"""Random scenes at finite strain: rubber and metal, every element, obstacle and surface, bodies on bodies, in rings, in
boxes and on themselves, supports that turn back. Each is solved by every method. Prints, per class, how many runs do
not converge and why, and how far the methods are apart.

    random_finite.py STICKSLIP [--count 10] [--seed 1] [--classes ...] [--surfaces as_drawn ...] [--methods ...]
                     [--seconds 60] [--jobs 1] [--keep DIR] [--verify] [--most-unsolved SHARE]

The scene of a class and a number is the same on every machine. The surface that it has is drawn with it (`as_drawn`), or
named, which leaves all else as it is. The exit code is 1 if a run crashes or hangs, if methods disagree without a word,
if a converged run fails its certificate (--verify), or if more than SHARE of all runs are unsolved.
"""
import argparse
import json
import math
import random
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SURFACES = {
    "default": {},
    "facets": {"surface": "faceted"},
    "catmull_rom": {"surface": "smooth"},
    "b_spline": {"surface": {"smooth": "b_spline"}},
    "segment": {"discretization": "segment"},
}
METHODS = ["monolithic_al", "uzawa_al", "penalty"]
MARGIN = {"uzawa_al": 1e-6, "penalty": 0.05}  # of the largest force: Uzawa's tolerance; the penetration of springs


class Draw:
    """What a scene is made of, drawn one after the other."""

    def __init__(self, name):
        self.rng = random.Random(name)
        self.uniform, self.choice, self.whole = self.rng.uniform, self.rng.choice, self.rng.randint

    def body(self, mesh, metal=True, elements=("Q4", "Q4_mean_dilatation", "Q8", "T3", "T6"), soft=1.0):
        E, nu = 10 ** self.uniform(2.5, 3.5) / soft, self.uniform(0.2, 0.45)
        element = self.choice(elements)
        if metal and self.rng.random() < 0.25:
            material = {"j2_plastic": {"E": E, "nu": 0.3, "yield": E * self.uniform(0.01, 0.05),
                                       "hardening": E * self.uniform(0.01, 0.1)}}
            element = self.choice([e for e in elements if e in ("Q4_mean_dilatation", "Q8", "T6")] or elements)
        else:
            material = {"neo_hookean": {"E": E, "nu": nu}}
        return {"mesh": mesh, "material": material, "element": element}

    def box(self, low, high, cells, **how):
        return self.body({"box": {"min": low, "max": high, "cells": cells}}, **how)

    def friction(self):
        return {} if self.rng.random() < 0.2 else {"friction": self.uniform(0.05, 0.6)}

    def surface(self):
        return self.choice(["facets", "catmull_rom", "b_spline", "segment"])

    def there_and_back(self, way):
        """A table from t = 1 to t = 2 that goes by `way`, and in half of the scenes turns."""
        turn = self.choice([None, self.uniform(-0.5, 0.8)])
        return [[0, 0], [1, 0], [2, way]] if turn is None else [[0, 0], [1, 0], [1.6, way], [2, turn * way]]

    def time(self):
        return {"legs": [[1, self.whole(2, 8)], [2, self.whole(2, 12)]]}


def over_obstacle(draw, obstacle, reach=1.0):
    """A block, or a half disk, pressed onto an obstacle whose top is at the origin, and drawn along."""
    width, height = draw.uniform(0.8, 2), draw.uniform(0.5, 1.2)
    if draw.choice([True, False]):
        body = draw.box([-width / 2, 0], [width / 2, height], [draw.whole(3, 10), draw.whole(2, 4)])
        slave, held, thick = "body.bottom", "body.top", height
    else:
        radius = width / 2
        body = draw.body({"half_disk": {"center": [0, radius], "radius": radius,
                                        "cells": [draw.whole(4, 8), draw.whole(4, 6)]}},
                         elements=("Q4", "Q4_mean_dilatation", "Q8"))
        slave, held, thick = "body.arc", "body.flat", radius
    press = draw.uniform(0.02, 0.12) * thick
    way = draw.choice([-1, 1]) * draw.uniform(0.1, 1.2) * reach
    return {"bodies": {"body": body}, "obstacles": {"tool": obstacle},
            "contacts": {"c": dict(slave=slave, master="tool", **draw.friction())},
            "supports": [{"on": held, "move": {"x": draw.there_and_back(way), "y": [[0, 0], [1, -press]]}}],
            "press_on": held}


def plane(draw):
    angle = math.radians(draw.uniform(-20, 20))
    scene = over_obstacle(draw, {"plane": {"point": [0, 0], "normal": [0, 1]}})
    scene["obstacles"]["tool"]["plane"]["normal"] = [math.sin(angle) * 0.1, math.cos(angle)]
    return scene


def circle(draw):
    radius = draw.uniform(0.4, 4)
    scene = over_obstacle(draw, {"circle": {"center": [0, -radius], "radius": radius}}, reach=0.5 * radius)
    if draw.choice([True, False]):
        scene["obstacles"]["tool"]["rotate"] = {"center": [0, -radius],
                                                "angle": [[0, 0], [1, 0], [2, draw.uniform(-40, 40)]]}
    return scene


def cup(draw):
    radius = draw.uniform(1.1, 2)
    inner = radius * draw.uniform(0.5, 0.9)
    body = draw.body({"half_disk": {"center": [0, inner], "radius": inner,
                                    "cells": [draw.whole(4, 8), draw.whole(4, 6)]}},
                     elements=("Q4", "Q4_mean_dilatation", "Q8"))
    press = draw.uniform(0.03, 0.1) * inner
    room = math.sqrt(radius**2 - (radius - inner + press)**2) - inner  # beside the corners of the flat side
    way = draw.choice([-1, 1]) * draw.uniform(0.2, 0.8) * room
    return {"bodies": {"body": body},
            "obstacles": {"tool": {"circle": {"center": [0, radius], "radius": radius, "inside": True}}},
            "contacts": {"c": dict(slave="body.arc", master="tool", **draw.friction())},
            "supports": [{"on": "body.flat", "move": {"x": draw.there_and_back(way), "y": [[0, 0], [1, -press]]}}],
            "press_on": "body.flat"}


def polyline(draw):
    """Of a random profile, waves or a step that ends; the body slides over its vertices, and past its end."""
    kind = draw.choice(["waves", "step", "end", "random"])
    if kind == "waves":
        high, long = draw.uniform(0.02, 0.1), draw.uniform(0.8, 2)
        points = [[x, high * (math.cos(2 * math.pi * x / long) - 1)] for x in
                  [-3 + 6 * i / 48 for i in range(49)]]
    elif kind == "step":
        a, rise = draw.uniform(0.8, 1.2), draw.uniform(0.05, 0.2)
        points = [[-3, 0], [a, 0], [a + draw.uniform(0.2, 0.6), rise], [4, rise]]
    elif kind == "end":
        points = [[-3, 0], [draw.uniform(0.3, 1.2), 0]]
    else:
        points = [[-3 + 0.5 * i, draw.uniform(-0.06, 0)] for i in range(14)]
    scene = over_obstacle(draw, {"polyline": {"points": points}})
    scene["contacts"]["c"]["on"] = "surface"
    return scene


def slide(draw):
    """A block on a longer slab, whichever of them is the slave, past ends too."""
    width, height, beyond, depth = (draw.uniform(0.8, 2), draw.uniform(0.5, 1.2), draw.uniform(0.3, 1.2),
                                    draw.uniform(0.5, 1.2))
    way = draw.choice([-1, 1]) * draw.uniform(0.05, 1.3) * (beyond + 0.3 * width)
    press = draw.uniform(0.01, 0.12) * min(height, depth)
    sides = draw.choice([["slab.top", "block.bottom"], ["block.bottom", "slab.top"]])
    return {"bodies": {"block": draw.box([0, 0], [width, height], [draw.whole(3, 10), draw.whole(2, 4)]),
                       "slab": draw.box([-beyond, -depth], [width + beyond, 0], [draw.whole(4, 14), draw.whole(2, 3)])},
            "contacts": {"c": dict(slave=sides[0], master=sides[1], on="surface", **draw.friction())},
            "supports": [{"on": "slab.bottom", "move": {"x": 0, "y": 0}},
                         {"on": "block.top", "move": {"x": draw.there_and_back(way), "y": [[0, 0], [1, -press]]}}],
            "press_on": "block.top"}


def ironing(draw):
    """A round or a sharp-cornered die, pressed into a slab and drawn over it."""
    long, depth, die = draw.uniform(3, 5), draw.uniform(0.6, 1.2), draw.uniform(0.4, 0.8)
    if draw.choice([True, False]):
        body = draw.body({"half_disk": {"center": [0, die], "radius": die, "cells": [draw.whole(6, 10), draw.whole(5, 6)]}},
                         elements=("Q4", "Q4_mean_dilatation", "Q8"), metal=False, soft=0.1)
        side, held = "die.arc", "die.flat"
    else:
        body = draw.box([-die / 2, 0], [die / 2, die], [draw.whole(3, 8), draw.whole(3, 6)], metal=False, soft=0.1)
        side, held = "die.bottom", "die.top"
    sides = draw.choice([[side, "slab.top"], ["slab.top", side]])
    start = -0.2 * long
    slab = draw.box([start - 0.5, -depth], [start + long, 0], [draw.whole(12, 30), draw.whole(3, 5)])
    way = draw.uniform(0.2, 0.5) * long
    return {"bodies": {"die": body, "slab": slab},
            "contacts": {"c": dict(slave=sides[0], master=sides[1], on="surface", **draw.friction())},
            "supports": [{"on": "slab.bottom", "move": {"x": 0, "y": 0}},
                         {"on": held, "move": {"x": draw.there_and_back(way),
                                               "y": [[0, 0], [1, -draw.uniform(0.05, 0.2) * depth]]}}],
            "press_on": held}


def stack(draw):
    """Two or three blocks of other widths on one another, pressed from above and sheared."""
    bodies, contacts, low, count = {}, {}, 0.0, draw.whole(2, 3)
    for k in range(count):
        half, height = draw.uniform(0.5, 1.2), draw.uniform(0.4, 0.9)
        bodies[f"b{k}"] = draw.box([-half, low], [half, low + height], [draw.whole(3, 9), draw.whole(2, 4)])
        low += height
        if k:
            sides = [f"b{k}.bottom", f"b{k - 1}.top"]
            if draw.choice([True, False]):
                sides.reverse()
            contacts[f"c{k}"] = dict(slave=sides[0], master=sides[1], on="surface", friction=draw.uniform(0.1, 0.6))
    top = f"b{count - 1}.top"
    return {"bodies": bodies, "contacts": contacts,
            "supports": [{"on": "b0.bottom", "move": {"x": 0, "y": 0}},
                         {"on": top, "move": {"x": draw.there_and_back(draw.uniform(-0.3, 0.3)),
                                              "y": [[0, 0], [1, -draw.uniform(0.02, 0.2) * low]]}}],
            "press_on": top}


def rings(draw):
    """One ring pressed into another, and turned in it."""
    radius, overlap = draw.uniform(1.5, 3), draw.uniform(0.002, 0.05)
    inner = draw.body({"ring": {"center": [0, 0], "inner": radius * draw.uniform(0.4, 0.7), "outer": radius + overlap,
                                "cells": [draw.whole(2, 4), draw.whole(16, 40)]}}, metal=False)
    outer = draw.body({"ring": {"center": [0, 0], "inner": radius, "outer": radius * draw.uniform(1.3, 2),
                                "cells": [draw.whole(2, 4), draw.whole(16, 40)]}}, metal=False)
    turn = {"center": [0, 0], "angle": [[0, 0], [1, 0], [2, draw.uniform(1, 10)]]}
    sides = draw.choice([["a.outer", "b.inner"], ["b.inner", "a.outer"]])
    return {"bodies": {"a": inner, "b": outer},
            "contacts": {"c": dict(slave=sides[0], master=sides[1], on="surface", **draw.friction())},
            "supports": [{"on": "b.outer", "move": {"x": 0, "y": 0}}, {"on": "a.inner", "rotate": turn}],
            "press_on": "a.inner"}


def disks(draw):
    """Disks between plates that come together, in contact all with all."""
    radius, count = draw.uniform(0.4, 0.6), draw.whole(2, 3)
    bodies = {f"d{k}": draw.body({"disk": {"center": [(2 * k - count + 1) * radius, radius], "radius": radius,
                                           "cells": [draw.whole(3, 6), draw.whole(2, 4)]}},
                                 elements=("Q4", "Q4_mean_dilatation", "Q8")) for k in range(count)}
    half = count * radius + 0.3
    bodies["base"] = draw.box([-half, -0.5], [half, 0], [draw.whole(6, 14), 2], metal=False)
    bodies["lid"] = draw.box([-half, 2 * radius], [half, 2 * radius + 0.5], [draw.whole(6, 14), 2], metal=False)
    return {"bodies": bodies, "contacts": {"c": dict(between="all", friction=draw.uniform(0.1, 0.6))},
            "supports": [{"on": "base.bottom", "move": {"x": 0, "y": 0}},
                         {"on": "lid.top", "move": {"x": draw.there_and_back(draw.uniform(-0.2, 0.2)),
                                                    "y": [[0, 0], [1, -draw.uniform(0.05, 0.25) * radius]]}}],
            "press_on": "lid.top"}


def tube(draw):
    """A ring flattened between planes until its inside touches itself."""
    inner = draw.uniform(0.6, 0.85)
    ring = draw.body({"ring": {"center": [0, 0], "inner": inner, "outer": 1,
                               "cells": [draw.whole(1, 3), draw.whole(24, 48)]}}, metal=False,
                     elements=("Q4", "Q4_mean_dilatation", "Q8"))
    down = draw.uniform(0.5, 1.02) * 2 * inner
    return {"bodies": {"tube": ring},
            "obstacles": {"floor": {"plane": {"point": [0, -1], "normal": [0, 1]}},
                          "lid": {"plane": {"point": [0, 1], "normal": [0, -1]},
                                  "move": {"y": [[0, 0], [1, -0.5 * down], [2, -down]]}}},
            "contacts": {"below": dict(slave="tube.outer", master="floor", friction=0.3),
                         "above": dict(slave="tube.outer", master="lid", friction=0.3),
                         "self": dict(slave="tube.inner", master="tube.inner", **draw.friction())},
            "press_on": None}


def side_of(kind, mesh, side):
    """A side of a generated mesh as a rigid obstacle."""
    return {"mesh_side": {"mesh": {kind: mesh}, "side": side}}


def tool(draw):
    """A body on the side of a rigid mesh: a disk's, a ring's, or all sides of a block, over whose corners it slides; in
    space a ball's, a drum's or a block's."""
    if draw.choice([True, False]):
        return over_tool(draw, ["ball", "drum", "block"])
    radius, cells = draw.uniform(0.4, 4), draw.whole(4, 24)
    disk = {"center": [0, -radius], "radius": radius, "cells": [cells, 1]}
    ring = {"center": [0, -radius], "inner": radius / 2, "outer": radius, "cells": [1, 4 * cells]}
    block = {"min": [-draw.uniform(0.4, 2), -0.5], "max": [draw.uniform(0.4, 2), 0], "cells": [cells, 2]}
    kind = draw.choice(["disk", "ring", "box"])
    sides = {"disk": side_of("disk", disk, "arc"), "ring": side_of("ring", ring, "outer"),
             "box": side_of("box", block, "boundary")}
    scene = over_obstacle(draw, sides[kind], reach=1 if kind == "box" else 0.5 * radius)
    scene["contacts"]["c"]["on"] = "surface"
    return scene


def solid(draw):
    """A block or a tube of space, pressed onto a plane, a ball or a drum, dragged along two directions and twisted."""
    return over_tool(draw, ["plane", "plane", "sphere", "cylinder"])


def over_tool(draw, kinds):
    """A block or a tube of space, pressed onto one of these tools, dragged along two directions and twisted."""
    width, depth, height = draw.uniform(0.8, 2), draw.uniform(0.8, 2), draw.uniform(0.5, 1.2)
    elements = ("H8", "H8_mean_dilatation", "T4")
    if draw.choice([True, False]):
        body = draw.body({"box": {"min": [-width / 2, -depth / 2, 0], "max": [width / 2, depth / 2, height],
                                  "cells": [draw.whole(2, 5), draw.whole(2, 5), draw.whole(2, 4)]}}, elements=elements)
        sole, held = "body.bottom", "body.top"
    else:
        ring = {"ring": {"center": [0, 0], "inner": 0.25 * width, "outer": width / 2,
                         "cells": [draw.whole(1, 3), draw.whole(8, 16)]}}
        body = draw.body({"extruded": {"mesh": ring, "from": 0, "to": height, "cells": draw.whole(2, 4)}},
                         elements=elements)
        sole, held = "body.front", "body.back"
    if "j2_plastic" in body["material"]:
        body["element"] = "H8_mean_dilatation"
    kind = draw.choice(kinds)
    radius = draw.uniform(1, 5)
    ring = {"ring": {"center": [0, -radius], "inner": radius / 2, "outer": radius, "cells": [1, 40]}}
    tool = {"plane": {"plane": {"point": [0, 0, 0], "normal": [draw.uniform(-0.05, 0.05), draw.uniform(-0.05, 0.05), 1]}},
            "sphere": {"sphere": {"center": [0, 0, -radius], "radius": radius}},
            "cylinder": {"cylinder": {"point": [0, 0, -radius], "axis": [draw.uniform(-1, 1), 1, 0], "radius": radius}},
            "ball": side_of("ball", {"center": [0, 0, -radius], "radius": radius, "cells": [10, 1]}, "surface"),
            "drum": side_of("extruded", {"mesh": ring, "from": -3, "to": 3, "cells": 8}, "outer"),
            "block": side_of("box", {"min": [-0.5 * width, -depth, -1], "max": [0.7 * width, depth, 0],
                                     "cells": [5, 8, 2]}, "boundary")}
    contact = dict(slave=sole, master="tool", **draw.friction())
    if draw.choice([True, False]):
        tool[kind]["rotate"] = {"center": [0, 0, -radius], "axis": [draw.uniform(-0.2, 0.2), draw.uniform(-0.2, 0.2), 1],
                                "angle": draw.there_and_back(draw.uniform(-5, 5))}
    press = draw.uniform(0.02, 0.1) * height
    support = {"on": held, "move": {"x": draw.there_and_back(draw.uniform(-0.5, 0.5)),
                                    "y": draw.there_and_back(draw.uniform(-0.5, 0.5)), "z": [[0, 0], [1, -press]]},
               "rotate": {"center": [0, 0, height], "axis": [draw.uniform(-0.1, 0.1), draw.uniform(-0.1, 0.1), 1],
                          "angle": draw.there_and_back(draw.uniform(-10, 10))}}
    return {"space": "solid", "bodies": {"body": body}, "obstacles": {"tool": tool[kind]}, "contacts": {"c": contact},
            "supports": [support], "press_on": held}


def pile(draw):
    """Small strain: a block of space on another whose nodes do not match, pressed, dragged and twisted."""
    def box(low, high):
        material = draw.choice([{"linear_elastic": {"E": draw.uniform(100, 2000), "nu": draw.uniform(0, 0.4)}},
                                {"j2_plastic": {"E": draw.uniform(500, 2000), "nu": 0.3, "yield": draw.uniform(2, 20),
                                                "hardening": 50}}])
        element = "H8_mean_dilatation" if "j2_plastic" in material else draw.choice(["H8", "T4"])
        cells = [draw.whole(2, 5), draw.whole(2, 5), draw.whole(1, 3)]
        return {"mesh": {"box": {"min": low, "max": high, "cells": cells}}, "material": material, "element": element}
    upper = box([draw.uniform(0.02, 0.4), draw.uniform(0.02, 0.4), 1], [draw.uniform(0.9, 1.4), draw.uniform(0.9, 1.4), 1.6])
    lower = box([0, 0, 0], [1.5, 1.5, 1])
    press = draw.uniform(0.002, 0.02)
    supports = [{"on": "lower.bottom", "move": {"x": 0, "y": 0, "z": 0}},
                {"on": "upper.top", "move": {"x": draw.there_and_back(draw.uniform(-0.02, 0.02)),
                                             "y": draw.there_and_back(draw.uniform(-0.02, 0.02)),
                                             "z": [[0, 0], [1, -press]]},
                 "rotate": {"center": [0.7, 0.7, 1.6], "axis": [draw.uniform(-0.1, 0.1), draw.uniform(-0.1, 0.1), 1],
                            "angle": draw.there_and_back(draw.uniform(-1, 1))}}]
    return {"space": "solid", "strain": "small", "bodies": {"upper": upper, "lower": lower},
            "contacts": {"c": dict(slave="upper.bottom", master="lower.top", **draw.friction())}, "supports": supports,
            "press_on": "upper.top"}


def drag(draw):
    """A block of space, or a half ball, on a slab, whichever of them is the slave: pressed, dragged, past edges too."""
    width, depth, beyond = draw.uniform(0.8, 2), draw.uniform(0.8, 2), draw.uniform(0.2, 0.8)
    elements = ("H8", "H8_mean_dilatation", "T4", "T10", "H20", "H27")
    if draw.choice([True, False]):
        height = draw.uniform(0.5, 1.2)
        upper = draw.body({"box": {"min": [0, 0, 0], "max": [width, depth, height],
                                   "cells": [draw.whole(2, 5), draw.whole(2, 5), draw.whole(1, 3)]}}, elements=elements)
        sole, held = "upper.bottom", "upper.top"
    else:
        height = width / 2
        upper = draw.body({"half_ball": {"center": [height, depth / 2, height], "radius": height,
                                         "cells": 2 * [draw.whole(2, 4)]}},
                          elements=("H8", "H8_mean_dilatation"), soft=0.3)
        sole, held = "upper.surface", "upper.flat"
    thick = draw.uniform(0.4, 1)
    slab = draw.body({"box": {"min": [-beyond, -beyond, -thick], "max": [width + beyond, depth + beyond, 0],
                              "cells": [draw.whole(3, 8), draw.whole(3, 8), draw.whole(1, 3)]}}, elements=elements)
    for body in (upper, slab):
        if "j2_plastic" in body["material"]:
            body["element"] = "H8_mean_dilatation"
    sides = draw.choice([[sole, "slab.top"], ["slab.top", sole]])
    way = draw.uniform(0.1, 0.9) * beyond
    turn = draw.uniform(0, 2 * math.pi)
    support = {"on": held, "move": {"x": draw.there_and_back(way * math.cos(turn)),
                                    "y": draw.there_and_back(way * math.sin(turn)),
                                    "z": [[0, 0], [1, -draw.uniform(0.02, 0.1) * min(height, thick)]]}}
    if draw.choice([True, False]):
        support["rotate"] = {"center": [width / 2, depth / 2, height], "axis": [0, 0, 1],
                             "angle": draw.there_and_back(draw.uniform(-10, 10))}
    return {"space": "solid", "bodies": {"upper": upper, "slab": slab},
            "contacts": {"c": dict(slave=sides[0], master=sides[1], **draw.friction())},
            "supports": [{"on": "slab.bottom", "move": {"x": 0, "y": 0, "z": 0}}, support], "press_on": held}


CLASSES = {f.__name__: f for f in (plane, circle, cup, polyline, tool, slide, ironing, stack, rings, disks, tube, solid,
                                   pile, drag)}


def scene_of(kind, number, surface):
    """Scene `number` of a class, on a surface of SURFACES or as it was drawn."""
    draw = Draw(f"{kind} {number}")
    scene = CLASSES[kind](draw)
    drawn = draw.surface()
    press_on = scene.pop("press_on")
    for contact in scene["contacts"].values():
        if contact.pop("on", None):
            contact.update(SURFACES[drawn if surface == "as_drawn" else surface])
    responses = {f"{name}_{c}": {"contact_force": {"contact": name, "component": c}}
                 for name in scene["contacts"] for c in ("x", "y", "normal")}
    if press_on:
        responses |= {f"push_{c}": {"reaction": {"on": press_on, "component": c}} for c in "xy"}
    return {"title": f"{kind} {number}", "space": "plane_strain", "strain": "finite", **scene, "time": draw.time(),
            "responses": responses}


def solve(program, scene, method, asked):
    """What came of it: `status`, `message`, `forces` (of each step), `warnings`, `seconds`, `verified` (None: not
    asked)."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.json"
        path.write_text(json.dumps(dict(scene, method={method: {}})))
        begun = time.monotonic()
        out = {"message": "", "forces": [], "warnings": [], "seconds": 0.0, "verified": None}
        try:
            run = subprocess.run([program, "run", str(path), "--json", "-o", f"{folder}/out"], stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, text=True, timeout=asked.seconds)
        except subprocess.TimeoutExpired:
            return out | {"status": "hang", "seconds": asked.seconds}
        out["seconds"] = time.monotonic() - begun
        if run.returncode not in (0, 3):
            return out | {"status": "crash", "message": f"exit {run.returncode}: {run.stderr.strip()}"}
        result = json.loads(run.stdout)
        if asked.verify and result["status"].startswith("converged"):
            out["verified"] = subprocess.run([program, "verify", f"{folder}/out"], stdout=subprocess.DEVNULL,
                                             stderr=subprocess.DEVNULL).returncode == 0
        number = lambda x: x["value"] if isinstance(x, dict) else x
        return out | {"status": result["status"], "message": result["message"],
                      "forces": [[number(x) for x in step["responses"].values()] for step in result["steps"]
                                 if "responses" in step],
                      "warnings": sorted({w["code"] for w in result.get("warnings", [])})}


def apart(scene, one, other):
    """The largest difference of forces in any step, of the largest force; of what strains the softest body by a
    millionth, if that is more, since bodies that do not touch have forces that are rounding."""
    softest = min(law["E"] for body in scene["bodies"].values() for law in body["material"].values())
    size = max((abs(x) for step in one["forces"] for x in step), default=0)
    return max((abs(x - y) for p, q in zip(one["forces"], other["forces"]) for x, y in zip(p, q)),
               default=0) / max(size, 1e-6 * softest)


def is_solved(run):
    return run["status"].startswith("converged")


def keep(scene, surface, method, folder):
    if not folder:
        return
    Path(folder).mkdir(parents=True, exist_ok=True)
    name = f"{scene['title'].replace(' ', '_')}.{surface}.{method}.json"
    (Path(folder) / name).write_text(json.dumps(dict(scene, method={method: {}}), indent=1))


def report(kind, surface, scenes, runs, asked):
    """Prints what came of a class; returns how many runs are unsolved, and how many are faults."""
    unsolved = faults = 0
    print(f"{kind}, {surface}:", flush=True)
    for method in asked.methods:
        of = runs[method]
        failed = [(scene, run) for scene, run in zip(scenes, of) if not is_solved(run)]
        refused = [scene for scene, run in zip(scenes, of) if run["verified"] is False]
        unsolved += len(failed)
        faults += sum(run["status"] in ("crash", "hang") for _, run in failed) + len(refused)
        print(f"  {method}: {len(failed)} of {len(of)} fail, {sum(run['seconds'] for run in of):.1f} s")
        for scene, run in failed:
            print(f"    {scene['title']}: {run['status']} after {len(run['forces'])} steps: {run['message'][:150]}")
        for scene in refused:
            print(f"    {scene['title']}: verify refuses it")
        for scene in [scene for scene, _ in failed] + refused:
            keep(scene, surface, method, asked.keep)
    for method in [m for m in asked.methods if m != "monolithic_al" and "monolithic_al" in asked.methods]:
        both = [(scene, a, b) for scene, a, b in zip(scenes, runs["monolithic_al"], runs[method])
                if is_solved(a) and is_solved(b)]
        far = [(apart(scene, a, b), scene, a["warnings"] + b["warnings"]) for scene, a, b in both
               if apart(scene, a, b) > MARGIN[method]]
        silent = [x for x in far if not x[2]]
        for _, scene, _ in silent:
            keep(scene, surface, method, asked.keep)
        faults += len(silent) if method == "uzawa_al" else 0
        print(f"  {method} against monolithic_al: {len(far)} of {len(both)} apart, {len(silent)} without a warning"
              + "".join(f"; {scene['title']} {x:.2g}" for x, scene, _ in sorted(far, key=lambda f: -f[0])[:20]),
              flush=True)
    return unsolved, faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=10, help="scenes of each class")
    parser.add_argument("--seed", type=int, default=1, help="number of the first scene")
    parser.add_argument("--classes", nargs="+", default=list(CLASSES), choices=list(CLASSES))
    parser.add_argument("--surfaces", nargs="+", default=["as_drawn"], choices=["as_drawn", *SURFACES])
    parser.add_argument("--methods", nargs="+", default=METHODS, choices=METHODS)
    parser.add_argument("--seconds", type=float, default=60, help="limit of one run")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", help="folder for the scenes that fail, are refused or differ")
    parser.add_argument("--verify", action="store_true", help="certificates of converged runs too")
    parser.add_argument("--most-unsolved", type=float, default=1, help="share of all runs")
    asked = parser.parse_args()
    unsolved = faults = count = 0
    for kind in asked.classes:
        for surface in asked.surfaces:
            scenes = [scene_of(kind, asked.seed + n, surface) for n in range(asked.count)]
            with ThreadPoolExecutor(asked.jobs) as pool:
                runs = {m: list(pool.map(lambda s: solve(asked.program, s, m, asked), scenes)) for m in asked.methods}
            found = report(kind, surface, scenes, runs, asked)
            unsolved, faults, count = unsolved + found[0], faults + found[1], count + len(scenes) * len(runs)
    print(f"{unsolved} of {count} runs unsolved, {faults} faults")
    return 1 if faults or unsolved > asked.most_unsolved * count else 0


if __name__ == "__main__":
    sys.exit(main())
