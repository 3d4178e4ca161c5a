#!/usr/bin/env python3
"""Groups source files that compile as one (unity builds), so that names local to a file may repeat.

Usage: unity_groups.py SOURCE PUBLIC SIZE FILE...
  SOURCE  folder of rooms, src/byre
  PUBLIC  folder of public headers, include/byre
  SIZE    most files of a group

Files of a group have no local name in common, and no local name that a header of another file of the group declares.
Prints the group of each file, counted from 0, one line a file. CMake calls it when it configures: after adding a name
that another file of the group has, which the compiler reports as redefined, configure again.
"""
import pathlib
import re
import sys

import check_floors


def names_of(path: pathlib.Path, source: pathlib.Path, public: pathlib.Path) -> tuple[frozenset, frozenset]:
    """Names local to a file, and the names that its headers declare in the same form."""
    own = {name for name, _ in check_floors.definitions_in(path) if check_floors.ANONYMOUS in name}
    seen = set()
    for header in check_floors.headers_of([path], source, public):
        for full_name, _ in check_floors.definitions_in(header):
            scope_and_name, mark = re.fullmatch(r"([^(=]*)(.*)", full_name).groups()
            scope, _, name = scope_and_name.rpartition("::")
            seen.add(f"{scope}::{check_floors.ANONYMOUS}::{name}{mark}")
    return frozenset(own), frozenset(seen)


def clash(some: set, others: set) -> bool:
    """Whether both have a name in common; an alias only clashes with an alias of another type."""
    if any("=" not in name for name in some & others):
        return True
    types = dict(name.split("=", 1) for name in others if "=" in name)
    return any(types.get(alias, type_) != type_ for alias, type_ in
               (name.split("=", 1) for name in some if "=" in name))


def groups_of(files: list[pathlib.Path], size: int, source: pathlib.Path, public: pathlib.Path) -> list[int]:
    """Puts each file into the first group that it fits."""
    groups = []  # of [number of files, local names, declared names]
    chosen = []
    for path in files:
        own, seen = names_of(path, source, public)
        fits = (i for i, (count, owned, declared) in enumerate(groups)
                if count < size and not clash(own, owned | declared) and not clash(seen, owned))
        chosen.append(next(fits, len(groups)))
        if chosen[-1] == len(groups):
            groups.append([0, set(), set()])
        group = groups[chosen[-1]]
        group[0] += 1
        group[1] |= own
        group[2] |= seen
    return chosen


def main(arguments: list[str]) -> int:
    if len(arguments) < 3 or not arguments[2].isdigit():
        print(__doc__, file=sys.stderr)
        return 2
    source, public, size = pathlib.Path(arguments[0]), pathlib.Path(arguments[1]), int(arguments[2])
    for group in groups_of([pathlib.Path(name) for name in arguments[3:]], size, source, public):
        print(group)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
