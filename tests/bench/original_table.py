#!/usr/bin/env python3
"""The evaluation of the original ray tracer, again: six scenes, 500 x 500 pixels, 200 samples per pixel.

Columns
  distributed   accelerator list, BSDF sampling only, emission where a ray hits it (integrator simplevolpath)
  bvh           the same with accelerator bvh: the same picture bit for bit, which is checked
  bvh-mc        accelerator bvh, integrator mixture: half of the directions from the BSDF, half towards lights
  production    Embree, integrator volpath, the scene's own sampler
  farm          production over two worker processes of one thread (`tessera render`): checked to be its picture

The first three draw independent random numbers, as the original did. Roulette is in `production` and `farm` alone;
the depth limit is the scene's in all columns.

relMSE is the mean over R, G and B of (a - r)(a - s) / (((r + s) / 2)^2 + 0.01), with two independent references r and s,
so that their noise does not count; `relMSE trimmed` leaves out the largest 0.1 % of values. The references of the first
three columns are made by volpath, those of the other two by mixture: always by another estimator. Efficiency is
1 / (relMSE x CPU seconds). The time to the first column's relMSE takes errors to fall as 1 / samples.

A cell that would take longer than --run-seconds is measured with fewer samples, its times and rays multiplied, its relMSE
divided, and is marked so. What the farm's processes take to start, load and write is measured with one sample per pixel
and is not multiplied.

Usage: original_table.py [--quick] [--bin DIR] [--out DIR] [--scenes NAME ...]
On two cores the whole table takes some four hours, at most 6 x (4 x --reference-seconds + 5 x --runs x --run-seconds).
Writes DIR/original_table.md, DIR/original_table.csv (cells) and DIR/original_table_runs.csv (every run).
"""

import argparse
import csv
import datetime
import hashlib
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ["earth", "perlin-spheres", "emissive-light", "cornell-box", "materials", "final"]
ORIGINAL_SECONDS = {  # as reported in 2020, on a machine that was not named
    "earth": (59, 55, 51), "perlin-spheres": (121, 107, 95), "emissive-light": (98, 93, 64),
    "cornell-box": (456, 398, 332), "materials": (1014, 928, 645), "final": (863, 736, 482)}
COLUMNS = {  # accelerator, integrator, sampler: "independent" or the scene's own (None)
    "distributed": ("list", "simplevolpath", "independent"),
    "bvh": ("bvh", "simplevolpath", "independent"),
    "bvh-mc": ("bvh", "mixture", "independent"),
    "production": ("embree", "volpath", None),
    "farm": ("embree", "volpath", None)}
PILOT_SPP = 1           # to estimate how long a cell takes, and to warm the file cache
SPP_MIN = 1             # of a cell that is too slow to run whole
SEED_OF_REFERENCES = 1000


class Unavailable(Exception):
    """What was asked for does not run here; says why."""


class Bench:
    """Runs the programs of one build on copies of the scenes with the samplers that the columns ask for."""

    def __init__(self, options):
        self.options = options
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="original-table-"))
        for sampler in ("own", "independent"):
            target = self.folder / sampler
            shutil.copytree(ROOT / "tests/scenes/original", target)
            if sampler == "own":
                continue
            for scene in target.glob("*.pbrt"):
                text = scene.read_text(encoding="utf-8")
                text, count = re.subn(r'(?m)^Sampler "\w+"', f'Sampler "{sampler}"', text)
                assert count == 1, f"{scene.name}: expected one Sampler directive"
                scene.write_text(text, encoding="utf-8")

    def close(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def scene(self, name, sampler):
        return str(self.folder / (sampler or "own") / f"{name}.pbrt")

    def run(self, name, column, spp, seed, references=None, picture=None):
        """One run of scene_bench: its JSON."""
        accelerator, integrator, sampler = column
        target = self.scene(name, sampler)
        if references:
            target += "=" + ",".join(map(str, references))
        command = [str(self.options.bin / "scene_bench"), "--json", "--spp", str(spp), "--first-seed", str(seed),
                   "--threads", str(self.options.threads), "--width", str(self.options.size), "--height",
                   str(self.options.size), "--accelerator", accelerator, "--integrator", integrator]
        if picture:
            command += ["--write", str(picture)]
        done = subprocess.run(command + [target], capture_output=True, text=True)
        if done.returncode != 0:
            raise Unavailable((done.stderr or done.stdout).strip().splitlines()[-1])
        return json.loads(done.stdout)

    def farm(self, name, spp, seed, picture):
        """One run of the farm: wall and CPU seconds of the command and all its processes."""
        command = [str(self.options.bin / "tessera"), "render", self.scene(name, None), "-o", str(picture), "--workers", "2",
                   "--threads", "1", "--spp", str(spp), "--seed", str(seed), "--resolution",
                   f"{self.options.size}x{self.options.size}", "--exr-type", "float", "--integrator", "volpath"]
        start = time.monotonic()
        try:
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        except OSError as error:
            raise Unavailable(f"{command[0]}: {error.strerror}") from error
        messages = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            raise Unavailable((messages.strip().splitlines() or ["tessera render failed"])[-1])
        return {"wall_s": time.monotonic() - start, "cpu_s": usage.ru_utime + usage.ru_stime}


def same_values(bench, a, b):
    """Whether two pictures have the same bits; their headers differ."""
    done = subprocess.run([str(bench.options.bin / "tessera"), "compare", str(a), str(b)], capture_output=True, text=True)
    if "identical=" in done.stdout:
        return "identical=yes" in done.stdout
    raise Unavailable((done.stderr or done.stdout).strip())


def file_digest(path):
    return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()


def power_of_two_below(n):
    return 1 << max(0, int(n).bit_length() - 1)


def affordable_spp(bench, name, column, seconds, spp):
    """The samples per pixel, at most spp, that a run of this many wall seconds affords."""
    pilot = bench.run(name, column, PILOT_SPP, 0)
    if pilot["wall_s"] / PILOT_SPP * spp <= seconds:
        return spp
    return max(SPP_MIN, power_of_two_below(seconds * PILOT_SPP / pilot["wall_s"]))


def make_references(bench, name, integrator):
    """Two independent pictures by one estimator."""
    column = ("embree", integrator, None)
    seconds = bench.options.reference_seconds
    spp = power_of_two_below(affordable_spp(bench, name, column, seconds, bench.options.reference_spp))
    paths = []
    for i in range(2):
        path = bench.folder / f"{name}-{integrator}-{i}.exr"
        bench.run(name, column, spp, SEED_OF_REFERENCES + i, picture=path)
        paths.append(path)
    return {"paths": paths, "spp": spp, "integrator": integrator}


def measure_cell(bench, name, column_name, references):
    """All runs of a cell, scaled to the full number of samples."""
    column, full = COLUMNS[column_name], bench.options.spp
    spp = affordable_spp(bench, name, column, bench.options.run_seconds, full)
    runs = []
    picture = bench.folder / f"{name}-{column_name}.exr"
    for i in range(bench.options.runs):
        load_before = os.getloadavg()[0]
        run = bench.run(name, column, spp, i, references["paths"], picture if i == 0 else None)
        run.update(seed=i, measured_spp=spp, load_before=load_before, load_after=os.getloadavg()[0])
        runs.append(run)
    return {"runs": runs, "spp": spp, "scale": full / spp, "picture": picture, "reference": references}


def measure_farm(bench, name, production):
    """The farm's cell: its own times; everything else is production's if the pictures agree."""
    runs = []
    picture = bench.folder / f"{name}-farm.exr"
    once = [bench.farm(name, PILOT_SPP, i, picture) for i in range(bench.options.runs)]
    fixed = {key: fixed_cost([run[key] for run in once], [run[key] for run in production["runs"]], production["spp"])
             for key in ("wall_s", "cpu_s")}
    for i in range(bench.options.runs):
        load_before = os.getloadavg()[0]
        timing = bench.farm(name, production["spp"], i, picture)
        if i == 0 and not same_values(bench, picture, production["picture"]):
            raise Unavailable("the farm's picture is not production's")
        runs.append(dict(production["runs"][i], **timing, load_before=load_before, load_after=os.getloadavg()[0]))
    return dict(production, runs=runs, picture=picture, fixed=fixed)


def fixed_cost(pilots, production, spp):
    """Of a farm's run, from runs with PILOT_SPP: without what production takes for so many samples."""
    return max(0.0, statistics.median(pilots) - statistics.median(production) / spp * PILOT_SPP)


def summarize(cell):
    """Medians over runs of times, means over runs (which are independent samples) of errors."""
    runs, scale = cell["runs"], cell["scale"]
    summary = {"spp": cell["spp"], "scale": scale, "runs": len(runs)}
    for key in ("cpu_s", "wall_s"):
        fixed = cell.get("fixed", {}).get(key, 0.0)
        values = [max(0.0, run[key] - fixed) * scale + fixed for run in runs]
        summary[key] = statistics.median(values)
        summary[key + "_min"], summary[key + "_max"] = min(values), max(values)
    for key in ("camera_rays", "bounce_rays", "shadow_rays"):
        summary[key] = statistics.mean(run[key] for run in runs) * scale
    for key in ("relmse", "relmse_trimmed"):
        summary[key] = statistics.mean(run[key] for run in runs) / scale
    summary["relmse_spread"] = statistics.stdev(run["relmse"] for run in runs) / scale if len(runs) > 1 else 0.0
    summary["build_s"] = statistics.median(run["build_s"] for run in runs)
    summary["load_cpu_s"] = statistics.median(run["load_cpu_s"] for run in runs)
    summary["discarded_samples"] = sum(run["discarded_samples"] for run in runs)
    summary["relmse_reference"] = runs[0]["relmse_reference"]
    summary["reference"] = f'{cell["reference"]["integrator"]}, 2 x {cell["reference"]["spp"]} spp'
    product = summary["relmse"] * summary["cpu_s"]
    summary["efficiency"] = 1 / product if product > 0 else float("nan")
    return summary


def measure_scene(bench, name, log):
    """Cells by column: a summary, or the reason why there is none."""
    log(f"{name}: references")
    by_volpath = make_references(bench, name, "volpath")
    by_mixture = make_references(bench, name, "mixture")
    cells, raw = {}, {}
    for column_name in COLUMNS:
        log(f"{name}: {column_name}")
        references = by_volpath if column_name in ("distributed", "bvh", "bvh-mc") else by_mixture
        try:
            if column_name == "farm":
                if "production" not in raw:
                    raise Unavailable("there is no production picture to compare with")
                raw[column_name] = measure_farm(bench, name, raw["production"])
            else:
                raw[column_name] = measure_cell(bench, name, column_name, references)
            cells[column_name] = summarize(raw[column_name])
        except Unavailable as reason:
            cells[column_name] = {"unavailable": str(reason)}
    check_same_picture(bench, name, cells, raw)
    first = cells.get("distributed", {})
    if "unavailable" in first:
        first = cells.get("bvh", {})  # the same error
    for cell in cells.values():
        if "relmse" in cell and first.get("relmse", 0) > 0:
            cell["cpu_s_to_first_relmse"] = cell["cpu_s"] * cell["relmse"] / first["relmse"]
            cell["wall_s_to_first_relmse"] = cell["wall_s"] * cell["relmse"] / first["relmse"]
    return cells, raw


def check_same_picture(bench, name, cells, raw):
    """distributed and bvh, at the samples that the first can afford. Where they agree and the first was measured on
    fewer samples, its relMSE is bvh's, which was not."""
    if "distributed" not in raw or "bvh" not in raw:
        return
    spp = raw["distributed"]["spp"]
    other = raw["bvh"]["picture"]
    if raw["bvh"]["spp"] != spp:
        other = bench.folder / f"{name}-bvh-check.exr"
        bench.run(name, COLUMNS["bvh"], spp, 0, picture=other)
    same = file_digest(raw["distributed"]["picture"]) == file_digest(other)
    if not same:
        same = same_values(bench, raw["distributed"]["picture"], other)
    cells["bvh"]["same_picture"] = "yes" if same else "NO"
    if same and raw["distributed"]["spp"] < raw["bvh"]["spp"]:
        for key in ("relmse", "relmse_trimmed", "relmse_spread"):
            cells["distributed"][key] = cells["bvh"][key]
        cells["distributed"]["efficiency"] = 1 / (cells["distributed"]["relmse"] * cells["distributed"]["cpu_s"])


# ---- What was measured on what -----------------------------------------------------------------------------------------


def output_of(*command):
    try:
        return subprocess.run(command, capture_output=True, text=True, cwd=ROOT).stdout.strip()
    except OSError:
        return ""


def describe_machine(options):
    cpu = re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8"))
    cache = options.bin.parent / "CMakeCache.txt"
    settings = dict(re.findall(r"(?m)^(CMAKE_\w+):\w+=(.*)$", cache.read_text(encoding="utf-8"))) if cache.exists() else {}
    compiler = settings.get("CMAKE_CXX_COMPILER", "c++")
    changed = [line for line in output_of("git", "status", "--porcelain", "--untracked-files=no").splitlines() if line]
    return {
        "date": datetime.date.today().isoformat(),
        "processor": f"{cpu.group(1) if cpu else 'unknown'}, {os.cpu_count()} logical cores",
        "system": f"{os.uname().sysname} {os.uname().release}",
        "compiler": (output_of(compiler, "--version").splitlines() or ["unknown"])[0],
        "build": f"{settings.get('CMAKE_BUILD_TYPE', '?')}, {settings.get('CMAKE_CXX_FLAGS_RELEASE', '')} "
                 "-march=x86-64-v3 -ffp-contract=off".strip(),
        "commit": output_of("git", "rev-parse", "HEAD") + (f", {len(changed)} files changed since" if changed else ""),
        "command": " ".join(["tests/bench/original_table.py"] + sys.argv[1:]),
        "threads": str(options.threads),
        "load average before": f"{os.getloadavg()[0]:.2f}",
    }


# ---- Output ------------------------------------------------------------------------------------------------------------------


def number(value, digits=3):
    return f"{value:.{digits}g}" if abs(value) < 1e5 else f"{value:.{digits - 1}e}"


def seconds_text(cell, key):
    mark = "" if cell["scale"] == 1 else "\\*"
    digits = 1 if cell[key] >= 1 else 3
    spread = f' ({cell[key + "_min"]:.{digits}f}–{cell[key + "_max"]:.{digits}f})' if cell["runs"] > 1 else ""
    return f"{cell[key]:.{digits}f}{spread}{mark}"


def matrix(results, text):
    """A Markdown table of scenes by columns."""
    lines = ["| scene | " + " | ".join(COLUMNS) + " |", "|---" * (len(COLUMNS) + 1) + "|"]
    for scene, cells in results.items():
        row = ["–" if "unavailable" in cells[column] else text(cells[column]) for column in COLUMNS]
        lines.append(f"| {scene} | " + " | ".join(row) + " |")
    return "\n".join(lines) + "\n"


def detail(results):
    lines = ["| scene | column | measured spp | camera M | bounce M | shadow M | M rays/CPU s | load CPU s | build s "
             "| relMSE trimmed | reference | its relMSE |", "|---" * 12 + "|"]
    for scene, cells in results.items():
        for column, cell in cells.items():
            if "unavailable" in cell:
                lines.append(f"| {scene} | {column} | not measured: {cell['unavailable']} " + "| " * 9 + "|")
                continue
            rays = [cell[kind + "_rays"] / 1e6 for kind in ("camera", "bounce", "shadow")]
            lines.append(
                f"| {scene} | {column} | {cell['spp']} | " + " | ".join(f"{value:.1f}" for value in rays) +
                f" | {sum(rays) / cell['cpu_s']:.2f} | {cell['load_cpu_s']:.2f} | {cell['build_s']:.4f} | "
                f"{number(cell['relmse_trimmed'])} | {cell['reference']} | {number(cell['relmse_reference'], 2)} |")
    return "\n".join(lines) + "\n"


def original_table(scenes):
    lines = ["| scene | distributed | BVH | BVH + Monte Carlo |", "|---|---|---|---|"]
    for scene in scenes:
        lines.append(f"| {scene} | " + " | ".join(f"{seconds} s" for seconds in ORIGINAL_SECONDS[scene]) + " |")
    return "\n".join(lines) + "\n"


def speedup(results):
    lines = ["| scene | CPU s of distributed | CPU s of production to the same relMSE | ratio |", "|---|---|---|---|"]
    for scene, cells in results.items():
        first, production = cells["distributed"], cells["production"]
        if "unavailable" in first or "cpu_s_to_first_relmse" not in production:
            lines.append(f"| {scene} | – | – | – |")
            continue
        needed = production["cpu_s_to_first_relmse"]
        ratio = f"{first['cpu_s'] / needed:.0f}" if needed > 0 else "–"
        lines.append(f"| {scene} | {first['cpu_s']:.1f} | {needed:.3g} | {ratio} |")
    return "\n".join(lines) + "\n"


def write_markdown(results, machine, options, path):
    same = [f"{scene}: {cells['bvh'].get('same_picture', 'not compared')}" for scene, cells in results.items()]
    text = f"""# The original ray tracer's evaluation, by Tessera

{options.size} x {options.size} pixels, {options.spp} samples per pixel, {options.runs} run{"s (median, least and greatest)" if options.runs > 1 else ""}.
{chr(10).join(f'- {key}: {value}' for key, value in machine.items())}

What the columns are, and how errors are measured, is said in `tests/bench/original_table.py`. Numbers with a star were
measured with fewer samples (see *Details*) and scaled. `distributed` here means classic distributed ray tracing, not
rendering on several machines: that is `farm`, which on one machine measures overhead, and whose wall seconds hold
starting, loading and writing.

## Wall seconds
{matrix(results, lambda cell: seconds_text(cell, 'wall_s'))}
## CPU seconds
{matrix(results, lambda cell: seconds_text(cell, 'cpu_s'))}
## relMSE (± standard deviation over runs)
{matrix(results, lambda cell: f"{number(cell['relmse'])} ± {number(cell['relmse_spread'], 2)}")}
## Efficiency: 1 / (relMSE x CPU seconds)
{matrix(results, lambda cell: number(cell['efficiency']))}
## CPU seconds to the relMSE of the first column
{matrix(results, lambda cell: number(cell['cpu_s_to_first_relmse']) if 'cpu_s_to_first_relmse' in cell else '–')}
## Production against distributed, at equal error
{speedup(results)}
## Is the picture of `bvh` that of `distributed`, bit for bit?
{'; '.join(same)}.

## Details
{detail(results)}
## For comparison: what the original reported
Its own seconds for the whole picture, on a machine that it does not name.

{original_table(results)}"""
    path.write_text(text, encoding="utf-8")


def write_cells(results, path):
    keys = sorted({key for cells in results.values() for cell in cells.values() for key in cell})
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, ["scene", "column"] + keys)
        writer.writeheader()
        for scene, cells in results.items():
            for column, cell in cells.items():
                writer.writerow(dict(cell, scene=scene, column=column))


def write_runs(runs, machine, path):
    keys = sorted({key for run in runs for key in run} - {"table_scene", "column"})
    with path.open("w", newline="", encoding="utf-8") as file:
        for key, value in machine.items():
            file.write(f"# {key}: {value}\n")
        writer = csv.DictWriter(file, ["table_scene", "column"] + keys)
        writer.writeheader()
        writer.writerows(runs)


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin", help="where the programs are")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build/original_table", help="where the tables go")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=SCENES)
    parser.add_argument("--size", type=int, default=500, help="pixels along each side")
    parser.add_argument("--spp", type=int, default=200)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--threads", type=int, default=2, help="of all columns but farm, which has 2 workers of 1")
    parser.add_argument("--run-seconds", type=float, default=200, help="wall seconds that one run may take")
    parser.add_argument("--reference-spp", type=int, default=16384, help="at most")
    parser.add_argument("--reference-seconds", type=float, default=400, help="wall seconds for one of four references")
    parser.add_argument("--quick", action="store_true", help="small pictures, one run: to see that all works")
    options = parser.parse_args()
    if options.quick:
        options.size, options.spp, options.runs = 64, 16, 1
        options.run_seconds, options.reference_spp, options.reference_seconds = 5, 256, 5
    options.bin = options.bin.resolve()
    return options


def main():
    options = parse_options()
    start = time.monotonic()

    def log(text):
        print(f"[{time.monotonic() - start:7.1f} s] {text}", file=sys.stderr, flush=True)

    machine = describe_machine(options)
    options.out.mkdir(parents=True, exist_ok=True)
    bench = Bench(options)
    results, runs = {}, []
    try:
        for name in options.scenes:
            results[name], raw = measure_scene(bench, name, log)
            for column, cell in raw.items():
                runs += [dict(run, table_scene=name, column=column) for run in cell["runs"]]
            machine["load average after"] = f"{os.getloadavg()[0]:.2f}"
            write_markdown(results, machine, options, options.out / "original_table.md")  # after each scene
            write_cells(results, options.out / "original_table.csv")
            write_runs(runs, machine, options.out / "original_table_runs.csv")
    except Unavailable as reason:
        log(str(reason))
        return 1
    finally:
        bench.close()
    log(f"written to {options.out}")
    broken = [scene for scene, cells in results.items() if cells["bvh"].get("same_picture") == "NO"]
    if broken:
        log("bvh and distributed differ: " + ", ".join(broken))
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
