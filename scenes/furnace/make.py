#!/usr/bin/env python3
"""Writes inside.obj beside itself: an icosahedron, each face split in 16, pushed out to the unit sphere; fronts inward."""

import math
import os

GOLD = (1 + math.sqrt(5)) / 2
CORNERS = [(a, b * GOLD, 0) for b in (1, -1) for a in (-1, 1)]
CORNERS += [(0, a, b * GOLD) for b in (1, -1) for a in (-1, 1)]
CORNERS += [(a * GOLD, 0, b) for a in (1, -1) for b in (-1, 1)]


def unit(p):
    length = math.sqrt(sum(c * c for c in p))
    return tuple(c / length for c in p)


def far(p, q):
    return sum((a - b) ** 2 for a, b in zip(p, q))


def main():
    faces = []
    for i, p in enumerate(CORNERS):
        for j in range(i + 1, 12):
            for k in range(j + 1, 12):
                q, r = CORNERS[j], CORNERS[k]
                if max(far(p, q), far(q, r), far(r, p)) < 4.1:
                    volume = sum(p[a] * (q[a - 2] * r[a - 1] - q[a - 1] * r[a - 2]) for a in range(3))
                    faces.append((p, r, q) if volume > 0 else (p, q, r))
    for _ in range(2):
        finer = []
        for p, q, r in faces:
            pq, qr, rp = (unit(tuple(a + b for a, b in zip(unit(s), unit(t)))) for s, t in ((p, q), (q, r), (r, p)))
            finer += [(p, pq, rp), (q, qr, pq), (r, rp, qr), (pq, qr, rp)]
        faces = finer
    index, lines = {}, []
    out = ["# Written by make.py; do not edit.", "o inside"]
    for face in faces:
        ids = []
        for p in face:
            key = "v " + " ".join(f"{c + 0.0:.7f}" for c in unit(p)).replace("-0.0000000", "0.0000000")
            if key not in index:
                index[key] = len(index) + 1
                out.append(key)
            ids.append(index[key])
        lines.append("f " + " ".join(map(str, ids)))
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "inside.obj")
    with open(path, "w", newline="\n") as f:
        f.write("\n".join(out + lines) + "\n")


if __name__ == "__main__":
    main()
