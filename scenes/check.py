#!/usr/bin/env python3
"""Checks the geometry of OBJ files: `python3 scenes/check.py FILE.obj ...`; exit 1 when something is wrong.

Per file: bounds, counts, degenerate and badly shaped triangles, faces that coincide (coplanar and overlapping);
per object: whether it is closed with consistent orientation, and the sign of its volume.
`--open` accepts objects that are not closed, `--inward` expects fronts that face inward.
"""

import math
import sys
from collections import defaultdict


def load(path):
    points, objects, name = [], defaultdict(list), "(none)"
    for line in open(path):
        word = line.split()
        if not word:
            continue
        if word[0] == "v":
            points.append(tuple(map(float, word[1:4])))
        elif word[0] in ("o", "g"):
            name = word[1]
        elif word[0] == "f":
            ids = [int(w.split("/")[0]) - 1 for w in word[1:]]
            for k in range(1, len(ids) - 1):
                objects[name].append((ids[0], ids[k], ids[k + 1]))
    return points, objects


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def overlap(s, t, axis):
    """Whether two coplanar triangles share area, seen along `axis` (separating axes in the plane)."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    s, t = [(p[u], p[v]) for p in s], [(p[u], p[v]) for p in t]
    for shape in (s, t):
        for k in range(3):
            dx, dy = shape[(k + 1) % 3][0] - shape[k][0], shape[(k + 1) % 3][1] - shape[k][1]
            a = [-dy * p[0] + dx * p[1] for p in s]
            b = [-dy * p[0] + dx * p[1] for p in t]
            slack = 1e-4 * math.hypot(dx, dy)
            if max(a) <= min(b) + slack or max(b) <= min(a) + slack:
                return False
    return True


def check(path, need_closed, sign):
    points, objects = load(path)
    low = [min(p[k] for p in points) for k in range(3)]
    high = [max(p[k] for p in points) for k in range(3)]
    total = sum(map(len, objects.values()))
    wrong, planes, worst, narrow = [], defaultdict(list), math.inf, 0
    for name, faces in objects.items():
        edges, volume = defaultdict(int), 0.0
        weld = {}
        for face in faces:
            p = [points[i] for i in face]
            n = cross(sub(p[1], p[0]), sub(p[2], p[0]))
            length = math.sqrt(dot(n, n))
            longest = max(dot(sub(p[k], p[k - 1]), sub(p[k], p[k - 1])) for k in range(3))
            if length <= 1e-7 or length <= 1e-4 * longest:
                wrong.append(f"{name}: degenerate face {p}")
                continue
            angle = min(
                math.degrees(math.acos(max(-1.0, min(1.0, dot(a, b) / math.sqrt(dot(a, a) * dot(b, b))))))
                for a, b in ((sub(p[k - 1], p[k]), sub(p[k - 2], p[k])) for k in range(3))
            )
            worst, narrow = min(worst, angle), narrow + (angle < 5)
            volume += dot(p[0], cross(p[1], p[2])) / 6
            ids = [weld.setdefault(q, len(weld)) for q in p]
            for k in range(3):
                edges[(ids[k - 1], ids[k])] += 1
            n = tuple(c / length for c in n)
            axis = max(range(3), key=lambda k: abs(n[k]))
            unsigned = n if n[axis] > 0 else tuple(-c for c in n)
            key = (axis, *(round(c, 2) for c in unsigned), round(dot(unsigned, p[0]), 3))
            planes[key].append((name, p, axis))
        broken = sum(1 for (a, b), n in edges.items() if n != 1 or edges.get((b, a)) != 1)
        if broken and need_closed:
            wrong.append(f"{name}: not closed, {broken} half-edges without their one partner")
        if not broken and volume * sign <= 0:
            wrong.append(f"{name}: faces the wrong way, volume {volume:.4g}")
    for faces in planes.values():
        for i, (name, p, axis) in enumerate(faces):
            for other, q, _ in faces[i + 1 :]:
                if overlap(p, q, axis):
                    wrong.append(f"{name} and {other}: coincident faces {p} {q}")
    print(f"{path}: {total} triangles, {len(objects)} objects, bounds {low} .. {high}, smallest angle {worst:.1f} deg, {narrow} below 5 deg")
    for line in wrong[:40]:
        print("  " + line)
    return not wrong


def main():
    options = [a for a in sys.argv[1:] if a.startswith("--")]
    files = [a for a in sys.argv[1:] if not a.startswith("--")]
    good = [check(f, "--open" not in options, -1 if "--inward" in options else 1) for f in files]
    sys.exit(0 if good and all(good) else 1)


if __name__ == "__main__":
    main()
