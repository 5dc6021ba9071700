"""Starting scenes and a study for fuzz.py: small, and between them every effect."""
import copy
import json
import re


def box(low, high, cells, **more):
    return {"mesh": {"box": {"min": low, "max": high, "cells": cells}},
            "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}, **more}


FLOOR = {"plane": {"point": [0, 0], "normal": [0, 1]}}

BLOCK = {
    "title": "a block",
    "bodies": {"block": box([0, 0], [4, 2], [3, 2])},
    "obstacles": {"floor": FLOOR},
    "contacts": {"sole": {"slave": "block.bottom", "master": "floor", "friction": 0.3}},
    "supports": [{"on": "block.top", "move": {"x": [[0, 0], [1, 0.01]], "y": -0.01}}],
    "time": {"end": 1, "steps": 2},
    "responses": {"pull": {"reaction": {"on": "block.top", "component": "x"}}},
    "objectives": {"J": {"of": "pull", "sum": True}},
    "parameters": {"mu": "/contacts/sole/friction", "height": "/bodies/block/mesh/box/max/1"},
    "output": {"fields": "all"},
    "linear_solver": {"engine": "auto"},
    "method": {"monolithic_al": {"scale": 1}},
}
PAIR = {
    "space": "plane_stress",
    "bodies": {"a": {"mesh": {"quad": {"corners": [[0, 0], [2, 0], [2, 1], [0, 1]], "cells": [2, 1]}}, "thickness": 2,
                     "material": {"linear_elastic": {"E": 1000, "nu": 0.2}}, "element": "Q4"},
               "b": {"mesh": {"half_disk": {"center": [1, 2], "radius": 1, "cells": [2, 2], "facing": "down"}},
                     "material": {"linear_elastic": {"E": 500, "nu": 0.3}}}},
    "contacts": {"touch": {"slave": "b.arc", "master": "a.top", "friction": 0.2, "discretization": "segment"}},
    "supports": [{"on": "a.bottom", "move": {"x": 0, "y": 0}}, {"on": "b.flat", "move": {"x": 0.001, "y": -0.01}}],
    "time": {"legs": [[1, 1], [2, 1]]},
    "responses": {"press": {"contact_force": {"contact": "touch", "component": "normal"}},
                  "width": {"contact_half_width": {"contact": "touch"}}},
    "parameters": {"E": {"/bodies/a/material/linear_elastic/E": 1},
                   "shape": {"shape": {"side": "a.top", "direction": [0, 1]}}},
    "sensitivity": {"mode": "direct"},
    "method": {"uzawa_al": {"tolerance": 1e-6, "acceleration": "anderson"}},
}
DRAWN = {  # finite strain, a smooth master, adjoint with little memory
    "strain": "finite",
    "bodies": {"die": box([0.2, 1], [0.8, 1.4], [2, 1], material={"neo_hookean": {"E": 5000, "nu": 0.3}}),
               "slab": box([0, 0], [2, 1], [4, 2], material={"neo_hookean": {"E": 1000, "nu": 0.3}})},
    "contacts": {"touch": {"slave": "die.bottom", "master": "slab.top", "friction": 0.2, "surface": "smooth"}},
    "supports": [{"on": "slab.bottom", "move": {"x": 0, "y": 0}},
                 {"on": "die.top", "move": {"x": [[0, 0], [1, 0], [2, 0.3]], "y": [[0, 0], [1, -0.05]]}}],
    "time": {"legs": [[1, 1], [2, 3]]},
    "responses": {"V": {"reaction": {"on": "die.top", "component": "y"}},
                  "H": {"reaction": {"on": "die.top", "component": "x"}},
                  "deep": {"gap": {"contact": "touch", "take": "min"}}},
    "objectives": {"J": {"of": "H", "sum": True, "target": 10}},
    "parameters": {"mu": "/contacts/touch/friction", "E": "/bodies/die/material/neo_hookean/E"},
    "sensitivity": {"mode": "adjoint", "memory": 1e-4},
    "method": {"penalty": {"stiffness": 100}},
}
METAL = {  # plasticity, revolution, a rigid circle, limited friction
    "space": "axisymmetric", "strain": "small",
    "bodies": {"metal": box([0, -1], [1, 0], [3, 3],
                            material={"j2_plastic": {"E": 1000, "nu": 0.3, "yield": 5, "hardening": 50}})},
    "obstacles": {"ball": {"circle": {"center": [0, 2], "radius": 2}, "move": {"y": [[0, 0], [1, -0.05], [2, 0]]}}},
    "contacts": {"dent": {"slave": "metal.top", "master": "ball", "friction": {"coulomb": 0.3, "limit": 2}}},
    "supports": [{"on": "metal.bottom", "move": {"x": 0, "y": 0}}],
    "time": {"legs": [[1, 2], [2, 1]]},
    "responses": {"press": {"contact_force": {"contact": "dent", "component": "normal"}},
                  "flow": {"plastic_strain": {"on": "metal", "take": "max"}}, "stored": {"strain_energy": {}}},
    "parameters": {"yield": "/bodies/metal/material/j2_plastic/yield", "R": "/obstacles/ball/circle/radius"},
    "method": {"monolithic_al": {}},
}
CROWD = {  # several bodies, each against each and itself
    "strain": "finite",
    "bodies": {"tube": {"mesh": {"ring": {"center": [0, 0], "inner": 0.8, "outer": 1, "cells": [1, 12],
                                          "to_angle": 180}},
                        "material": {"neo_hookean": {"E": 1000, "nu": 0.3}}},
               "left": box([-0.5, 1.02], [-0.1, 1.4], [2, 1], material={"neo_hookean": {"E": 9000, "nu": 0.2}}),
               "right": box([0.1, 1.02], [0.5, 1.4], [1, 2], element="Q8",
                            material={"j2_plastic": {"E": 1000, "nu": 0.3, "yield": 20, "hardening": 10}})},
    "obstacles": {"floor": {"plane": {"point": [0, -1], "normal": [0, 1]}}},
    "contacts": {"all": {"between": ["tube", "left", "right"], "self": True, "friction": 0.1},
                 "stand": {"slave": "tube.outer", "master": "floor", "friction": {"tresca": 3}}},
    "supports": [{"on": "left.top", "move": {"x": 0, "y": [[0, 0], [1, -0.1]]}},
                 {"on": "right.top", "move": {"x": 0, "y": [[0, 0], [1, -0.12]]}},
                 {"on": "tube.start", "move": {"x": 0, "y": 0}}, {"on": "tube.end", "move": {"x": 0, "y": 0}}],
    "time": {"end": 1, "steps": 3},
    "responses": {"load": {"reaction": {"on": "left.top", "component": "y"}},
                  "heat": {"dissipation": {"contact": "all"}}},
    "parameters": {"mu": "/contacts/all/friction"},
    "method": {"uzawa_al": {}},
}
TRUSS = {  # bars on a path by arc length
    "strain": "finite",
    "bodies": {"truss": {"mesh": {"line": {"from": [0, 0], "to": [2, 0.3], "cells": 1}}, "area": 0.1,
                         "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}, "element": "bar"}},
    "obstacles": {"floor": {"polyline": {"points": [[3, -0.5], [1, -0.5]]}}},
    "contacts": {"stop": {"slave": "truss.end", "master": "floor", "friction": 0.2}},
    "supports": [{"on": "truss.start", "move": {"x": 0, "y": 0}}, {"on": "truss.end", "along": [1, 0], "value": 0}],
    "loads": [{"on": "truss.end", "force": [0, -1]}],
    "time": {"end": 1, "steps": 4, "control": {"arc_length": {"max": 30}}},
    "responses": {"sink": {"displacement": {"on": "truss.end", "component": "y"}}},
    "parameters": {"E": "/bodies/truss/material/linear_elastic/E"},
    "method": {"monolithic_al": {}},
}
MESHED = {  # a file of Gmsh, beside the scene
    "bodies": {"body": {"mesh": {"gmsh": "mesh.msh", "body": "block"},
                        "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}}},
    "obstacles": {"floor": FLOOR},
    "contacts": {"sole": {"slave": "body.bottom", "master": "floor", "friction": 0.3}},
    "supports": [{"on": "body.top", "move": {"x": 0.01, "y": -0.01}}],
    "time": {"end": 1, "steps": 1},
    "responses": {"n": {"contact_force": {"contact": "sole", "component": "normal"}}},
    "method": {"monolithic_al": {}},
}
STUDY = {"title": "a study", "scene": "scene.json",
         "methods": [{"penalty": {"stiffness": [10, 1e3]}}, {"uzawa_al": {}}, {"monolithic_al": {"scale": [1]}}],
         "vary": {"/time/steps": [1]}, "refine": [0],
         "reference": [{"method": {"monolithic_al": {}}}, {"values": {"pull": 1}}], "errors": ["response:*", "kkt"],
         "timing": {"repeat": 1}}
OWN = [BLOCK, PAIR, DRAWN, METAL, CROWD, TRUSS]
SHIPPED = ("slider", "stop", "stop_bars", "belt", "tractrix", "greco_plate", "truss", "snap", "plastic_bar", "slope",
           "bending", "press_fit")


def small(path):
    """A scene with few cells and steps."""
    text = "\n".join(re.sub(r"^\s*//.*|\s//.*", "", line) for line in path.read_text().splitlines())
    scene = json.loads(text)
    if "legs" in scene["time"]:
        scene["time"]["legs"] = [[end, 1] for end, _ in scene["time"]["legs"]]
    else:
        scene["time"]["steps"] = min(scene["time"]["steps"], 2)
    for body in scene["bodies"].values():
        for mesh in body["mesh"].values():
            if isinstance(mesh, dict) and "cells" in mesh:
                cells = mesh["cells"]
                mesh["cells"] = [min(n, 3) for n in cells] if isinstance(cells, list) else min(cells, 4)
    return scene


def starting_scenes(source):
    """Own ones, shipped ones and those of tests/cases that need no mesh file."""
    paths = [source / "studies" / "scenes" / f"{name}.json" for name in SHIPPED]
    for path in sorted((source / "tests" / "cases").glob("*.json")):
        if '"gmsh"' not in path.read_text() and '"bodies"' in path.read_text():
            paths.append(path)
    scenes = copy.deepcopy(OWN)
    for path in paths:
        try:
            scenes.append(small(path))
        except (ValueError, KeyError, TypeError):  # a case may be none that JSON or a scene allows
            continue
    return scenes
