#!/usr/bin/env python3
"""getfem_punch.py FILE: the punch of punch.json by GetFEM (python3-getfem), as a solution that stickslip verifies:

    stickslip run studies/peers/punch.json -o results/punch
    /usr/bin/python3 studies/peers/getfem_punch.py getfem.json
    stickslip verify results/punch --solution getfem.json

Serendipity elements of second degree, and a multiplier at each node of the floor. Forces of contact are left out: they are
what balances the bodies at the nodes of the contact.
"""
import json
import sys

import getfem
import numpy

E, NU, PRESSED, STEPS = 1000.0, 0.3, 0.01, 4
BOTTOM, TOP = 1, 2

mesh = getfem.Mesh("cartesian", numpy.linspace(0, 2, 9), numpy.linspace(0, 1, 5))
outer = mesh.outer_faces()
normals = mesh.normal_of_faces(outer)
mesh.set_region(BOTTOM, outer[:, normals[1] < -0.5])
mesh.set_region(TOP, outer[:, normals[1] > 0.5])
space = getfem.MeshFem(mesh, 2)
space.set_fem(getfem.Fem("FEM_Q2_INCOMPLETE(2)"))
integration = getfem.MeshIm(mesh, getfem.Integ("IM_GAUSS_PARALLELEPIPED(2,5)"))


def solve(pressed):
    """Displacements, where the top is moved down by so much; friction is not there, so that no step needs the last."""
    model = getfem.Model("real")
    model.add_fem_variable("u", space)
    model.add_initialized_data("lame", [E * NU / ((1 + NU) * (1 - 2 * NU))])
    model.add_initialized_data("G", [E / (2 * (1 + NU))])
    model.add_isotropic_linearized_elasticity_brick(integration, "u", "lame", "G")
    model.add_initialized_data("down", [0.0, -pressed])
    model.add_Dirichlet_condition_with_multipliers(integration, "u", space, TOP, "down")
    model.add_variable("pressing", space.basic_dof_on_region(BOTTOM).size // 2)
    model.add_initialized_data("r", [E])
    model.add_nodal_contact_with_rigid_obstacle_brick(integration, "u", "pressing", "r", BOTTOM, "y", 1)
    model.solve("max_res", 1e-13, "max_iter", 50)
    return model.variable("u").tolist()


times = [step / STEPS for step in range(1, STEPS + 1)]
with open(sys.argv[1], "w") as file:
    json.dump({"schema": "stickslip_solution", "version": 1,
               "nodes": space.basic_dof_nodes()[:, ::2].T.tolist(),
               "increments": [{"time": t, "displacement": solve(t * PRESSED)} for t in times]}, file)
