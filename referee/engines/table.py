"""Rows as lines and as tables in Markdown."""

LOADS = ["tension", "shear", "torsion", "bending"]


def number(row, key):
    # Adding zero makes a zero of a negative one.
    return f"{round(row[key], 1) + 0.0:+.1f}".replace("-", "−").replace("+0.0", "0.0") if key in row else "not at rest"


def line(row):
    words = [row["engine"], row["solver"], row["model"], f"nu {row['poisson']}", row["load"]]
    keys = {"model": "of_model_percent", "tip": "tip_percent", "energy": "energy_percent", "truth": "truth_percent"}
    found = ", ".join(f"{name} {row[key]:+.2f} %" for name, key in keys.items()) if row["at_rest"] else "not at rest"
    return f"{', '.join(words)}: {found} ({row['seconds']:.1f} s)"


def by_load(record, key, title, models):
    """A table with a column for each load."""
    lines = [f"| {title} | solver | ν | {' | '.join(LOADS)} |", "|---|---|---|" + "---|" * len(LOADS)]
    groups = {}
    for row in record["rows"]:
        if models(row["model"]):
            groups.setdefault((row["engine"], row["solver"], row["model"], row["poisson"]), {})[row["load"]] = row
    for (engine, solver, model, poisson), loads in groups.items():
        cells = [number(loads[load], key) if load in loads else "–" for load in LOADS]
        lines.append(f"| {engine}, {model} | {solver} | {poisson} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def repairs(record):
    lines = ["| engine | solver | ν | factor of E by tension | derived: factor of E | and ν |", "|---|---|---|---|---|---|"]
    for entry in record["maps"]:
        derived = entry["derived"]
        cells = [f"{derived['factor']:.3f}", f"{derived['poisson']:.3f}"] if derived else ["–", "–"]
        lines.append(f"| {entry['engine']} | {entry['solver']} | {entry['poisson']} | {entry['factor']:.3f} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def truth(record):
    """How far the finite elements of the mesh are from the truth."""
    lines = ["| finite elements of the mesh | ν | energy, % of the truth | the truth is uncertain by, % |", "|---|---|---|---|"]
    seen = {}
    for row in record["rows"]:
        seen[row["load"], row["poisson"]] = row
    for load, poisson in sorted(seen, key=lambda key: (key[1], LOADS.index(key[0]))):
        row = seen[load, poisson]
        error = 100 * (row["energy_of_finite_elements_J"] / row["truth_J"] - 1)
        lines.append(f"| {load} | {poisson} | {error:+.1f} | {row['truth_uncertainty_percent']:.1f} |".replace("-", "−", 1))
    return "\n".join(lines) + "\n"


def page(record):
    own = lambda model: model.startswith("own")
    every = lambda model: True
    springs = lambda model: not own(model)
    parts = [
        ", ".join(f"{name} {version}" for name, version in record["versions"].items()) + "\n",
        "## Own elements: energy beside finite elements of the same mesh, %\n\n" + by_load(record, "energy_percent", "", own),
        "## Own elements: tip beside finite elements of the same mesh, %\n\n" + by_load(record, "tip_percent", "", own),
        "## Repair\n\n" + repairs(record),
        "## Springs: energy beside the equilibrium of the network itself, %\n\n" + by_load(record, "of_model_percent", "", springs),
        "## Springs: energy beside finite elements of the same mesh, %\n\n" + by_load(record, "energy_percent", "", springs),
        "## Energy beside the truth, %\n\n" + by_load(record, "truth_percent", "", every),
        "## The mesh\n\n" + truth(record),
    ]
    return "\n".join(parts)
