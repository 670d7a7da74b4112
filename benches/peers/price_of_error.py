#!/usr/bin/env python3
"""CPU seconds to a given error, etendue beside Mitsuba 3 (path, llvm_ad_rgb), taking turns within one run.

    pip install mitsuba numpy; apt-get install libllvm19        # once; DRJIT_LIBLLVM_PATH names the library
    cargo build --release
    python3 benches/peers/price_of_error.py $ETENDUE_SCENES/closed_cornell/area.toml $ETENDUE_SCENES/closed_cornell/area_ref.exr

Scenes: diffuse, of one OBJ, with rectangles and point lights. Error: rel_mse = mean((x - r)^2 / (r^2 + 0.01)) over pixels and channels.
Error falls as 1/N, so that a render's CPU seconds times its rel_mse over 1e-3 is the price of 1e-3. Medians over the turns.
CPU seconds are user and system: of the whole process for etendue, of the render call alone for Mitsuba, after one to warm it up.
"""

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

from obj import meshes

GOAL = 1e-3
TURNS = int(os.environ.get("TURNS", "5"))
OURS = int(os.environ.get("OUR_SAMPLES", "64"))
THEIRS = int(os.environ.get("THEIR_SAMPLES", "64"))


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


def scene_of(file):
    """The same scene for Mitsuba."""
    description = tomllib.loads(file.read_text())
    camera = description["camera"]
    width, height = camera["resolution"]
    to_world = mi.ScalarTransform4f().look_at(
        origin=camera["position"], target=camera["look_at"], up=camera["up"]
    )
    out = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": -1},
        "sensor": {
            "type": "perspective",
            "fov": camera["fov_x_deg"],
            "fov_axis": "x",
            "to_world": to_world,
            "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}},
        },
    }
    emission = {m["name"]: m for m in description.get("material", [])}
    for mesh in description["mesh"]:
        out.update(mitsuba_meshes(file.parent / mesh["file"]))
    for i, shape in enumerate(description.get("shape", [])):
        c, u, v = (np.array(shape[k]) for k in ("center", "u", "v"))
        n = np.cross(u, v)
        matrix = np.eye(4)
        matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = u, v, n / np.linalg.norm(n), c
        material = emission[shape["material"]]
        out[f"shape{i}"] = {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f(matrix),
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": material["albedo"]}},
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": material["emission"]}},
        }
    for i, light in enumerate(description.get("light", [])):
        intensity = {"type": "rgb", "value": light["intensity"]}
        out[f"light{i}"] = {"type": "point", "position": light["position"], "intensity": intensity}
    return mi.load_dict(out)


def read(file):
    """Colours of an EXR's unnamed layer."""
    bitmap = dict(mi.Bitmap(str(file)).split())["<root>"]
    names = [field.name for field in bitmap.struct_()]
    return np.array(bitmap).astype(np.float32)[:, :, [names.index(c) for c in "RGB"]]


def rel_mse(image, reference):
    return float(np.mean((image - reference) ** 2 / (reference**2 + 0.01)))


def ours(program, file, seed):
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.exr"
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [program, "render", file, "-o", out, "--samples", str(OURS), "--seed", str(seed), "--quiet"],
            check=True,
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, read(out)


def theirs(scene, seed):
    before = time.process_time()
    image = mi.render(scene, spp=THEIRS, seed=seed)
    dr.eval(image)
    dr.sync_thread()
    return time.process_time() - before, np.array(image)


def main():
    file, reference = Path(sys.argv[1]), Path(sys.argv[2])
    mi.set_variant("llvm_ad_rgb")
    scene, truth = scene_of(file), read(reference)
    program = Path(__file__).resolve().parents[2] / "target/release/etendue"
    theirs(scene, 0)
    rows = {"etendue": [], "mitsuba": []}
    for turn in range(1, TURNS + 1):
        for name, (seconds, image) in {
            "etendue": ours(program, file, turn),
            "mitsuba": theirs(scene, turn),
        }.items():
            error = rel_mse(image, truth)
            rows[name].append((seconds, error, seconds * error / GOAL, float(image.mean() / truth.mean())))
            print(f"{name:8} {seconds:7.2f} CPU-s, rel_mse {error:.3e}, mean {rows[name][-1][3]:.4f}", flush=True)
    price = {name: statistics.median(row[2] for row in all) for name, all in rows.items()}
    ratio = statistics.median(a[2] / b[2] for a, b in zip(rows["etendue"], rows["mitsuba"]))
    print(f"CPU-s to rel_mse {GOAL}: etendue {price['etendue']:.1f}, Mitsuba {mi.__version__} {price['mitsuba']:.1f}; ratio {ratio:.2f}")


main()
