"""Whether a comparison tells the same on a machine that is busy.

    python benches/steady.py [springfit]

Ten runs of one comparison of six fits of tet4, on a machine that is otherwise idle in every second run and builds a crate in the others. The ratios
of the medians of processor time to those of the first fit are printed, and it is checked that fits whose medians differ by more than 10 % in some
run have the same order in all runs that do not call them a tie.
"""

import itertools
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
FITS = ["objective = ['frobenius', 'offdiag', 'spectral', 'divergence', 'van-gelder', 'exact']"]


def run(program, folder):
    """The summary of one run."""
    arguments = [program, "compare", "tet4", "--shapes", "200", *[a for fit in FITS for a in ("--fit", fit)], "--json", "--out", str(folder)]
    return json.loads(subprocess.run(arguments, check=True, capture_output=True, text=True).stdout)


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "target/release/springfit")
    runs = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for i in range(10):
            build = None
            if i % 2:
                command = ["cargo", "build", "--release", "--offline", "-p", "springfit-foundation", "--target-dir", str(folder / f"build{i}")]
                build = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            summary = run(program, folder / "out")
            was_building = build is not None and build.poll() is None
            if build is not None:
                build.kill()
                build.wait()
            runs.append(summary)
            times = {method["fit"]: method["times"]["fit"]["median"] for method in summary["cases"][0]["methods"]}
            first = next(iter(times.values()))
            load = "a build" if was_building else "idle"
            print(f"run {i + 1:2} {load:8}", "  ".join(f"{fit} {time / first:.3f}" for fit, time in times.items()), flush=True)
    wrong = 0
    names = [method["fit"] for method in runs[0]["cases"][0]["methods"]]
    for first, second in itertools.combinations(names, 2):
        pairs = [
            next(p for p in summary["pairs"] if p["quantity"] == "seconds fit" and (p["first"], p["second"]) == (first, second)) for summary in runs
        ]
        verdicts = [pair["verdict"] for pair in pairs]
        told = set(verdicts) - {"tie"}
        wrong += len(told) > 1
        print(f"{first} / {second}: ratios {min(p['ratio'] for p in pairs):.3f} to {max(p['ratio'] for p in pairs):.3f}, {dict((v, verdicts.count(v)) for v in sorted(set(verdicts)))}")
    print(f"{wrong} of {len(names) * (len(names) - 1) // 2} pairs have both orders")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
