#!/usr/bin/env python3
"""Generates the manual pages of byre from the help of its commands: byre.1 and one page per command.

Usage: make_manual.py BYRE FOLDER      BYRE is the program; output: byre.1.gz, byre-map.1.gz, ... in FOLDER
"""
import gzip
import pathlib
import re
import subprocess
import sys
from typing import NamedTuple

COMMANDS = "Subcommands"  # heading of the list of commands
COLUMN = 30  # first column of descriptions


class Entry(NamedTuple):
    name: str  # "-o,--output MAP" or "map"
    text: str


class Help(NamedTuple):
    summary: str
    usage: str
    groups: dict[str, list[Entry]]  # by heading, such as "Options"
    examples: str
    exit_codes: str
    notes: list[str]  # paragraphs


def parse_entries(lines: list[str]) -> list[Entry]:
    """Names are indented by two; descriptions are in a separate column, or below names that reach into it."""
    margin = " " * COLUMN
    entries: list[Entry] = []
    for line, next_line in zip(lines, [*lines[1:], ""]):
        if entries and line.startswith(margin):
            entries[-1] = Entry(entries[-1].name, f"{entries[-1].text} {line.strip()}".strip())
        elif next_line.startswith(margin):
            entries.append(Entry(line.strip(), ""))
        else:
            entries.append(Entry(line[:COLUMN].strip(), line[COLUMN:].strip()))
    return entries


def parse_help(text: str) -> Help:
    summary, _, rest = text.partition("\nUsage: ")
    usage, _, rest = rest.partition("\n")
    groups: dict[str, list[Entry]] = {}
    examples, exit_codes, notes = "", "", []
    for block in re.split(r"\n{2,}", rest.strip()):
        heading, _, body = block.partition("\n")
        if heading in ("Example:", "Examples:"):
            examples = "\n".join(line.strip() for line in body.split("\n"))
        elif heading.endswith(":") and body.startswith("  "):
            groups[heading[:-1]] = parse_entries(body.split("\n"))
        elif heading.startswith("Exit codes: "):
            exit_codes = re.sub(r'\n"byre COMMAND.*', "", block.removeprefix("Exit codes: "))
        elif block:
            notes.append(block)
    return Help(summary.strip(), usage, groups, examples, exit_codes, notes)


def help_of(program: str, names: list[str]) -> Help:
    return parse_help(subprocess.run([program, *names, "--help"], check=True, capture_output=True, text=True).stdout)


def roff(text: str) -> str:
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^([.'])", r"\\&\1", text, flags=re.MULTILINE)


def heading(text: str) -> str:
    return f'.SH "{roff(text).upper()}"'


def paragraphs(texts: list[str]) -> list[str]:
    return [line for text in texts for line in (".PP", roff(text))]


def group_lines(groups: dict[str, list[Entry]]) -> list[str]:
    lines = []
    for name, entries in groups.items():
        lines.append(heading("commands" if name == COMMANDS else name))
        for entry in entries:
            lines += [".TP", rf"\fB{roff(entry.name)}\fR", roff(entry.text)]
    return lines


def example_lines(examples: str) -> list[str]:
    return [heading("examples"), ".nf", roff(examples), ".fi"] if examples else []


def below(program: str, names: list[str], of: Help) -> list[str]:
    """Section on the subcommands of a command."""
    lines = []
    for entry in of.groups.get(COMMANDS, []):
        inner = help_of(program, [*names, entry.name])
        lines += [heading(f"byre {' '.join(names)} {entry.name}"), ".B", roff(inner.usage)]
        lines += paragraphs([inner.summary + ".", *inner.notes]) + group_lines(inner.groups)
        lines += example_lines(inner.examples)
    return lines


def page(program: str, version: str, names: list[str], main: Help) -> str:
    own = help_of(program, names)
    title = "-".join(["byre", *names])
    others = [f"byre\\-{roff(entry.name)}(1)" for entry in main.groups[COMMANDS] if entry.name not in names]
    summary = own.summary.rstrip(".")
    lines = [f'.TH "{roff(title).upper()}" 1 "" "{version}" "byre"',
             heading("name"), rf"{roff(title)} \- {roff(summary[0].lower() + summary[1:])}",
             heading("synopsis"), ".B", roff(own.usage),
             heading("description"), *paragraphs([summary + ".", *own.notes]),
             *group_lines(own.groups), *example_lines(own.examples), *(below(program, names, own) if names else []),
             heading("exit status"), *paragraphs([own.exit_codes or main.exit_codes]),
             heading("see also"), ", ".join([*(["byre(1)"] if names else []), *others])]
    return "\n".join(lines) + "\n"


def main() -> int:
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    version = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout.strip()
    top = help_of(program, [])
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("byre*.1.gz"):  # may belong to removed commands
        old.unlink()
    for names in [[], *([entry.name] for entry in top.groups[COMMANDS])]:
        text = page(program, version, names, top).encode()
        (folder / f"{'-'.join(['byre', *names])}.1.gz").write_bytes(gzip.compress(text, 9, mtime=0))
    return 0


if __name__ == "__main__":
    sys.exit(main())
