"""Answers of studies/hard that a few lines find: enumerations, roots and recursions, by the standard library alone.

`python3 hard_answers.py` prints them; tests/studies/hard_answers_test.py holds the comments of the scenes against them.
"""

import math


def point_on_a_wall(K, load, friction):
    """All equilibria (name, u_t, u_n, p) of a point on a spring K = (k_tt, k_tn, k_nn), whose wall lets u_n <= 0 pass;
    the load is (F_t, F_n). K u = F + (r, -p), |r| <= friction p."""
    (tt, tn, nn), (F_t, F_n) = K, load
    found = []
    if F_n >= 0 and abs(F_t) <= friction * F_n:
        found.append(("stick", 0.0, 0.0, F_n))
    for sign in (1, -1):
        # u_n = 0, r = -sign friction p: tt u_t = F_t - sign friction p and tn u_t = F_n - p
        pivot = 1 - sign * friction * tn / tt
        if abs(pivot) > 1e-14:
            p = (F_n - tn / tt * F_t) / pivot
            u_t = (F_t - sign * friction * p) / tt
            if p >= 0 and sign * u_t > 0:
                found.append(("slip" if sign > 0 else "slip back", u_t, 0.0, p))
    det = tt * nn - tn * tn
    u_t, u_n = (nn * F_t - tn * F_n) / det, (tt * F_n - tn * F_t) / det
    if u_n < 0:
        found.append(("open", u_t, u_n, 0.0))
    return found


def triangle_stiffness(E=1000.0, nu=0.3):
    """k_xx, k_xy, k_yy of the corner (0, 0) of a linear triangle with the corners (2, 1) and (1, 2), plane strain."""
    area, bx, by = 1.5, (1 - 2) / 3, (1 - 2) / 3  # gradient of the corner's shape function
    lame, G = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    return (area * ((lame + 2 * G) * bx * bx + G * by * by), area * (lame + G) * bx * by,
            area * ((lame + 2 * G) * by * by + G * bx * bx))


def triangle_on_a_floor(held, friction):
    """All (name, N, T): the other two corners move by `held`, the corner (0, 0) stands on a rough floor."""
    xx, xy, yy = triangle_stiffness()
    # Mirrored so that the floor is a wall above: u_n = -y; a corner without contact would move by `held`.
    x, y = held
    found = point_on_a_wall((xx, -xy, yy), (xx * x + xy * y, -xy * x - yy * y), friction)
    return [(name, p, xx * (u_t - x) + xy * (-u_n - y)) for name, u_t, u_n, p in found]


def truss_force(w):
    """Force that holds a von Mises truss (EA 1e4, half span 10, rise 1, Green strain) down by w."""
    s = 1 - w
    return 1e4 / 101 ** 1.5 * (s - s ** 3)


def truss_deflection(force):
    """w before the limit point, by bisection."""
    low, high = 0.0, 1 - 1 / math.sqrt(3)
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if truss_force(middle) < force else (low, middle)
    return low


def truss_slope(w):
    """dw/dforce."""
    return 1 / (1e4 / 101 ** 1.5 * (3 * (1 - w) ** 2 - 1))


def tractrix(steps=300, end=3.0, start=0.6):
    """Where a point on a leash of length 1 is, by radial return in each step."""
    x, y = 0.0, start
    for i in range(1, steps + 1):
        dx, dy = end * i / steps - x, -y
        r = math.hypot(dx, dy)
        if r > 1:
            x, y = x + dx * (1 - 1 / r), y + dy * (1 - 1 / r)
    return x, y


def belt(nodes=8, friction=0.3, angle=math.pi):
    """Tension behind a drum over that before it, of bars, and its derivative by the friction."""
    t = math.tan(angle / (2 * nodes))
    ratio = ((1 + friction * t) / (1 - friction * t)) ** nodes
    return ratio, ratio * 2 * nodes * t / (1 - (friction * t) ** 2)


def complete_elliptic(k):
    """K(k) and E(k), by the arithmetic-geometric mean."""
    a, b, c, weight = 1.0, math.sqrt(1 - k * k), k, 1.0
    lost = k * k / 2
    while abs(c) > 1e-16:
        a, b, c = (a + b) / 2, math.sqrt(a * b), (a - b) / 2
        lost, weight = lost + weight * c * c, 2 * weight
    return math.pi / (2 * a), math.pi / (2 * a) * (1 - lost)


def elastica_crown(length, shortening):
    """How far the middle of an inextensible bar with clamped ends moves aside in its first shape."""
    low, high = 0.0, 1.0 - 1e-12  # of the modulus k; shortening = 2 length (1 - E / K)
    for _ in range(100):
        k = (low + high) / 2
        K, E = complete_elliptic(k)
        low, high = (k, high) if 2 * length * (1 - E / K) < shortening else (low, k)
    return length * k / complete_elliptic(k)[0]


if __name__ == "__main__":
    for friction, load in ((1, .5), (1, 1.5), (1, 2.5), (2, 1.9), (2, 2.5), (3, 1.9), (3, 2.5), (3, 3.5)):
        print(f"point on a wall, friction {friction}, F_t {load}:", point_on_a_wall((1, .5, 1), (load, 1), friction))
    for friction, held in ((1.7, (.03, -.01)), (1.8, (.01, -.01)), (1.8, (-.1, .01)), (3, (.04, -.01)),
                           (3, (-.05, .01))):
        print(f"triangle, friction {friction}, held {held}:", triangle_on_a_floor(held, friction))
    print("truss under 3.79:", truss_deflection(3.79), truss_slope(truss_deflection(3.79)))
    print("tractrix:", tractrix())
    print("belt:", belt())
    print("elastica:", *(elastica_crown(20, 19.8 * t) for t in (.25, .5, .75)))
