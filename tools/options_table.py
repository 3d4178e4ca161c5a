#!/usr/bin/env python3
"""Updates the table of a page: options of "byre map --print-options", or with --node settings of the node.

Usage: options_table.py PROGRAM PAGE [--node] [--check]
  PROGRAM   byre
  PAGE      docs/reference/options.md; with --node docs/reference/ros2_settings.md
  --node    settings of "byre node --print-config"
  --check   does not write the page

The table is between the lines BEGIN and END (below) of the page. Exit code: 0 the page was up to date, 1 it was
outdated (updated without --check), 2 wrong usage, a page without these lines, or output that cannot be parsed.
"""
import pathlib
import re
import subprocess
import sys
from typing import Iterator, NamedTuple

BEGIN = "<!-- The table is written by tools/options_table.py. -->"
END = "<!-- End of the table. -->"
LINE = re.compile(r"(?P<indent> *)(?P<word>\w+): (?P<value>\S+)  # (?P<meaning>.*) \((?P<facts>[^()]*)\)")
GROUP = re.compile(r"(\w+):")


class Option(NamedTuple):
    name: str
    unit: str
    range: str
    default: str
    meaning: str

    def row(self, has_units: bool) -> str:
        accepted = self.range.replace("|", ", ")
        unit = f" {self.unit} |" if has_units else ""
        return f"| `{self.name}` |{unit} {self.default} | {accepted} | {self.meaning} |"


def options_in(text: str) -> Iterator[Option]:
    group = ""
    for line in text.splitlines():
        if found := GROUP.fullmatch(line):
            group = found[1] + "."
        elif found := LINE.fullmatch(line):
            *unit, accepted = found["facts"].split(", ")
            name = (group if found["indent"] else "") + found["word"]
            yield Option(name, "".join(unit), accepted, found["value"], found["meaning"])
        else:
            raise ValueError(f"line is no option: {line}")


def table_of(text: str) -> str:
    options = list(options_in(text))
    if not options:
        raise ValueError("the program prints no options")
    has_units = any(option.unit for option in options)
    head = ["option", *(["unit"] if has_units else []), "default", "accepted", "meaning"]
    rows = [option.row(has_units) for option in options]
    return "\n".join([f"| {' | '.join(head)} |", "|---" * len(head) + "|", *rows])


def with_table(page: str, table: str) -> str:
    if page.count(BEGIN) != 1 or page.count(END) != 1:
        raise ValueError(f"the page lacks the lines '{BEGIN}' and '{END}'")
    before, rest = page.split(BEGIN)
    return f"{before}{BEGIN}\n\n{table}\n\n{END}{rest.split(END)[1]}"


def main(arguments: list[str]) -> int:
    names = [argument for argument in arguments if not argument.startswith("-")]
    if len(names) != 2 or any(argument not in (*names, "--node", "--check") for argument in arguments):
        print(__doc__, file=sys.stderr)
        return 2
    program, path = names[0], pathlib.Path(names[1])
    command = ["node", "--print-config"] if "--node" in arguments else ["map", "--print-options"]
    printed = subprocess.run([program, *command], capture_output=True, text=True, check=True).stdout
    page = path.read_text(encoding="utf-8")
    try:
        wanted = with_table(page, table_of(printed))
    except ValueError as error:
        print(f"{path}: {error}", file=sys.stderr)
        return 2
    if page == wanted:
        return 0
    if "--check" in arguments:
        node = " --node" if "--node" in arguments else ""
        print(f"{path}: the table is outdated: run tools/options_table.py {program} {path}{node}")
    else:
        path.write_text(wanted, encoding="utf-8")
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
