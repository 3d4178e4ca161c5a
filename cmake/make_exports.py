#!/usr/bin/env python3
"""Writes the linker's export list of libbyre.so: the functions, classes and members that its headers declare.

Replaces -fvisibility=hidden, with which the compiler would inline more and poses would differ in their last digits.

Usage: make_exports.py VERSION OUTPUT HEADER...      VERSION: of the interface, "0.1"
"""
import pathlib
import re
import sys

COMMENT = re.compile(r"//[^\n]*")
CLASS = re.compile(r"^(?:class|struct) (\w+)[^;{]*\{\n(.*?)^\};", re.MULTILINE | re.DOTALL)
MEMBER = re.compile(r"^  (?! )(?:[A-Za-z][^(;{}\n]*[ >&*])?(~?\w+|operator\S+?)\(", re.MULTILINE)
FUNCTION = re.compile(r"^(?!inline\b|template\b|constexpr\b)[A-Za-z][\w:<>, ]*?[ >&*](\w+)\(((?:[^;{]|\{\})*)\);",
                      re.MULTILINE)
TYPE = re.compile(r"^(?:class|struct|enum class) (\w+)", re.MULTILINE)


def first_parameter(parameters: str, own_types: set[str]) -> str:
    """Type of the first parameter, which distinguishes overloads; empty if it may be an alias."""
    found = re.match(r"(?:const )?([\w:]+)", parameters)
    if found and found[1] in own_types:
        return f"byre::{found[1]}"
    return found[1] if found and found[1] in ("std::vector", "std::span") else ""


def patterns(text: str, own_types: set[str]) -> list[str]:
    result = []
    for name, parameters in FUNCTION.findall(CLASS.sub("", text)):
        first = first_parameter(parameters, own_types)
        result += [f"{name}({first}*", f"{name}[abi:*({first}*"]  # "[abi:cxx11]" marks functions that return strings
    for name, body in CLASS.findall(text):
        result += [f"{name}::{member}(*" for member in dict.fromkeys(MEMBER.findall(body))]
    return result


def exports(texts: list[str]) -> list[str]:
    own_types = {name for text in texts for name in TYPE.findall(text)}
    lines = [f"byre::{pattern}" for text in texts for pattern in patterns(text, own_types)]
    for text in texts:
        lines += [f"{kind} for byre::{name}" for name, _ in CLASS.findall(text)
                  for kind in ("vtable", "typeinfo", "typeinfo name")]
    # The linker's patterns consist of names, "::", "*" and "?" for any character.
    return [re.sub(r"(?<!:):(?!:)|[^\w:*]", "?", line) for line in lines]


def main() -> int:
    if len(sys.argv) < 4:
        print(__doc__, file=sys.stderr)
        return 2
    texts = [COMMENT.sub("", pathlib.Path(path).read_text(encoding="utf-8")) for path in sys.argv[3:]]
    listed = "".join(f"      {line};\n" for line in exports(texts))
    version = f"BYRE_{sys.argv[1]} {{\n  global:\n    extern \"C++\" {{\n{listed}    }};\n  local:\n    *;\n}};\n"
    pathlib.Path(sys.argv[2]).write_text(version, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
