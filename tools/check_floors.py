#!/usr/bin/env python3
"""Checks rules beyond the compiler: which rooms a room may include, and calls forbidden in library code.

Usage: check_floors.py [SOURCE]        SOURCE: folder of rooms, default: src/byre of this project.

A room may include only rooms on lower floors. Some headers and calls are restricted, see KEPT_IN and FORBIDDEN. A type
is defined by one header only: two types of one name in one program violate the one-definition rule. Names local to a
file are unique in its room, because several files compile as one (unity builds). File-local functions may overload by
types of byre. They may not overload by convertible types such as numbers, or another file could call them instead of a
function that a header declares.
Prints one line per fault, "file:line: what is wrong". Exit code: 0 all rules hold, 1 faults found, 2 no source files.
"""
import functools
import pathlib
import re
import sys
from typing import Iterator, NamedTuple

# From the ground up; ARCHITECTURE.md describes the rooms.
FLOORS = [
    {"input", "workers"},
    {"geometry", "ros"},
    {"bag", "motion", "features", "optimise", "evaluation", "dds"},
    {"dataset"},
    {"map"},
    {"place", "simulation"},
    {"slam"},
    {"mapping"},
    {"localisation"},
    {"session"},
    {"system"},
    {"playback"},
    {"archive"},
    {"assessment", "viewer", "fleet"},
    {"benchmark", "camera"},
    {"demo", "node"},
    {"cli"},
]
# Room of each header of include/byre.
PUBLIC = {
    "input_error.h": "input",
    "alignment.h": "geometry", "calibration.h": "geometry", "pose.h": "geometry", "pose_hint.h": "geometry",
    "rig.h": "geometry",
    "trajectory.h": "geometry", "two_view_failure.h": "geometry",
    "body_motion.h": "motion", "motion_warning.h": "motion",
    "features.h": "features", "image.h": "features", "image_condition.h": "features",
    "trajectory_error.h": "evaluation", "trajectory_file.h": "evaluation",
    "calibration_file.h": "dataset", "floor_plan.h": "dataset", "recording.h": "dataset",
    "frame_cuts.h": "slam", "health.h": "slam", "session_event.h": "slam", "state.h": "slam",
    "frame_report.h": "session",
    "byre.h": "system", "slam.h": "system",
}
FLOOR = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}
EVERY_ROOM = frozenset(FLOOR)

# Headers that only some rooms may include. Tests may include all.
KEPT_IN = {
    r"thread|condition_variable|future|stop_token|semaphore|latch|barrier": {
        "workers", "simulation", "mapping", "playback", "viewer", "camera", "fleet", "cli"},
    r"atomic": {"input", "workers", "simulation", "mapping", "playback", "viewer", "camera", "fleet", "cli"},
    r"mutex|shared_mutex": {"workers", "viewer"},
    r"filesystem|fstream": {"input", "bag", "evaluation", "dataset", "map", "place", "simulation", "system", "playback",
                            "archive", "viewer", "benchmark", "camera", "demo", "node", "cli"},
    r"iostream|CLI/.*": {"cli"},
    r"ceres/.*": {"optimise"},
    r"embree3/.*": {"simulation"},
    r"boost/.*": {"dataset", "viewer"},
    r"dds/.*": {"dds"},
    r"opencv2/.*": {"features", "dataset", "simulation", "viewer", "camera", "node"},
    r"yaml-cpp/.*": {"bag", "dataset", "benchmark"},
    r"sqlite3\.h|zstd\.h|lz4frame\.h|bzlib\.h|zlib\.h": {"bag"},
    r"nlohmann/.*": {"assessment", "viewer", "fleet", "benchmark", "node", "cli"},
    r"mosquitto\.h": {"fleet"},
    r"systemd/.*": {"node"},
    r"linux/videodev2\.h|poll\.h|sys/(ioctl|poll)\.h": {"camera"},
}


class Rule(NamedTuple):
    pattern: str
    rooms: frozenset  # exempt from the rule
    reason: str


# Calls forbidden in library code and its tests.
FORBIDDEN = [
    Rule(r"\bstd::(cout|cerr|clog)\b|(?<![\w.>])(std::)?(printf|fprintf|puts|fputs|putchar|perror)\s*\(",
         frozenset({"cli"}), "only cli prints: return what is to be told, or throw InputError"),
    Rule(r"(?<![\w.>])(std::)?(exit|_Exit|quick_exit|abort|terminate)\s*\(", frozenset({"cli"}),
         "only cli ends the program: throw InputError for bad input, assert what cannot be"),
    Rule(r"\.dump\s*\(", frozenset({"assessment", "viewer", "fleet"}),
         "JSON text needs printable_json(): call dumped() of assessment/report_json.h"),
    Rule(r"\brandom_device\b|(?<![\w.>:])(std::)?s?rand\s*\(", frozenset(),
         "the same seed must give the same result: take the seed as an option"),
]


class Fault(NamedTuple):
    path: pathlib.Path
    line: int  # from 1
    message: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.message}"


def listing(rooms) -> str:
    return ", ".join(sorted(rooms, key=lambda room: (FLOOR[room], room)))


TOKEN = re.compile(
    r"""R"(?P<mark>\w*)\(.*?\)(?P=mark)"    # raw string
      | "(?:\\.|[^"\\\n])*" | '(?:\\.|[^'\\\n])'  # string, character
      | //[^\n]* | /\*.*?\*/                         # comments
    """, re.DOTALL | re.VERBOSE)


def without_comments(text: str) -> str:
    """Blanks out comments and raw strings; line numbers and other literals stay."""
    def kept(found: re.Match) -> str:
        is_literal = found[0][0] in "\"'"
        return found[0] if is_literal else "\n" * found[0].count("\n")
    return TOKEN.sub(kept, text)


def without_strings(line: str) -> str:
    return re.sub(r'"(?:\\.|[^"\\])*"', '""', line)


def room_fault(room: str, other: str) -> str | None:
    if other == room:
        return None
    if other not in FLOOR:
        return f"there is no room '{other}'; the rooms are {listing(FLOOR)}"
    if FLOOR[other] == FLOOR[room]:
        return f"{room} must not include {other}: both are on floor {FLOOR[room]}"
    if FLOOR[other] > FLOOR[room]:
        return f"{room} (floor {FLOOR[room]}) must not include {other} (floor {FLOOR[other]}): only lower floors"
    return None


def fence_fault(room: str, header: str) -> str | None:
    for pattern, rooms in KEPT_IN.items():
        if re.fullmatch(pattern, header) and room not in rooms:
            return f"{room} must not include <{header}>: it is kept in {listing(rooms)}"
    return None


def include_fault(room: str, header: str, is_test: bool) -> str | None:
    if found := re.match(r"byre/(\w+)/", header):
        return room_fault(room, found[1])
    if found := re.fullmatch(r"byre/(\w+\.h)", header):
        known = PUBLIC.get(found[1])
        return room_fault(room, known) if known else f"'{header}' belongs to no room: see PUBLIC"
    return None if is_test else fence_fault(room, header)


def line_messages(room: str, line: str, is_test: bool) -> Iterator[str]:
    if found := re.match(r'\s*#\s*include\s*[<"]([^>"]+)[>"]', line):
        if message := include_fault(room, found[1], is_test):
            yield message
        return
    for rule in FORBIDDEN:
        if room not in rule.rooms and (call := re.search(rule.pattern, without_strings(line))):
            yield f"'{call[0].rstrip('( ')}' in {room}: {rule.reason}"


def is_of_tests(path: pathlib.Path) -> bool:
    return re.search("_(test|scene|fixture|matchers|images)$", path.stem) is not None


def file_faults(path: pathlib.Path, room: str) -> Iterator[Fault]:
    is_test = is_of_tests(path)
    for number, line in enumerate(without_comments(path.read_text(encoding="utf-8")).split("\n"), start=1):
        for message in line_messages(room, line, is_test):
            yield Fault(path, number, message)


OPENING = re.compile(
    r"namespace(?:\s+(?P<namespace>[\w:]+))?\s*\{"
    r"|\b(?:struct|class|enum(?:\s+class)?)\s+(?P<type>\w+)\s*(?:final\s*)?(?::[^:;{(][^;{(]*)?\{"
    r"|(?<=\n)(?:inline\s+)?const(?:expr)?\s[^;=({]*\b(?P<constant>k[A-Z]\w*)"
    r"|(?<=\n)(?!return|using|template|static_assert|#)[A-Za-z_][^\n;{}=()]*[\s&*](?P<function>\w+)"
    r"\((?:const\s+)?(?P<taken>[\w:]*)"
    r"|[{}]")


ANONYMOUS = "{anonymous}"


# Declarations and definitions of a file at namespace scope, each as qualified name and line: types, constants, and
# functions whose first parameter is no type of byre, marked by "()".
def definitions(text: str) -> Iterator[tuple[str, int]]:
    code = "\n".join(without_strings(line) for line in without_comments(text).split("\n"))
    code = re.sub(r"'(?:\\.|[^'\\\n])'", "' '", code)
    scopes = []
    for found in OPENING.finditer(code):
        name = found["type"] or found["constant"] or found["function"]
        is_overload = found["function"] and re.match("[A-Z](?!igen::)|ros::", found["taken"])
        if name and None not in scopes and not is_overload:
            yield "::".join([*scopes, name]) + "()" * bool(found["function"]), code.count("\n", 0, found.start()) + 1
        if found[0] == "}":
            del scopes[-1:]
        elif not found["constant"] and not found["function"]:
            is_namespace = found[0].startswith("namespace")
            scopes.append((found["namespace"] or ANONYMOUS) if is_namespace else None)


@functools.cache
def definitions_in(path: pathlib.Path) -> tuple[tuple[str, int], ...]:
    return tuple(definitions(path.read_text(encoding="utf-8")))


def faults_of_names(paths: list[pathlib.Path], is_wanted, first: dict[str, pathlib.Path]) -> Iterator[Fault]:
    for path in paths:
        for name, line in definitions_in(path):
            if is_wanted(name) and first.setdefault(name, path) != path:
                yield Fault(path, line, f"{name} is defined by {first[name]} too: name one of them otherwise")


def twice_defined_faults(headers: list[pathlib.Path]) -> Iterator[Fault]:
    return faults_of_names(headers, lambda name: ANONYMOUS not in name and not name.endswith("()"), {})


# Declarations of the headers on the floors up to a room's, in the form of file-local names.
def declared_names(headers: list[tuple[str, pathlib.Path]], room: str) -> dict[str, pathlib.Path]:
    names = {}
    for other, path in headers:
        if not is_of_tests(path) and (other == room or FLOOR[other] < FLOOR[room]):
            for full_name, _ in definitions_in(path):
                scope, _, name = full_name.rpartition("::")
                names[f"{scope}::{ANONYMOUS}::{name}"] = path
    return names


# Name clashes of files that compile as one: those of a room; its tests separately.
def clash_faults(source: pathlib.Path, public: pathlib.Path) -> Iterator[Fault]:
    together = {}
    headers = [(PUBLIC[path.name], path) for path in source_files(public) if path.name in PUBLIC]
    for path in source_files(source):
        room = path.relative_to(source).parts[0]
        if path.suffix == ".cc":
            together.setdefault((room, is_of_tests(path)), []).append(path)
        elif room in EVERY_ROOM:
            headers.append((room, path))
    for (room, _), paths in together.items():
        if room in EVERY_ROOM:
            yield from faults_of_names(paths, lambda name: ANONYMOUS in name, declared_names(headers, room))


def source_files(source: pathlib.Path) -> list[pathlib.Path]:
    return sorted(path for path in source.rglob("*") if path.suffix in {".h", ".cc"} and path.is_file())


# A public header may include public headers, the standard library and Eigen.
def public_faults(path: pathlib.Path) -> Iterator[Fault]:
    for fault in file_faults(path, PUBLIC[path.name]):
        yield fault
    for number, line in enumerate(without_comments(path.read_text(encoding="utf-8")).split("\n"), start=1):
        found = re.match(r'\s*#\s*include\s*([<"][^>"]+)[>"]', line)
        if found and not re.fullmatch(r'"byre/\w+\.h|<\w+|<Eigen/\w+', found[1]):
            yield Fault(path, number, f"a public header must not include {found[1][1:]}")


def all_public_faults(folder: pathlib.Path) -> Iterator[Fault]:
    for path in source_files(folder):
        if path.name in PUBLIC:
            yield from public_faults(path)
        else:
            yield Fault(path, 1, "belongs to no room: see PUBLIC")


def faults(source: pathlib.Path) -> Iterator[Fault]:
    for path in source_files(source):
        room = path.relative_to(source).parts[0]
        if room == path.name:
            yield Fault(path, 1, f"lies in no room; the rooms are {listing(FLOOR)}")
        elif room not in EVERY_ROOM:
            yield Fault(path, 1, f"'{room}' has no floor; the rooms are {listing(FLOOR)}")
        else:
            yield from file_faults(path, room)


def main(arguments: list[str]) -> int:
    if len(arguments) > 1 or any(argument.startswith("-") for argument in arguments):
        print(__doc__, file=sys.stderr)
        return 2
    default = pathlib.Path(__file__).resolve().parent.parent / "src" / "byre"
    source = pathlib.Path(arguments[0]) if arguments else default
    files = source_files(source)
    if not files:
        print(f"{source}: no .h or .cc file in it", file=sys.stderr)
        return 2
    public = source.parent.parent / "include" / "byre"
    found = list(faults(source)) + list(all_public_faults(public))
    files += source_files(public)
    found += twice_defined_faults([path for path in files if path.suffix == ".h"])
    found += clash_faults(source, public)
    for fault in found:
        print(fault)
    print(f"{len(files)} files, {len(found)} faults" if found else f"floors hold in {len(files)} files")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
