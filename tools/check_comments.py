#!/usr/bin/env python3
"""Checks that comments are self-contained: each is understood without the line of code above it.

Usage: check_comments.py [FOLDER...]        default: include and src of this project

A comment behind code must neither begin with a word that refers to the line above ("of those", "likewise") nor
continue on the next line: longer comments stand on separate lines above the code. Comments on separate lines must not
begin with "Of", "Likewise" or "Ditto".
Prints one line per fault, "file:line: fault". Exit code: 0 no faults, 1 faults, 2 wrong usage or no source files.
"""
import pathlib
import re
import sys
from typing import Iterator, NamedTuple

from check_floors import Fault, TOKEN, source_files

MEANT_FOR_TOOLS = re.compile(r"NOLINT|IWYU|clang-format|namespace\b")

# First words behind code whose noun is on another line. Words that can begin a noun phrase ("both cameras", "too few
# points", "which of the maps", "the same as before") count only if they do not.
LEANING = re.compile(
    r"""(?:of|and|or|nor|but|also|else|otherwise|ditto|likewise|again|then|that|whose|those|these|they|them)\b
      | (?:by|for|from|in|on|to|with)\s(?:which|those|these|them|that)\b
      | (?:both|too)\b(?!\s\w)
      | which\b(?!\sof\b)
      | (?:the\s)?same\b(?!\s(?:as|in|on|at)\b)
    """, re.IGNORECASE | re.VERBOSE)
# Words that refer to another line at any position.
POINTING = re.compile(r"\b(?:likewise|ditto|as (?:above|below)|see (?:above|below)|(?:of|by|in|with) (?:those|these)$)",
                      re.IGNORECASE)
UNFINISHED = re.compile(r",$|\b(?:and|or|nor|the|a|an|than)$", re.IGNORECASE)
LEANING_PROSE = re.compile(r"(?:Of|Likewise|Ditto)\b")


class Comment(NamedTuple):
    line: int  # from 1
    column: int  # of its slashes, from 0
    text: str  # without slashes and surrounding spaces
    is_behind_code: bool


def comments(text: str) -> dict[int, Comment]:
    """Comments after two slashes by line, in order, without empty ones and those for tools."""
    found = {}
    line, counted = 1, 0
    for token in TOKEN.finditer(text):
        line += text.count("\n", counted, token.start())
        counted = token.start()
        words = token[0].removeprefix("//").strip()
        if not token[0].startswith("//") or not words or MEANT_FOR_TOOLS.match(words):
            continue
        before = text[text.rfind("\n", 0, token.start()) + 1:token.start()]
        found[line] = Comment(line, len(before), words, bool(before.strip()))
    return found


def messages_behind_code(comment: Comment, following: Comment | None) -> Iterator[str]:
    if leaning := LEANING.match(comment.text):
        yield f"begins with '{leaning[0]}', which refers to the line above"
    elif pointing := POINTING.search(comment.text):
        yield f"'{pointing[0]}' points to another line"
    if following is None:
        return
    if not following.is_behind_code and following.column == comment.column:
        yield "continues on the next line: move it to separate lines above the code"
    elif following.is_behind_code and UNFINISHED.search(comment.text):
        yield "continues in the comment of the next line"


def messages(comment: Comment, preceding: Comment | None, following: Comment | None) -> Iterator[str]:
    if comment.is_behind_code:
        yield from messages_behind_code(comment, following)
        return
    is_first = preceding is None or preceding.is_behind_code
    if is_first and (leaning := LEANING_PROSE.match(comment.text)):
        yield f"begins with '{leaning[0]}', which refers to the code below: name the noun"


def file_faults(path: pathlib.Path) -> Iterator[Fault]:
    by_line = comments(path.read_text(encoding="utf-8"))
    for line, comment in by_line.items():
        for message in messages(comment, by_line.get(line - 1), by_line.get(line + 1)):
            yield Fault(path, line, message)


def main(arguments: list[str]) -> int:
    if any(argument.startswith("-") for argument in arguments):
        print(__doc__, file=sys.stderr)
        return 2
    root = pathlib.Path(__file__).resolve().parent.parent
    files = []
    for folder in [pathlib.Path(argument) for argument in arguments] or [root / "include", root / "src"]:
        in_folder = source_files(folder)
        if not in_folder:
            print(f"{folder}: contains no .h or .cc file", file=sys.stderr)
            return 2
        files += in_folder
    faults = [fault for path in files for fault in file_faults(path)]
    for fault in faults:
        print(fault)
    print(f"{len(files)} files, {len(faults)} faults" if faults else f"{len(files)} files, no faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
