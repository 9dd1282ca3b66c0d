"""A bar for each body: the energy beside finite elements of the same mesh."""
from table import LOADS

SHADES = ["#22577a", "#c7703c", "#5b8c5a", "#8a6bb0"]
HEIGHT, LEFT, RIGHT, SCALE = 9, 370, 40, 4.0  # of a bar, margins, and units per percent
MOST = 60  # percent


def svg(record):
    groups = {}
    for row in record["rows"]:
        groups.setdefault(f"{row['engine']} {row['solver']}, {row['model'].replace(' nu ', ' ν ')}, ν = {row['poisson']}", {})[row["load"]] = row
    groups = {name: rows for name, rows in groups.items() if "classical" not in name and "length" not in name}
    width, zero = LEFT + 2 * 20 * SCALE + MOST * SCALE + RIGHT, LEFT + 20 * SCALE
    height = 60 + len(groups) * (4 * HEIGHT + 10)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height}" font-family="sans-serif" font-size="11">',
        f'<rect width="{width:g}" height="{height}" fill="white"/>',
    ]
    for i, load in enumerate(LOADS):
        parts.append(f'<rect x="{LEFT + 90 * i}" y="8" width="10" height="10" fill="{SHADES[i]}"/>')
        parts.append(f'<text x="{LEFT + 14 + 90 * i}" y="17">{load}</text>')
    for percent in range(-20, MOST + 1, 20):
        x = zero + percent * SCALE
        parts.append(f'<line x1="{x:g}" x2="{x:g}" y1="38" y2="{height - 10}" stroke="{"#444" if percent == 0 else "#ddd"}"/>')
        parts.append(f'<text x="{x:g}" y="34" text-anchor="middle">{percent:+d} %</text>'.replace("+0", "0"))
    y = 44
    for name, rows in groups.items():
        parts.append(f'<text x="{LEFT - 10}" y="{y + 2 * HEIGHT + 4}" text-anchor="end">{name}</text>')
        for i, load in enumerate(LOADS):
            parts += bar(rows.get(load), zero, y + i * HEIGHT, SHADES[i])
        y += 4 * HEIGHT + 10
    return "\n".join([*parts, "</svg>"]) + "\n"


def bar(row, zero, y, shade):
    if row is None:
        return []
    if not row["at_rest"]:
        return [f'<text x="{zero + 4:g}" y="{y + HEIGHT - 1}" font-size="8" fill="{shade}">not at rest</text>']
    percent = row["energy_percent"]
    shown = max(-20.0, min(percent, MOST)) * SCALE
    parts = [f'<rect x="{zero + min(shown, 0):.2f}" y="{y}" width="{max(abs(shown), 0.8):.2f}" height="{HEIGHT - 1}" fill="{shade}"/>']
    if shown != percent * SCALE:
        parts.append(f'<text x="{zero + max(shown, 0) + 3:.2f}" y="{y + HEIGHT - 1}" font-size="8">{percent:+.0f} %</text>')
    return parts
