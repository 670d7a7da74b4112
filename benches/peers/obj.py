"""Meshes of an OBJ file with its materials, as far as the scenes of these scripts go: triangles or convex polygons, Kd."""


def albedos(mtl):
    """Kd by name."""
    out, name = {}, None
    for line in mtl.read_text().splitlines():
        words = line.split()
        if words[:1] == ["newmtl"]:
            name = words[1]
        elif words[:1] == ["Kd"]:
            out[name] = [float(x) for x in words[1:4]]
    return out


def meshes(obj):
    """Name, albedo, vertices and triangles for each material of an OBJ."""
    vertices, faces, name, kd = [], {}, None, {}
    for line in obj.read_text().splitlines():
        words = line.split()
        if words[:1] == ["mtllib"]:
            kd = albedos(obj.parent / words[1])
        elif words[:1] == ["usemtl"]:
            name = words[1]
        elif words[:1] == ["v"]:
            vertices.append(tuple(float(x) for x in words[1:4]))
        elif words[:1] == ["f"]:
            corner = [int(w.split("/")[0]) - 1 for w in words[1:]]
            faces.setdefault(name, []).extend((corner[0], a, b) for a, b in zip(corner[1:], corner[2:]))
    for name, triangles in faces.items():
        yield name, kd[name], vertices, triangles
