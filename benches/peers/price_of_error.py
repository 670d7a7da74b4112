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
from pathlib import Path

import mitsuba as mi
import numpy as np

from mitsuba_peer import Mitsuba, read

GOAL = 1e-3
TURNS = int(os.environ.get("TURNS", "5"))
OURS = int(os.environ.get("OUR_SAMPLES", "64"))
THEIRS = int(os.environ.get("THEIR_SAMPLES", "64"))


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


def theirs(peer, seed):
    before = time.process_time()
    image = peer.render(THEIRS, seed)
    return time.process_time() - before, image


def main():
    file, reference = Path(sys.argv[1]), Path(sys.argv[2])
    scene, truth = Mitsuba(file, os.cpu_count()), read(reference)
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


if __name__ == "__main__":
    main()
