#!/usr/bin/env python3
"""Prints the size of the product: lines of C++ without tests, and types per 1,000 of these lines.

Usage: product_size.py [FOLDER]      FOLDER: project, default: the current folder

Counts .h and .cc files in include, src and python, except tests (*_test.cc) and their helpers (*_scene.h,
*_matchers.h). A type is a class, struct or enum with a body.
"""
import pathlib
import re
import sys

TYPE = re.compile(r"^\s*(?:template\s*<[^>]*>\s*)?(?:class|struct|enum class|enum)\s+\w+[^;=()]*\{", re.MULTILINE)
OF_TESTS = re.compile(r"(_test|_scene|_matchers)\.(cc|h)$")


def main() -> int:
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    files = [path for folder in ("include", "src", "python") for path in sorted((root / folder).rglob("*"))
             if path.suffix in (".h", ".cc") and not OF_TESTS.search(path.name)]
    if not files:
        print(f"product_size.py: no C++ files in {root}", file=sys.stderr)
        return 2
    texts = [path.read_text(encoding="utf-8") for path in files]
    lines = sum(text.count("\n") for text in texts)
    types = sum(len(TYPE.findall(text)) for text in texts)
    print(f"Product: {lines:,} lines of C++ in {len(files)} files, {1000.0 * types / lines:.1f} types per 1,000 lines")
    return 0


if __name__ == "__main__":
    sys.exit(main())
