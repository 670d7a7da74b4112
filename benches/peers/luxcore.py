#!/usr/bin/env python3
"""CPU seconds to a given error, etendue beside LuxCore (paths, and paths from both ends), taking turns within one run.

    pip install pyluxcore numpy OpenEXR        # once; pyluxcore 2.11.2 is what this was written for
    cargo build --release
    python3 benches/peers/luxcore.py --scenes $ETENDUE_SCENES/closed_cornell --etendue target/release/etendue [--rounds 2]

Wants area.toml and point.toml in the folder, with area_ref.exr and point_ref.exr; scenes are diffuse, of OBJ files, rectangles and point lights.
Prints one Markdown table. About nine CPU minutes for two rounds; every renderer has one thread.

Error: rel_mse = mean((x - r)^2 / (r^2 + 0.01)) over channels and pixels, without those within one pixel of a lamp that is seen directly.
Bias: mean(x) / mean(r) - 1. A bias b leaves a floor of about mean((b r)^2 / (r^2 + 0.01)) that no number of samples gets below.
Price: the error above the floor falls as 1/samples, so that CPU seconds * (rel_mse - floor) / (1e-3 - floor) is what 1e-3 costs: extrapolated.
LuxCore's error falls faster than that while samples are few (Sobol' points): against 64 samples the price of BIDIRCPU comes out right (point)
to a tenth too high (area) from 16, and a quarter to a half too high from 2.
CPU seconds are user and system: of the whole process for etendue, from start to stop of the session for LuxCore. Figures are medians of the rounds.

LuxCore's roulette makes BIDIRCPU too bright (by its source, weights count the chance of survival in connections, not in bounces), so that
rows without roulette stand beside one with it. Without, paths end at a largest depth at either end: the deeper, the dearer and the less too dark.
"""

import argparse
import math
import multiprocessing
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import namedtuple
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from obj import meshes

GOAL = 1e-3
SCENES = ["area", "point"]


@dataclass(eq=False)
class Method:
    """`like`: which of ours it is compared with. `options`: arguments of etendue, or properties of LuxCore. `samples`: two budgets."""

    program: str
    name: str
    like: str
    settings: str
    options: object
    samples: list


def from_both_ends(depth, roulette, samples):
    options = {"renderengine.type": "BIDIRCPU", "path.maxdepth": depth, "light.maxdepth": depth}
    if not roulette:
        options["path.russianroulette.depth"] = 1_000_000
    words = f"roulette {'as it comes' if roulette else 'off'}, depth {depth}"
    return Method("LuxCore", "BIDIRCPU", "bdpt", words, options, samples)


def from_the_eye(depth, samples):
    options = {"renderengine.type": "PATHCPU", **{f"path.pathdepth.{k}": depth for k in ("total", "diffuse", "glossy", "specular")}}
    return Method("LuxCore", "PATHCPU", "path", f"roulette as it comes, depth {depth}", options, samples)


METHODS = [
    Method("etendue", "bdpt", "bdpt", "as it comes", ["--method", "bdpt"], [16, 32]),
    from_both_ends(depth=12, roulette=False, samples=[2, 16]),
    from_both_ends(depth=8, roulette=False, samples=[2, 16]),
    from_both_ends(depth=12, roulette=True, samples=[2, 4]),
    Method("etendue", "path", "path", "as it comes", ["--method", "path"], [16, 32]),
    from_the_eye(depth=64, samples=[8, 32]),
]


def rectangles(description):
    """Centre, half-edges, albedo and emission of each rectangle."""
    materials = {m["name"]: m for m in description.get("material", [])}
    for shape in description.get("shape", []):
        if shape["kind"] != "rectangle":
            continue
        material = materials[shape["material"]]
        c, u, v = (np.array(shape[k], dtype=float) for k in ("center", "u", "v"))
        yield c, u, v, material["albedo"], material["emission"]


def boxes(description):
    """Eight corners, twelve triangles that face outwards, and the medium within, of each box."""
    media = {m["name"]: m for m in description.get("medium", [])}
    for shape in description.get("shape", []):
        if shape["kind"] != "box":
            continue
        low, high = shape["min"], shape["max"]
        corners = [tuple(float((low, high)[i >> k & 1][k]) for k in range(3)) for i in range(8)]
        sides = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
        yield corners, [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))], media[shape["interior"]]


def translated(lux, file):
    """The same scene for LuxCore."""
    description = tomllib.loads(file.read_text())
    camera = description["camera"]
    width, height = camera["resolution"]
    scene, properties = lux.Scene(), lux.Properties()

    def put(values):
        for key, value in values.items():
            properties.Set(lux.Property(f"scene.{key}", value))

    def surface(name, vertices, triangles, kd, emission=None):
        scene.DefineMesh(name, vertices, triangles, None, None, None, None)
        put({f"objects.{name}.shape": name, f"objects.{name}.material": name})
        put({f"materials.{name}.type": "matte", f"materials.{name}.kd": [float(x) for x in kd]})
        if emission:
            light = f"materials.{name}.emission"
            put({light: emission, f"{light}.gain": [1.0] * 3})
            put({f"{light}.power": 0.0, f"{light}.efficency": 0.0, f"{light}.normalizebycolor": False})

    # Its camera takes each row of pixels for the next one (in PerspectiveCamera::InitRay, height - y - 1 is not where y is): this window undoes it.
    half, row = height / width, 2 / width
    put(
        {
            "camera.type": "perspective",
            "camera.lookat.orig": camera["position"],
            "camera.lookat.target": camera["look_at"],
            "camera.up": camera["up"],
            "camera.fieldofview": camera["fov_x_deg"],
            "camera.screenwindow": [-1.0, 1.0, -half - row, half - row],
            "camera.autofocus.enable": False,
            "camera.lensradius": 0.0,
        }
    )
    for i, mesh in enumerate(description["mesh"]):
        for name, kd, vertices, triangles in meshes(file.parent / mesh["file"]):
            surface(f"{name}{i}", vertices, triangles, kd)
    for i, (c, u, v, kd, emission) in enumerate(rectangles(description)):
        # It shines on the side that sees its corners turn to the left, as ours does.
        corners = [tuple(float(x) for x in p) for p in (c - u - v, c + u - v, c + u + v, c - u + v)]
        surface(f"rectangle{i}", corners, [(0, 1, 2), (0, 2, 3)], kd, emission)
    for i, (corners, triangles, medium) in enumerate(boxes(description)):
        name = f"box{i}"
        scene.DefineMesh(name, corners, triangles, None, None, None, None)
        # Its volumes and materials share names.
        volume = f"volumes.fog{i}"
        put({f"{volume}.type": "homogeneous", f"{volume}.multiscattering": True})
        put({f"{volume}.absorption": medium["sigma_a"], f"{volume}.scattering": medium["sigma_s"]})
        put({f"{volume}.asymmetry": [float(medium["g"])] * 3})
        put({f"materials.{name}.type": "null", f"materials.{name}.volume.interior": f"fog{i}"})
        put({f"objects.{name}.shape": name, f"objects.{name}.material": name})
    for i, light in enumerate(description.get("light", [])):
        assert light["kind"] == "point", "only point lights are translated"
        # With neither power nor efficacy the gain is the flux.
        gain = [4 * math.pi * x for x in light["intensity"]]
        name = f"lights.light{i}"
        put({f"{name}.type": "point", f"{name}.position": light["position"], f"{name}.color": [1.0] * 3})
        put({f"{name}.gain": gain, f"{name}.power": 0.0, f"{name}.efficency": 0.0, f"{name}.normalizebycolor": False})
    scene.Parse(properties)
    return scene, width, height


def luxcore_here(file, options, samples, seed):
    """Version, samples per pixel, CPU seconds, seconds and image; to be run in a process of its own."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    import pyluxcore as lux

    lux.Init(lambda message: None)
    scene, width, height = translated(lux, file)
    config = lux.Properties()
    settings = {
        "native.threads.count": 1,
        "renderengine.seed": seed,
        "sampler.type": "SOBOL",
        "sampler.sobol.adaptive.strength": 0.0,
        "batch.haltspp": [samples, 0],
        "film.width": width,
        "film.height": height,
        "film.filter.type": "NONE",
        "film.imagepipelines.0.0.type": "NOP",
        "film.outputs.0.type": "RGB",
        "film.outputs.0.filename": "image.exr",
        **options,
    }
    for key, value in settings.items():
        config.Set(lux.Property(key, value))
    session = lux.RenderSession(lux.RenderConfig(config, scene))
    before, clock = resource.getrusage(resource.RUSAGE_SELF), time.perf_counter()
    session.Start()
    while not session.HasDone():
        time.sleep(0.05)
        session.UpdateStats()
    session.Stop()
    after = resource.getrusage(resource.RUSAGE_SELF)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    clock = time.perf_counter() - clock
    passes = session.GetStats().Get("stats.renderengine.pass").GetFloat()
    image = np.empty((height, width, 3), dtype=np.float32)
    session.GetFilm().GetOutputFloat(lux.FilmOutputType.RGB, image, 0, True)
    return lux.Version(), passes, seconds, clock, image[::-1].copy()


def luxcore(file, method, samples, seed):
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as child:
        version, passes, seconds, _, image = child.submit(luxcore_here, file, method.options, samples, seed).result()
        return version, passes, seconds, image


def etendue(program, file, method, samples, seed):
    version = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout.split()[-1]
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.exr"
        command = [program, "render", file, "-o", out, *method.options, "--samples", str(samples)]
        child = subprocess.Popen([*command, "--seed", str(seed), "--threads", "1", "--quiet"])
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode:
            raise SystemExit(f"etendue ended with {child.returncode}")
        return version, samples, usage.ru_utime + usage.ru_stime, read(out)


def read(file):
    """Colours of an EXR's unnamed layer."""
    import OpenEXR  # here, for it cannot share a process with pyluxcore

    return OpenEXR.File(str(file)).parts[0].channels["RGB"].pixels.astype(np.float32)


def counted(file):
    """Which pixels count: those more than one pixel away from a rectangle that shines and is seen."""
    description = tomllib.loads(file.read_text())
    camera = description["camera"]
    width, height = camera["resolution"]
    eye = np.array(camera["position"], dtype=float)
    forward = np.array(camera["look_at"]) - eye
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, camera["up"])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    fine = 8
    scale = math.tan(math.radians(camera["fov_x_deg"]) / 2)
    x = ((np.arange(width * fine) + 0.5) / (width * fine) * 2 - 1) * scale
    y = (1 - (np.arange(height * fine) + 0.5) / (height * fine) * 2) * scale * height / width
    ray = forward + x[None, :, None] * right + y[:, None, None] * up
    seen = np.zeros((height, width), dtype=bool)
    for c, u, v, _, _ in rectangles(description):
        normal = np.cross(u, v)
        facing = ray @ normal
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = ((c - eye) @ normal) / facing
            at = eye + distance[..., None] * ray - c
            hit = (facing < 0) & (distance > 0) & (abs(at @ u) <= u @ u) & (abs(at @ v) <= v @ v)
        seen |= hit.reshape(height, fine, width, fine).any(axis=(1, 3))
    wide = np.pad(seen, 1)
    near = [wide[j : j + height, i : i + width] for j in range(3) for i in range(3)]
    return ~np.logical_or.reduce(near)


def error(image, truth):
    return float(np.mean((image - truth) ** 2 / (truth**2 + 0.01)))


Run = namedtuple("Run", "version samples seconds error bias")


def price(runs, floor):
    """CPU seconds to the goal, of each round."""
    return [r.seconds * (r.error - floor) / (GOAL - floor) for r in runs]


def table(scene, runs, truth):
    """Rows of one scene; `runs` has the rounds by method and budget."""
    median, floors = statistics.median, {}
    for m in METHODS:
        bias = median(r.bias for n in m.samples for r in runs[m, n])
        floors[m] = error(truth * (1 + bias), truth)
    own = {m.name: price(runs[m, m.samples[-1]], floors[m]) for m in METHODS if m.program == "etendue"}
    for m in METHODS:
        few, many = (runs[m, n] for n in m.samples)
        if floors[m] < GOAL:
            costs = price(many, floors[m])
            cost, check = f"{median(costs):.1f}", f"{median(price(few, floors[m])):.1f}"
            ratio = f"{median(a / b for a, b in zip(costs, own[m.like])):.1f} x {m.like}"
        else:
            cost, check, ratio = "never: biased", "-", "-"
        cells = [scene, f"{m.program} {m.name}", many[0].version, m.settings, f"{many[0].samples:.0f}"]
        cells += [f"{median(r.seconds for r in many):.1f}", f"{median(r.error for r in many):.2e}"]
        bias = f"{100 * median(r.bias for r in many):+.2f}"
        cells += [bias if floors[m] < GOAL / 100 else f"{bias} (floor {floors[m]:.0e})", cost, check, ratio]
        yield "| " + " | ".join(cells) + " |"


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--scenes", type=Path, required=True, help="folder of area.toml, point.toml and their references")
    options.add_argument("--etendue", type=Path, required=True, help="the program")
    options.add_argument("--rounds", type=int, default=2)
    args = options.parse_args()
    load, runs, truths = [os.getloadavg()[0]], {}, {}
    for turn in range(1, args.rounds + 1):
        for scene in SCENES:
            file = args.scenes / f"{scene}.toml"
            kept = counted(file)
            truth = truths[scene] = read(args.scenes / f"{scene}_ref.exr")[kept]
            for m in METHODS:
                for n in m.samples:
                    if m.program == "etendue":
                        version, samples, seconds, image = etendue(args.etendue.resolve(), file, m, n, turn)
                    else:
                        version, samples, seconds, image = luxcore(file, m, n, turn)
                    image = image[kept]
                    bias = float(image.mean(dtype=float) / truth.mean(dtype=float)) - 1
                    run = Run(version, samples, seconds, error(image, truth), bias)
                    runs.setdefault(scene, {}).setdefault((m, n), []).append(run)
                    load.append(os.getloadavg()[0])
                    note = f"round {turn}, {scene}: {m.program} {m.name}, {m.settings}, {samples:.0f} samples:"
                    print(f"{note} {seconds:.2f} CPU-s, rel_mse {run.error:.3e}, bias {100 * bias:+.2f} %", file=sys.stderr, flush=True)
    print(
        f"One thread each, {args.rounds} rounds in turns; load of the machine {min(load):.1f} to {max(load):.1f}. CPU-s to 1e-3 are extrapolated.\n"
    )
    head = ["scene", "method", "version", "settings", "samples", "CPU-s", "rel_mse", "bias, %"]
    head += ["CPU-s to 1e-3 (extrapolated)", "the same from fewer samples", "ratio to ours"]
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for scene in SCENES:
        print("\n".join(table(scene, runs[scene], truths[scene])))


if __name__ == "__main__":
    main()
