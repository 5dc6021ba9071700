"""Independent reference solver for small-strain frictional contact, for the tests of stickslip.

Reads a scene in stickslip's own JSON and solves it by other algorithms than stickslip's: no Newton iteration on a
projected traction and no regularisation of the exact law.

  1. The bodies are condensed to the contact points, W = B K^-1 B^T, and the incremental Signorini-Coulomb problem is
     solved as a linear complementarity problem by Lemke's pivoting in the plane, by block Gauss-Seidel in space.
     (Bodies that only contact holds have a singular K; this search, and only it, then adds weak springs.)
  2. Its states (open, stick, slip and direction) are taken as known, and the equations they leave are solved directly
     in (u, r), r the forces of the points on their slave nodes, with K as it is.
  3. Every inequality of the contact law is verified on that solution; without that there is no result.

The penalised problem is the same one with a compliance 1/(eps A) in series with each point, and stored tangential
forces.

Derivatives: complex step through mesh, stiffness, contact geometry and step 2 over the whole path, with the states of
the real path. It is exact where no point is weakly active; `margins` says how far each increment is from that.

Conventions: gap and slip from the initial geometry (projection, normal, tributary area fixed); slip increments from
the last converged increment; plane strain of unit thickness; n out of the master; normal traction negative in
compression, force on the slave -A (t_N n + t_T).
"""

import copy
import json
import math
import re

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

STEP = 1e-40  # of the complex step: no cancellation, so any size whose square vanishes will do


def load_commented(path):
    """The document of a JSON file with // comments."""
    with open(path, encoding="utf-8") as f:
        text = f.read()
    return json.loads(re.sub(r'("(?:[^"\\]|\\.)*")|//[^\n]*', lambda m: m.group(1) or "", text))


def at_pointer(document, pointer):
    """Container and key that a JSON pointer ends in."""
    keys = pointer.strip("/").split("/")
    node = document
    for key in keys[:-1]:
        node = node[int(key)] if isinstance(node, list) else node[key]
    return node, int(keys[-1]) if isinstance(node, list) else keys[-1]


def perturbed(document, weights, step):
    """A copy of the document with step * weight added at each pointer."""
    result = copy.deepcopy(document)
    for pointer, weight in weights.items():
        node, key = at_pointer(result, pointer)
        node[key] = node[key] + step * weight
    return result


def weights_of(parameter):
    return {parameter: 1.0} if isinstance(parameter, str) else parameter


def table_at(table, t):
    """Linear between points, held outside; a plain number is constant."""
    if not isinstance(table, list):
        return table
    if t <= table[0][0]:
        return table[0][1]
    for (t0, v0), (t1, v1) in zip(table, table[1:]):
        if t <= t1:
            s = (t - t0) / (t1 - t0)
            return v0 * (1 - s) + v1 * s
    return table[-1][1]


def time_grid(time):
    legs = time.get("legs", [[time["end"], time["steps"]]] if "end" in time else None)
    times, start = [], 0.0
    for end, steps in legs:
        times += [start + (end - start) * (i + 1) / steps for i in range(steps)]
        start = end
    return times


# --- meshes ----------------------------------------------------------------------------------------------------------


class Side:
    def __init__(self, nodes, facets=()):
        self.nodes, self.facets = list(nodes), [tuple(f) for f in facets]

    @staticmethod
    def along(nodes):
        return Side(nodes, zip(nodes, nodes[1:]))


class Body:
    """Coordinates (n x d), elements and sides of one body; kind is Q4, T3, bar or point."""

    def __init__(self, description, dimension, folder="."):
        self.description = description
        (family, m), = description["mesh"].items() if "gmsh" not in description["mesh"] else (("gmsh", None),)
        getattr(self, "_" + family)(m, dimension, folder)

    def _box(self, m, dimension, folder):
        (nx, ny), lo, hi = m["cells"], m["min"], m["max"]
        fx, fy = np.arange(nx + 1) / nx, np.arange(ny + 1) / ny
        self.X = np.array([[lo[0] * (1 - a) + hi[0] * a, lo[1] * (1 - b) + hi[1] * b] for b in fy for a in fx])
        node = lambda i, j: j * (nx + 1) + i
        self.kind = self.description.get("element", "Q4")
        self.elements = []
        for j in range(ny):
            for i in range(nx):
                a, b, c, d = node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)
                if self.kind == "Q4":
                    self.elements.append((a, b, c, d))
                    continue
                # alternating diagonals, mirror symmetric, one starting in every corner of the box
                even = (min(i, nx - 1 - i) + min(j, ny - 1 - j)) % 2 == 0
                first = even == ((2 * i < nx) == (2 * j < ny))
                self.elements += [(a, b, c), (a, c, d)] if first else [(a, b, d), (b, c, d)]
        self.sides = {"bottom": Side.along([node(i, 0) for i in range(nx + 1)]),
                      "right": Side.along([node(nx, j) for j in range(ny + 1)]),
                      "top": Side.along([node(nx - i, ny) for i in range(nx + 1)]),
                      "left": Side.along([node(0, ny - j) for j in range(ny + 1)])}

    def _chain(self, cells):
        self.kind = "bar"
        self.elements = [(i, i + 1) for i in range(cells)]
        whole = Side.along(range(cells + 1))
        self.sides = {"start": Side([0]), "end": Side([cells]), "nodes": whole,
                      "interior": Side(range(1, cells), whole.facets)}

    def _line(self, m, dimension, folder):
        n, a, b = m["cells"], np.array(m["from"]), np.array(m["to"])
        self.X = np.array([a * (1 - i / n) + b * (i / n) for i in range(n + 1)])
        self._chain(n)

    def _arc(self, m, dimension, folder):
        n, degree = m["cells"], math.pi / 180
        angle = np.array([m["from_angle"] * (1 - i / n) + m["to_angle"] * (i / n) for i in range(n + 1)]) * degree
        self.X = np.stack([m["center"][0] + m["radius"] * np.cos(angle),
                           m["center"][1] + m["radius"] * np.sin(angle)], axis=1)
        if dimension == 3:
            self.X = np.hstack([self.X, np.zeros((n + 1, 1))])
        self._chain(n)

    def _point(self, m, dimension, folder):
        # node 1 is the anchor of the spring: a degree of freedom of its own, at the same place
        self.kind, self.elements = "point", [(0, 1)]
        self.X = np.array([m["at"], m["at"]])
        self.sides = {"node": Side([0]), "anchor": Side([1])}

    def _gmsh(self, m, dimension, folder):
        self.X, self.kind, self.elements, self.sides = read_msh(
            f"{folder}/{self.description['mesh']['gmsh']}", self.description["mesh"]["body"])

    def side(self, names):
        """Side of "left", ["left", ("&", "bottom")], ["bottom", ("-", "right")]."""
        first = self.sides[names[0]]
        nodes, facets = list(first.nodes), list(first.facets)
        for operation, name in names[1:]:
            other = self.sides[name]
            keep = operation == "&"
            nodes = [n for n in nodes if (n in other.nodes) == keep]
            facets = [f for f in facets if (f in other.facets if keep else any(n in nodes for n in f))]
        return Side(nodes, facets)

    def tributary(self, side):
        """Half of the facets at each node of the side (n values)."""
        area = np.zeros(len(self.X), dtype=self.X.dtype)
        for a, b in side.facets:
            length = np.sqrt(np.sum((self.X[b] - self.X[a]) ** 2))
            area[a] += length / 2
            area[b] += length / 2
        return area[side.nodes]

    def stiffness(self, plane_stress=False):
        """Element matrices and their dofs."""
        d = self.X.shape[1]
        E = np.array(self.elements)
        if self.kind == "point":
            k = np.array(self.description["material"]["grounded_spring"]["stiffness"])
            return np.block([[k, -k], [-k, k]])[None], dofs_of(E, d)
        law = self.description["material"]["linear_elastic"]
        if self.kind == "bar":
            t = self.X[E[:, 1]] - self.X[E[:, 0]]
            L = np.sqrt((t * t).sum(axis=1))
            k = np.einsum("ei,ej->eij", t, t) * (law["E"] * self.description.get("area", 1) / L ** 3)[:, None, None]
            return np.concatenate([np.concatenate([k, -k], 2), np.concatenate([-k, k], 2)], 1), dofs_of(E, d)
        nu, young = law["nu"], law["E"]
        if plane_stress:
            D = young / (1 - nu * nu) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
        else:
            D = young / ((1 + nu) * (1 - 2 * nu)) * np.array(
                [[1 - nu, nu, 0], [nu, 1 - nu, 0], [0, 0, (1 - 2 * nu) / 2]])
        if self.kind == "Q4":
            g = 1 / math.sqrt(3)
            corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
            rule = [(corners * (1 + corners[:, ::-1] * np.array(p)[::-1]) / 4, 1.0) for p in corners * g]
        else:
            rule = [(np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]), 0.5)]
        X = self.X[E]
        K = 0
        for dN, weight in rule:
            J = np.einsum("ak,eai->eki", dN, X)
            det = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
            assert (det.real > 0).all(), "inverted element"
            inverse = np.empty_like(J)
            inverse[:, 0, 0], inverse[:, 1, 1] = J[:, 1, 1] / det, J[:, 0, 0] / det
            inverse[:, 0, 1], inverse[:, 1, 0] = -J[:, 0, 1] / det, -J[:, 1, 0] / det
            G = np.einsum("eik,ak->eia", inverse, dN)
            B = np.zeros((len(E), 3, 2 * E.shape[1]), dtype=G.dtype)
            B[:, 0, 0::2] = B[:, 2, 1::2] = G[:, 0]
            B[:, 1, 1::2] = B[:, 2, 0::2] = G[:, 1]
            K = K + np.einsum("eki,kl,elj,e->eij", B, D, B, det * weight)
        return K, dofs_of(E, 2)

    def shape_at(self, point):
        """(least shape function, nodes, shape functions) of the element in which a point of the initial configuration
        lies deepest; it holds the point where the first is not negative."""
        best = None
        X = self.X.real
        for element in self.elements:
            P = X[list(element)]
            xi = np.zeros(2)
            for _ in range(30):
                N, dN = shape(self.kind, xi)
                step = np.linalg.solve((dN.T @ P).T, np.asarray(point) - N @ P)
                xi = xi + step
            N, _ = shape(self.kind, xi)
            if best is None or N.min() > best[0]:
                best = (N.min(), element, N)
        return best[0], best[1], best[2].tolist()


def shape(kind, xi):
    if kind == "T3":
        return np.array([1 - xi[0] - xi[1], xi[0], xi[1]]), np.array([[-1.0, -1.0], [1, 0], [0, 1]])
    c = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    f = 1 + c * xi
    return f[:, 0] * f[:, 1] / 4, np.stack([c[:, 0] * f[:, 1], c[:, 1] * f[:, 0]], axis=1) / 4


def dofs_of(elements, d):
    return (elements[:, :, None] * d + np.arange(d)).reshape(len(elements), -1)


def read_msh(path, body):
    """Coordinates, kind, elements and sides of one physical surface of a plane MSH 4.1 ASCII file."""
    with open(path, encoding="utf-8") as f:
        sections = dict(re.findall(r"\$(\w+)\n(.*?)\n\$End\1", f.read(), re.S))
    names = {}
    for line in sections["PhysicalNames"].split("\n")[1:]:
        dimension, tag, name = line.split(" ", 2)
        names[int(dimension), int(tag)] = name.strip('"')
    lines = iter(sections["Entities"].split("\n"))
    counts = [int(c) for c in next(lines).split()]
    physical = {}
    for dimension, count in enumerate(counts):
        for _ in range(count):
            words = next(lines).split()
            at = 4 if dimension == 0 else 7
            tags = words[at + 1:at + 1 + int(words[at])]
            physical[dimension, int(words[0])] = [names[dimension, int(tag)] for tag in tags]
    lines = iter(sections["Nodes"].split("\n"))
    blocks = int(next(lines).split()[0])
    at = {}
    for _ in range(blocks):
        count = int(next(lines).split()[3])
        tags = [int(next(lines)) for _ in range(count)]
        for tag in tags:
            at[tag] = [float(x) for x in next(lines).split()[:2]]
    lines = iter(sections["Elements"].split("\n"))
    blocks = int(next(lines).split()[0])
    edges, elements, kind = {}, [], None
    for _ in range(blocks):
        dimension, entity, element_type, count = [int(w) for w in next(lines).split()]
        rows = [[int(w) for w in next(lines).split()[1:]] for _ in range(count)]
        for name in physical.get((dimension, entity), []):
            if dimension == 1:
                edges.setdefault(name, []).extend(rows)
            elif dimension == 2 and name == body:
                kind = {2: "T3", 3: "Q4"}[element_type]
                elements += rows
    tags = sorted({n for e in elements for n in e})
    index = {tag: i for i, tag in enumerate(tags)}
    X = np.array([at[t] for t in tags])
    elements = [tuple(index[n] for n in e) for e in elements]
    P = X[np.array(elements)[:, :3]]
    a, b = P[:, 1] - P[:, 0], P[:, 2] - P[:, 0]
    left = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0
    elements = [e if ok else e[::-1] for e, ok in zip(elements, left)]
    boundary = {(a, b) for e in elements for a, b in zip(e, e[1:] + e[:1])}  # solid on the left of a -> b
    sides = {}
    for name, rows in edges.items():
        if all(n in index for row in rows for n in row):
            facets = [(index[a], index[b]) for a, b in rows]
            facets = [f if f in boundary else f[::-1] for f in facets]
            following = dict(facets)
            starts = [a for a, _ in facets if a not in following.values()]
            nodes = [starts[0] if starts else facets[0][0]]
            while nodes[-1] in following and len(nodes) <= len(facets):
                nodes.append(following[nodes[-1]])
            sides[name] = Side(nodes, zip(nodes, nodes[1:]))
    return X, kind, elements, sides


# --- model -----------------------------------------------------------------------------------------------------------


class Point:
    """One contact point: relative displacement w = sum weight_i u_i - obstacle."""

    def __init__(self, contact, slave, weights, normal, gap, area, friction, obstacle):
        self.contact, self.slave, self.weights = contact, slave, weights
        self.n, self.gap, self.area, self.mu, self.obstacle = normal, gap, area, friction, obstacle
        if len(normal) == 2:
            self.t = np.array([[-normal[1], normal[0]]])
        else:
            axis = np.eye(3)[np.argmin(np.abs(normal.real))]
            e = np.cross(axis, normal)
            e = e / np.sqrt(e @ e)
            self.t = np.array([e, np.cross(normal, e)])

    def moved(self, t):
        return np.array([table_at(self.obstacle.get("move", {}).get(axis, 0.0), t) for axis in "xyz"[:len(self.n)]])


class Model:
    """Everything of a scene that does not change along the path. Scalars are complex where the document's are."""

    def __init__(self, document, folder="."):
        self.document = document
        self.d = 3 if document.get("space") == "solid" else 2
        self.bodies = {name: Body(b, self.d, folder) for name, b in document["bodies"].items()}
        self.first, count = {}, 0
        for name, body in self.bodies.items():
            self.first[name] = count
            count += len(body.X)
        self.size = count * self.d
        rows, columns, values = [], [], []
        for name, body in self.bodies.items():
            K, dofs = body.stiffness(document.get("space") == "plane_stress")
            dofs = dofs + self.first[name] * self.d
            rows.append(np.repeat(dofs, dofs.shape[1], axis=1).ravel())
            columns.append(np.tile(dofs, (1, dofs.shape[1])).ravel())
            values.append(K.ravel())
        values = [v if np.iscomplexobj(v) else v.astype(float) for v in values]
        self.K = sp.csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
                               shape=(self.size, self.size))
        self._supports()
        self.points = [p for name, c in document.get("contacts", {}).items() for p in self._contact(name, c)]
        self.times = time_grid(document["time"])

    def resolve(self, expression):
        """Body's name and side of "block.bottom - block.right"."""
        terms = re.split(r"\s*(&|\s-\s)\s*", expression)
        body = terms[0].split(".")[0].strip()
        names = [terms[0].split(".")[1].strip()]
        names += [(op.strip(), term.split(".")[1].strip()) for op, term in zip(terms[1::2], terms[2::2])]
        return body, self.bodies[body].side(names)

    def nodes(self, expression):
        body, side = self.resolve(expression)
        return [self.first[body] + n for n in side.nodes]

    def _supports(self):
        self.prescribed = {}
        for name, body in self.bodies.items():
            if body.kind == "point":  # an anchor that no support moves stays
                self.prescribed.update({(self.first[name] + 1) * self.d + i: 0.0 for i in range(self.d)})
        for support in self.document.get("supports", []):
            for axis, table in support["move"].items():
                for node in self.nodes(support["on"]):
                    self.prescribed[node * self.d + "xyz".index(axis)] = table
        self.held = np.array(sorted(self.prescribed), dtype=int)
        self.free = np.setdiff1d(np.arange(self.size), self.held)

    def held_at(self, t):
        return np.array([table_at(self.prescribed[dof], t) for dof in self.held])

    def load_at(self, t):
        f = np.zeros(self.size, dtype=complex)
        for load in self.document.get("loads", []):
            name, side = self.resolve(load["on"])
            body, factor = self.bodies[name], table_at(load.get("history", 1.0), t)
            if "traction" in load:
                share = body.tributary(side)
            elif len(side.nodes) == 1:
                share = np.ones(1)
            else:
                share = body.tributary(side) / body.tributary(side).sum()
            for node, s in zip(side.nodes, share):
                at = (self.first[name] + node) * self.d
                f[at:at + self.d] += factor * s * np.array(load.get("traction", load.get("force")))
        return f

    def _contact(self, name, contact):
        body_name, side = self.resolve(contact["slave"])
        body, offset = self.bodies[body_name], contact.get("offset", 0.0)
        if body.kind == "point":
            area = [1.0]
        elif body.kind == "bar" and not side.facets:
            area = [body.description.get("area", 1)] * len(side.nodes)
        else:
            area = body.tributary(side)
        for node, a in zip(side.nodes, area):
            x, slave = body.X[node], self.first[body_name] + node
            obstacle = self.document.get("obstacles", {}).get(contact["master"])
            weights = {slave: 1.0}
            if obstacle is None:
                found = self._project(x, contact["master"])
                if found is None:
                    continue
                n, gap, master, place = found
                if body.kind not in ("point", "bar"):  # two continua: the bisector of the two normals
                    outward = np.zeros(2, dtype=complex)
                    for p, q in side.facets:
                        if node in (p, q):
                            tau = body.X[q] - body.X[p]
                            outward += np.array([tau[1], -tau[0]])
                    shared = n - outward / np.sqrt(outward @ outward)
                    shared = shared / np.sqrt(shared @ shared)
                    n, gap = shared, shared @ (x - place)
                weights.update({i: -N for i, N in master.items()})
            elif "plane" in obstacle:
                n = np.array(obstacle["plane"]["normal"])
                n = n / np.sqrt(n @ n)
                gap = n @ (x - np.array(obstacle["plane"]["point"]))
            else:
                shape_ = obstacle["circle"]
                r = x - np.array(shape_["center"])
                distance = np.sqrt(r @ r)
                sign = -1 if shape_.get("inside") else 1
                n, gap = sign * r / distance, sign * (distance - shape_["radius"])
            yield Point(name, slave, weights, n, gap + offset, a, contact.get("friction"), obstacle or {})

    def _project(self, x, master):
        """Normal, gap, {node: N} and place of the closest point of the facets; None past a free end. At a vertex the
        normal bisects those of its facets."""
        name, side = self.resolve(master)
        body, found = self.bodies[name], []
        ends = {side.facets[0][0], side.facets[-1][1]}
        for a, b in side.facets:
            ya, tau = body.X[a], body.X[b] - body.X[a]
            s = (x - ya) @ tau / (tau @ tau)
            rounding = 1e-12  # a point above the end of the master belongs to it
            if (s.real < -rounding and a in ends) or (s.real > 1 + rounding and b in ends):
                continue
            vertex = a if s.real < rounding else b if s.real > 1 - rounding else None
            vertex = None if vertex in ends else vertex
            y = ya + s * tau if vertex is None else body.X[vertex]
            found.append((np.linalg.norm((x - y).real), vertex, (a, b), tau / np.sqrt(tau @ tau), y, s))
        if not found:
            return None
        _, vertex, (a, b), tau, y, s = min(found, key=lambda f: f[0])
        first = self.first[name]
        weights = {first + a: 1 - s, first + b: s}
        if vertex is not None:
            tau = sum((body.X[q] - body.X[p]) / np.sqrt(np.sum((body.X[q] - body.X[p]) ** 2))
                      for p, q in side.facets if vertex in (p, q))
            tau = tau / np.sqrt(tau @ tau)
            weights = {first + vertex: 1.0}
        n = np.array([tau[1], -tau[0]])
        return n, n @ (x - y), weights, y

    def operators(self):
        """Sparse B_N (points x dofs) and B_T ((d-1) points x dofs) of gap and slip."""
        rows, columns, normal, tangential = [], [], [], [[] for _ in range(self.d - 1)]
        for i, p in enumerate(self.points):
            for node, w in p.weights.items():
                for axis in range(self.d):
                    rows.append(i)
                    columns.append(node * self.d + axis)
                    normal.append(w * p.n[axis])
                    for a in range(self.d - 1):
                        tangential[a].append(w * p.t[a, axis])
        shape_ = (len(self.points), self.size)
        BN = sp.csr_matrix((normal, (rows, columns)), shape=shape_)
        r = np.array(rows)
        BT = sum(sp.csr_matrix((v, (r * (self.d - 1) + a, columns)), shape=(shape_[0] * (self.d - 1), self.size))
                 for a, v in enumerate(tangential))
        return BN, sp.csr_matrix(BT)


# --- one increment ---------------------------------------------------------------------------------------------------


def lemke(M, q):
    """z >= 0 with w = M z + q >= 0 and z w = 0, by Lemke's pivoting with covering vector 1."""
    n = len(q)
    if (q >= 0).all():
        return np.zeros(n)
    T = np.hstack([np.eye(n), -M, -np.ones((n, 1)), q[:, None]])
    basis = list(range(n))
    row = int(np.argmin(q))
    entering = 2 * n
    for _ in range(100 * n):
        T[row] /= T[row, entering]
        others = np.arange(n) != row
        T[others] -= np.outer(T[others, entering], T[row])
        leaving, basis[row] = basis[row], entering
        if leaving == 2 * n:
            z = np.zeros(2 * n + 1)
            z[basis] = T[:, -1]
            return z[n:2 * n]
        entering = leaving + n if leaving < n else leaving - n
        column = T[:, entering]
        candidates = np.flatnonzero(column > 1e-11 * np.abs(T).max(initial=1.0))
        if not len(candidates):
            return None
        ratio = T[candidates, -1] / column[candidates]
        ties = candidates[ratio <= ratio.min() + 1e-14 * (1 + abs(ratio.min()))]
        artificial = [i for i in ties if basis[i] == 2 * n]
        row = artificial[0] if artificial else int(ties[np.argmax(column[ties])])
    return None


def plane_search(W, qN, qT, mu):
    """Contact forces (rN, rT) of the plane problem: gap = qN + W.. r, slip = qT + W.. r."""
    n = len(qN)
    N, T = slice(0, n), slice(n, 2 * n)
    scale = np.sqrt(np.diag(W))  # forces times it are lengths: every row of the same size
    scale[scale == 0] = scale.max()  # a direction in which the point is held
    S = W / np.outer(scale, scale)
    q = np.concatenate([qN, qT]) / scale
    size = np.abs(q).max() or 1.0
    f = np.diag(mu * scale[n:] / scale[:n])
    I, Z = np.eye(n), np.zeros((n, n))
    M = np.block([[S[N, N], S[N, T], -S[N, T], Z], [S[T, N], S[T, T], -S[T, T], I],
                  [-S[T, N], -S[T, T], S[T, T], I], [f, -I, -I, Z]])
    z = lemke(M, np.concatenate([q[N], q[T], -q[T], np.zeros(n)]) / size)
    if z is None:
        return None
    z = z * size
    return z[N] / scale[:n], (z[n:2 * n] - z[2 * n:3 * n]) / scale[n:]


def gauss_seidel(W, qN, qT, mu, d):
    """The same in any dimension, by sweeps over the points: exact normal, projected tangential updates."""
    n, k = len(qN), d - 1
    q = np.concatenate([qN, qT])
    r = np.zeros(n * d)
    for _ in range(200000):
        before = r.copy()
        for i in range(n):
            r[i] = max(0.0, r[i] - (q[i] + W[i] @ r) / W[i, i])
            t = slice(n + i * k, n + (i + 1) * k)
            stiffness = np.linalg.eigvalsh(W[t, t]).max() or W[i, i]
            trial = r[t] - (q[t] + W[t] @ r) / stiffness
            size = np.linalg.norm(trial)
            r[t] = trial * min(1.0, mu[i] * r[i] / size) if size > 0 else 0.0
        if np.abs(r - before).max() <= 1e-15 * np.abs(r).max():
            break
    return r[:n], r[n:]


class Path:
    """Solves the increments of a model. `law` is None (exact) or {"stiffness": rho, "tangential_ratio": c} with rho in
    force per length cubed. With `states` (of a real path) they are followed, and scalars may be complex."""

    def __init__(self, model, law=None, states=None, guess=None):
        self.m, self.law, self.states, self.guess = model, law, states, guess
        m = model
        self.real = states is None
        part = (lambda a: a.real) if self.real else (lambda a: a)
        self.BN, self.BT = (part(B) for B in m.operators())
        self.K = part(m.K) if self.real else m.K.astype(complex)
        self.gap0 = part(np.array([p.gap for p in m.points], dtype=complex))
        self.area = part(np.array([p.area for p in m.points], dtype=complex))
        self.mu = part(np.array([p.mu if p.mu is not None else 0.0 for p in m.points], dtype=complex))
        self.rubs = np.array([p.mu is not None for p in m.points])
        n = len(m.points)
        self.CN = self.CT = np.zeros(n)
        if law:
            self.CN = 1 / (law["stiffness"] * self.area)
            self.CT = self.CN / law.get("tangential_ratio", 1.0)
        self.k = m.d - 1
        self.u = np.zeros(m.size, dtype=self.K.dtype)
        self.rT_before = np.zeros(n * self.k, dtype=self.K.dtype)
        self.worst = 0.0
        self.dissipation = np.zeros(n * self.k)  # of each tangential component
        self.condensed = None
        self.before = {"time": 0.0}

    def run(self):
        return [self.increment(i, t) for i, t in enumerate(self.m.times)]

    def increment(self, index, t):
        m, k, n = self.m, self.k, len(self.m.points)
        kind = self.K.dtype
        part = (lambda a: a.real) if self.real else (lambda a: a)
        f, held = part(m.load_at(t)), part(np.asarray(m.held_at(t), dtype=complex))
        drift = [p.moved(t) for p in m.points]
        step = [p.moved(t) - p.moved(self.before["time"]) for p in m.points]
        gap0 = self.gap0 - part(np.array([p.n @ w for p, w in zip(m.points, drift)], dtype=complex))
        slip0 = -part(np.array([p.t @ w for p, w in zip(m.points, step)], dtype=complex).ravel()) - self.BT @ self.u
        u = np.zeros(m.size, dtype=kind)
        u[m.held] = held
        CT = np.repeat(self.CT, k)

        if self.states is None:
            rN, rT = self.search(f, u, gap0, slip0 - CT * self.rT_before)
            states, near = None, self.bent(f, u, rN, rT)
        else:
            states = self.states[index]
            rN, rT, near = self.guess[index]
        for attempt in range(1 + 4 * n if self.real else 1):
            if states is None:
                states = self.classify(rN, rT, f, u, gap0, slip0, CT)
            x, rN, rT = self.polish(states, f, u, gap0, slip0, CT, rN, rT, near)
            if not self.real:
                break
            violation, repaired = self.verify(states, x, rN, rT, gap0, slip0, CT)
            if violation <= 1e-9:
                self.worst = max(self.worst, violation)
                break
            states = repaired
        else:
            raise RuntimeError(f"no states satisfy the contact law at t = {t}: violation {violation:.2e}")

        gap = gap0 + self.BN @ x
        slip = slip0 + self.BT @ x
        plastic = slip + CT * (rT - self.rT_before)
        touching = np.repeat([s[0] != "open" for s in states], k) if n else np.zeros(0, bool)
        self.dissipation = self.dissipation - np.where(touching, rT * plastic, 0)
        result = {"time": t, "u": x, "rN": rN, "rT": rT, "gap": gap, "slip": slip, "states": states, "f": f,
                  "dissipation": self.dissipation,
                  "margins": self.margins(states, rN, rT, gap, plastic, np.abs(x).max() or 1.0)}
        self.u, self.rT_before, self.before = x, rT, {"time": t}
        return result

    def search(self, f, u, gap0, slip0):
        m, n = self.m, len(self.m.points)
        if not n:
            return np.zeros(0), np.zeros(0)
        if self.condensed is None:
            K = self.K[m.free][:, m.free].tocsc()
            diagonal = K.diagonal()
            eigen = np.abs(diagonal).max()
            lu = spla.splu((K + sp.identity(K.shape[0]) * eigen * 1e-9).tocsc()) if self.singular(K) else spla.splu(K)
            B = sp.vstack([self.BN, self.BT]).tocsr()
            Bf = B[:, m.free]
            W = Bf @ lu.solve(Bf.T.toarray())
            self.condensed = lu, B, W + np.diag(np.concatenate([self.CN, np.repeat(self.CT, self.k)]))
        lu, B, W = self.condensed
        v = u.copy()
        v[m.free] = lu.solve((f - self.K @ u)[m.free])
        free = B @ v
        qN, qT = gap0 + free[:n], slip0 + free[n:]
        found = plane_search(W, qN, qT, self.mu) if m.d == 2 else None
        return found or gauss_seidel(W, qN, qT, self.mu, m.d)

    def bent(self, f, u, rN, rT):
        """Displacement under the loads and given contact forces, as accurate as the search."""
        x = u.copy()
        if self.condensed:
            lu, B, _ = self.condensed
            free = self.m.free
            x[free] = lu.solve((f - self.K @ u + B.T @ np.concatenate([rN, rT]))[free])
        return x

    def singular(self, K):
        try:
            lu = spla.splu(K)
        except RuntimeError:
            return True
        pivots = np.abs(lu.U.diagonal())
        return pivots.min() < 1e-12 * pivots.max()

    def classify(self, rN, rT, f, u, gap0, slip0, CT):
        """States from forces that need not be accurate: each compares a force with its gap or slip in one unit."""
        k, n = self.k, len(rN)
        if not n:
            return []
        B, W = self.condensed[1:]
        x = self.bent(f, u, rN, rT)
        y = B @ x + np.concatenate(
            [gap0 + self.CN * rN, slip0 + CT * (rT - self.rT_before)])
        rounding = 1e-12 * np.abs(x).max()  # a point on its cone that does not slip sticks
        states = []
        for i in range(n):
            t = slice(i * k, (i + 1) * k)
            s = y[n:][t]
            if y[i] > rN[i] * W[i, i]:
                states.append(("open", None))
            elif not self.rubs[i]:
                states.append(("slip", np.zeros(k)))
            elif (self.mu[i] * rN[i] - np.linalg.norm(rT[t])) * W[n + i * k, n + i * k] > np.linalg.norm(s) - rounding:
                states.append(("stick", None))
            else:
                direction = rT[t] if np.linalg.norm(rT[t]) > 0 else -s
                states.append(("slip", direction / (np.linalg.norm(direction) or 1.0)))
        return states

    def polish(self, states, f, u, gap0, slip0, CT, rN, rT, near):
        """u and forces of given states. In space the direction of slip is an unknown too, found by Newton's
        method from a starting point already at rounding."""
        m, k, n = self.m, self.k, len(self.m.points)
        kind = self.K.dtype
        N = [i for i in range(n) if states[i][0] != "open"]
        sticks = [i * k + a for i in range(n) if states[i][0] == "stick" for a in range(k)]
        slips = [i for i in N if states[i][0] == "slip" and self.rubs[i]]
        turning = [i * k + a for i in slips for a in range(k)] if k == 2 else []
        T = sticks + turning
        nf, nN, nT = len(m.free), len(N), len(T)
        column = {j: nf + nN + c for c, j in enumerate(T)}
        rN, rT, x = rN.astype(kind), rT.astype(kind), near.astype(kind)
        BNf, BTf = self.BN[:, m.free], self.BT[:, m.free]
        push = BNf[N].T.astype(kind).tolil()
        if k == 1:
            for c, i in enumerate(N):
                if i in slips:
                    push[:, c] = push[:, c] + (BTf[i] * (self.mu[i] * states[i][1][0])).T
        push = push.tocsr()
        CN = sp.diags(self.CN[N]) if N else sp.csr_matrix((0, 0))
        # (u_f, rN, rT) of everything but the turning rows, which are not linear
        for _ in range(1 if not turning else 12):
            blocks = sp.bmat([[self.K[m.free][:, m.free], -push, -BTf[T].T],
                              [BNf[N], CN, None],
                              [BTf[T], None, sp.diags(CT[T])]], format="lil", dtype=kind) if N else None
            right = np.concatenate([(f - self.K @ u)[m.free], -(gap0 + self.BN @ u)[N],
                                    -(slip0 + self.BT @ u - CT * self.rT_before)[T]])
            if turning:
                v = (slip0 + self.BT @ x + CT * (rT - self.rT_before))
                for i in slips:
                    t = [i * k, i * k + 1]
                    s = v[t]
                    size = np.sqrt(s @ s)
                    # |s| rT + mu rN s = 0, linearised about (s, rT, rN)
                    A = np.outer(rT[t], s / size) + self.mu[i] * rN[i] * np.eye(2)
                    for a in range(2):
                        row = column[t[a]]
                        blocks[row, :] = 0
                        blocks[row, :nf] = (A[a, 0] * BTf[t[0]] + A[a, 1] * BTf[t[1]]).toarray()
                        for b in range(2):
                            blocks[row, column[t[b]]] = A[a, b] * CT[t[b]] + (size if a == b else 0)
                        blocks[row, nf + N.index(i)] = self.mu[i] * s[a]
                        residual = size * rT[t[a]] + self.mu[i] * rN[i] * s[a]
                        value = np.concatenate([x[m.free], rN[N], rT[T]])
                        right[row] = (blocks[row].toarray().ravel() @ value) - residual
            if N:
                blocks = blocks.tocsc()
                lu = spla.splu(blocks)
                solution = lu.solve(right.astype(kind))
                # one step of refinement: the states are verified to rounding
                solution += lu.solve(right.astype(kind) - blocks @ solution)
            else:
                K = self.K[m.free][:, m.free].tocsc()
                solution = spla.splu(K).solve(right[:nf].astype(kind)) if nf else np.zeros(0, dtype=kind)
            x = u.astype(kind)
            x[m.free] = solution[:nf]
            rN, rT = np.zeros(n, dtype=kind), np.zeros(n * k, dtype=kind)
            rN[N] = solution[nf:nf + nN]
            rT[T] = solution[nf + nN:nf + nN + nT]
            if k == 1:
                for i in slips:
                    rT[i] = self.mu[i] * rN[i] * states[i][1][0]
        return x, rN, rT

    def verify(self, states, x, rN, rT, gap0, slip0, CT):
        """Largest violation of the contact law, lengths by the largest displacement and forces by the largest force,
        and states with the worst point repaired."""
        k = self.k
        if not len(rN):
            return 0.0, states
        gap = gap0 + self.BN @ x + self.CN * rN
        slip = slip0 + self.BT @ x + CT * (rT - self.rT_before)
        length, force = np.abs(x).max() or 1.0, np.abs(rN).max() or 1.0
        faults = []
        for i, (name, direction) in enumerate(states):
            t = slice(i * k, (i + 1) * k)
            if name == "open":
                faults.append((-gap[i] / length, i, ("stick", None) if self.rubs[i] else ("slip", np.zeros(k))))
                continue
            faults.append((-rN[i] / force, i, ("open", None)))
            size = np.linalg.norm(rT[t])
            if name == "stick":
                d = rT[t] / (size or 1.0)
                faults.append(((size - self.mu[i] * rN[i]) / force, i, ("slip", d)))
            elif self.rubs[i]:
                faults.append(((slip[t] @ rT[t]) / (size or 1.0) / length, i, ("stick", None)))
        if not np.isfinite([fault[0] for fault in faults]).all():
            raise RuntimeError("the solution of these states is not finite")
        worst = max(faults, key=lambda fault: fault[0])
        repaired = list(states)
        repaired[worst[1]] = worst[2]
        return max(0.0, worst[0]), repaired

    def margins(self, states, rN, rT, gap, plastic, length):
        """Distances to a change of state relative to the largest force and displacement: (open, slip)."""
        if not len(rN):
            return {"open": None, "slip": None}
        force = np.abs(rN).max() or 1.0
        k, opening, sliding = self.k, [], []
        for i, (name, _) in enumerate(states):
            t = slice(i * k, (i + 1) * k)
            opening.append(abs(gap[i]) / length if name == "open" else abs(rN[i]) / force)
            if name != "open" and self.rubs[i]:
                sliding.append(abs(self.mu[i] * rN[i] - np.linalg.norm(rT[t])) / force if name == "stick"
                               else np.linalg.norm(plastic[t]) / length)
        return {"open": min(opening), "slip": min(sliding) if sliding else None}


# --- responses and the whole reference -------------------------------------------------------------------------------


def places(model):
    """Element and shape functions of every response with `at`: a place of the mesh, kept when the mesh changes."""
    found = {}
    for name, response in model.document.get("responses", {}).items():
        (_, r), = response.items()
        if "at" in r:
            # the body in which the point lies deepest, should several hold it
            deepest, body = max((b.shape_at(r["at"]), n) for n, b in model.bodies.items() if b.kind in ("Q4", "T3"))
            found[name] = [(model.first[body] + e, w) for e, w in zip(*deepest[1:])]
    return found


def responses(model, result, place):
    """Values of the scene's responses at one increment; `place` is places() of the unperturbed model."""
    m, values, d = model, {}, model.d
    u = result["u"].reshape(-1, d)
    forces = slave_forces(model, result)
    for name, response in m.document.get("responses", {}).items():
        (kind, r), = response.items()
        mine = [i for i, p in enumerate(m.points) if p.contact == r.get("contact")] if kind != "strain_energy" else []
        take = {"mean": lambda v: sum(v) / len(v), "max": lambda v: max(v, key=lambda z: z.real),
                "min": lambda v: min(v, key=lambda z: z.real)}[r.get("take", "mean")]
        if kind == "displacement" and "at" in r:
            values[name] = sum(w * u[node]["xyz".index(r["component"])] for node, w in place[name])
        elif kind == "displacement":
            values[name] = take([u[n]["xyz".index(r["component"])] for n in m.nodes(r["on"])])
        elif kind == "reaction":
            total = (m.K @ result["u"] - result["f"]).reshape(-1, d).astype(complex)
            for p, force in zip(m.points, forces):
                for node, w in p.weights.items():
                    total[node] = total[node] - w * force
            values[name] = sum(total[n]["xyz".index(r["component"])] for n in m.nodes(r["on"]))
        elif kind == "contact_force":
            values[name] = (sum(result["rN"][i] for i in mine) if r["component"] == "normal"
                            else sum(forces[i]["xyz".index(r["component"])] for i in mine))
        elif kind == "contact_pressure":
            values[name] = take([result["rN"][i] / m.points[i].area for i in mine])
        elif kind == "gap":
            values[name] = take([result["gap"][i] for i in mine])
        elif kind == "dissipation":
            k = m.d - 1
            values[name] = sum(result["dissipation"][i * k:(i + 1) * k].sum() for i in mine)
        elif kind == "strain_energy":
            values[name] = result["u"] @ (m.K @ result["u"]) / 2
        elif kind == "contact_half_width":
            p = np.array([result["rN"][i] for i in mine])
            x = np.array([np.concatenate([b.X for b in m.bodies.values()])[m.points[i].slave][0] for i in mine])
            center = (p @ x) / p.sum()
            values[name] = 2 * np.sqrt((p @ (x - center) ** 2) / p.sum())
        else:
            raise ValueError(f"response {name}: {kind}")
    return values


def slave_forces(model, result):
    k = model.d - 1
    return [p.n * result["rN"][i] + result["rT"][i * k:(i + 1) * k] @ p.t for i, p in enumerate(model.points)]


def solve(document, law=None, folder=".", derivatives=True, place=None):
    """(model, results, values per increment, sensitivities per increment, worst violation) of the whole path."""
    model = Model(document, folder)
    path = Path(model, law)
    results = path.run()
    place = place or places(model)
    values = [responses(model, r, place) for r in results]
    gradients = [{name: {} for name in v} for v in values]
    states = [r["states"] for r in results]
    guess = [(r["rN"], r["rT"], r["u"]) for r in results]
    parameters = {name: weights_of(p) for name, p in document.get("parameters", {}).items()} if derivatives else {}
    if law and derivatives:
        parameters["stiffness"] = None
    for name, weights in parameters.items():
        law_, document_ = law, document
        if weights is None:
            law_ = dict(law, stiffness=law["stiffness"] + 1j * STEP)
        else:
            document_ = perturbed(document, weights, 1j * STEP)
        twin = Model(document_, folder)
        path_ = Path(twin, law_, states, guess)
        for gradient, result in zip(gradients, path_.run()):
            for response, value in responses(twin, result, place).items():
                gradient[response][name] = complex(value).imag / STEP
    return model, results, values, gradients, path.worst


def differences(document, weights, law=None, steps=(1e-3, 5e-4, 2.5e-4), folder="."):
    """Derivatives of the last increment's responses by central differences of the whole path (states free) with
    Richardson extrapolation; `steps` relative to the first number. A check on the complex step, not the reference."""
    node, key = at_pointer(document, next(iter(weights)))
    size = abs(node[key]) or 1.0
    rows, place = [], places(Model(document, folder))
    for h in steps:
        ends = [solve(perturbed(document, weights, s * h * size), law, folder, False, place)[2][-1] for s in (1, -1)]
        rows.append({name: (ends[0][name] - ends[1][name]).real / (2 * h * size) for name in ends[0]})
    table = [[row[name] for row in rows] for name in rows[0]]
    for order in range(1, len(steps)):
        factor = (steps[0] / steps[1]) ** (2 * order)
        table = [[(factor * b - a) / (factor - 1) for a, b in zip(line, line[1:])] for line in table]
    return dict(zip(rows[0], (line[0] for line in table)))


def reference(document, law=None, folder="."):
    """The solution as it is written to tests/references/*.json."""
    model, results, values, gradients, worst = solve(document, law, folder)
    d, k = model.d, model.d - 1
    nodes = {name: [n for n in range(len(b.X)) if not (b.kind == "point" and n == 1)]
             for name, b in model.bodies.items()}
    steps = []
    for result, value, gradient in zip(results, values, gradients):
        u = result["u"].reshape(-1, d)
        forces = slave_forces(model, result)
        contacts = {}
        for i, p in enumerate(model.points):
            c = contacts.setdefault(p.contact, {key: [] for key in
                                                ("x", "area", "gap", "slip", "normal", "force", "state")})
            everything = np.concatenate([b.X for b in model.bodies.values()])
            c["x"].append(plain(everything[p.slave]))
            c["area"].append(plain(p.area))
            c["gap"].append(plain(result["gap"][i]))
            c["slip"].append(plain(result["slip"][i * k:(i + 1) * k] @ p.t))
            c["normal"].append(plain(-result["rN"][i] / p.area))
            c["force"].append(plain(forces[i]))
            c["state"].append(result["states"][i][0])
        steps.append({"time": result["time"],
                      "displacement": {b: [plain(u[model.first[b] + n]) for n in nodes[b]] for b in nodes},
                      "contacts": contacts,
                      "margins": result["margins"],
                      "responses": {name: plain(v) for name, v in value.items()},
                      "sensitivities": gradient})
    solution = {"largest_violation": worst, "steps": steps}
    if law:
        solution["method"] = {"penalty": {"stiffness": {"absolute": law["stiffness"]},
                                          "tangential_ratio": law.get("tangential_ratio", 1.0)}}
    return solution


def plain(value):
    """Floats and lists of them."""
    a = np.asarray(value)
    return np.real(a).tolist()
