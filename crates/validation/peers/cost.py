"""How the cost of a study grows: the disc and pad refined, with more scenes and with more samples.

    python3 cost.py SQUEAL FOLDER [WHAT...]

SQUEAL is the program; FOLDER keeps meshes, matrices and what was measured; each WHAT is PARTS:IN_CONTACT:SAMPLES:CHECKS, as 2:9,8:100:20:
each edge of the mesh in two parts, arrangements with nine and eight patches in contact, a hundred samples in each scene, twenty draws with
the whole brake. Needs CalculiX (ccx), by which cases/make.sh makes the matrices, and GNU time.

For each it runs `squeal cea`, which solves the whole brake at the medians; `squeal run` with one sample in each scene and nothing kept, which is
the preparation with its checks; and `squeal run` on the brake that is kept by then. Processor seconds and the largest memory are those of whole
commands, with reading and writing. Adds a line to FOLDER/cost.csv, and at the end prints all of them with the powers by which they grow, and draws FOLDER/cost.svg.
"""
import csv
import gzip
import json
import re
import shutil
import subprocess
import sys
from math import log, log10
from pathlib import Path

CASES = Path(__file__).resolve().parents[3] / "cases"
COMMANDS = {"cea": "squeal cea", "preparation": "preparation", "run": "samples, report"}
COLOURS = {"cea": "#0072b2", "preparation": "#d55e00", "run": "#009e73"}


def measured(*command):
    """Processor seconds and megabytes of a command."""
    done = subprocess.run(["/usr/bin/time", "-f", "%U %S %M", *map(str, command)], capture_output=True, text=True)
    *said, last = done.stderr.strip().splitlines()
    if done.returncode != 0:
        sys.exit("\n".join(said[-5:]))
    user, system, kilobytes = map(float, last.split())
    return round(user + system, 2), round(kilobytes / 1000)


def refined(folder, parts, in_contact, checks):
    """The case file of a refined disc and pad; its matrices are made where they are not there yet."""
    brake = folder / f"parts-{parts}"
    if not (brake / "disc-pad.sti.gz").exists():
        subprocess.run(["sh", CASES / "make.sh", CASES / "disc-pad", parts, brake], check=True)
    text = (brake / "disc-pad.toml").read_text()
    for field, value in (("in_contact", f"[{in_contact}]"), ("full_checks", checks)):
        text, count = re.subn(rf"^{field} = (\[[^]]*\]|\d+)", f"{field} = {value}", text, flags=re.M)
        assert count == 1, field
    file = brake / f"{in_contact.replace(',', '-')}.toml"
    file.write_text(text)
    return file


def line(squeal, folder, what):
    parts, in_contact, samples, checks = what.split(":")
    file = refined(folder, parts, in_contact, checks)
    out, cache = file.with_suffix(""), file.parent / ".squeal"
    shutil.rmtree(cache, ignore_errors=True)
    cost = {}
    for command, arguments in (("cea", ()), ("preparation", ("--samples", 1, "--out", out)), ("run", ("--samples", samples, "--out", out))):
        shutil.rmtree(out, ignore_errors=True)
        cost[f"{command}_s"], cost[f"{command}_mb"] = measured(squeal, "cea" if command == "cea" else "run", file, *arguments)
    manifest = json.loads((out / "manifest.json").read_text())
    face = (file.parent / "disc-pad.inp").read_text().split("NSET=PADFACE")[1].split("*")[0]
    checked = manifest["full_checks"]
    return {
        "what": what,
        "dofs": len(gzip.open(file.parent / "disc-pad.dof.gz").read().split()),
        "pairs": len(re.findall(r"\d+", face)),
        "scenes": manifest["analyses"] // manifest["samples"],
        "samples": samples,
        **cost,
        "modes": checked["modes"],
        "wrong": checked["missing"] + checked["invented"] + checked["other_verdicts"],
        "largest_distance": f"{checked['largest_distance']:.1e}",
    }


def power(of, by):
    """The power p of y ~ x^p through positive points, by least squares of logarithms."""
    points = [(log(x), log(y)) for x, y in zip(by, of)]
    mean_x, mean_y = (sum(axis) / len(points) for axis in zip(*points))
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, _ in points)


def of_meshes(lines):
    """Lines that differ by their mesh alone, those of the finest one."""
    finest = max(lines, key=lambda line: int(line["dofs"]))
    alike = [line for line in lines if (line["scenes"], line["samples"]) == (finest["scenes"], finest["samples"])]
    return sorted(alike, key=lambda line: int(line["dofs"]))


def figure(lines):
    """Processor time over degrees of freedom, both by their logarithms."""
    dofs = [int(line["dofs"]) for line in lines]
    values = [float(line[f"{command}_s"]) for line in lines for command in COMMANDS]
    low, high = (int(log10(min(values)) // 1), -int(-log10(max(values)) // 1))
    left, right = (log10(edge) for edge in (0.8 * dofs[0], 1.25 * dofs[-1]))
    x = lambda value: 70 + 400 * (log10(value) - left) / (right - left)
    y = lambda value: 290 - 270 * (log10(value) - low) / (high - low)
    out = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 640 340" font-family="sans-serif" font-size="12">']
    out.append('<rect width="640" height="340" fill="white"/>')
    for decade in range(low, high + 1):
        out.append(f'<path d="M70 {y(10.0**decade):.1f}H470" stroke="#ddd"/>')
        out.append(f'<text x="62" y="{y(10.0**decade) + 4:.1f}" text-anchor="end">{10.0**decade:g}</text>')
    for value in dofs:
        out.append(f'<path d="M{x(value):.1f} 20V290" stroke="#ddd"/>')
        out.append(f'<text x="{x(value):.1f}" y="307" text-anchor="middle">{value:,}</text>')
    out.append('<rect x="70" y="20" width="400" height="270" fill="none" stroke="#333"/>')
    out.append('<text x="270" y="329" text-anchor="middle">degrees of freedom</text>')
    out.append('<text x="16" y="155" text-anchor="middle" transform="rotate(-90 16 155)">processor time, s</text>')
    for command, name in COMMANDS.items():
        seconds = [float(line[f"{command}_s"]) for line in lines]
        points = " ".join(f"{x(a):.1f},{y(b):.1f}" for a, b in zip(dofs, seconds))
        out.append(f'<polyline points="{points}" fill="none" stroke="{COLOURS[command]}" stroke-width="2"/>')
        out += [f'<circle cx="{x(a):.1f}" cy="{y(b):.1f}" r="3.5" fill="{COLOURS[command]}"/>' for a, b in zip(dofs, seconds)]
        label = f"{name}, power {power(seconds, dofs):.1f}"
        out.append(f'<text x="{x(dofs[-1]) + 22:.1f}" y="{y(seconds[-1]) + 4:.1f}" fill="{COLOURS[command]}">{label}</text>')
    return "\n".join([*out, "</svg>", ""])


def main():
    squeal, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    table = folder / "cost.csv"
    lines = list(csv.DictReader(table.open())) if table.exists() else []
    for what in sys.argv[3:]:
        lines = [other for other in lines if other["what"] != what] + [line(squeal, folder, what)]
        with table.open("w", newline="") as file:
            writer = csv.DictWriter(file, lines[0].keys())
            writer.writeheader()
            writer.writerows(lines)
    names = list(lines[0].keys())
    print("| " + " | ".join(names) + " |\n| " + " | ".join("---:" for _ in names) + " |")
    for each in sorted(lines, key=lambda line: (int(line["dofs"]), int(line["scenes"]), int(line["samples"]))):
        print("| " + " | ".join(str(each[name]) for name in names) + " |")
    by_mesh = of_meshes(lines)
    if len(by_mesh) > 1:
        dofs = [int(each["dofs"]) for each in by_mesh]
        for name in (f"{command}_{unit}" for command in COMMANDS for unit in ("s", "mb")):
            print(f"{name} grows as the power {power([float(each[name]) for each in by_mesh], dofs):.2f} of the degrees of freedom")
        (folder / "cost.svg").write_text(figure(by_mesh))


main()
