#!/usr/bin/env python3
"""Checks that a shared library exports all that its headers declare, and nothing else.

Usage: check_exports.py LIBRARY HEADERS      HEADERS is the folder include/byre
Prints one line per fault. Exit code: 0 none, 1 faults found.
"""
import collections
import pathlib
import re
import subprocess
import sys

NOT_IN_IT = ("colmap.h", "floor_plan.h", "recording.h")  # of the component data, which is static only
FUNCTION = re.compile(r"(?!inline|template|constexpr|using)[A-Za-z][\w:<>, ]*?[ >&*](\w+)\(")
TYPE = re.compile(r"(?:class|struct|enum class) (\w+)")


def declared(folder: pathlib.Path) -> tuple[collections.Counter, set[str]]:
    """Number of functions by name, and the types, including nested ones."""
    functions, types = collections.Counter(), set()
    for path in folder.glob("*.h"):
        text = re.sub(r"^(template <.*>)\n", r"\1 ", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
        for line in text.split("\n"):
            if found := TYPE.match(line.strip()):
                types.add(found[1])
            elif (found := FUNCTION.match(line)) and path.name not in NOT_IN_IT:
                functions[found[1]] += 1
    return functions, types


def exported_symbols(library: str) -> set[str]:
    listed = subprocess.run(["nm", "--dynamic", "--demangle", "--defined-only", library], check=True,
                            capture_output=True, text=True).stdout
    lines = [line.split(" ", 2) for line in listed.splitlines()]
    return {re.sub(r"@@\S*$", "", symbol) for _, kind, symbol in lines if kind != "A"}  # A: version symbol


def is_declared(symbol: str, functions: collections.Counter, types: set[str]) -> bool:
    """Whether it is byre::function(...), byre::Type::member(...) or type information, with declared types only."""
    if found := re.match(r"(?:vtable|typeinfo|typeinfo name) for byre::(\w+)$", symbol):
        return found[1] in types
    own = re.match(r"byre::(\w+)(?:::([~\w]+|operator[^(]+))?(?:\[abi:\w+\])?\(", symbol)
    if not own or not (own[1] in types if own[2] else own[1] in functions):
        return False
    arguments = symbol[own.end():]
    return all(name in types for name in re.findall(r"byre::(\w+)", arguments))


def main() -> int:
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    functions, types = declared(pathlib.Path(sys.argv[2]))
    symbols = exported_symbols(sys.argv[1])
    faults = [f"{symbol} is exported, and no header declares it"
              for symbol in sorted(symbols) if not is_declared(symbol, functions, types)]
    for name, count in sorted(functions.items()):
        found = sum(1 for symbol in symbols if re.match(rf"byre::{name}(?:\[abi:\w+\])?\(", symbol))
        if found != count:
            faults.append(f"byre::{name} is declared {count} times, and exported {found} times")
    print("\n".join(faults) or f"{len(symbols)} symbols are exported, {functions.total()} functions among them")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
