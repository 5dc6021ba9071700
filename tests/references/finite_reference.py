"""Independent reference solver for finite-strain frictional contact of two bodies, for the tests of stickslip.

Reads a scene in stickslip's own JSON: plane strain or plane stress, boxes and quads of Q4, neo-Hookean or metal (J2,
multiplicative, hardening linear or by a table), supports, one contact or more.
All of contact is where it is now:

  gap    g = (x - y(xi)) . n, y(xi) the closest point of the master's curve, n out of the master, + offset
  slip   of a step: e . (y(xi) - y(xi_last)), both on the curve as it is now; e = (-n_y, n_x); xi_last is the foot at
         the end of the last step, that of the initial configuration in the first one
  force  on the slave node A (p n + t e), A the initial tributary length; on the master's nodes -N_i(xi) times that

On facets a point may have no solution: the normal jumps at a vertex, and each of its two facets leaves the point on
the other one. That is an error, as is any step for which none is found.

  1. A semi-smooth Newton iteration on (u, p, t) with the tangent by complex step, element by element and point by
     point, finds a step. Where it fails it is started from solutions of a part of the step.
  2. Every inequality of the contact law is verified on the solution.
  3. Derivatives are by complex step through mesh, material, geometry and history, over the whole path, with the
     states of the real one. `differences` takes them by differences of the whole path, states free.

Curves: straight facets, a point belonging to the facet on its side of the bisectors through the facet's ends, beyond
which the facet's line goes on; Catmull-Rom of facets of one length; uniform cubic B-spline. A ghost node 2 y1 - y2
stands beyond a free end. A point more than a hundredth of a facet past a free end has no contact.

In plane stress the stretch of the thickness is sought by halving, point by point, until the laws of three dimensions
leave no stress across; nothing here knows a law of plane stress.

`press_fit` solves two concentric rings with an interference as a boundary value problem along the radius.
"""

import numpy as np
import scipy.integrate
import scipy.linalg

from contact_reference import STEP, Body, at_pointer, perturbed, plain, table_at, time_grid, weights_of

PAST_THE_END = 0.01


# --- bodies ----------------------------------------------------------------------------------------------------------


class FiniteBody(Body):
    def __init__(self, description, dimension, plane_stress=False):
        super().__init__(description, dimension)
        self.plane_stress, self.thickness = plane_stress, description.get("thickness", 1.0)

    def tributary(self, side):
        return [self.thickness * area for area in super().tributary(side)]

    def _quad(self, m, dimension, folder):
        self._box({"min": [0, 0], "max": [1, 1], "cells": m["cells"]}, dimension, folder)
        a, b = self.X[:, :1], self.X[:, 1:]
        c = [np.array(corner)[None] for corner in m["corners"]]
        self.X = c[0] * (1 - a) * (1 - b) + c[1] * a * (1 - b) + c[2] * a * b + c[3] * (1 - a) * b

    def prepare(self):
        """Gradients of the shape functions and weights at the four points of each element: (e, q, 4, 2), (e, q)."""
        g = 1 / np.sqrt(3)
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        local = np.array([[[c[0] * (1 + c[1] * q[1]) / 4, c[1] * (1 + c[0] * q[0]) / 4] for c in corners]
                          for q in corners * g])
        self.E = np.array(self.elements)
        jacobian = np.einsum("eai,qak->eqik", self.X[self.E], local)  # dX_i / dxi_k
        det = jacobian[..., 0, 0] * jacobian[..., 1, 1] - jacobian[..., 0, 1] * jacobian[..., 1, 0]
        assert (det.real > 0).all(), "element turned inside out"
        self.weight = det * self.thickness
        self.gradient = np.einsum("qak,eqki->eqai", local, inverse2(jacobian, det))
        (self.kind, law), = self.description["material"].items()
        young, nu = law["E"], law["nu"]
        self.G, self.La = young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu))
        self.log = law.get("volumetric", "quadratic") == "log"

    def deformation(self, ue):
        F = np.einsum("...eai,eqak->...eqik", ue, self.gradient) + np.eye(2)
        return F, F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0]

    def thickening(self, J):
        """Stretch of the thickness."""
        if not self.plane_stress:
            return 1.0
        pressure = lambda V: self.La * (np.log(V) / V if self.log else V - 1)
        return np.exp(without_stress(lambda x: self.G * (np.exp(2 * x) - 1) / (J * np.exp(x)) +
                                     pressure(J * np.exp(x)), J.shape))

    def forces(self, ue):
        """Internal forces of the elements (..., e, 4, 2) at their displacements."""
        F, plane = self.deformation(ue)
        if not (plane.real > 0).all():
            raise Inverted
        J = plane * self.thickening(plane)
        times_J = self.La * np.log(J) if self.log else self.La * (J - 1) * J  # J dvol/dJ
        P = self.G * F + (times_J - self.G)[..., None, None] * np.swapaxes(inverse2(F, plane), -1, -2)
        return np.einsum("...eqik,eqak,eq->...eai", P, self.gradient, self.weight)

    def energy(self, ue):
        F, plane = self.deformation(ue)
        thick = self.thickening(plane)
        J = plane * thick
        invariant = np.einsum("...ik,...ik->...", F, F) + thick ** 2
        vol = self.La / 2 * (np.log(J) if self.log else J - 1) ** 2
        return np.sum((self.G / 2 * (invariant - 3 - 2 * np.log(J)) + vol) * self.weight)

    def settle(self, ue):
        """Remembers what elements that stay at these displacements do."""

    def tangents(self, ue):
        """d forces / d displacements (e, 8, 8), the displacements real."""
        turned = ue[None] + 1j * STEP * np.eye(8).reshape(8, 1, 4, 2)
        return np.moveaxis(self.forces(turned).imag.reshape(8, len(ue), 8) / STEP, 0, 2)


class MetalBody(FiniteBody):
    """Elastic by Hooke's law between Kirchhoff's stress and the logarithmic strain of F C F^T, C the inverse of the
    plastic right Cauchy-Green tensor, which flow along the stress deviator changes. `memory`: C in the plane, across
    it, and the equivalent plastic strain, (e, q) each."""

    def prepare(self):
        super().prepare()
        law = self.description["material"]["j2_plastic"]
        hardening = law["hardening"]
        rows = hardening if isinstance(hardening, list) else [[0, law["yield"]], [1, law["yield"] + hardening]]
        if rows[0][0] != 0:
            rows = [[0, law["yield"]]] + rows
        self.strains, self.stresses = np.array(rows).T
        self.slopes = np.diff(self.stresses) / np.diff(self.strains)
        if isinstance(hardening, list):
            self.slopes = np.append(self.slopes, 0)
        self.forget()

    def forget(self):
        shape = self.weight.shape
        self.memory = (np.zeros(shape + (2, 2), dtype=complex) + np.eye(2), np.ones(shape, dtype=complex),
                       np.zeros(shape, dtype=complex))

    def piece(self, hardened):
        """Of the bound: slope there, and the bound that the piece has where nothing has flown."""
        k = np.clip(np.searchsorted(self.strains.real, hardened.real, side="right") - 1, 0, len(self.slopes) - 1)
        return self.slopes[k], self.stresses[k] - self.slopes[k] * self.strains[k]

    def grown(self, q, hardened):
        """Plastic strain that brings q back to the bound: sought by halving, then solved for on its piece."""
        low, high = np.zeros(q.shape), q.real / (3 * self.G).real
        for _ in range(60 if len(self.slopes) > 1 else 0):
            middle = (low + high) / 2
            slope, bound = self.piece(hardened + middle)
            beyond = (q - 3 * self.G * middle - bound - slope * (hardened + middle)).real > 0
            low, high = np.where(beyond, middle, low), np.where(beyond, high, middle)
        slope, bound = self.piece(hardened + (low + high) / 2)
        return (q - bound - slope * hardened) / (3 * self.G + slope)

    def returned(self, e, z):
        """Elastic strains in the plane and across behind the flow, and the equivalent plastic strain."""
        hardened = self.memory[2] + np.zeros(np.shape(z))
        third = (e[..., 0, 0] + e[..., 1, 1] + z) / 3
        d, dz = e - third[..., None, None] * np.eye(2), z - third
        q = 2 * self.G * np.sqrt(1.5 * (np.einsum("...ij,...ij->...", d, d) + dz ** 2))
        slope, bound = self.piece(hardened)
        flows = q.real > (bound + slope * hardened).real
        grown = np.where(flows, self.grown(q, hardened), 0)
        share = np.where(flows, 3 * self.G * grown / np.where(flows, q, 1), 0)
        return e - share[..., None, None] * d, z - share * dz, hardened + grown

    def flow(self, ue):
        """F, elastic logarithmic strain in the plane and across, equivalent plastic strain; logarithm of the stretch of
        the thickness."""
        F, J = self.deformation(ue.astype(complex))
        if not (J.real > 0).all():
            raise Inverted
        C, across, _ = self.memory
        e, z = logarithm(F @ C @ np.swapaxes(F, -1, -2)) / 2, np.log(across) / 2
        thick = 0.0
        if self.plane_stress:
            def stress(x):
                e_, z_, _ = self.returned(e, z + x)
                return self.La * (e_[..., 0, 0] + e_[..., 1, 1] + z_) + 2 * self.G * z_
            thick = without_stress(stress, e.shape[:-2])
        return (F, J) + self.returned(e, z + thick + np.zeros(e.shape[:-2])) + (thick,)

    def forces(self, ue):
        F, J, e, z, _, _ = self.flow(ue)
        pressure = self.La * (e[..., 0, 0] + e[..., 1, 1] + z)
        P = (pressure[..., None, None] * np.eye(2) + 2 * self.G * e) @ np.swapaxes(inverse2(F, J), -1, -2)
        return np.einsum("...eqik,eqak,eq->...eai", P, self.gradient, self.weight)

    def energy(self, ue):
        _, _, e, z, _, _ = self.flow(ue)
        squares = np.einsum("...ij,...ij->...", e, e) + z ** 2
        return np.sum((self.La / 2 * (e[..., 0, 0] + e[..., 1, 1] + z) ** 2 + self.G * squares) * self.weight)

    def settle(self, ue):
        F, J, e, z, hardened, thick = self.flow(ue)
        inverse = inverse2(F, J)
        self.memory = (inverse @ exponential(2 * e) @ np.swapaxes(inverse, -1, -2), np.exp(2 * (z - thick)), hardened)


def body_of(description, dimension, plane_stress):
    kind = MetalBody if "j2_plastic" in description["material"] else FiniteBody
    return kind(description, dimension, plane_stress)


def without_stress(stress, shape):
    """Where stresses of a shape that grow with a real number vanish, each for itself: by halving to 4e-9, and three
    corrections by the slope there, which what rides on it in complex numbers follows."""
    low, high = np.full(shape, -2.0), np.full(shape, 2.0)
    for _ in range(30):
        middle = (low + high) / 2
        tension = stress(middle).real > 0
        low, high = np.where(tension, low, middle), np.where(tension, middle, high)
    x, h = (low + high) / 2 + 0j, 1e-7
    slope = (stress(x + h) - stress(x - h)).real / (2 * h)
    for _ in range(3):
        x = x - stress(x) / slope
    return x


def root(A):
    """The square root of 2 x 2 matrices with positive eigenvalues (Cayley-Hamilton)."""
    s = np.sqrt(A[..., 0, 0] * A[..., 1, 1] - A[..., 0, 1] * A[..., 1, 0])
    return (A + s[..., None, None] * np.eye(2)) / np.sqrt(A[..., 0, 0] + A[..., 1, 1] + 2 * s)[..., None, None]


def logarithm(A):
    """By the series of artanh near one, after roots."""
    for _ in range(5):
        A = root(A)
    B = A + np.eye(2)
    Z = (A - np.eye(2)) @ inverse2(B, B[..., 0, 0] * B[..., 1, 1] - B[..., 0, 1] * B[..., 1, 0])
    return 2 ** 6 * sum(np.linalg.matrix_power(Z, k) / k for k in range(1, 14, 2))


def exponential(A):
    """By Taylor's series of a share, squared."""
    A = A / 2 ** 5
    power, total = np.eye(2) + 0 * A, np.eye(2) + 0 * A
    for k in range(1, 14):
        power = power @ A / k
        total = total + power
    for _ in range(5):
        total = total @ total
    return total


class Inverted(RuntimeError):
    """An element has no volume left."""


def inverse2(A, det):
    inverse = np.empty(A.shape, dtype=np.result_type(A, det))
    inverse[..., 0, 0], inverse[..., 1, 1] = A[..., 1, 1] / det, A[..., 0, 0] / det
    inverse[..., 0, 1], inverse[..., 1, 0] = -A[..., 0, 1] / det, -A[..., 1, 0] / det
    return inverse


# --- the curve of a master -------------------------------------------------------------------------------------------

# Power coefficients of a segment: y(xi) = sum_k xi^k sum_c POWERS[k][c] y_c of its four places y_c.
POWERS = {
    "faceted": np.array([[0, 1, 0, 0], [0, -1, 1, 0], [0, 0, 0, 0], [0, 0, 0, 0]]),
    "b_spline": np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6,
}
BEZIER = np.array([[1, 0, 0, 0], [-3, 3, 0, 0], [3, -6, 3, 0], [-1, 3, -3, 1]])  # of its four points
POWERS["catmull_rom"] = BEZIER @ (np.array([[0, 6, 0, 0], [-1, 6, 1, 0], [0, 1, 6, -1], [0, 0, 6, 0]]) / 6)


class Curve:
    """The curve through an open chain of facets: `nodes[j]` are the four nodes of segment j, `powers[j]` its
    coefficients of them (ghosts are shared among the nodes that they are made of)."""

    def __init__(self, kind, facets):
        self.kind, self.chain = kind, [facets[0][0]] + [b for _, b in facets]
        assert self.chain[:-1] == [a for a, _ in facets] and self.chain[0] != self.chain[-1], "not an open chain"
        n = len(facets)
        self.nodes, self.powers = np.zeros((n, 4), dtype=int), np.zeros((n, 4, 4))
        for j in range(n):
            share = np.zeros((4, n + 1))  # of the four places, by node of the chain
            for c, at in enumerate(range(j - 1, j + 3)):
                if 0 <= at <= n:
                    share[c, at] = 1
                elif at < 0:
                    share[c, 0], share[c, 1] = 2, -1
                else:
                    share[c, n], share[c, n - 1] = 2, -1
            first = min(max(j - 1, 0), max(n - 3, 0))
            window = [min(first + c, n) for c in range(4)]
            assert n >= 3, "a master of three facets at least"
            self.nodes[j] = [self.chain[w] for w in window]
            self.powers[j] = POWERS[kind] @ share[:, window]

    def locate(self, x, all_places):
        """(segment, xi) of the closest point, or None past a free end; all numbers real."""
        at = all_places[self.chain]
        n = len(self.chain) - 1
        best = None
        if self.kind == "faceted":
            edge = np.diff(at, axis=0)
            length = np.sqrt((edge ** 2).sum(axis=1))
            unit = edge / length[:, None]
            for j in range(n):
                if j > 0 and (x - at[j]) @ (unit[j - 1] + unit[j]) < 0:
                    continue
                if j < n - 1 and (x - at[j + 1]) @ (unit[j] + unit[j + 1]) > 0:
                    continue
                xi = (x - at[j]) @ edge[j] / length[j] ** 2
                distance = np.linalg.norm(x - at[j] - np.clip(xi, 0, 1) * edge[j])
                if best is None or distance < best[0]:
                    best = (distance, j, xi)
        else:
            # from three places of every segment
            b = np.repeat(self.powers @ all_places[self.nodes], 3, axis=0)
            xi = np.tile([0.0, 0.5, 1.0], n)
            for _ in range(40):
                y, d, dd = value(b, xi)
                slope, square = dot(x - y, dd) - dot(d, d), dot(d, d)
                step = -dot(x - y, d) / np.where(slope < 0, slope, -square)
                xi = np.clip(xi + np.clip(step, -0.5, 0.5), -0.5, 1.5)
                if np.abs(step[(xi > -0.5) & (xi < 1.5)]).max(initial=0) < 1e-15:
                    break
            distance = np.linalg.norm(x - value(b, xi)[0], axis=1)
            inner = 1e-12  # rounding: the point of two segments is that of either
            low, high = np.full(3 * n, -inner), np.full(3 * n, 1 + inner)
            low[:3], high[-3:] = -0.5, 1.5
            inside = np.flatnonzero((low <= xi) & (xi <= high))
            if len(inside):
                k = inside[np.argmin(distance[inside])]
                best = (distance[k], int(k) // 3, xi[k])
        if best is None or (best[1] == 0 and best[2] < -PAST_THE_END) or (
                best[1] == n - 1 and best[2] > 1 + PAST_THE_END):
            return None
        return best[1:]


def value(b, xi):
    """Place and two derivatives of a segment with power coefficients b (..., 4, 2) at xi (...)."""
    xi = np.asarray(xi)[..., None]
    y = b[..., 0, :] + xi * (b[..., 1, :] + xi * (b[..., 2, :] + xi * b[..., 3, :]))
    d = b[..., 1, :] + xi * (2 * b[..., 2, :] + 3 * xi * b[..., 3, :])
    return y, d, 2 * b[..., 2, :] + 6 * xi * b[..., 3, :]


def dot(a, b):
    return (a * b).sum(axis=-1)


# --- model -----------------------------------------------------------------------------------------------------------


class FinitePoint:
    def __init__(self, contact, slave, curve, area, mu, offset):
        self.contact, self.slave, self.curve, self.area, self.mu, self.offset = contact, slave, curve, area, mu, offset


class FiniteModel:
    def __init__(self, document):
        self.document = document
        self.bodies, self.first, n = {}, {}, 0
        for name, description in document["bodies"].items():
            body = self.bodies[name] = body_of(description, 2, document["space"] == "plane_stress")
            body.prepare()
            self.first[name] = n
            n += len(body.X)
        self.X = np.concatenate([b.X for b in self.bodies.values()])
        self.points = []
        for name, c in document.get("contacts", {}).items():
            (slave, side), (master, other) = self.side(c["slave"]), self.side(c["master"])
            kind = c.get("surface", "faceted")
            kind = kind["smooth"] if isinstance(kind, dict) else {"smooth": "catmull_rom"}.get(kind, kind)
            facets = [(self.first[master] + a, self.first[master] + b) for a, b in other.facets]
            curve = Curve(kind, facets)
            for node, area in zip(side.nodes, self.bodies[slave].tributary(side)):
                self.points.append(FinitePoint(name, self.first[slave] + node, curve, area, c.get("friction"),
                                               c.get("offset", 0.0)))
        self.area = np.array([p.area for p in self.points])
        self.mu = np.array([p.mu or 0.0 for p in self.points])
        self.offset = np.array([p.offset for p in self.points])
        self.held = {}
        for support in document["supports"]:
            for axis, table in support["move"].items():
                for node in self.nodes(support["on"]):
                    self.held[2 * node + "xy".index(axis)] = table
        self.fixed = np.array(sorted(self.held), dtype=int)
        self.free = np.setdiff1d(np.arange(2 * n), self.fixed)

    def side(self, name):
        body, side = name.split(".")
        return body, self.bodies[body].side([side])

    def nodes(self, name):
        body, side = self.side(name)
        return [self.first[body] + n for n in side.nodes]

    def prescribed(self, t):
        return np.array([table_at(self.held[dof], t) for dof in self.fixed])

    def dofs(self):
        """Of each body: (body, global dofs of its elements)."""
        return [(b, (2 * (b.E + self.first[name])[:, :, None] + np.arange(2)).reshape(len(b.E), 8))
                for name, b in self.bodies.items()]

    def internal(self, u):
        force = np.zeros(len(u), dtype=u.dtype if np.iscomplexobj(u) else complex)
        for body, dofs in self.dofs():
            np.add.at(force, dofs, body.forces(u[dofs].reshape(-1, 4, 2)).reshape(-1, 8))
        return force

    def energy(self, u):
        return sum(body.energy(u[dofs].reshape(-1, 4, 2)) for body, dofs in self.dofs())

    def stiffness(self, u):
        K = np.zeros((len(u), len(u)))
        for body, dofs in self.dofs():
            np.add.at(K, (dofs[:, :, None], dofs[:, None, :]), body.tangents(u[dofs].reshape(-1, 4, 2)))
        return K

    def settle(self, u):
        for body, dofs in self.dofs():
            body.settle(u[dofs].reshape(-1, 4, 2))

    def memory(self):
        return {name: body.memory for name, body in self.bodies.items() if isinstance(body, MetalBody)}

    def remember(self, memory):
        for name, numbers in memory.items():
            self.bodies[name].memory = numbers

    def locate(self, u):
        """Feet of all points: (segment or -1, xi), on the real configuration."""
        places = self.X.real + u.real.reshape(-1, 2)
        feet = [p.curve.locate(places[p.slave], places) for p in self.points]
        return [f if f is not None else (-1, 0.0) for f in feet]


class Pairing:
    """The points that have a foot, with their segments now and at the end of the last step; nine local nodes each: the
    slave, four of the master now, four of it then."""

    def __init__(self, model, feet, before):
        self.model = model
        self.on = np.array([i for i, f in enumerate(feet) if f[0] >= 0], dtype=int)
        for i in self.on:
            assert before[i][0] >= 0, "a point that had no foot at the end of the last step slips from nowhere"
        points = [model.points[i] for i in self.on]
        now, then = [feet[i] for i in self.on], [before[i] for i in self.on]
        self.nodes = np.array([[p.slave, *p.curve.nodes[f[0]], *p.curve.nodes[b[0]]]
                               for p, f, b in zip(points, now, then)]).reshape(-1, 9)
        self.powers = np.array([p.curve.powers[f[0]] for p, f in zip(points, now)]).reshape(-1, 4, 4)
        self.powers_then = np.array([p.curve.powers[b[0]] for p, b in zip(points, then)]).reshape(-1, 4, 4)
        self.xi = np.array([f[1] for f in now])
        self.xi_then = np.array([b[1] for b in then])
        self.dofs = (2 * self.nodes[:, :, None] + np.arange(2)).reshape(-1, 18)

    def kinematics(self, local):
        """xi, gap without its offset, slip, normal, tangent, shape functions at local places (..., points, 9, 2)."""
        x = local[..., 0, :]
        b = self.powers @ local[..., 1:5, :]
        xi = self.xi + np.zeros(x.shape[:-1])
        for _ in range(6):  # from the closest point at hand: the first few are for the real part
            y, d, dd = value(b, xi)
            xi = xi - dot(x - y, d) / (dot(x - y, dd) - dot(d, d))
        y, d, _ = value(b, xi)
        e = d / np.sqrt(dot(d, d))[..., None]
        n = np.stack([e[..., 1], -e[..., 0]], axis=-1)  # the solid is on the left of d
        y_then = value(self.powers_then @ local[..., 5:9, :], self.xi_then)[0]
        N = np.stack([xi ** 0, xi, xi ** 2, xi ** 3], axis=-1)[..., None, :] @ self.powers
        return xi, dot(x - y, n), dot(y - y_then, e), n, e, N[..., 0, :]

    def places(self, u):
        return (self.model.X + u.reshape(-1, 2))[self.nodes]

    def forces(self, local, p, t):
        """Forces of contact on the nine local nodes (..., points, 18), gap and slip."""
        _, gap, slip, n, e, N = self.kinematics(local)
        force = self.model.area[self.on][:, None] * (p[..., None] * n + t[..., None] * e)
        shared = np.concatenate([force[..., None, :], -N[..., :, None] * force[..., None, :],
                                 0 * local[..., 5:9, :]], axis=-2)
        return shared.reshape(shared.shape[:-2] + (18,)), gap + self.model.offset[self.on], slip

    def everything(self, u, p, t, tangents=True):
        """Forces, gap and slip, and their derivatives by the 18 local displacements, p and t."""
        local = self.places(u)
        p, t = p[self.on], t[self.on]
        force, gap, slip = self.forces(local, p, t)
        if not tangents:
            return force, gap, slip
        turn = 1j * STEP * np.eye(20)
        f, g, s = self.forces(local[None] + turn[:, :18].reshape(20, 1, 9, 2), p[None] + turn[:, 18:19],
                              t[None] + turn[:, 19:20])
        return force, gap, slip, f.imag / STEP, g.imag / STEP, s.imag / STEP


# --- the path --------------------------------------------------------------------------------------------------------


class FinitePath:
    def __init__(self, model):
        self.model, self.n = model, len(model.points)
        self.size = 2 * len(model.X)
        young = max(np.real(b.description["material"][b.kind]["E"]) for b in model.bodies.values())
        lengths = [np.sqrt(np.abs(b.weight.real.sum(axis=1)).max()) for b in model.bodies.values()]
        self.length, self.force = max(lengths), young * max(lengths)
        self.rho = young / max(lengths)  # pressure per length
        self.worst = 0.0

    def states(self, pairing, p, t, gap, slip):
        """Branch of each point: open, stick or slip with its sign."""
        m, states = self.model, [("open", 0)] * self.n
        for k, i in enumerate(pairing.on):
            pressure = p[i] - self.rho * gap[k]
            if pressure <= 0:
                continue
            trial = t[i] - self.rho * slip[k]
            if m.points[i].mu is None:
                states[i] = ("slip", 0)
            elif abs(trial) <= m.mu[i].real * pressure:
                states[i] = ("stick", 0)
            else:
                states[i] = ("slip", int(np.sign(trial)))
        return states

    def system(self, u, p, t, pairing, states, tangents=True):
        """Residual of (all displacements, p, t) and its tangent."""
        m, n, size = self.model, self.n, self.size
        force, gap, slip, *slopes = pairing.everything(u, p, t, tangents)
        R = np.zeros(size + 2 * n, dtype=complex)
        R[:size] = m.internal(u)
        np.subtract.at(R, pairing.dofs, force)
        # rows of the law: p and t by rho, gap and slip as they are
        R[size:size + n], R[size + n:] = p / self.rho, t / self.rho
        closed = [(k, i) for k, i in enumerate(pairing.on) if states[i][0] != "open"]
        for k, i in closed:
            R[size + i] = gap[k]
            sliding = (t[i] - states[i][1] * m.mu[i] * p[i]) / self.rho
            R[size + n + i] = slip[k] if states[i][0] == "stick" else sliding
        if not tangents:
            return R, gap, slip, None
        J = np.zeros((size + 2 * n, size + 2 * n))
        J[:size, :size] = m.stiffness(u.real)
        J[range(size, size + 2 * n), range(size, size + 2 * n)] = 1 / self.rho
        for k, i in enumerate(pairing.on):
            columns = np.append(pairing.dofs[k], [size + i, size + n + i])
            f, g, s = (slope[:, k] for slope in slopes)
            np.subtract.at(J, (pairing.dofs[k][:, None], columns[None]), f.T)
            if states[i][0] == "open":
                continue
            J[size + i, size + i] = 0
            np.add.at(J[size + i], columns, g)
            if states[i][0] == "stick":
                J[size + n + i, size + n + i] = 0
                np.add.at(J[size + n + i], columns, s)
            else:
                J[size + n + i, size + i] = -states[i][1] * m.mu[i].real / self.rho
        return R, gap, slip, J

    def newton(self, u, p, t, before, held):
        """Solves from a starting point, the supports at `held`; None where it fails, or strays to where a solution
        would be another one: nothing moves by twice what a support does."""
        m, n, size = self.model, self.n, self.size
        unknown = np.concatenate([m.free, np.arange(size, size + 2 * n)])
        start, u, p, t, last = u, u.copy(), p.copy(), t.copy(), None
        reach = 2 * np.abs(held - u[m.fixed]).max() + 1e-9 * self.length
        for _ in range(60):
            feet = m.locate(u)
            pairing = Pairing(m, feet, before)
            _, gap, slip = pairing.everything(u, p, t, False)
            states = self.states(pairing, p.real, t.real, gap.real, slip.real)
            try:
                R, gap, slip, J = self.system(u, p, t, pairing, states)
            except Inverted:
                return None
            R = R.real
            jump = held - u[m.fixed]
            scale = np.concatenate([np.full(len(m.free), self.force), np.full(2 * n, self.length)])
            error = np.abs(R[unknown] / scale).max()
            here = (tuple(states), tuple(f[0] for f in feet))
            if error < 1e-14 and not np.abs(jump).max() > 0 and here == last:
                return u, p, t, feet, states, pairing
            last = here
            try:
                step = np.linalg.solve(J[np.ix_(unknown, unknown)], -R[unknown] - J[np.ix_(unknown, m.fixed)] @ jump)
            except np.linalg.LinAlgError:
                return None
            whole = np.zeros(size + 2 * n)
            whole[unknown], whole[m.fixed] = step, jump
            factor = 1.0
            for _ in range(8):
                try:
                    m.internal(u + factor * whole[:size])
                    break
                except Inverted:
                    factor /= 2
            u = u + factor * whole[:size]
            if factor == 1:
                u[m.fixed] = held
            p, t = p + factor * whole[size:size + n], t + factor * whole[size + n:]
            if np.abs(u - start).max() > reach:
                return None
        return None

    def step(self, u, p, t, before, start, end):
        """From the solution at the time `start`; a part of the step only gives a starting point: its slip is that of
        the step so far."""
        for parts in (1, 2, 4, 8, 16, 32, 64):
            found = (u, p, t)
            for k in range(parts):
                time = start + (end - start) * (k + 1) / parts if k + 1 < parts else end
                found = self.newton(*found[:3], before, self.model.prescribed(time).real)
                if found is None:
                    break
            if found is not None:
                return found
        raise RuntimeError(f"no solution found at time {end}")

    def verify(self, p, t, states, pairing, gap, slip):
        """Largest violation of the law: lengths by that of an element, tractions by Young's modulus; and margins."""
        m, faults, opening, sliding = self.model, [0.0], [], []
        place = {i: k for k, i in enumerate(pairing.on)}
        pressure, length = self.rho * self.length, self.length
        for i, (name, _) in enumerate(states):
            mu = m.mu[i].real
            if name == "open":
                faults += [abs(p[i]) / pressure, abs(t[i]) / pressure]
                if i in place:
                    faults.append(-gap[place[i]] / length)
                    opening.append(gap[place[i]] / length)
                continue
            g, s = gap[place[i]], slip[place[i]]
            faults += [abs(g) / length, -p[i] / pressure, (abs(t[i]) - mu * p[i]) / pressure]
            opening.append(p[i] / pressure)
            if m.points[i].mu is None:
                continue
            faults.append(abs(s) / length if name == "stick" else
                          max(s * np.sign(t[i]) / length, (mu * p[i] - abs(t[i])) / pressure))
            sliding.append((mu * p[i] - abs(t[i])) / pressure if name == "stick" else abs(s) / length)
        self.worst = max(self.worst, *faults)
        return {"open": min(opening, default=None), "slip": min(sliding, default=None)}

    def result(self, time, u, p, t, feet, states, pairing, dissipation):
        _, gap, slip = pairing.everything(u, p, t, False)
        every_gap, every_slip = np.zeros(self.n, dtype=complex), np.zeros(self.n, dtype=complex)
        every_gap[pairing.on], every_slip[pairing.on] = gap, slip
        return {"time": time, "u": u, "p": p, "t": t, "feet": feet, "states": states, "pairing": pairing,
                "memory": self.model.memory(),  # that the step starts from
                "gap": every_gap, "slip": every_slip,
                "dissipation": dissipation - self.model.area * t * every_slip *
                               np.array([s[0] == "slip" and s[1] != 0 for s in states])}

    def run(self):
        m, n = self.model, self.n
        for body in m.bodies.values():
            if isinstance(body, MetalBody):
                body.forget()
        u, p, t = np.zeros(self.size), np.zeros(n), np.zeros(n)
        feet, results, dissipation, start = m.locate(u), [], np.zeros(n), 0.0
        for end in time_grid(m.document["time"]):
            u, p, t, feet_now, states, pairing = self.step(u, p, t, feet, start, end)
            result = self.result(end, u, p, t, feet_now, states, pairing, dissipation)
            result["margins"] = self.verify(p, t, states, pairing, result["gap"][pairing.on].real,
                                            result["slip"][pairing.on].real)
            # the foot is where the converged displacements put it
            feet, dissipation, start = m.locate(u), result["dissipation"], end
            result["feet"] = feet
            results.append(result)
            m.settle(u)
        return results

    def tangents(self, results):
        """Factors of the converged steps, for complex twins."""
        m, n, size = self.model, self.n, self.size
        unknown = np.concatenate([m.free, np.arange(size, size + 2 * n)])
        factors = []
        for r in results:
            m.remember(r["memory"])
            J = self.system(r["u"], r["p"], r["t"], r["pairing"], r["states"])[3]
            factors.append((unknown, scipy.linalg.lu_factor(J[np.ix_(unknown, unknown)])))
        return factors

    def twin(self, document, results, factors):
        """The path of a document with complex numbers, with the states of the real one."""
        m, n, size = FiniteModel(document), self.n, self.size
        twin = FinitePath(m)
        before, dissipation, path = FinitePath.feet_at(m, np.zeros(size), self.model.locate(np.zeros(size))), 0, []
        for r, (unknown, factor) in zip(results, factors):
            u, p, t = r["u"].astype(complex), r["p"].astype(complex), r["t"].astype(complex)
            u[m.fixed] = m.prescribed(r["time"])
            pairing = Pairing(m, r["feet"], before)
            for _ in range(3):  # the first is exact but for rounding
                R = twin.system(u, p, t, pairing, r["states"], False)[0]
                step = -1j * scipy.linalg.lu_solve(factor, R[unknown].imag / STEP) * STEP
                whole = np.zeros(size + 2 * n, dtype=complex)
                whole[unknown] = step
                u, p, t = u + whole[:size], p + whole[size:size + n], t + whole[size + n:]
            path.append(twin.result(r["time"], u, p, t, r["feet"], r["states"], pairing, dissipation))
            m.settle(u)
            before, dissipation = FinitePath.feet_at(m, u, r["feet"]), path[-1]["dissipation"]
        return m, path

    @staticmethod
    def feet_at(model, u, feet):
        """The feet again, with the derivatives of their places on their segments."""
        pairing = Pairing(model, feet, feet)
        xi = pairing.kinematics(pairing.places(u))[0]
        again = list(feet)
        for k, i in enumerate(pairing.on):
            again[i] = (feet[i][0], xi[k])
        return again


# --- responses and the whole reference -------------------------------------------------------------------------------


def residual_forces(model, r):
    """Forces of the supports on the nodes: internal forces less those of contact (nodes x 2)."""
    total = model.internal(r["u"].astype(complex))
    force, _, _ = r["pairing"].everything(r["u"], r["p"], r["t"], False)
    np.subtract.at(total, r["pairing"].dofs, force)
    return total.reshape(-1, 2)


def slave_forces(model, r):
    """Forces on the slave nodes (points x 2), and tangents e there."""
    pairing = r["pairing"]
    forces, tangents = np.zeros((len(model.points), 2), dtype=complex), np.zeros((len(model.points), 2), dtype=complex)
    _, _, _, n, e, _ = pairing.kinematics(pairing.places(r["u"]))
    on = pairing.on
    forces[on] = model.area[on][:, None] * (r["p"][on][:, None] * n + r["t"][on][:, None] * e)
    tangents[on] = e
    return forces, tangents


def responses(model, r):
    values = {}
    model.remember(r["memory"])
    for name, response in model.document.get("responses", {}).items():
        (kind, q), = response.items()
        mine = [i for i, p in enumerate(model.points) if p.contact == q.get("contact")]
        if kind == "reaction":
            values[name] = sum(residual_forces(model, r)[model.nodes(q["on"]), "xy".index(q["component"])])
        elif kind == "strain_energy":
            values[name] = model.energy(r["u"].astype(complex))
        elif kind == "contact_force":
            values[name] = (sum(model.area[i] * r["p"][i] for i in mine) if q["component"] == "normal"
                            else sum(slave_forces(model, r)[0][mine, "xy".index(q["component"])]))
        elif kind == "gap" and q.get("take", "mean") == "mean":
            values[name] = sum(model.area[i] * r["gap"][i] for i in mine) / sum(model.area[i] for i in mine)
        elif kind == "dissipation":
            values[name] = sum(r["dissipation"][i] for i in mine)
        elif kind == "plastic_strain":
            body = model.bodies[q["on"]]
            dofs, = (dofs for b, dofs in model.dofs() if b is body)
            strain = body.flow(r["u"][dofs].reshape(-1, 4, 2))[4]
            at = strain.real.argmax()
            values[name] = (strain.flat[at] if q.get("take") == "max"
                            else np.sum(strain * body.weight) / np.sum(body.weight))
        else:
            raise ValueError(f"response {name}: {kind}")
    return values


def solve(document, derivatives=True):
    """(model, results, values per increment, sensitivities per increment, worst violation) of the whole path."""
    model = FiniteModel(document)
    path = FinitePath(model)
    results = path.run()
    values = [{name: complex(v).real for name, v in responses(model, r).items()} for r in results]
    gradients = [{name: {} for name in v} for v in values]
    if derivatives:
        factors = path.tangents(results)
        for name, parameter in document.get("parameters", {}).items():
            twin, steps = path.twin(perturbed(document, weights_of(parameter), 1j * STEP), results, factors)
            for gradient, r in zip(gradients, steps):
                for response, v in responses(twin, r).items():
                    gradient[response][name] = complex(v).imag / STEP
    return model, results, values, gradients, path.worst


def differences(document, parameter, h=1e-4):
    """Derivatives of all steps' responses by central differences of the whole path, states free, with one Richardson
    extrapolation; h relative to the first number. A check on the complex step, not the reference."""
    weights = weights_of(parameter)
    node, key = at_pointer(document, next(iter(weights)))
    size = abs(node[key]) or 1.0
    rows = []
    for step in (h * size, h * size / 2):
        up, down = (solve(perturbed(document, weights, s * step), False)[2] for s in (1, -1))
        rows.append([{name: (a[name] - b[name]) / (2 * step) for name in a} for a, b in zip(up, down)])
    return [{name: (4 * b[name] - a[name]) / 3 for name in a} for a, b in zip(*rows)]


def finite_reference(document):
    """The solution as it is written to tests/references/finite_*.json, laid out as by contact_reference.reference.
    Positions and areas are initial, slips and forces current."""
    model, results, values, gradients, worst = solve(document)
    steps = []
    for r, value_, gradient in zip(results, values, gradients):
        u = r["u"].reshape(-1, 2)
        forces, tangents = slave_forces(model, r)
        contacts = {}
        for i, p in enumerate(model.points):
            c = contacts.setdefault(p.contact, {key: [] for key in
                                                ("x", "area", "gap", "slip", "normal", "force", "state")})
            c["x"].append(plain(model.X[p.slave]))
            c["area"].append(plain(p.area))
            c["gap"].append(plain(r["gap"][i]))
            c["slip"].append(plain(r["slip"][i] * tangents[i] if p.mu is not None else 0 * tangents[i]))
            c["normal"].append(plain(-r["p"][i]))
            c["force"].append(plain(forces[i]))
            c["state"].append(r["states"][i][0])
        steps.append({"time": r["time"],
                      "displacement": {name: plain(u[model.first[name]:][:len(b.X)])
                                       for name, b in model.bodies.items()},
                      "contacts": contacts, "margins": r["margins"], "responses": value_,
                      "sensitivities": gradient})
    return {"largest_violation": worst, "steps": steps}


# --- two rings -------------------------------------------------------------------------------------------------------


class Ring:
    """A neo-Hookean ring in plane strain, quadratic in its volume: state (r, a = dr/dR) along the initial radius R."""

    def __init__(self, young, nu):
        self.G, self.La = young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu))

    def radial(self, R, r, a):
        """Nominal radial stress: dpsi/da, with b = r/R and J = a b."""
        b = r / R
        return self.G * (a - 1 / a) + self.La * (a * b - 1) * b

    def slope(self, R, r, a):
        """(r', a') from dP_R/dR = (P_hoop - P_R) / R."""
        b = r / R
        hoop = self.G * (b - 1 / b) + self.La * (a * b - 1) * a
        by_a = self.G * (1 + 1 / a ** 2) + self.La * b ** 2
        by_b = self.La * (2 * a * b - 1)
        return a, ((hoop - self.radial(R, r, a)) / R - by_b * (a - b) / R) / by_a


def press_fit(interference, young=1000.0, nu=0.3, radii=(1.0, 2.0, 4.0), shooting=False):
    """Nominal contact pressure, per initial area, of a ring between radii[0] and radii[1], held within, in a ring
    between radii[1] and radii[2], held around, that overlap by the interference at radii[1]."""
    ring = Ring(young, nu)
    inner, middle, outer = radii
    if shooting:
        def ends(slopes):
            # both rings from their held walls to the middle
            found = []
            for R, slope in zip((inner, outer), slopes):
                run = scipy.integrate.solve_ivp(lambda R_, y: ring.slope(R_, *y), (R, middle), [R, slope],
                                                method="DOP853", rtol=1e-13, atol=1e-14)
                found.append(run.y[:, -1])
            return found
        slopes = np.ones(2)
        for _ in range(12):
            def misfit(s):
                (r1, a1), (r2, a2) = ends(s)
                return np.array([r2 - r1 - interference,
                                 (ring.radial(middle, r2, a2) - ring.radial(middle, r1, a1)) / young])
            J = np.array([(misfit(slopes + h) - misfit(slopes - h)) / 2e-6 for h in 1e-6 * np.eye(2)]).T
            step = np.linalg.solve(J, misfit(slopes))
            slopes = slopes - step
            if np.abs(step).max() < 1e-14:
                break
        return -ring.radial(middle, *ends(slopes)[1])
    # both rings along s of 0 to 1, from their inner walls outward
    along = lambda s: (inner + (middle - inner) * s, middle + (outer - middle) * s)

    # displacements in units of the interference: the tolerance of the solver is then one of the pressure
    def states(s, y):
        return tuple((R, R + interference * u, 1 + interference * du) for R, u, du in zip(along(s), y[::2], y[1::2]))

    def slope(s, y):
        return np.vstack([np.stack([du, ring.slope(*state)[1] / interference]) * width
                          for du, state, width in zip(y[1::2], states(s, y), (middle - inner, outer - middle))])

    def at_the_walls(y0, y1):
        P1, P2 = ring.radial(*states(1, y1)[0]), ring.radial(*states(0, y0)[1])
        return np.array([y0[0], y1[2], y0[2] - y1[0] - 1, (P1 - P2) / (young * interference)])

    s = np.linspace(0, 1, 41)
    found = scipy.integrate.solve_bvp(slope, at_the_walls, s, np.zeros((4, len(s))), tol=1e-10, bc_tol=1e-11,
                                      max_nodes=20000)
    assert found.success, found.message
    return -ring.radial(*states(0, found.sol(0))[1])
