"""Writes the reference solutions beside this file: python3 make_references.py [NAME...].

Each NAME.json holds the scene and, under `solutions`, what contact_reference.py finds for the exact law and for the
penalised one; of the scenes at finite strain, what finite_reference.py finds for the exact law. Steps carry
displacements per body and node, and per contact point: initial position and tributary area, gap, slip
increment (a vector), normal traction (negative in compression), force on the slave node, and state.
"""

import copy
import json
import os
import sys

from contact_reference import at_pointer, load_commented, reference
from finite_reference import finite_reference

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "..", "..", "studies", "scenes")


def shipped(name, **changes):
    """A shipped scene, with numbers changed by pointer (written with __ for /)."""
    document = load_commented(os.path.join(SCENES, name + ".json"))
    return changed(document, {pointer.replace("__", "/"): value for pointer, value in changes.items()})


def changed(document, values):
    document = copy.deepcopy(document)
    for pointer, value in values.items():
        node, key = at_pointer(document, pointer)
        node[key] = value
    return document


def plate(cells, friction=1, pressure=50, push=150):
    return changed(shipped("greco_plate"), {
        "/title": f"Plate on a rough floor, {cells} x {cells} elements, friction {friction}, push {push}",
        "/bodies/plate/mesh/box/cells": [cells, cells], "/contacts/sole/friction": friction,
        "/loads/0/traction/1": -pressure, "/loads/1/traction/0": push})


def belt(nodes):
    turn = 180 / nodes
    return changed(shipped("belt"), {
        "/title": f"Belt over a drum, {nodes} nodes on it",
        "/bodies/belt/mesh/arc/from_angle": -turn / 2, "/bodies/belt/mesh/arc/to_angle": 180 + turn / 2,
        "/bodies/belt/mesh/arc/cells": nodes + 1})


def pull_out(cells):
    return {
        "title": f"Bar of {cells} elements pulled along a rough floor, and back: partial slip in one dimension",
        "space": "plane_strain",
        "bodies": {"bar": {"mesh": {"line": {"from": [0, 0], "to": [1, 0], "cells": cells}}, "element": "bar",
                           "area": 1, "material": {"linear_elastic": {"E": 1000, "nu": 0}}}},
        "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
        "contacts": {"sole": {"slave": "bar.nodes - bar.end", "master": "floor", "friction": 0.3}},
        "supports": [{"on": "bar.end", "move": {"x": 0, "y": 0}}],
        "loads": [{"on": "bar.nodes", "traction": [0, -100]},
                  {"on": "bar.start", "force": [-20, 0], "history": [[0, 0], [1, 1], [2, 0], [3, -1], [4, 1]]}],
        "time": {"legs": [[1, 2], [2, 2], [3, 2], [4, 4]]},
        "responses": {"u0": {"displacement": {"on": "bar.start", "component": "x"}},
                      "hold": {"reaction": {"on": "bar.end", "component": "x"}},
                      "friction": {"contact_force": {"contact": "sole", "component": "x"}},
                      "heat": {"dissipation": {"contact": "sole"}}},
        "parameters": {"mu": "/contacts/sole/friction", "E": "/bodies/bar/material/linear_elastic/E",
                       "P": {"/loads/1/force/0": -1}, "weight": {"/loads/0/traction/1": -1},
                       "length": "/bodies/bar/mesh/line/to/0"},
        "method": {"monolithic_al": {}}}


def boxes(element):
    return {
        "title": f"Box pressed on a box with another mesh, sheared and sheared back ({element})",
        "space": "plane_strain",
        "bodies": {
            "upper": {"mesh": {"box": {"min": [1.3, 3], "max": [7.1, 5.5], "cells": [6, 3]}}, "element": element,
                      "material": {"linear_elastic": {"E": 700, "nu": 0.25}}},
            "lower": {"mesh": {"box": {"min": [0, 0], "max": [9, 3], "cells": [9, 4]}}, "element": element,
                      "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}}},
        "contacts": {"touch": {"slave": "upper.bottom", "master": "lower.top", "friction": 0.25, "offset": 0.003}},
        "supports": [{"on": "lower.bottom", "move": {"x": 0, "y": 0}},
                     {"on": "upper.top", "move": {"x": [[0, 0], [1, 0], [2, 0.05], [4, -0.05]],
                                                  "y": [[0, 0], [1, -0.05]]}}],
        "time": {"legs": [[1, 2], [2, 4], [4, 8]]},
        "responses": {"press": {"contact_force": {"contact": "touch", "component": "normal"}},
                      "shear": {"contact_force": {"contact": "touch", "component": "x"}},
                      "hold_x": {"reaction": {"on": "lower.bottom", "component": "x"}},
                      "hold_y": {"reaction": {"on": "lower.bottom", "component": "y"}},
                      "peak": {"contact_pressure": {"contact": "touch", "take": "max"}},
                      "heel": {"displacement": {"at": [1.5, 3.4], "component": "x"}},
                      "heat": {"dissipation": {"contact": "touch"}}},
        "parameters": {"mu": "/contacts/touch/friction", "offset": "/contacts/touch/offset",
                       "E_upper": "/bodies/upper/material/linear_elastic/E",
                       "nu_lower": "/bodies/lower/material/linear_elastic/nu",
                       "left": "/bodies/upper/mesh/box/min/0", "height": "/bodies/lower/mesh/box/min/1",
                       "width": "/bodies/lower/mesh/box/max/0",
                       "down": {"/supports/1/move/y/1/1": -1}, "turn": "/supports/1/move/x/2/1"},
        "method": {"monolithic_al": {}}}


def points_plane():
    """Three springs with a coupled stiffness: on a plane that is not level, on a disk and in a cup."""
    spring = lambda a, b, c: {"grounded_spring": {"stiffness": [[a, b], [b, c]]}}
    return {
        "title": "Three points on coupled springs: slope, disk and cup, driven to and fro",
        "space": "plane_strain",
        "bodies": {
            "a": {"mesh": {"point": {"at": [0.1, 0.02]}}, "material": spring(100, 30, 150)},
            "b": {"mesh": {"point": {"at": [2.3, 0.98]}}, "material": spring(120, -40, 90)},
            "c": {"mesh": {"point": {"at": [5.2, -0.9]}}, "material": spring(80, 20, 200)}},
        "obstacles": {"slope": {"plane": {"point": [0, 0], "normal": [-0.1, 1]}},
                      "disk": {"circle": {"center": [2, 0], "radius": 1}, "move": {"x": [[0, 0], [3, 0.02]]}},
                      "cup": {"circle": {"center": [5, 0], "radius": 1, "inside": True}}},
        "contacts": {"one": {"slave": "a.node", "master": "slope", "friction": 0.3},
                     "two": {"slave": "b.node", "master": "disk", "friction": 0.5},
                     "three": {"slave": "c.node", "master": "cup", "friction": 0.2, "offset": -0.01}},
        "supports": [
            {"on": "a.anchor", "move": {"x": [[0, 0], [1, 0.13], [2, -0.11], [3, 0.12]], "y": [[0, 0], [1, -0.1]]}},
            {"on": "b.anchor", "move": {"x": [[0, 0], [1, -0.17], [2, 0.19], [3, 0.05]], "y": [[0, 0], [1, -0.21]]}},
            {"on": "c.anchor", "move": {"x": [[0, 0], [1, 0.14], [2, -0.23], [3, 0.31]],
                                        "y": [[0, 0], [1, -0.16], [2, -0.12], [3, 0.3]]}}],
        "loads": [{"on": "a.node", "force": [0.5, -3], "history": [[0, 0.4], [3, 1]]}],
        "time": {"legs": [[1, 4], [2, 7], [3, 7]]},
        "responses": {"pull": {"reaction": {"on": "a.anchor", "component": "x"}},
                      "press_one": {"contact_force": {"contact": "one", "component": "normal"}},
                      "x_two": {"contact_force": {"contact": "two", "component": "x"}},
                      "press_three": {"contact_force": {"contact": "three", "component": "normal"}},
                      "u_two": {"displacement": {"on": "b.node", "component": "x"}},
                      "heat_one": {"dissipation": {"contact": "one"}},
                      "heat_two": {"dissipation": {"contact": "two"}}},
        "parameters": {"mu_one": "/contacts/one/friction", "mu_two": "/contacts/two/friction",
                       "tilt": "/obstacles/slope/plane/normal/0", "radius": "/obstacles/disk/circle/radius",
                       "cup": "/obstacles/cup/circle/radius", "drag": "/obstacles/disk/move/x/1/1",
                       "offset": "/contacts/three/offset",
                       "k_tn": {"/bodies/a/material/grounded_spring/stiffness/0/1": 1,
                                "/bodies/a/material/grounded_spring/stiffness/1/0": 1},
                       "k_two": "/bodies/b/material/grounded_spring/stiffness/0/0",
                       "at": "/bodies/b/mesh/point/at/0", "load": "/loads/0/force/1",
                       "turn": "/supports/0/move/x/2/1"},
        "method": {"monolithic_al": {}}}


def points_space():
    """Three springs in space: around a loop, to and fro with a change of direction, and off the plane and on again."""
    spring = lambda k: {"grounded_spring": {"stiffness": k}}
    return {
        "title": "Three points on coupled springs in space: loop, reversal and lift-off",
        "space": "solid",
        "bodies": {
            "a": {"mesh": {"point": {"at": [0, 0, 0]}},
                  "material": spring([[100, 10, 20], [10, 120, -15], [20, -15, 150]])},
            "b": {"mesh": {"point": {"at": [1, 0.1, 0.2]}},
                  "material": spring([[90, 0, 0], [0, 110, 30], [0, 30, 130]])},
            "c": {"mesh": {"point": {"at": [2, 0, 0.01]}},
                  "material": spring([[70, -20, 10], [-20, 80, 0], [10, 0, 100]])}},
        "obstacles": {"floor": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}},
                      "slope": {"plane": {"point": [1, 0.1, 0.2], "normal": [0.3, -0.2, 1]}}},
        "contacts": {"one": {"slave": "a.node", "master": "floor", "friction": 0.4},
                     "two": {"slave": "b.node", "master": "slope", "friction": 0.6},
                     "three": {"slave": "c.node", "master": "floor", "friction": 0.3}},
        "supports": [
            {"on": "a.anchor", "move": {"x": [[0, 0], [1, 0.11], [2, 0.13], [3, -0.12], [4, 0.02]],
                                        "y": [[0, 0], [1, 0.01], [2, 0.14], [3, 0.1], [4, -0.13]],
                                        "z": [[0, 0], [1, -0.1]]}},
            {"on": "b.anchor", "move": {"x": [[0, 0], [1, 0.15], [2, -0.14], [4, 0.17]],
                                        "y": [[0, 0], [2, 0.08], [3, -0.18], [4, 0.01]], "z": [[0, 0], [1, -0.15]]}},
            {"on": "c.anchor", "move": {"x": [[0, 0], [1, 0.12], [4, -0.12]], "y": [[0, 0], [2, 0.1], [4, 0]],
                                        "z": [[0, 0], [1, -0.12], [2, 0.05], [3, -0.11], [4, -0.08]]}}],
        "time": {"end": 4, "steps": 24},
        "responses": {"pull_x": {"reaction": {"on": "a.anchor", "component": "x"}},
                      "pull_y": {"reaction": {"on": "a.anchor", "component": "y"}},
                      "press_two": {"contact_force": {"contact": "two", "component": "normal"}},
                      "z_two": {"contact_force": {"contact": "two", "component": "z"}},
                      "press_three": {"contact_force": {"contact": "three", "component": "normal"}},
                      "u_three": {"displacement": {"on": "c.node", "component": "x"}},
                      "heat_one": {"dissipation": {"contact": "one"}},
                      "heat_two": {"dissipation": {"contact": "two"}}},
        "parameters": {"mu_one": "/contacts/one/friction", "mu_two": "/contacts/two/friction",
                       "mu_three": "/contacts/three/friction", "tilt": "/obstacles/slope/plane/normal/0",
                       "floor": "/obstacles/floor/plane/point/2",
                       "k_tn": {"/bodies/a/material/grounded_spring/stiffness/0/2": 1,
                                "/bodies/a/material/grounded_spring/stiffness/2/0": 1},
                       "k_two": "/bodies/b/material/grounded_spring/stiffness/0/0",
                       "turn": "/supports/0/move/y/2/1"},
        "method": {"monolithic_al": {}}}


def ironing(surface, friction=0.3, along=0.7):
    """A die that is not level, pressed into a slab and drawn along it."""
    neo_hookean = lambda young: {"neo_hookean": {"E": young, "nu": 0.3, "volumetric": "log"}}
    contact = {"slave": "die.bottom", "master": "slab.top", "surface": surface}
    responses = {"x": {"reaction": {"on": "die.top", "component": "x"}},
                 "y": {"reaction": {"on": "die.top", "component": "y"}},
                 "energy": {"strain_energy": {}},
                 "normal": {"contact_force": {"contact": "touch", "component": "normal"}}}
    parameters = {"E_die": "/bodies/die/material/neo_hookean/E", "nu_slab": "/bodies/slab/material/neo_hookean/nu",
                  "tip_x": "/bodies/die/mesh/quad/corners/1/0", "tip_y": "/bodies/die/mesh/quad/corners/1/1",
                  "height": {"/bodies/slab/mesh/quad/corners/2/1": 1, "/bodies/slab/mesh/quad/corners/3/1": 1},
                  "down": {"/supports/1/move/y/1/1": -1, "/supports/1/move/y/2/1": -1},
                  "along": "/supports/1/move/x/2/1"}
    if friction is not None:
        contact["friction"] = friction
        responses["heat"] = {"dissipation": {"contact": "touch"}}
        parameters["mu"] = "/contacts/touch/friction"
    return {
        "title": "Die ironing a slab at finite strain", "space": "plane_strain", "strain": "finite",
        "bodies": {
            "slab": {"mesh": {"quad": {"corners": [[0, 0], [4, 0], [4, 1], [0, 1]], "cells": [12, 3]}},
                     "material": neo_hookean(1)},
            "die": {"mesh": {"quad": {"corners": [[0.9, 1.05], [1.7, 1.0], [1.8, 1.6], [0.8, 1.6]], "cells": [4, 2]}},
                    "material": neo_hookean(5)}},
        "contacts": {"touch": contact},
        "supports": [{"on": "slab.bottom", "move": {"x": 0, "y": 0}},
                     {"on": "die.top", "move": {"x": [[0, 0], [1, 0], [2, along]],
                                                "y": [[0, 0], [1, -0.15], [2, -0.15]]}}],
        "time": {"legs": [[1, 2], [2, 4]]}, "responses": responses, "parameters": parameters,
        "method": {"monolithic_al": {}}}


def metal(surface):
    """The same of a metal slab, which flows below the die, and of less depth; the die is lifted a little at the end."""
    document = ironing(surface, along=0.5)
    document["title"] = "Die ironing a metal slab at finite strain"
    document["bodies"]["slab"]["material"] = {"j2_plastic": {"E": 1, "nu": 0.3, "yield": 0.04, "hardening": 0.1}}
    document["bodies"]["slab"]["element"] = "Q4"
    document["supports"][1]["move"] = {"x": [[0, 0], [1, 0], [2, 0.5], [3, 0.5]],
                                       "y": [[0, 0], [1, -0.12], [2, -0.12], [3, -0.11]]}
    document["time"]["legs"] = [[1, 3], [2, 4], [3, 1]]
    document["responses"]["plastic"] = {"plastic_strain": {"on": "slab"}}
    document["responses"]["most"] = {"plastic_strain": {"on": "slab", "take": "max"}}
    slab = "/bodies/slab/material/j2_plastic/"
    document["parameters"] |= {"nu_slab": slab + "nu", "yield": slab + "yield", "hardening": slab + "hardening"}
    return document


def thin(document, title):
    """The same in plane stress, slab and die of different thickness."""
    document |= {"title": title, "space": "plane_stress"}
    document["bodies"]["slab"]["thickness"], document["bodies"]["die"]["thickness"] = 0.8, 1.1
    document["parameters"] |= {"thin": "/bodies/slab/thickness", "wide": "/bodies/die/thickness"}
    return document


def tabulated(document):
    """The same of a metal that hardens by a table, whose corners the flow below the die passes."""
    law = document["bodies"]["slab"]["material"]["j2_plastic"]
    law["hardening"] = [[0, law.pop("yield")], [0.01, 0.0425], [0.06, 0.046], [0.2, 0.05]]
    at = "/bodies/slab/material/j2_plastic/hardening"
    document["parameters"] |= {"yield": at + "/0/1", "hardening": at + "/1/1", "corner": at + "/2/0",
                               "last": at + "/3/1"}
    document["title"] = document["title"].replace("metal slab", "slab of a metal with a table")
    return document


def finite_cases():
    """Name: scene. On facets drawn along by 0.7 the last step has no solution, see check_references.vertex."""
    return {
        "finite_ironing_faceted": lambda: ironing("faceted", along=0.6),
        "finite_ironing_smooth": lambda: ironing("smooth"),
        "finite_ironing_b_spline": lambda: ironing({"smooth": "b_spline"}),
        "finite_ironing_frictionless": lambda: ironing("faceted", None),
        "finite_ironing_metal": lambda: metal({"smooth": "b_spline"}),
        "finite_ironing_table": lambda: tabulated(metal({"smooth": "b_spline"})),
        "finite_ironing_thin": lambda: thin(ironing("smooth"), "Die ironing a slab in plane stress"),
        "finite_ironing_thin_table": lambda: tabulated(thin(metal({"smooth": "b_spline"}),
                                                            "Die ironing a metal slab in plane stress")),
    }


def cases():
    """Name: (scene, penalty stiffness in force per length cubed, tangential over normal penalty)."""
    return {
        "stop": (lambda: shipped("stop"), 1e4, 1.0),
        "stop_bars": (lambda: shipped("stop_bars"), 1e4, 1.0),
        "slider": (lambda: shipped("slider"), 1e4, 0.5),
        "tractrix": (lambda: shipped("tractrix", __time__steps=31), 1e4, 1.0),
        "belt_8": (lambda: belt(8), 1e6, 1.0),
        "belt_16": (lambda: belt(16), 1e6, 0.1),
        "pull_out_10": (lambda: pull_out(10), 1e6, 1.0),
        "plate_8": (lambda: plate(8), 1e5, 1.0),
        "plate_16": (lambda: plate(16), 1e6, 1.0),
        "plate_32": (lambda: plate(32), 1e6, 0.5),
        "plate_16_friction_0.3": (lambda: plate(16, friction=0.3), 1e6, 1.0),
        "plate_16_push_60": (lambda: plate(16, friction=0.6, push=60), 1e6, 1.0),
        "boxes_q4": (lambda: boxes("Q4"), 2e4, 1.0),
        "boxes_t3": (lambda: boxes("T3"), 2e4, 0.5),
        "points_plane": (points_plane, 5e3, 0.5),
        "points_space": (points_space, 5e3, 0.5),
        "cattaneo_mindlin": (lambda: shipped("cattaneo_mindlin"), 1e6, 1.0),
    }


def solutions_of(scene, stiffness, ratio):
    law = {"stiffness": stiffness, "tangential_ratio": ratio}
    return {"exact": reference(scene, folder=SCENES), "penalty": reference(scene, law, SCENES)}


def write(name, scene, solutions):
    if name == "cattaneo_mindlin":  # the fields of its fine mesh stay out
        for step in (step for solution in solutions.values() for step in solution["steps"]):
            del step["displacement"]
            if step["time"] < scene["time"]["legs"][-1][0]:
                del step["contacts"]
    with open(os.path.join(HERE, name + ".json"), "w", encoding="utf-8") as f:
        f.write('{"scene": ' + json.dumps(scene, indent=1) + ',\n"solutions": {')
        for i, (law_name, solution) in enumerate(solutions.items()):
            steps = solution.pop("steps")
            f.write((",\n" if i else "\n") + json.dumps({law_name: solution})[1:-2] + ', "steps": [\n')
            f.write(",\n".join(json.dumps(step) for step in steps) + "\n]}")
            solution["steps"] = steps
        f.write("\n}}\n")


if __name__ == "__main__":
    every = {name: (scene, lambda document, law=law: solutions_of(document, *law))
             for name, (scene, *law) in cases().items()}
    every.update((name, (scene, lambda document: {"exact": finite_reference(document)}))
                 for name, scene in finite_cases().items())
    for name, (scene, solve) in every.items():
        if len(sys.argv) > 1 and name not in sys.argv[1:]:
            continue
        document = scene()
        solutions = solve(document)
        write(name, document, solutions)
        for law, solution in solutions.items():
            letter = {"open": "o", "stick": "t", "slip": "s"}
            signatures = ["".join(letter[s] for c in step.get("contacts", {}).values() for s in c["state"])
                          for step in solution["steps"]]
            margin = min((m for step in solution["steps"] for m in step["margins"].values() if m is not None),
                         default=None)
            print(f"{name:24} {law:8} violation {solution['largest_violation']:.1e} smallest margin {margin:.1e}")
            print("   ", " ".join(signatures) if len(" ".join(signatures)) < 600 else signatures[-1])
