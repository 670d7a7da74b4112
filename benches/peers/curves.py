#!/usr/bin/env python3
"""Error against time of etendue, Mitsuba 3 and LuxCore on one scene, taking turns within one run: a table that `etendue report --runs` draws.

    pip install mitsuba pyluxcore numpy OpenEXR; apt-get install libllvm19        # once; DRJIT_LIBLLVM_PATH names the library
    cargo build --release
    python3 benches/peers/curves.py $ETENDUE_SCENES/closed_cornell/area.toml $ETENDUE_SCENES/closed_cornell/area_ref.exr -o runs.csv
    target/release/etendue report --runs runs.csv -o curves

Scenes: diffuse, of OBJ files, rectangles and point lights, with boxes of fog behind null boundaries (`volpath` of Mitsuba then). Every error is by `etendue compare`, pixels within one of a lamp that is seen directly left out.
All renderers have the same threads (--threads). Seconds are of the clock: of the render call for Mitsuba (after one to warm it up) and LuxCore (from start to stop), and etendue's own stages for etendue; CPU seconds are user and system: of the same for the two, of the whole process for etendue.
"""

import argparse
import csv
import json
import multiprocessing
import os
import resource
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from importlib.metadata import version
from pathlib import Path

import mitsuba as mi
import numpy as np

import luxcore
from mitsuba_peer import Mitsuba

COLUMNS = (
    "method variant backend effort rung replicate samples seconds cpu_seconds stages rays bytes rel_error rel_mse energy_error "
    "bias_r bias_g bias_b block_5 block_50 block_95 worst_block flip z_pass"
).split()
# Samples per pixel, by what one costs; a block of ours has 16.
FEW, SOME, MANY = [1, 4, 16], [4, 16, 64], [16, 64, 256]


def cpu(who):
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


class Etendue:
    """Our own command, one method of it."""

    backend = "cpu"

    def __init__(self, program, scene, method, threads, ladder, more=()):
        self.program, self.scene, self.threads = program, scene, threads
        self.method, self.options = method, ["--method", method, *more]
        self.variant = "gather" if "--gather" in more else ""
        self.ladder = ladder

    def run(self, samples, seed, file):
        command = [self.program, "render", self.scene, "-o", file, *self.options, "--samples", str(samples)]
        if self.method == "photon":
            command += ["--photons", str(4096 * samples)]
        before = cpu(resource.RUSAGE_CHILDREN)
        done = subprocess.run(
            [*command, "--seed", str(seed), "--threads", str(self.threads), "--json"],
            check=True,
            capture_output=True,
            text=True,
        )
        used = cpu(resource.RUSAGE_CHILDREN) - before
        said = json.loads(done.stdout)
        stages = {k: v for k, v in said["seconds"].items() if k not in ("total", "load", "compile", "prepare", "write")}
        return sum(stages.values()), used, said["rays"]


class MitsubaPath:
    """Mitsuba's path tracer; it lives in this process."""

    backend, variant = f"Mitsuba {mi.__version__}", "llvm"

    def __init__(self, scene, threads):
        self.peer = Mitsuba(scene, threads)
        self.method, self.ladder = self.peer.method, MANY

    def run(self, samples, seed, file):
        clock, before = time.perf_counter(), cpu(resource.RUSAGE_SELF)
        image = self.peer.render(samples, seed)
        seconds, used = time.perf_counter() - clock, cpu(resource.RUSAGE_SELF) - before
        write(file, image)
        return seconds, used, None


class LuxCore:
    """LuxCore, in a process of its own for each run."""

    backend = f"LuxCore {version('pyluxcore')}"

    def __init__(self, scene, threads, variant, theirs):
        self.scene, self.threads, self.method, self.variant = scene, threads, theirs.name, variant
        self.options, self.ladder = theirs.options, theirs.samples

    def run(self, samples, seed, file):
        options = {**self.options, "native.threads.count": self.threads}
        clock = time.perf_counter()
        with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as child:
            _, _, used, seconds, image = child.submit(luxcore.luxcore_here, self.scene, options, samples, seed).result()
        assert seconds <= time.perf_counter() - clock
        write(file, image)
        return seconds, used, None


def write(file, image):
    """Linear colours as an EXR; by a process of its own, for OpenEXR's library is not that of the renderers."""
    with tempfile.TemporaryDirectory() as folder:
        raw = Path(folder) / "image.npy"
        np.save(raw, np.ascontiguousarray(image, dtype=np.float32))
        code = (
            "import sys, numpy, OpenEXR; a = numpy.load(sys.argv[1]); "
            "OpenEXR.File({'compression': OpenEXR.ZIP_COMPRESSION, 'type': OpenEXR.scanlineimage}, {'RGB': a}).write(sys.argv[2])"
        )
        subprocess.run([sys.executable, "-c", code, str(raw), str(file)], check=True)


def mask(scene, folder):
    """A picture of the pixels that count."""
    kept = luxcore.counted(scene)
    file = Path(folder) / "mask.png"
    grey = np.where(kept, 255, 0).astype(np.uint8)
    mi.Bitmap(np.repeat(grey[:, :, None], 3, axis=2)).write(str(file))
    return file


def metrics(program, file, reference, mask_file):
    done = subprocess.run(
        [program, "compare", file, reference, "--mask", mask_file, "--json"], check=True, capture_output=True, text=True
    )
    m = json.loads(done.stdout)
    low, middle, high = m["block_ratio"]
    r, g, b = m["bias"]
    out = {k: m[k] for k in ("rel_error", "rel_mse", "energy_error", "worst_block", "flip")}
    return {**out, "block_5": low, "block_50": middle, "block_95": high, "bias_r": r, "bias_g": g, "bias_b": b, "z_pass": m.get("z_pass")}


def rivals(args):
    ours = [("path", (), MANY), ("bdpt", (), SOME[1:]), ("photon", ("--gather",), MANY)]
    list_ = [Etendue(args.etendue, args.scene, method, args.threads, ladder, more) for method, more, ladder in ours]
    list_.append(MitsubaPath(args.scene, args.threads))
    for variant, theirs in (
        ("depth 64", luxcore.from_the_eye(depth=64, samples=SOME)),
        ("depth 12, roulette off", luxcore.from_both_ends(depth=12, roulette=False, samples=FEW)),
    ):
        list_.append(LuxCore(args.scene, args.threads, variant, theirs))
    return list_


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("scene", type=Path)
    options.add_argument("reference", type=Path)
    options.add_argument("-o", "--output", type=Path, required=True, help="the table")
    options.add_argument("--rounds", type=int, default=5)
    options.add_argument("--threads", type=int, default=1)
    root = Path(__file__).resolve().parents[2]
    options.add_argument("--etendue", type=Path, default=root / "target/release/etendue", help="the program")
    args = options.parse_args()
    with tempfile.TemporaryDirectory() as folder, open(args.output, "w", newline="") as out:
        table = csv.DictWriter(out, COLUMNS, lineterminator="\n")
        table.writeheader()
        mask_file, image = mask(args.scene, folder), Path(folder) / "image.exr"
        list_ = rivals(args)
        for turn in range(args.rounds):
            for rung in range(max(len(r.ladder) for r in list_)):
                # Another one first in each round.
                for rival in list_[turn % len(list_) :] + list_[: turn % len(list_)]:
                    if rung >= len(rival.ladder):
                        continue
                    samples = rival.ladder[rung]
                    seconds, used, rays = rival.run(samples, turn + 1, image)
                    row = {
                        "method": rival.method,
                        "variant": rival.variant,
                        "backend": rival.backend,
                        "effort": f"{samples} samples",
                        "rung": rung,
                        "replicate": turn,
                        "samples": samples,
                        "seconds": seconds,
                        "cpu_seconds": used,
                        "stages": "",
                        "rays": rays,
                        **metrics(args.etendue, image, args.reference, mask_file),
                    }
                    table.writerow(row)
                    out.flush()
                    name = f"{rival.backend} {rival.method} {rival.variant}".strip()
                    print(f"round {turn + 1}: {name}, {samples} samples: {seconds:.2f} s, rel_mse {row['rel_mse']:.2e}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
