"""Our scenes for Mitsuba 3: diffuse, of OBJ files, rectangles, point lights, and boxes of fog behind null boundaries."""

import tomllib

import drjit as dr
import mitsuba as mi
import numpy as np

from obj import meshes

mi.set_variant("llvm_ad_rgb")


def mitsuba_meshes(obj):
    """A Mitsuba mesh for each material of an OBJ."""
    for name, albedo, vertices, triangles in meshes(obj):
        properties = mi.Properties()
        bsdf = {"type": "diffuse", "reflectance": {"type": "rgb", "value": albedo}}
        properties["bsdf"] = mi.load_dict({"type": "twosided", "bsdf": bsdf})
        mesh = mi.Mesh(name, vertex_count=len(vertices), face_count=len(triangles), props=properties)
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = np.array(vertices, dtype=np.float32).ravel()
        parameters["faces"] = np.array(triangles, dtype=np.uint32).ravel()
        parameters.update()
        yield name, mesh


def rectangle(shape, material):
    c, u, v = (np.array(shape[k], dtype=float) for k in ("center", "u", "v"))
    n = np.cross(u, v)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = u, v, n / np.linalg.norm(n), c
    return {
        "type": "rectangle",
        "to_world": mi.ScalarTransform4f(matrix),
        "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": material["albedo"]}},
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": material["emission"]}},
    }


def box_of_fog(shape, medium):
    low, high = (np.array(shape[k], dtype=float) for k in ("min", "max"))
    matrix = np.diag([*(0.5 * (high - low)), 1.0])
    matrix[:3, 3] = 0.5 * (low + high)
    absorbed, scattered = (np.array(medium[k], dtype=float) for k in ("sigma_a", "sigma_s"))
    extinction = absorbed + scattered
    return {
        "type": "cube",
        "to_world": mi.ScalarTransform4f(matrix),
        "bsdf": {"type": "null"},
        "interior": {
            "type": "homogeneous",
            "sigma_t": {"type": "rgb", "value": [float(x) for x in extinction]},
            "albedo": {"type": "rgb", "value": [float(x) for x in scattered / extinction]},
            "phase": {"type": "hg", "g": medium["g"]},
        },
    }


def scene_of(file):
    """The same scene, and the integrator that it needs."""
    description = tomllib.loads(file.read_text())
    camera = description["camera"]
    width, height = camera["resolution"]
    to_world = mi.ScalarTransform4f().look_at(
        origin=camera["position"], target=camera["look_at"], up=camera["up"]
    )
    materials = {m["name"]: m for m in description.get("material", [])}
    media = {m["name"]: m for m in description.get("medium", [])}
    integrator = "volpath" if media else "path"
    out = {
        "type": "scene",
        "integrator": {"type": integrator, "max_depth": -1},
        "sensor": {
            "type": "perspective",
            "fov": camera["fov_x_deg"],
            "fov_axis": "x",
            "to_world": to_world,
            "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}},
        },
    }
    for mesh in description["mesh"]:
        out.update(mitsuba_meshes(file.parent / mesh["file"]))
    for i, shape in enumerate(description.get("shape", [])):
        fog = shape["kind"] == "box"
        out[f"shape{i}"] = box_of_fog(shape, media[shape["interior"]]) if fog else rectangle(shape, materials[shape["material"]])
    for i, light in enumerate(description.get("light", [])):
        intensity = {"type": "rgb", "value": light["intensity"]}
        out[f"light{i}"] = {"type": "point", "position": light["position"], "intensity": intensity}
    return mi.load_dict(out), integrator


class Mitsuba:
    """A scene, compiled and warm."""

    def __init__(self, file, threads):
        dr.set_thread_count(threads)
        self.scene, self.method = scene_of(file)
        self.render(4, 0)

    def render(self, samples, seed):
        image = mi.render(self.scene, spp=samples, seed=seed)
        dr.eval(image)
        dr.sync_thread()
        return np.array(image)


def read(file):
    """Colours of an EXR's unnamed layer."""
    bitmap = dict(mi.Bitmap(str(file)).split())["<root>"]
    names = [field.name for field in bitmap.struct_()]
    return np.array(bitmap).astype(np.float32)[:, :, [names.index(c) for c in "RGB"]]
