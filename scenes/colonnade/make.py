#!/usr/bin/env python3
"""Writes colonnade.obj and colonnade.mtl beside itself; same bytes on every run.

A cloister walk of six groin-vaulted bays beside a sunken courtyard. Metres, +y up, the walk along x,
back wall at z = 0, columns at z = 3.9, courtyard beyond. Every object is a closed solid with its
front outward. Where two solids meet, one sinks a little into the other, so that no faces coincide
and no light leaks through a joint.
"""

import math
import os

HERE = os.path.dirname(os.path.abspath(__file__))

BAYS, PITCH = 6, 3.0
HALF = BAYS * PITCH / 2  # 9: the inner faces of the end walls
SPRING = 3.0  # top of the abaci, where arches start
RISE = 1.2  # also the half-span of the arches: they are semicircles
WALK = 3.6  # clear width of the walk
THICK = 0.6  # thickness of the arcade wall
ARCADE = WALK + THICK / 2  # z of the column axes
TOP = 5.2  # top of the masonry above the vaults
YARD = -0.45  # level of the courtyard
FAR = 15.0  # inner face of the far wall
SEG = 10  # segments of each arch

MATERIALS = [  # name, linear reflectance
    ("limestone", (0.66, 0.60, 0.50)),
    ("plaster", (0.78, 0.74, 0.66)),
    ("ochre", (0.68, 0.48, 0.27)),
    ("teal", (0.10, 0.26, 0.29)),
    ("cream_tile", (0.68, 0.62, 0.52)),
    ("slate_tile", (0.17, 0.21, 0.25)),
    ("flagstone", (0.46, 0.46, 0.45)),
    ("flagstone_dark", (0.36, 0.37, 0.39)),
    ("lawn", (0.11, 0.22, 0.05)),
]


class Solid:
    """A polygon soup that is welded by position when written."""

    def __init__(self, name):
        self.name = name
        self.faces = []

    def tri(self, a, b, c, material):
        self.faces.append((material, (a, b, c)))

    def quad(self, a, b, c, d, material, flip=False):
        """Counter-clockwise a b c d, split along a-c, or b-d with `flip`."""
        if flip:
            a, b, c, d = b, c, d, a
        self.tri(a, b, c, material)
        self.tri(a, c, d, material)

    def zipper(self, low, high, material, reverse=False):
        """Fills the upright strip between two polylines that run the same way between the same two ends."""
        axis = 0 if low[0][0] != low[-1][0] else 2
        s, t = [p[axis] for p in low], [p[axis] for p in high]
        i = j = 0
        while i + 1 < len(low) or j + 1 < len(high):
            if j + 1 == len(high) or (i + 1 < len(low) and s[i] + s[i + 1] <= t[j] + t[j + 1]):
                face = (low[i], low[i + 1], high[j])
                i += 1
            else:
                face = (low[i], high[j + 1], high[j])
                j += 1
            self.tri(*(face[::-1] if reverse else face), material)


def spread(a, b, step):
    """a .. b in equal parts no longer than `step`."""
    n = max(1, math.ceil((b - a) / step - 1e-9))
    return [a + (b - a) * k / n for k in range(n + 1)]


def box(name, low, high, material, step=1.5):
    solid = Solid(name)
    grid = [spread(low[k], high[k], step) for k in range(3)]
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side, at in ((0, low[axis]), (1, high[axis])):
            for ua, ub in zip(grid[u], grid[u][1:]):
                for va, vb in zip(grid[v], grid[v][1:]):
                    corners = []
                    for pu, pv in ((ua, va), (ub, va), (ub, vb), (ua, vb)):
                        p = [0.0] * 3
                        p[axis], p[u], p[v] = at, pu, pv
                        corners.append(tuple(p))
                    solid.quad(*(corners if side else corners[::-1]), material)
    return solid


def lathe(name, cx, cz, profile, material, sides=16):
    """Turns (radius, y) points, bottom to top, about a vertical axis; flat caps at both ends."""
    solid = Solid(name)
    ring = [(math.cos(math.tau * (k + 0.5) / sides), math.sin(math.tau * (k + 0.5) / sides)) for k in range(sides)]

    def at(k, radius, y):
        return (cx + radius * ring[k % sides][0], y, cz + radius * ring[k % sides][1])

    for (r0, y0), (r1, y1) in zip(profile, profile[1:]):
        for k in range(sides):
            solid.quad(at(k, r0, y0), at(k, r1, y1), at(k + 1, r1, y1), at(k + 1, r0, y0), material)
    for (r, y), up in ((profile[0], False), (profile[-1], True)):
        for k in range(sides):
            a, b = at(k, r, y), at(k + 1, r, y)
            solid.tri((cx, y, cz), *((b, a) if up else (a, b)), material)
    return solid


def sweep(name, section, close_ends, material):
    """Joins a row of four-cornered sections (each counter-clockwise seen from the far end)."""
    solid = Solid(name)
    for p, q in zip(section, section[1:]):
        for k in range(4):
            solid.quad(p[k], p[(k + 1) % 4], q[(k + 1) % 4], q[k], material)
    if close_ends:
        solid.quad(*section[0][::-1], material)
        solid.quad(*section[-1], material)
    return solid


def superstructure():
    """Groin vaults, arches and the masonry above them, in one piece: flat on top, and below the height field
    max(barrel across, barrel along). The arches of the arcade are the cross barrels, cut off by its face."""
    solid = Solid("superstructure")
    drop = 0.01  # into the abaci
    turn = [-math.cos(math.pi * k / SEG) for k in range(SEG + 1)]
    xs = [(-HALF - 0.1, 1.0)]  # (x, |u|): 0 on the crown of the cross barrel, 1 at its springing and on the piers
    for bay in range(BAYS):
        centre = -HALF + (bay + 0.5) * PITCH
        xs += [(centre + RISE * t, t) for t in turn]
    xs.append((HALF + 0.1, 1.0))
    zs = [(WALK / 2 * (1 + t), t) for t in turn]
    zs[0] = (-0.02, -1.0)
    zs.append((WALK + THICK, 1.0))

    def height(u, v):
        m = min(abs(u), abs(v))
        return SPRING - drop + (RISE + drop) * math.sqrt(max(0.0, 1.0 - m * m))

    def under(i, j):
        return (xs[i][0], height(xs[i][1], zs[j][1]), zs[j][0])

    for i in range(len(xs) - 1):
        for j in range(len(zs) - 1):
            u, v = xs[i][1] + xs[i + 1][1], zs[j][1] + zs[j + 1][1]
            material = "plaster" if j + 2 < len(zs) else "limestone"
            # the split follows the groin, which runs along |u| = |v|
            solid.quad(under(i, j), under(i + 1, j), under(i + 1, j + 1), under(i, j + 1), material, u * v < 0)
    tx = [xs[0][0]] + [-HALF + (bay + 0.5) * PITCH + t for bay in range(BAYS) for t in (-RISE, 0.0, RISE)] + [xs[-1][0]]
    tz = spread(zs[0][0], zs[-1][0], 1.5)
    for xa, xb in zip(tx, tx[1:]):
        for za, zb in zip(tz, tz[1:]):
            solid.quad((xa, TOP, za), (xa, TOP, zb), (xb, TOP, zb), (xb, TOP, za), "limestone")
    for j, z in ((0, tz[0]), (len(zs) - 1, tz[-1])):
        solid.zipper([under(i, j) for i in range(len(xs))], [(x, TOP, z) for x in tx], "limestone", j == 0)
    for i, x in ((0, tx[0]), (len(xs) - 1, tx[-1])):
        solid.zipper([under(i, j) for j in range(len(zs))], [(x, TOP, z) for z in tz], "limestone", i != 0)
    return solid


def arched_wall(name, span, openings, levels, depth, along_x, material):
    """A wall with round-headed openings (centre, half-width, springing height) that reach down to its foot."""
    solid = Solid(name)
    foot, top = levels
    near, far = depth

    def at(s, y, t):
        return (s, y, t) if along_x else (t, y, s)

    def quad(a, b, c, d):
        solid.quad(a, b, c, d, material) if along_x else solid.quad(d, c, b, a, material)

    spring = openings[0][2]
    rows, layers = spread(foot, spring, 1.6), spread(near, far, 1.6)
    edges = [span[0]] + [c + d * w for c, w, _ in openings for d in (-1, 1)] + [span[1]]
    low = []
    for k in range(0, len(edges), 2):  # piers
        columns = spread(edges[k], edges[k + 1], 1.6)
        for sa, sb in zip(columns, columns[1:]):
            for ya, yb in zip(rows, rows[1:]):
                quad(at(sa, ya, far), at(sb, ya, far), at(sb, yb, far), at(sa, yb, far))
                quad(at(sb, ya, near), at(sa, ya, near), at(sa, yb, near), at(sb, yb, near))
            for ta, tb in zip(layers, layers[1:]):
                quad(at(sa, foot, ta), at(sb, foot, ta), at(sb, foot, tb), at(sa, foot, tb))
        for ya, yb in zip(rows, rows[1:]):
            for ta, tb in zip(layers, layers[1:]):
                s = edges[k]
                quad(at(s, ya, ta), at(s, ya, tb), at(s, yb, tb), at(s, yb, ta))
                s = edges[k + 1]
                quad(at(s, ya, tb), at(s, ya, ta), at(s, yb, ta), at(s, yb, tb))
        low += [(s, spring) for s in columns]
        if k // 2 < len(openings):
            centre, half, _ = openings[k // 2]
            arch = [(centre - half * math.cos(math.pi * q / SEG), spring + half * math.sin(math.pi * q / SEG)) for q in range(SEG + 1)]
            arch[0], arch[-1] = low[-1], (edges[k + 2], spring)
            for (sa, ya), (sb, yb) in zip(arch, arch[1:]):
                for ta, tb in zip(layers, layers[1:]):
                    quad(at(sa, ya, ta), at(sb, yb, ta), at(sb, yb, tb), at(sa, ya, tb))
            low += arch[1:-1]
    high = [(s, top) for k in range(0, len(edges), 2) for s in spread(edges[k], edges[k + 1], 1.6)]
    # the spandrels end in a level line above the crowns, and plain courses follow
    crown = spring + max(w for _, w, _ in openings) + 0.2
    courses = spread(crown, top, 1.6)
    for t, back in ((far, False), (near, True)):
        solid.zipper([at(s, y, t) for s, y in low], [at(s, crown, t) for s, _ in high], material, back == along_x)
        for (sa, _), (sb, _) in zip(high, high[1:]):
            a, b = (sb, sa) if back else (sa, sb)
            for ya, yb in zip(courses, courses[1:]):
                quad(at(a, ya, t), at(b, ya, t), at(b, yb, t), at(a, yb, t))
    for s, back in ((span[0], True), (span[1], False)):
        for ta, tb in zip(layers, layers[1:]):
            a, b = (ta, tb) if back else (tb, ta)
            for ya, yb in zip([spring, *courses], courses):
                quad(at(s, ya, a), at(s, ya, b), at(s, yb, b), at(s, yb, a))
    for (sa, _), (sb, _) in zip(high, high[1:]):
        for ta, tb in zip(layers, layers[1:]):
            quad(at(sa, top, tb), at(sb, top, tb), at(sb, top, ta), at(sa, top, ta))
    return solid


def ground():
    """Tiled walk, three steps, paved courtyard: one profile drawn out along x."""
    solid = Solid("ground")
    ends = HALF + 0.3
    xs = [-ends] + [-HALF + 0.75 * k for k in range(25)] + [ends]
    top = [(-0.45, 0.0)] + [(0.75 * k, 0.0) for k in range(7)]  # (z, y)
    for step in range(1, 4):
        z = top[-1][0]
        top += [(z, -0.15 * step), (z + 0.4, -0.15 * step)]
    z = top[-1][0]
    top += [(p, YARD) for p in spread(z, FAR + 0.25, 1.5)[1:]]

    def material(i, j):
        (za, ya), (zb, yb) = top[j], top[j + 1]
        if ya == 0.0 == yb:
            return ("cream_tile", "slate_tile")[(i + j) % 2]
        if zb <= z:
            return "limestone"
        return ("flagstone", "flagstone_dark")[((i + 1) // 2 + j) % 2]

    for i, (xa, xb) in enumerate(zip(xs, xs[1:])):
        for j, ((za, ya), (zb, yb)) in enumerate(zip(top, top[1:])):
            solid.quad((xa, ya, za), (xa, yb, zb), (xb, yb, zb), (xb, ya, za), material(i, j))
    bottom = -1.6
    bx = spread(xs[0], xs[-1], 2.4)
    # one line just before each riser, so that the sides have neither folds nor slivers
    bz = spread(top[0][0], 4.4, 1.7) + [4.8, 5.2] + spread(5.2, top[-1][0], 2.4)[1:]
    for xa, xb in zip(bx, bx[1:]):
        for za, zb in zip(bz, bz[1:]):
            solid.quad((xa, bottom, za), (xb, bottom, za), (xb, bottom, zb), (xa, bottom, zb), "limestone")
    for x, right in ((xs[0], False), (xs[-1], True)):
        solid.zipper([(x, bottom, q) for q in bz], [(x, y, q) for q, y in top], "limestone", right)
    for (q, y), front in ((top[0], False), (top[-1], True)):
        solid.zipper([(x, bottom, q) for x in bx], [(x, y, q) for x in xs], "limestone", not front)
    return solid


def column(name, x):
    z, half = ARCADE, 0.42
    shaft = [
        (0.37, 0.12), (0.405, 0.20), (0.37, 0.28), (0.31, 0.30), (0.29, 0.42),
        (0.282, 1.30), (0.245, 2.48), (0.278, 2.52), (0.245, 2.57), (0.25, 2.64), (0.39, 2.80), (0.39, 2.85),
    ]  # fmt: skip
    return [
        box(name + "_plinth", (x - half, -0.03, z - half), (x + half, 0.14, z + half), "limestone"),
        lathe(name + "_shaft", x, z, shaft, "limestone"),
        box(name + "_abacus", (x - half, 2.82, z - half), (x + half, SPRING, z + half), "limestone"),
    ]


def half_ring(centre, inner, outer, foot, place):
    """Sections of a semi-elliptic band: legs down to `foot`, then the curve. place(s, y, side) gives a point."""
    outline = [(-1.0, None)] + [(-math.cos(math.pi * k / SEG), math.sin(math.pi * k / SEG)) for k in range(SEG + 1)] + [(1.0, None)]
    sections = []
    for c, s in outline:
        y = (foot, foot) if s is None else (SPRING + inner[1] * s, SPRING + outer[1] * s)
        p, q = (centre + inner[0] * c, y[0]), (centre + outer[0] * c, y[1])
        sections.append([place(*p, 1), place(*q, 1), place(*q, 0), place(*p, 0)])
    return sections


def building():
    parts = [ground(), superstructure()]
    for k in range(1, BAYS):
        parts += column(f"column{k}", -HALF + k * PITCH)
    for k in range(BAYS + 1):
        x = -HALF + k * PITCH
        parts += [
            box(f"pilaster{k}_base", (x - 0.32, -0.03, -0.05), (x + 0.32, 0.18, 0.21), "limestone"),
            box(f"pilaster{k}_shaft", (x - 0.24, 0.16, -0.06), (x + 0.24, 2.80, 0.13), "limestone"),
            box(f"pilaster{k}_capital", (x - 0.34, 2.78, -0.12), (x + 0.34, SPRING, 0.22), "limestone"),
        ]
        # a band under each transverse barrel, from the pilaster to the abacus
        band = half_ring(
            WALK / 2, (WALK / 2 - 0.11, RISE - 0.11), (WALK / 2 + 0.05, RISE + 0.05), SPRING - 0.02,
            lambda z, y, side, x=x: (x + (0.19 if side else -0.19), y, z),
        )  # fmt: skip
        parts.append(sweep(f"rib{k}", band, True, "limestone"))
    for k in range(BAYS):
        x = -HALF + (k + 0.5) * PITCH
        ring = half_ring(
            x, (RISE + 0.03, RISE + 0.03), (RISE + 0.24, RISE + 0.24), SPRING - 0.02,
            lambda s, y, side: (s, y, WALK + THICK + (-0.05 if side else 0.06)),
        )  # fmt: skip
        parts.append(sweep(f"archivolt{k}", ring, True, "limestone"))
    parts += [
        box("string_course", (-HALF - 0.06, 4.56, 4.14), (HALF + 0.06, 4.66, 4.25), "limestone", 3.0),
        box("cornice_lower", (-HALF - 0.07, 4.98, 4.12), (HALF + 0.07, 5.12, 4.30), "limestone", 3.0),
        box("cornice_upper", (-HALF - 0.08, 5.10, 4.10), (HALF + 0.08, 5.32, 4.44), "limestone", 3.0),
        box("back_wall", (-HALF - 0.21, -0.5, -0.6), (HALF + 0.21, 5.3, 0.0), "ochre"),
        box("dado", (-HALF - 0.04, -0.04, -0.08), (HALF + 0.04, 0.98, 0.03), "teal"),
        box("dado_rail", (-HALF - 0.05, 0.96, -0.07), (HALF + 0.05, 1.04, 0.06), "limestone"),
    ]
    for name, near, far in (("west", -HALF - 0.6, -HALF), ("east", HALF, HALF + 0.6)):
        wall = arched_wall(f"{name}_wall", (-0.3, FAR + 0.4), [(WALK / 2, 0.85, 2.1)], (-0.9, 5.5), (near, far), False, "ochre")
        parts.append(wall)
        sign = 1 if far > 0 else -1
        # where the arcade meets the wall a respond stands instead of a column
        for part, width, depth, foot, head in (("base", 0.44, 0.44, -0.03, 0.22), ("shaft", 0.34, 0.36, 0.2, 2.84), ("capital", 0.42, 0.43, 2.82, SPRING)):
            xa, xb = sorted((sign * (HALF - depth), sign * (HALF + depth / 4)))
            parts.append(box(f"{name}_respond_{part}", (xa, foot, ARCADE - width), (xb, head, ARCADE + width), "limestone", 2.7))
        xa, xb = sorted((sign * (HALF + 0.25), sign * (HALF + 0.4)))
        parts.append(box(f"{name}_door", (xa, -0.06, 0.9), (xb, 3.0, 2.7), "teal"))
        xa, xb = sorted((sign * (HALF - 0.25), sign * (HALF + 0.35)))
        parts.append(box(f"{name}_sill", (xa, -0.07, 0.85), (xb, 0.12, 2.75), "limestone"))
    blind = [(-HALF + (k + 0.5) * PITCH, 1.05, 2.2) for k in range(BAYS)]
    parts += [
        arched_wall("far_wall", (-HALF - 0.15, HALF + 0.15), blind, (-0.7, 5.4), (FAR, FAR + 0.6), True, "ochre"),
        box("far_backing", (-HALF - 0.1, -0.8, FAR + 0.35), (HALF + 0.1, 5.0, FAR + 0.7), "plaster", 3.0),
        box("far_coping", (-HALF - 0.12, 5.3, FAR - 0.12), (HALF + 0.12, 5.52, FAR + 0.8), "limestone", 3.0),
        box("lawn", (-6.0, -0.62, 8.2), (6.0, -0.36, 12.4), "lawn", 3.0),
    ]  # fmt: skip
    return parts


def number(value):
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def main():
    out = ["# Written by make.py; do not edit.", "mtllib colonnade.mtl"]
    count = 0
    for solid in building():
        out.append(f"o {solid.name}")
        index, faces = {}, {}
        for material, corners in solid.faces:
            ids = []
            for p in corners:
                key = "v " + " ".join(number(c) for c in p)
                if key not in index:
                    count += 1
                    index[key] = count
                    out.append(key)
                ids.append(index[key])
            faces.setdefault(material, []).append("f " + " ".join(map(str, ids)))
        for material, lines in faces.items():
            out.append(f"usemtl {material}")
            out += lines
    with open(os.path.join(HERE, "colonnade.obj"), "w", newline="\n") as f:
        f.write("\n".join(out) + "\n")
    with open(os.path.join(HERE, "colonnade.mtl"), "w", newline="\n") as f:
        f.write("# Written by make.py; do not edit. Linear reflectances.\n")
        for name, kd in MATERIALS:
            f.write(f"\nnewmtl {name}\nKd {' '.join(map(str, kd))}\n")


if __name__ == "__main__":
    main()
