"""How many points run in real time on this machine, by engine: a bar of tetrahedra of several sizes, moved by each program.

    pip install numpy mujoco newton          # those that are missing are left out, as are a C compiler and Node
    python exports/real_time.py              # 60 frames a second on one core; some minutes
    python exports/real_time.py --frames 30 --points 300,1000,3000 --engines xpbd,jolt,mujoco
    python exports/real_time.py --jolt FOLDER   # a folder in which `npm install jolt-physics@1.1.0` was run

The bar is 120 x 60 x 60 mm of 60 kPa with Poisson's ratio 0.45, held at one end. Its springs and volume springs have positive constants and the
lengths of the mesh (`divergence` with volume springs), so that every engine holds it. Each engine is run for a short and for a longer time, and the
difference of the processor times of both is that of the motion, without its start. A frame is 1/60 s. What is printed is the processor time of a
frame in ms, and the number of points at which it is as long as the frame: between two sizes by a power of the number of points, beyond them, which
is marked, by that of the last two.
"""
import argparse
import json
import math
import os
import platform
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SCENE = """
[mesh]
box = {{ element = "tet4", size = [0.12, 0.06, 0.06], cells = [{twice}, {n}, {n}] }}
[material]
young   = "60 kPa"
poisson = 0.45
density = 1060
[[fix]]
group = "xmin"
[[fit]]
name        = "positive"
objective   = "divergence"
springs     = ["all + volume"]
nonnegative = true
{motion}
"""
MOTION = """
[motion]
duration        = {seconds}
step            = "1/60 s"
gravity         = [0, 0, -1]
integrator      = "implicit-euler"
{keys}
finite_elements = false
account         = false
every           = {seconds}
"""


def loop(folder, seconds):
    """Symplectic Euler steps of the arrays of `export --to npz`, as a script of one's own would make them."""
    import numpy as np

    net = np.load(Path(folder) / "network.npz")
    x, masses, springs, k, rest = (net[name].copy() for name in ["points", "masses", "springs", "k", "rest"])
    volumes, k_volume, rest_volume = (net[name] for name in ["volumes", "k_volume", "rest_volume"])
    free = np.isnan(net["held"])
    n, v = len(x), np.zeros_like(x)
    step = float(net["dt_max"]) / 2
    places = np.concatenate([springs[:, 0], springs[:, 1], volumes.T.ravel()])
    for _ in range(round(seconds / step)):
        d = x[springs[:, 1]] - x[springs[:, 0]]
        length = np.sqrt(np.einsum("ij,ij->i", d, d))
        pull = (k * (1 - rest / length))[:, None] * d
        a, b, c = (x[volumes[:, i]] - x[volumes[:, 0]] for i in (1, 2, 3))
        g = [np.cross(b, c) / 6, np.cross(c, a) / 6, np.cross(a, b) / 6]
        push = -k_volume * (np.einsum("ij,ij->i", g[0], a) - rest_volume)
        g = [push[:, None] * part for part in [-(g[0] + g[1] + g[2]), *g]]
        forces = np.concatenate([pull, -pull, *g])
        total = np.stack([np.bincount(places, forces[:, axis], n) for axis in range(3)], axis=1)
        v = free * (v + step * (total / masses[:, None] + net["gravity"]))
        x += step * v
    assert np.isfinite(x).all(), "the loop diverges"


def processor(command, folder, seconds=600):
    """Processor time of a command, s; raises an error where it fails."""
    one = {name: "1" for name in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"]}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True, timeout=seconds, env=os.environ | one)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    # A script that ends with 1 has cells that are inside out, or does not come to rest: its time is that of the motion.
    if done.returncode not in (0, 1) or "Error" in done.stderr:
        raise RuntimeError((done.stderr.strip().splitlines() or ["no message"])[-1])
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


class Engine:
    """What moves the bar, and in which setting; `command` is that of a motion of some seconds, in the folder of its export."""

    def __init__(self, name, setting, target, command, first=0.1, prepare=None):
        self.name, self.setting, self.target, self.command, self.first, self.prepare = name, setting, target, command, first, prepare


def frame(engine, network, arguments, frames):
    """Processor time of a frame, s, or the reason why there is none."""
    folder = network.parent / f"{network.stem}-{engine.name.replace(' ', '-')}"
    if engine.target:
        subprocess.run([arguments.springfit, "export", network, "--to", engine.target, "--gravity", "0 0 -1", "--out", folder, "-q"], check=True, capture_output=True)
    else:
        folder.mkdir()
    if engine.prepare:
        engine.prepare(folder)
    # The first run compiles what is compiled once.
    processor(engine.command(folder, engine.first), folder)
    start = processor(engine.command(folder, engine.first), folder)
    more = engine.first
    while True:
        more *= 3
        longer = processor(engine.command(folder, engine.first + more), folder)
        # Long enough beside what the start takes, which differs from run to run.
        if longer - start > max(0.3, 0.5 * start) or more > 30:
            return (longer - start) / more / frames


def engines(arguments):
    python, substeps = sys.executable, arguments.substeps
    compiler = next((c for c in ["cc", "gcc", "clang"] if shutil.which(c)), None)
    found = []
    if compiler:
        def build(flags):
            return lambda folder: subprocess.run([compiler, *flags, "-o", "run", "run.c", "-lm"], cwd=folder, check=True)

        def run(folder, seconds):
            return ["./run", seconds, "--substeps", substeps]

        found.append(Engine("XPBD in C", f"run.c of --to xpbd, {substeps} substeps of one sweep, double", "xpbd", run, 0.5, build(["-O2"])))
        found.append(Engine("XPBD in C, single", "the same with -O3 -DREAL=float", "xpbd", run, 0.5, build(["-O3", "-DREAL=float"])))
    found.append(Engine("XPBD in NumPy", f"run.py of --to xpbd, {substeps} substeps", "xpbd", lambda _, s: [python, "run.py", s, "--substeps", substeps]))
    if arguments.jolt and shutil.which("node"):
        link = lambda folder: (folder / "node_modules").symlink_to(Path(arguments.jolt).resolve() / "node_modules")
        found.append(Engine("Jolt", f"WebAssembly in Node, {substeps} substeps", "jolt", lambda _, s: ["node", "run.mjs", s, "--substeps", substeps], 0.5, link))
    for name, module, setting in [("MuJoCo", "mujoco", "a step of 2 ms, implicit"), ("Newton", "newton", "semi-implicit steps as the script chooses, on the CPU")]:
        if subprocess.run([python, "-c", f"import {module}"], capture_output=True).returncode == 0:
            found.append(Engine(name, setting, module, lambda _, s: [python, "run.py", s], 0.02))
    found.append(Engine("NumPy", "arrays of --to npz, explicit steps of half the longest", "npz", lambda folder, s: [python, Path(__file__).resolve(), "--loop", folder, s], 0.02))

    def motion(keys):
        def run(folder, seconds):
            n = int(folder.parent.name)
            (folder / "scene.toml").write_text(SCENE.format(n=n, twice=2 * n, motion=MOTION.format(seconds=seconds, keys=keys)))
            return [arguments.springfit, "run", "scene.toml", "--out", "out", "-q"]

        return run

    found.append(Engine("[motion] linearised", "springfit run, implicit Euler of 1/60 s, one iteration", None, motion("iterations = 1"), 0.1))
    found.append(Engine("[motion] linear", "springfit run, implicit Euler of 1/60 s, linear = true", None, motion("linear = true"), 0.1))
    return found


def at_real_time(points, times, frame_time):
    """The number of points at which a frame takes its own time, and whether it is beyond the sizes that were measured."""
    pairs = list(zip(points, times))
    if len(pairs) < 2:
        return None, True
    k = next((i for i in range(1, len(pairs)) if pairs[i][1] > frame_time), len(pairs) - 1)
    (a, s), (b, t) = pairs[k - 1], pairs[k]
    power = math.log(max(t, 1e-12) / max(s, 1e-12)) / math.log(b / a)
    power = min(max(power, 0.5), 3.0)
    return b * (frame_time / t) ** (1 / power), not s <= frame_time <= t


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--springfit", default=shutil.which("springfit") or "springfit")
    arguments.add_argument("--frames", type=float, default=60, help="frames a second")
    arguments.add_argument("--substeps", type=int, default=10, help="of XPBD and Jolt")
    arguments.add_argument("--points", default="225,637,1377,4225,9537", help="about so many, in order")
    arguments.add_argument("--engines", help="names or beginnings of names, separated by commas")
    arguments.add_argument("--jolt", help="a folder with node_modules/jolt-physics")
    arguments.add_argument("--loop", nargs=2, help=argparse.SUPPRESS)
    arguments = arguments.parse_args()
    if arguments.loop:
        return loop(arguments.loop[0], float(arguments.loop[1]))
    arguments.springfit = str(Path(arguments.springfit).resolve()) if Path(arguments.springfit).exists() else arguments.springfit
    chosen = [word.strip().lower() for word in (arguments.engines or "").split(",") if word.strip()]
    wanted = [engine for engine in engines(arguments) if not chosen or any(engine.name.lower().startswith(word) for word in chosen)]
    if not wanted:
        sys.exit(f"error: --engines: expected names of engines that are there ({', '.join(e.name for e in engines(arguments))}), found none in \"{arguments.engines}\"")
    sizes = [max(2, round((int(p) / 2) ** (1 / 3) - 0.75)) for p in arguments.points.split(",")]
    times = {engine.name: {} for engine in wanted}
    with tempfile.TemporaryDirectory() as work:
        points = []
        for n in sizes:
            folder = Path(work) / str(n)
            folder.mkdir()
            (folder / "bar.toml").write_text(SCENE.format(n=n, twice=2 * n, motion=""))
            subprocess.run([arguments.springfit, "run", "bar.toml", "--out", "out", "-q"], cwd=folder, check=True, capture_output=True)
            network = folder / "bar.json"
            shutil.move(folder / "out" / "positive.json", network)
            points.append(len(json.loads(network.read_text())["points"]))
            for engine in wanted:
                # An engine that is far too slow at one size is not asked for the next.
                if times[engine.name] and max(times[engine.name].values()) > 6 / arguments.frames:
                    continue
                try:
                    times[engine.name][points[-1]] = frame(engine, network, arguments, arguments.frames)
                except (RuntimeError, subprocess.SubprocessError) as problem:
                    print(f"note: {engine.name}: {problem}", file=sys.stderr)
    print(f"{cpu()}, one core; ms of processor time for a frame of 1/{arguments.frames:g} s\n")
    heads = ["engine", *[f"{n} points" for n in points], f"points at {arguments.frames:g} Hz", "setting"]
    rows = []
    for engine in wanted:
        own = times[engine.name]
        count, is_beyond = at_real_time(list(own), list(own.values()), 1 / arguments.frames)
        about = "–" if count is None else f"{'about ' if is_beyond else ''}{float(f'{count:.2g}'):.0f}"
        rows.append([engine.name, *[f"{1e3 * own[n]:.2f}" if n in own else "–" for n in points], about, engine.setting])
    print("| " + " | ".join(heads) + " |\n" + "|---" * len(heads) + "|")
    print("\n".join("| " + " | ".join(row) + " |" for row in rows))


def cpu():
    """The processor, by its name."""
    try:
        names = [line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")]
    except OSError:
        names = []
    return (names or [platform.processor() or platform.machine()])[0]


if __name__ == "__main__":
    main()
