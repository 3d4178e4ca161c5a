#!/usr/bin/env python3
"""Compares instructions and allocated memory of the hot loops with stored values.

Unlike times, both are independent of the load, and equal on all machines with the same instruction set. Valgrind
(callgrind) counts the instructions of one pass of the loop.

Usage: check_hot_loops.py BENCHMARKS KEPT.json [--write]
  BENCHMARKS  program byre_benchmarks
  KEPT.json   stored figures by benchmark name
  --write     replaces the stored figures by the measured ones
Exit code: 0 no figure exceeds its stored value by more than 10 %, 1 at least one does, 2 wrong usage, 77 valgrind is
not installed.
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ALLOWED = 1.10  # ratio to the stored value
FIGURES = ("instructions", "allocations", "allocated_bytes")
SKIPPED = 77


def chosen(names):
    return ["--benchmark_filter=^(" + "|".join(names) + ")$", "--benchmark_min_time=0"]  # one pass per loop


def measured_memory(program, names):
    """Allocations and bytes of one pass, by name, in the order of execution."""
    output = subprocess.run([program, *chosen(names), "--benchmark_format=json"], check=True, capture_output=True,
                            text=True).stdout
    return {one["name"]: {figure: round(one[figure]) for figure in FIGURES[1:]}
            for one in json.loads(output)["benchmarks"]}


def measured_instructions(program, names):
    """Instructions of one pass, in the order of execution. The program starts the count of callgrind before a pass, and
    lets it write a file after it."""
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out", "--instr-atstart=no", program,
             *chosen(names)],
            capture_output=True, text=True)
        if run.returncode != 0:
            sys.exit(f"check_hot_loops.py: {program} failed under valgrind:\n{run.stderr}")
        dumps = sorted(pathlib.Path(folder).glob("out.*"), key=lambda dump: int(dump.suffix[1:]))
        return [int(re.search(r"^totals: (\d+)", dump.read_text(), re.MULTILINE)[1]) for dump in dumps]


def measured(program, names):
    figures = measured_memory(program, names)
    missing = set(names) - set(figures)
    if missing:
        sys.exit(f"check_hot_loops.py: {program} has no benchmark {', '.join(sorted(missing))}")
    instructions = measured_instructions(program, names)
    if len(instructions) != len(figures):
        sys.exit(f"check_hot_loops.py: valgrind counted {len(instructions)} loops instead of {len(figures)}")
    return {name: {"instructions": count, **figures[name]} for name, count in zip(figures, instructions)}


def compare(kept, now):
    """Table rows, and whether a cost exceeds its limit."""
    lines, too_much = [f"{'':40} {'instructions':>22} {'allocations':>16} {'bytes':>18}"], False
    for name, before in kept.items():
        cells = []
        for figure in FIGURES:
            ratio = now[name][figure] / before[figure] if before[figure] else 1.0 + now[name][figure]
            too_much = too_much or ratio > ALLOWED
            cells.append(f"{now[name][figure]:>11,} ({ratio:.2f})" + ("!" if ratio > ALLOWED else " "))
        lines.append(f"{name:40} {cells[0]:>22} {cells[1]:>16} {cells[2]:>18}")
    return lines, too_much


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--write"]
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    if not shutil.which("valgrind"):
        print("Skipped: valgrind, which counts instructions, is not installed")
        return SKIPPED
    program, file = arguments[0], pathlib.Path(arguments[1])
    kept = json.loads(file.read_text())
    now = measured(program, list(kept))
    if "--write" in sys.argv:
        file.write_text(json.dumps(now, indent=2) + "\n")
        return 0
    lines, too_much = compare(kept, now)
    print("\n".join(lines))
    if too_much:
        print(f"\nFigures with (!) exceed {ALLOWED:.2f} times their values in {file.name}. If justified, state the "
              f"reason and store the new figures: check_hot_loops.py {program} {file} --write")
    return 1 if too_much else 0


if __name__ == "__main__":
    sys.exit(main())
