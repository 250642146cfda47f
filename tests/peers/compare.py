#!/usr/bin/env python3
"""Renders scenes with woodcock and with Mitsuba 3 and asks whether the images are the same but for noise.

Exit codes: 0 all agree (and every planted bias was found); 1 not; 2 usage.
"""

import argparse
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import OpenEXR

import judge

HERE = Path(__file__).resolve().parent


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--woodcock", type=Path, required=True, help="the binary")
    parser.add_argument("--scenes", nargs="+", metavar="NAME", help="all, if not given")
    parser.add_argument("--spp", type=int, default=256, help="samples per pixel of either renderer, more in noisy scenes")
    parser.add_argument("--seeds", type=int, default=32, help="renderings of Mitsuba, of spp / seeds samples each")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--integrator", default="path", help="of woodcock")
    parser.add_argument("--variant", default="llvm_ad_rgb", choices=["llvm_ad_rgb", "scalar_rgb"], help="of Mitsuba")
    parser.add_argument("--plant", type=float, default=1.02, help="a factor on woodcock's image that must be noticed")
    parser.add_argument("--out", type=Path, default=Path("peers-out"), help="folder for images and pictures")
    return parser.parse_args()


def write_exr(path, pixels):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {"RGB": np.ascontiguousarray(pixels, np.float32)}) as file:
        file.write(str(path))


def render_woodcock(args, name, spp, pictures):
    """Mean and variance of the mean, (height, width, 3)."""
    folder = args.out / "scenes"
    folder.mkdir(parents=True, exist_ok=True)
    for file in [HERE / "scenes" / f"{name}.pbrt", *(HERE / "scenes").glob("*.ply")]:
        shutil.copy(file, folder)
    for picture, make in pictures.items():
        write_exr(folder / picture, make())
    image = args.out / f"{name}.woodcock.exr"
    command = [args.woodcock, folder / f"{name}.pbrt", "--integrator", args.integrator, "-q", "-o", image]
    command += ["--spp", str(spp), "--seed", str(args.seed)]
    subprocess.run([str(word) for word in command], check=True)
    with OpenEXR.File(str(image), separate_channels=True) as file:
        channels = file.channels()
        planes = [[channels[layer + c].pixels for c in "RGB"] for layer in ("", "Variance.")]
    mean, variance = (np.stack(p, -1).astype(np.float64) for p in planes)
    return mean, variance


def render_mitsuba(args, name, spp, description):
    """(seeds, height, width, 3)."""
    import mitsuba as mi

    scene = mi.load_dict(description)
    first = args.seed * 100_000
    images = [np.array(mi.render(scene, spp=max(spp // args.seeds, 1), seed=first + i), np.float64) for i in range(args.seeds)]
    images = np.stack(images)[..., :3]
    write_exr(args.out / f"{name}.mitsuba.exr", images.mean(0))
    return images


def main():
    args = arguments()
    import mitsuba as mi

    mi.set_variant(args.variant)
    import scenes

    unknown = set(args.scenes or []) - set(scenes.SCENES)
    if unknown:
        print(f"unknown: {', '.join(sorted(unknown))}; known: {', '.join(scenes.SCENES)}", file=sys.stderr)
        return 2
    args.out.mkdir(parents=True, exist_ok=True)
    fine = True
    version = subprocess.run([str(args.woodcock), "--version"], check=True, capture_output=True, text=True).stdout.strip()
    print(f"Mitsuba {mi.__version__} {args.variant}, {version} {args.integrator}, {args.spp} samples per pixel")
    print()
    columns = ["scene", "blocks: max abs z", "mean z", "rms z", "image: difference", "its standard error", "z"]
    columns += ["planted: z (blocks)", "seconds", "verdict"]
    print(f"| {' | '.join(columns)} |\n{'|---' * len(columns)}|")
    for name in args.scenes or scenes.SCENES:
        start = time.monotonic()
        spp = args.spp * scenes.NOISY.get(name, 1)
        mean, variance = render_woodcock(args, name, spp, scenes.PICTURES.get(name, {}))
        middle = time.monotonic()
        build = scenes.SCENES[name]
        description = build(args.out / "scenes") if build.__code__.co_argcount else build()
        renderings = render_mitsuba(args, name, spp, description)
        end = time.monotonic()
        found = judge.judge(mean, variance, spp, renderings)
        planted = judge.judge(mean * args.plant, variance * args.plant**2, spp, renderings)
        verdict = "agrees" if found.agrees else "DIFFERS"
        if planted.agrees:
            verdict += ", PLANT NOT FOUND"
        fine = fine and found.agrees and not planted.agrees
        row, column, channel = found.where
        print(
            f"| {name} | {found.largest:.2f} ({row}, {column}, {'RGB'[channel]}) | {found.mean:+.3f} | {found.rms:.3f} "
            f"| {found.difference:+.2e} | {found.resolution:.1e} | {found.z:+.2f} "
            f"| {planted.z:+.1f} (blocks {planted.largest:.1f}) | {middle - start:.0f} + {end - middle:.0f} | {verdict} |",
            flush=True,
        )
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
