#!/usr/bin/env python3
"""CPU seconds times relMSE of woodcock and of Mitsuba 3 on the same scenes, in one run.

Mitsuba renders with each of its volumetric integrators, variants and a few settings of Russian roulette; a pilot picks the best
for each scene. Then both renderers take turns, with all cores. CPU time is user and system time of all threads, without reading
scenes, building structures and compiling kernels (LLVM's are warmed up). relMSE is

    mean over pixels and channels of  variance between seeds / (ref^2 + 0.01 mean(ref)^2)

with the mean of all renderings as the reference. Images must agree, by the test of judge.py.

Exit codes: 0 all within the targets and agreeing; 1 not; 2 usage.
"""

import argparse
import itertools
import json
import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
# Woodcock's seconds x relMSE over Mitsuba's, at most.
TARGETS = {"cloud": 1 / 20, "fog": 1 / 20, "smoke": 1 / 20, "absorption": 1 / 300, "box-fog": 1 / 4}
SAMPLES = {"cloud": 64, "fog": 256, "smoke": 128, "absorption": 512, "box-fog": 64}
INTEGRATORS = ["volpath", "volpathmis"]
VARIANTS = ["llvm_ad_rgb", "scalar_rgb"]
# Mitsuba's own is 5; 100000 is none.
ROULETTES = [5, 50, 100000]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--woodcock", type=Path, help="the binary")
    parser.add_argument("--yardsticks", type=Path, help="folder that `cargo run --release -p woodcock-benches --bin yardsticks -- FOLDER` wrote")
    parser.add_argument("--scenes", nargs="+", metavar="NAME", default=list(TARGETS), choices=list(TARGETS))
    parser.add_argument("--spike", type=float, nargs="+", help="instead: the cloud with one voxel so many times as dense, both renderers' times over those without")
    parser.add_argument("--spike-size", type=int, default=48, help="pixels along an edge with a spike; Mitsuba takes minutes at 1000")
    parser.add_argument("--size", type=int, default=128, help="pixels along an edge")
    parser.add_argument("--rounds", type=int, default=6, help="renderings of either, at least three")
    parser.add_argument("--way", help="of Mitsuba, in place of a pilot: VARIANT,INTEGRATOR,RR_DEPTH")
    parser.add_argument("--scale", type=float, default=1.0, help="factor on the samples per pixel")
    parser.add_argument("--out", type=Path, default=Path("peers-out"), help="folder for images")
    parser.add_argument("--worker", help=argparse.SUPPRESS)
    return parser.parse_args()


# The worker: Mitsuba in one variant, in a process of its own.


def numbers(text, name):
    """The numbers of a parameter or directive of a pbrt file."""
    import re

    found = re.search(re.escape(name) + r'"?\s+\[?([-+.eE\d\s]+)', text)
    return [float(word) for word in found[1].split()] if found else None


def describe(folder, name, size, integrator, spike=None):
    """A scene of the yardstick as Mitsuba has it: its numbers from the pbrt file, its meaning from here."""
    import mitsuba as mi
    import scenes

    scenes.SIZE = size
    if name == "box-fog":
        return {**scenes.box_fog(), "integrator": integrator}
    text = (folder / f"{name}.pbrt").read_text()
    eye = numbers(text, "LookAt")[:3]
    camera = scenes.camera(eye, [0, 0, 0], numbers(text, '"float fov"')[0])
    absorption, scattering = (np.array(numbers(text, f'"rgb sigma_{kind}')) for kind in "as")
    extinction = absorption + scattering
    phase = {"type": "hg", "g": numbers(text, '"float g"')[0]}
    sky = text.split('LightSource "infinite"')[1]
    parts = {"sky": scenes.constant(*numbers(sky, '"rgb L'))}
    if 'LightSource "distant"' in text:
        sun = text.split('LightSource "distant"')[1]
        parts["sun"] = scenes.sun(numbers(sun, '"point3 from'), *numbers(sun, '"rgb L'))
    if "homogeneous" in text:
        radius = numbers(text, '"float radius')[0]
        fog = scenes.fog(scattering, absorption, phase["g"])
        parts["matter"] = scenes.ball([0, 0, 0], radius, bsdf={"type": "null"}, interior=fog)
    else:
        density = np.array(mi.VolumeGrid(str(folder / f"{name}.vol")))
        density = density.reshape(density.shape[:3])
        if spike:
            density = density.copy()
            density[np.unravel_index(nearest_peak(density), density.shape)] *= spike
        relative = extinction / extinction.max()
        grey = np.ptp(relative) == 0
        values = density[..., None] if grey else density[..., None] * relative.astype(np.float32)
        to_world = mi.ScalarTransform4f().translate([-0.5, -0.5, -0.5])
        grid = mi.VolumeGrid(np.ascontiguousarray(values, dtype=np.float32))
        medium = {
            "type": "heterogeneous",
            "sigma_t": {"type": "gridvolume", "grid": grid, "to_world": to_world, "raw": True},
            "albedo": scenes.rgb(*(scattering / extinction)),
            "scale": float(extinction.max()),
            "phase": phase,
        }
        parts["matter"] = scenes.cube(mi.ScalarTransform4f().scale(0.5), medium)
    return {"type": "scene", "sensor": camera, "integrator": integrator, **parts}


def nearest_peak(density):
    """The voxel that a spike makes denser: the densest that is nearest to the middle in the order of storage."""
    flat = density.ravel()
    places = np.flatnonzero(flat == flat.max())
    nz, ny, nx = density.shape
    middle = (nz // 2 * ny + ny // 2) * nx + nx // 2
    return places[np.argmin(np.abs(places - middle))]


def worker(variant):
    """Reads requests, a JSON object a line, renders, and answers with a JSON object a line."""
    import mitsuba as mi

    mi.set_variant(variant)
    import drjit as dr

    sys.path.insert(0, str(HERE))
    loaded = {}

    def cpu():
        usage = resource.getrusage(resource.RUSAGE_SELF)
        return usage.ru_utime + usage.ru_stime

    for line in sys.stdin:
        job = json.loads(line)
        key = json.dumps([job[k] for k in ("scene", "integrator", "rr", "size", "spike")])
        if key not in loaded:
            loaded.clear()
            integrator = {"type": job["integrator"], "max_depth": -1, "rr_depth": job["rr"]}
            description = describe(Path(job["folder"]), job["scene"], job["size"], integrator, job["spike"])
            loaded[key] = mi.load_dict(description)
            # Compiles, and is thrown away.
            dr.eval(mi.render(loaded[key], spp=job["spp"], seed=999_999))
            dr.sync_thread()
        before = cpu()
        image = np.array(mi.render(loaded[key], spp=job["spp"], seed=job["seed"]), np.float64)[..., :3]
        took = cpu() - before
        np.save(job["image"], image)
        print("ANSWER " + json.dumps({"seconds": took}), flush=True)


class Mitsuba:
    def __init__(self, args, variant):
        self.args, self.variant = args, variant
        command = [sys.executable, str(Path(__file__).resolve()), "--worker", variant]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def render(self, scene, integrator, rr, spp, seed, size=None, spike=None):
        image = self.args.out / f"mitsuba-{self.variant}.npy"
        job = {"folder": str(self.args.yardsticks), "scene": scene, "integrator": integrator, "rr": rr, "spp": spp}
        job |= {"seed": seed, "size": size or self.args.size, "image": str(image), "spike": spike}
        self.process.stdin.write(json.dumps(job) + "\n")
        self.process.stdin.flush()
        while True:
            line = self.process.stdout.readline()
            if not line:
                raise RuntimeError(f"Mitsuba ({self.variant}) ended")
            if line.startswith("ANSWER "):
                return np.load(image), json.loads(line[7:])["seconds"]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def woodcock(args, scene, spp, seed, size=None):
    """Image, variance of its pixels' means, CPU seconds, kernel."""
    import OpenEXR

    image, stats = args.out / "woodcock.exr", args.out / "woodcock.json"
    size = size or args.size
    command = [args.woodcock.resolve(), args.yardsticks / f"{scene}.pbrt", "-q", "-o", image, "--stats", stats]
    command += ["--spp", spp, "--seed", seed, "--resolution", f"{size}x{size}"]
    subprocess.run([str(word) for word in command], check=True)
    with OpenEXR.File(str(image), separate_channels=True) as file:
        channels = file.channels()
        planes = [[channels[layer + c].pixels for c in "RGB"] for layer in ("", "Variance.")]
    mean, variance = (np.stack(p, -1).astype(np.float64) for p in planes)
    told = json.loads(stats.read_text())
    return mean, variance, told["cpu_seconds"], told["kernel"]


def relmse(images, reference):
    floor = 1e-2 * reference.mean() ** 2
    return float((images.var(0, ddof=1) / (reference**2 + floor)).mean())


def pilot(args, peers, scene):
    """The best of Mitsuba's ways: seconds x relMSE of three small renderings each."""
    if args.way:
        variant, integrator, rr = args.way.split(",")
        return variant, integrator, int(rr)
    results = []
    spp = max(int(SAMPLES[scene] * args.scale) // 8, 4)
    for (variant, peer), integrator, rr in itertools.product(peers.items(), INTEGRATORS, ROULETTES):
        if scene == "absorption" and rr != ROULETTES[0]:
            continue
        runs = [peer.render(scene, integrator, rr, spp, 1000 + i, args.size // 2) for i in range(3)]
        images = np.stack([image for image, _ in runs])
        seconds = np.mean([s for _, s in runs])
        results.append((seconds * relmse(images, images.mean(0)), variant, integrator, rr))
        print(f"#   pilot {scene}: {variant} {integrator} rr_depth {rr}: {results[-1][0]:.3g}", flush=True)
    return min(results)[1:]


def compare(args, peers, scene):
    import judge

    variant, integrator, rr = pilot(args, peers, scene)
    spp = max(int(SAMPLES[scene] * args.scale), 4)
    ours, theirs = [], []
    kernel = ""
    for seed in range(args.rounds):
        mean, variance, seconds, kernel = woodcock(args, scene, spp, seed)
        ours.append((mean, variance, seconds))
        theirs.append(peers[variant].render(scene, integrator, rr, spp, seed))
    images = np.stack([mean for mean, _, _ in ours]), np.stack([image for image, _ in theirs])
    seconds = np.array([s for _, _, s in ours]), np.array([s for _, s in theirs])
    weights = [1 / i.var(0, ddof=1).mean() for i in images]
    reference = sum(w * i.mean(0) for w, i in zip(weights, images)) / sum(weights)

    def figures(kept):
        return [s[kept].mean() * relmse(i[kept], reference) for s, i in zip(seconds, images)]

    everything = np.arange(args.rounds)
    a, b = figures(everything)
    logs = np.array([np.log(x / y) for x, y in (figures(np.delete(everything, i)) for i in everything)])
    error = np.exp(np.sqrt((args.rounds - 1) * logs.var()))
    mean_variance = sum(v for _, v, _ in ours) / args.rounds**2
    verdict = judge.judge(images[0].mean(0), mean_variance, spp * args.rounds, images[1])
    planted = judge.judge(images[0].mean(0) * 1.02, mean_variance * 1.02**2, spp * args.rounds, images[1])
    met = a / b <= TARGETS[scene]
    print(
        f"| {scene} | {variant} {integrator}, rr {rr} | {kernel} | {seconds[0].mean():.3g} | {relmse(images[0], reference):.3g} "
        f"| {a:.3g} | {seconds[1].mean():.3g} | {relmse(images[1], reference):.3g} | {b:.3g} | 1/{b / a:.1f} (*/ {error:.2f}) "
        f"| 1/{1 / TARGETS[scene]:.0f} {'met' if met else 'MISSED'} | {verdict.largest:.1f}, {verdict.z:+.1f}, {verdict.difference:+.1e} "
        f"| {max(planted.largest, abs(planted.z)):.0f} | {'agree' if verdict.agrees else 'DIFFER'} |",
        flush=True,
    )
    return met and verdict.agrees


def spiked(args, factor):
    """The name of a copy of the cloud, for woodcock, with one voxel so many times as dense."""
    name = f"cloud-spike-{factor:g}"
    volume = bytearray((args.yardsticks / "cloud.vol").read_bytes())
    # Mitsuba's format: a head of 48 bytes with the numbers of voxels along x, y and z at 8, then the values, x fastest.
    nx, ny, nz = np.frombuffer(volume, "<i4", 3, 8)
    density = np.frombuffer(volume, "<f4", nx * ny * nz, 48).reshape(nz, ny, nx)
    density[np.unravel_index(nearest_peak(density), density.shape)] *= factor
    (args.yardsticks / f"{name}.vol").write_bytes(volume)
    text = (args.yardsticks / "cloud.pbrt").read_text()
    assert text.count("cloud.vol") == 1
    (args.yardsticks / f"{name}.pbrt").write_text(text.replace("cloud.vol", f"{name}.vol"))
    return name


def spike(args, peers):
    """Times with a spike over those without, renderers taking turns; the rest of their merits a spike leaves alone."""
    rounds, spp, factors = 3, {"mitsuba": 2, "woodcock": 128}, [1.0, *args.spike]
    ways = [(variant, integrator) for variant in VARIANTS for integrator in INTEGRATORS]
    if args.way:
        variant, integrator, _ = args.way.split(",")
        ways = [(variant, integrator)]
    else:
        # The way that is fastest without a spike, which leaves variance nearly alone.
        pilot = {way: peers[way[0]].render("cloud", way[1], 50, spp["mitsuba"], 7, args.spike_size)[1] for way in ways}
        ways = [min(pilot, key=pilot.get)]
    (variant, integrator), size = ways[0], args.spike_size
    scenes = {factor: spiked(args, factor) for factor in factors}
    times = {factor: ([], []) for factor in factors}
    means = {factor: ([], []) for factor in factors}
    for factor in factors:
        # Mitsuba takes longer to make a scene ready than to render it: its renderings of one scene follow one another.
        for seed in range(rounds):
            image, took = peers[variant].render("cloud", integrator, 50, spp["mitsuba"], seed, size, factor)
            times[factor][0].append(took)
            means[factor][0].append(image.mean())
            mean, _, took, _ = woodcock(args, scenes[factor], spp["woodcock"], seed, size)
            times[factor][1].append(took)
            means[factor][1].append(mean.mean())
    print(f"{variant} {integrator}, {size} x {size} pixels, {spp['mitsuba']} and {spp['woodcock']} samples; CPU ns a path, medians of {rounds}\n")
    print("| spike | Mitsuba | over none | woodcock | over none | mean of the image: Mitsuba | woodcock |\n|---|---|---|---|---|---|---|")
    for factor in factors:
        cells = []
        for which, renderer in enumerate(spp):
            median = np.median(times[factor][which])
            over = median / np.median(times[1.0][which])
            cells.append(f"{median * 1e9 / spp[renderer] / size**2:.0f} | {over:.2f}")
        cells += [f"{np.mean(m):.3f} +- {np.std(m, ddof=1) / rounds**0.5:.3f}" for m in means[factor]]
        print(f"| {factor:g} | {' | '.join(cells)} |", flush=True)


def main():
    args = arguments()
    if args.worker:
        worker(args.worker)
        return 0
    if not args.yardsticks or not args.woodcock or args.rounds < 3:
        print("--woodcock and --yardsticks are needed, and three rounds", file=sys.stderr)
        return 2
    sys.path.insert(0, str(HERE))
    args.out.mkdir(parents=True, exist_ok=True)
    peers = {variant: Mitsuba(args, variant) for variant in VARIANTS}
    if args.spike:
        spike(args, peers)
        fine = True
    else:
        print(f"{args.size} x {args.size} pixels, {args.rounds} rounds, {time.strftime('%F %R')}\n")
        columns = ["scene", "best of Mitsuba", "woodcock's kernel", "CPU s", "relMSE", "s x relMSE"]
        columns += ["Mitsuba's CPU s", "relMSE", "s x relMSE", "ratio", "target", "z of blocks, image, difference", "planted", "images"]
        print(f"| {' | '.join(columns)} |\n{'|---' * len(columns)}|")
        fine = all([compare(args, peers, scene) for scene in args.scenes])
    for peer in peers.values():
        peer.close()
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
