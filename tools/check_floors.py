#!/usr/bin/env python3
"""Checks architecture rules: includes allowed between rooms, and calls forbidden in library code.

Usage: check_floors.py [SOURCE]        SOURCE: folder of rooms, default: src/byre of this project

A room is a folder of SOURCE with the folders in it. It may include only rooms on lower floors. Includes between folders
of a room must not be circular. Some headers and calls are restricted, see KEPT_IN and FORBIDDEN. A type is defined
by one header only: two types of one name in one program violate the one-definition rule.
Prints one line per fault, "file:line: fault". Exit code: 0 no faults, 1 faults, 2 wrong usage or no source files.
"""
import functools
import pathlib
import re
import sys
from typing import Iterator, NamedTuple

# From the ground up; ARCHITECTURE.md describes the rooms.
FLOORS = [
    {"base"},
    {"geometry"},
    {"features", "optimise", "odometry"},
    {"map", "io"},
    {"place", "simulation"},
    {"slam"},
    {"playback", "registry", "viewer"},
    {"benchmark", "camera", "ros2"},
    {"cli"},
]
# Room of each header of include/byre. Its functions may be defined in a higher room, as those of floor_plan.h in io.
PUBLIC = {
    "input_error.h": "base",
    "alignment.h": "geometry", "calibration.h": "geometry", "extrinsics.h": "geometry", "pose.h": "geometry",
    "pose_hint.h": "geometry", "rig.h": "geometry", "trajectory.h": "geometry", "trajectory_error.h": "geometry",
    "trajectory_file.h": "geometry", "two_view_failure.h": "geometry", "tag.h": "geometry",
    "features.h": "features", "floor_plan.h": "features", "image.h": "features", "image_condition.h": "features",
    "plan_registration.h": "map",
    "body_motion.h": "odometry", "motion_warning.h": "odometry",
    "calibration_file.h": "io", "extrinsics_file.h": "io", "recording.h": "io", "site.h": "io", "tag_file.h": "io",
    "frame_cuts.h": "slam", "frame_report.h": "slam", "health.h": "slam", "session_event.h": "slam",
    "localisation_failure.h": "slam", "map.h": "slam", "slam.h": "slam", "state.h": "slam",
    "byre.h": "playback", "colmap.h": "playback",
}
FLOOR = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}
EVERY_ROOM = frozenset(FLOOR)

# Headers that only some places may include: "room" with all its folders, "room/folder", or "room/" without its folders.
# Tests may include all.
KEPT_IN = {
    r"thread|condition_variable|future|stop_token|semaphore|latch|barrier": {
        "base", "simulation", "playback/", "registry", "viewer/web", "camera", "ros2/fleet", "cli"},
    r"atomic": {"base", "simulation", "slam/mapping", "playback/", "viewer/web", "camera", "ros2/fleet", "cli"},
    r"mutex|shared_mutex": {"base", "registry", "viewer/web"},
    r"filesystem|fstream": {"base", "geometry/evaluation", "map", "io", "place", "simulation", "slam/system",
                            "playback/", "playback/archive", "viewer", "benchmark", "camera", "registry", "ros2/node",
                            "cli"},
    r"iostream|CLI/.*": {"cli"},
    r"ceres/.*": {"optimise"},
    r"embree[34]/.*": {"simulation"},
    r"apriltag/.*": {"features"},
    r"jpeglib\.h": {"features"},
    r"boost/.*": {"viewer/web"},
    r"dds/.*": {"ros2/dds"},
    r"opencv2/.*": {"features", "io/calibration", "io/image", "io/recording", "simulation", "viewer", "camera", "ros2/node"},
    r"yaml-cpp/.*": {"io", "benchmark"},
    r"tinyxml2\.h": {"io/calibration"},
    r"sqlite3\.h|zstd\.h|lz4frame\.h|bzlib\.h|zlib\.h": {"io/bag"},
    r"nlohmann/.*": {"playback/report", "viewer", "ros2/fleet", "ros2/node", "benchmark", "cli"},
    r"mosquitto\.h": {"ros2/fleet"},
    r"systemd/.*": {"ros2/node"},
    r"libpq-fe\.h|openssl/.*": {"registry"},
    r"linux/videodev2\.h|sys/(ioctl|poll)\.h": {"camera"},
    r"poll\.h": {"camera", "cli", "registry"},
}


class Rule(NamedTuple):
    pattern: str
    places: frozenset  # exempt from the rule, in the form of KEPT_IN
    reason: str


# Calls forbidden in library code and its tests.
FORBIDDEN = [
    Rule(r"\bstd::(cout|cerr|clog)\b|(?<![\w.>])(std::)?(printf|fprintf|puts|fputs|putchar|perror)\s*\(",
         frozenset({"cli"}), "only cli prints: return a result, or throw InputError"),
    Rule(r"(?<![\w.>])(std::)?(exit|_Exit|quick_exit|abort|terminate)\s*\(", frozenset({"cli"}),
         "only cli ends the program: throw InputError for bad input, assert for bugs"),
    Rule(r"\.dump\s*\(", frozenset({"playback/report", "viewer/web", "ros2/fleet"}),
         "JSON text needs printable_json(): call dump_json() of playback/report/report.h"),
    Rule(r"\brandom_device\b|(?<![\w.>:])(std::)?s?rand\s*\(", frozenset(),
         "equal seeds must yield equal results: take the seed as an option"),
]


class Fault(NamedTuple):
    path: pathlib.Path
    line: int  # from 1
    message: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.message}"


def room_of(folder: str) -> str:
    return folder.split("/")[0]


def listing(places) -> str:
    return ", ".join(sorted(places, key=lambda place: (FLOOR[room_of(place)], place)))


def is_in(folder: str, places) -> bool:
    return room_of(folder) in places or folder in places or folder + "/" in places


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
        return f"unknown room '{other}'; the rooms are {listing(FLOOR)}"
    if FLOOR[other] == FLOOR[room]:
        return f"{room} must not include {other}: both are on floor {FLOOR[room]}"
    if FLOOR[other] > FLOOR[room]:
        return f"{room} (floor {FLOOR[room]}) must not include {other} (floor {FLOOR[other]}): only lower floors"
    return None


def fence_fault(folder: str, header: str) -> str | None:
    for pattern, places in KEPT_IN.items():
        if re.fullmatch(pattern, header) and not is_in(folder, places):
            return f"{folder} must not include <{header}>: only allowed in {listing(places)}"
    return None


def include_fault(folder: str, header: str, exempt: str) -> str | None:
    if found := re.match(r"byre/(\w+)/", header):
        return room_fault(room_of(folder), found[1])
    if found := re.fullmatch(r"byre/(\w+\.h)", header):
        known = PUBLIC.get(found[1])
        return room_fault(room_of(folder), known) if known else f"'{header}' belongs to no room: see PUBLIC"
    return None if re.fullmatch(exempt, header) else fence_fault(folder, header)


INCLUDE = re.compile(r'\s*#\s*include\s*[<"]([^>"]+)[>"]')


def line_messages(folder: str, line: str, exempt: str) -> Iterator[str]:
    if found := INCLUDE.match(line):
        if message := include_fault(folder, found[1], exempt):
            yield message
        return
    for rule in FORBIDDEN:
        if not is_in(folder, rule.places) and (call := re.search(rule.pattern, without_strings(line))):
            yield f"'{call[0].rstrip('( ')}' in {folder}: {rule.reason}"


def is_of_tests(path: pathlib.Path) -> bool:
    return re.search("_(test|scene|fixture|matchers|images)$", path.stem) is not None


def numbered_lines(path: pathlib.Path) -> Iterator[tuple[int, str]]:
    return enumerate(without_comments(path.read_text(encoding="utf-8")).split("\n"), start=1)


# exempt: pattern of headers that KEPT_IN does not apply to.
def file_faults(path: pathlib.Path, folder: str, exempt: str) -> Iterator[Fault]:
    for number, line in numbered_lines(path):
        for message in line_messages(folder, line, exempt):
            yield Fault(path, number, message)


class Arrow(NamedTuple):
    folder: str
    included: str
    path: pathlib.Path
    line: int


# Includes between folders of a room, except those of tests and of files directly in the room.
def folder_arrows(source: pathlib.Path) -> Iterator[Arrow]:
    for path in source_files(source):
        folder = path.parent.relative_to(source).as_posix()
        if "/" not in folder or is_of_tests(path):
            continue
        for number, line in numbered_lines(path):
            found = INCLUDE.match(line)
            included = re.match(rf"byre/({room_of(folder)}/.+)/", found[1]) if found else None
            if included and included[1] != folder:
                yield Arrow(folder, included[1], path, number)


def circle_faults(source: pathlib.Path) -> Iterator[Fault]:
    arrows = list(folder_arrows(source))
    reached = {}
    for arrow in arrows:
        reached.setdefault(arrow.folder, set()).add(arrow.included)
    for through in list(reached):
        for folder, included in reached.items():
            if through in included:
                included |= reached[through]
    for folder, included, path, line in arrows:
        if folder in reached.get(included, ()):
            yield Fault(path, line, f"{folder} must not include {included}, which depends on {folder}")


OPENING = re.compile(
    r"namespace(?:\s+(?P<namespace>[\w:]+))?\s*\{"
    r"|\b(?:struct|class|enum(?:\s+class)?)\s+(?P<type>\w+)\s*(?:final\s*)?(?::[^:;{(][^;{(]*)?\{"
    r"|(?<=\n)(?:inline\s+)?const(?:expr)?\s[^;=({]*\b(?P<constant>k[A-Z]\w*)"
    r"|(?<=\n)using\s+(?P<alias>\w+)\s*=(?P<target>[^;]*);"
    r"|(?<=\n)(?!return|using|template|static_assert|#)[A-Za-z_][^\n;{}=()]*[\s&*](?P<function>\w+)"
    r"\((?:const\s+)?(?P<taken>[\w:]*)"
    r"|[{}]")


ANONYMOUS = "{anonymous}"


# Declarations and definitions of a file at namespace scope, each as qualified name and line: types, constants, and
# functions, marked by "()", with the type of the first parameter inside if it is one of byre. Aliases have "=" and their
# type behind the name.
def definitions(text: str) -> Iterator[tuple[str, int]]:
    code = "\n".join(without_strings(line) for line in without_comments(text).split("\n"))
    code = re.sub(r"'(?:\\.|[^'\\\n])'", "' '", code)
    scopes = []
    for found in OPENING.finditer(code):
        name = found["type"] or found["constant"] or found["function"] or found["alias"]
        is_overload = found["function"] and re.match("[A-Z](?!igen::)|ros::", found["taken"])
        if name and None not in scopes:
            mark = f"({found['taken'] if is_overload else ''})" if found["function"] else ""
            mark = "=" + "".join(found["target"].split()) if found["alias"] else mark
            yield "::".join([*scopes, name]) + mark, code.count("\n", 0, found.start()) + 1
        if found[0] == "}":
            del scopes[-1:]
        elif found["type"] or found[0].startswith("namespace") or found[0] == "{":
            is_namespace = found[0].startswith("namespace")
            scopes.append((found["namespace"] or ANONYMOUS) if is_namespace else None)


@functools.cache
def definitions_in(path: pathlib.Path) -> tuple[tuple[str, int], ...]:
    return tuple(definitions(path.read_text(encoding="utf-8")))


def faults_of_names(paths: list[pathlib.Path], is_wanted, first: dict[str, pathlib.Path],
                    reason: str) -> Iterator[Fault]:
    for path in paths:
        for name, line in definitions_in(path):
            if is_wanted(name) and first.setdefault(name, path) != path:
                yield Fault(path, line, f"{name} is also defined in {first[name]}: {reason}")


def twice_defined_faults(headers: list[pathlib.Path]) -> Iterator[Fault]:
    return faults_of_names(headers, lambda name: ANONYMOUS not in name and not re.search(r"[)=]", name), {},
                           "rename one of them")


# Headers of byre that files include, directly or through others.
def headers_of(paths: list[pathlib.Path], source: pathlib.Path, public: pathlib.Path) -> list[pathlib.Path]:
    reached, waiting = {}, list(paths)
    while waiting:
        for header in included_headers(waiting.pop()):
            path = (source if "/" in header else public) / header
            if path not in reached and path.is_file():
                reached[path] = None
                waiting.append(path)
    return list(reached)


@functools.cache
def included_headers(path: pathlib.Path) -> tuple[str, ...]:
    found = [INCLUDE.match(line) for _, line in numbered_lines(path)]
    return tuple(include[1].removeprefix("byre/") for include in found if include and include[1].startswith("byre/"))


def source_files(source: pathlib.Path) -> list[pathlib.Path]:
    return sorted(path for path in source.rglob("*") if path.suffix in {".h", ".cc"} and path.is_file())


# A public header may include public headers, the standard library and Eigen; paths are part of interfaces.
def public_faults(path: pathlib.Path) -> Iterator[Fault]:
    yield from file_faults(path, PUBLIC[path.name], exempt="filesystem")
    for number, line in numbered_lines(path):
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
        folder = path.parent.relative_to(source).as_posix()
        if folder == ".":
            yield Fault(path, 1, f"is in no room; the rooms are {listing(FLOOR)}")
        elif room_of(folder) not in EVERY_ROOM:
            yield Fault(path, 1, f"'{room_of(folder)}' has no floor; the rooms are {listing(FLOOR)}")
        else:
            yield from file_faults(path, folder, exempt=".*" if is_of_tests(path) else "")


def main(arguments: list[str]) -> int:
    if len(arguments) > 1 or any(argument.startswith("-") for argument in arguments):
        print(__doc__, file=sys.stderr)
        return 2
    default = pathlib.Path(__file__).resolve().parent.parent / "src" / "byre"
    source = pathlib.Path(arguments[0]) if arguments else default
    files = source_files(source)
    if not files:
        print(f"{source}: contains no .h or .cc file", file=sys.stderr)
        return 2
    public = source.parent.parent / "include" / "byre"
    found = list(faults(source)) + list(circle_faults(source)) + list(all_public_faults(public))
    files += source_files(public)
    found += twice_defined_faults([path for path in files if path.suffix == ".h"])
    for fault in found:
        print(fault)
    print(f"{len(files)} files, {len(found)} faults" if found else f"{len(files)} files, no faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
