#!/usr/bin/env python3
"""Turns the figures of the benchmarks into a table, and names the machine that they come from.

table.py FIGURES.json --build FOLDER [--write PAGE.md]: prints the table; --write also puts it into PAGE.md between its two
marks.
"""
import argparse
import json
import math
import os
import pathlib
import re
import statistics
import subprocess

BEGIN, END = "<!-- figures: tools/bench --write -->", "<!-- end of figures -->"


class Figures:
    """The repetitions of each benchmark, by name."""

    def __init__(self, document):
        self.context = document["context"]
        self.runs = {}
        for run in document["benchmarks"]:
            if run.get("error_occurred"):
                raise SystemExit(f"table.py: {run['name']} failed: {run['error_message']}")
            if run["run_type"] == "iteration":
                name = re.sub(r"/(manual_time|repeats:\d+)", "", run["run_name"])
                self.runs.setdefault(name, []).append(run)

    def values(self, name, key):
        return [run[key] for run in self.runs[name]]

    def median(self, name, key):
        return statistics.median(self.values(name, key))

    def spread(self, name, key):
        """Half the distance of the quartiles, as a share of the median."""
        values = self.values(name, key)
        if len(values) < 2:
            return 0.0
        low, _, high = statistics.quantiles(values, n=4)
        return (high - low) / 2 / statistics.median(values)


def filter_rows(figures):
    for name, what in (("predict", "predict"), ("update_position", "update, position sensor"),
                       ("update_spherical", "update, spherical sensor")):
        plugin, inline, dense = (f"filter/{name}/{side}" for side in ("plugin", "inline", "dense"))
        ratio = f"filter/{name}/ratio"
        if not {plugin, inline, ratio} <= figures.runs.keys():
            continue
        key = "cpu_time"
        beside = f", dense {figures.median(dense, key):.0f} us" if dense in figures.runs else ""
        yield (f"1000 tracks, {what}",
               f"plugin {figures.median(plugin, key):.0f} us, inline {figures.median(inline, key):.0f} us{beside}",
               figures.spread(plugin, key), "")
        yield (f"plugin / inline, {what}", f"{figures.median(ratio, 'ratio'):.3f}", figures.spread(ratio, "ratio"),
               "at most 1.05")


def step_rows(figures):
    for states in (6, 9):
        for sensor in ("position", "spherical"):
            path = f"step/{states}_states/{sensor}/"
            sides = [side for side in ("plugin", "dense", "kernels", "copies", "cubature", "unscented") if path + side in figures.runs]
            if "plugin" not in sides:
                continue
            what = f"{states} states, predict + update, {sensor} sensor"
            times = {side: figures.median(path + side, "cpu_time") for side in sides}
            yield (f"1000 tracks, {what}", ", ".join(f"{side} {time:.0f} us" for side, time in times.items()) +
                   f"; plugin {1e3 / times['plugin']:.1f} million steps/s", figures.spread(path + "plugin", "cpu_time"), "")
            for side, other, target in (("dense", "plugin", "at least 4"), ("plugin", "kernels", ""),
                                        ("cubature", "plugin", "at most 3"), ("unscented", "plugin", "")):
                if (ratio := f"{path}{side}_to_{other}") in figures.runs:
                    yield (f"{side} / {other}, {what}", f"{figures.median(ratio, 'ratio'):.2f}",
                           figures.spread(ratio, "ratio"), target)


def process_rows(figures):
    for name, what, target in (("load/50_plugins", "finding and loading 50 plugins", "at most 100 ms"),
                               ("check/airship", "`pelorus check configs/airship.yaml`, one cell", "at most 50 ms"),
                               ("check/airship_campaign", "`pelorus check configs/airship.yaml`, 90 cells", ""),
                               ("check/50_nodes", "`pelorus check`, 50 nodes", "at most 50 ms")):
        if name not in figures.runs:
            continue
        fastest = min(figures.values(name, "real_time"))
        yield (what, f"{figures.median(name, 'real_time'):.1f} ms (fastest {fastest:.1f} ms; processor time of the "
               f"process {1e3 * figures.median(name, 'process_cpu_s'):.1f} ms)", figures.spread(name, "real_time"), target)


def campaign_rows(figures):
    one, two = "campaign/1_thread", "campaign/2_threads"
    if one not in figures.runs or two not in figures.runs:
        return
    for name, what in ((one, "1 thread"), (two, "2 threads")):
        yield (f"the airship's campaign, {what}", f"{288e3 / figures.median(name, 'real_time'):.0f} runs/s",
               figures.spread(name, "real_time"), "at least 300 runs/s" if name == two else "")
    yield ("2 threads / 1 thread", f"{figures.median(one, 'real_time') / figures.median(two, 'real_time'):.2f}", None,
           "at least 1.8")


def graph_rows(figures):
    for name, what in (("empty_scans", "scans without measurements"), ("one_measurement", "scans with 1 measurement"),
                       ("hundred_measurements", "scans with 100 measurements"), ("four_receivers", "4 receivers"),
                       ("feedback", "a feedback edge")):
        if (name := f"empty_graph/{name}") in figures.runs:
            yield (f"empty graph, {what}", f"{figures.median(name, 'events_per_second') / 1e6:.2f} million events/s, "
                   f"{figures.median(name, 'scans_per_second') / 1e6:.2f} million scans/s",
                   figures.spread(name, "events_per_second"), "")
    for name in ("recorded_radar", "recorded_radar_without_sinks", "ais_harbour", "ais_harbour_without_sinks"):
        if (path := f"pipeline/{name}") in figures.runs:
            config, without = name.removesuffix("_without_sinks"), name.endswith("_without_sinks")
            yield (f"`{config}`" + (" without sinks" if without else ""),
                   f"{figures.median(path, 'scans_per_second'):,.0f} scans/s".replace(",", " "),
                   figures.spread(path, "scans_per_second"), "")


def partition_rows(figures):
    for name, what, target in (("uniform", "3 neighbours each", "at most 0.3, 4, 60 ms; 1.2"),
                               ("clumped", "clumps of 1000", "1.2"), ("ball", "all in one ball", "1.2")):
        sizes = [10**k for k in range(3, 7) if f"partition/{name}/plugin/{10**k}" in figures.runs]
        if not sizes:
            continue
        times = {size: figures.median(f"partition/{name}/plugin/{size}", "cpu_time") for size in sizes}
        told = ", ".join(f"1e{len(str(size)) - 1} {time:.3g} ms" for size, time in times.items())
        if len(sizes) > 1:
            growth = math.log(times[sizes[-1]] / times[sizes[0]]) / math.log(sizes[-1] / sizes[0])
            told += f"; grows as m^{growth:.2f}"
        yield (f"distance partition in space, {what}", told,
               figures.spread(f"partition/{name}/plugin/{sizes[-1]}", "cpu_time"), target)
        others = [size for size in sizes if f"partition/{name}/nanoflann/{size}" in figures.runs]
        if others:
            ratios = [figures.median(f"partition/{name}/nanoflann/{size}", "cpu_time") / times[size] for size in others]
            yield (f"nanoflann's radius search with union-find / plugin, {what}",
                   ", ".join(f"1e{len(str(size)) - 1} {float(f'{ratio:.3g}'):g}" for size, ratio in zip(others, ratios)), None,
                   "at least 1")


def table(rows):
    lines = ["| What | Median | Spread | Target |", "| --- | --- | --- | --- |"]
    for what, result, spread, target in rows:
        lines.append(f"| {what} | {result} | {'' if spread is None else f'{100 * spread:.0f} %'} | {target} |")
    return "\n".join(lines)


def first_match(pattern, file, fallback="unknown"):
    found = re.search(pattern, pathlib.Path(file).read_text(), re.MULTILINE)
    return found.group(1).strip() if found else fallback


def machine(figures, build):
    cache = build / "CMakeCache.txt"
    compiler = first_match(r"^CMAKE_CXX_COMPILER:[A-Z]+=(.*)$", cache)
    version = subprocess.run([compiler, "--version"], capture_output=True, text=True, check=True).stdout.splitlines()[0]
    flags = first_match(r"^CMAKE_CXX_FLAGS_RELEASE:[A-Z]+=(.*)$", cache)
    memory = int(first_match(r"^MemTotal:\s*(\d+)", "/proc/meminfo", "0")) / 2**20
    load = " ".join(f"{x:.2f}" for x in figures.context["load_avg"])
    return "\n".join([
        "| | |", "| --- | --- |",
        f"| Processor | {first_match('^model name[^:]*:(.*)$', '/proc/cpuinfo')}, "
        f"{figures.context['num_cpus']} cores at {figures.context['mhz_per_cpu']} MHz |",
        f"| Memory | {memory:.1f} GiB |",
        f"| System | {first_match('^PRETTY_NAME=.(.*).$', '/etc/os-release')}, Linux {os.uname().release} |",
        f"| Compiler | {version}; `{flags} -ffp-contract=off`, no `-march` |",
        f"| Date | {figures.context['date'][:10]} |",
        f"| Load average at the start | {load} (1, 5, 15 minutes) |"])


def write(page, text):
    before = page.read_text()
    if before.count(BEGIN) != 1 or before.count(END) != 1:
        raise SystemExit(f"table.py: {page} does not have the two marks {BEGIN} and {END} once each")
    head, rest = before.split(BEGIN)
    page.write_text(f"{head}{BEGIN}\n{text}\n{END}{rest.split(END)[1]}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("figures", type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--write", type=pathlib.Path)
    arguments = parser.parse_args()
    figures = Figures(json.loads(arguments.figures.read_text()))
    rows = [*filter_rows(figures), *step_rows(figures), *process_rows(figures), *campaign_rows(figures), *graph_rows(figures),
            *partition_rows(figures)]
    text = f"{machine(figures, arguments.build)}\n\n{table(rows)}"
    print(text)
    if arguments.write:
        write(arguments.write, text)


if __name__ == "__main__":
    main()
