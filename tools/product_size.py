#!/usr/bin/env python3
"""Prints the size of the product: lines of C++ without tests, rooms and floors, types per 1,000 lines, and words of its
documentation.

Usage: product_size.py [FOLDER]      FOLDER: project, default: the current folder

Lines: .h and .cc files in include, src and python, except tests (*_test.cc) and their helpers (*_scene.h,
*_matchers.h, *_fixture.h). A type is a class, struct or enum with a body. Rooms and floors: FLOORS of
tools/check_floors.py.
Documentation: README.md and the pages of docs, except experiments (docs/lab) and generated pages.
"""
import pathlib
import re
import sys

import check_floors

TYPE = re.compile(r"^\s*(?:template\s*<[^>]*>\s*)?(?:class|struct|enum class|enum)\s+\w+[^;=()]*\{", re.MULTILINE)
OF_TESTS = re.compile(r"(_test|_scene|_matchers|_fixture)\.(cc|h)$")
GENERATED = {"docs/reference/options.md", "docs/reference/ros2_settings.md"}  # by tools/options_table.py


def documents(root: pathlib.Path) -> list[pathlib.Path]:
    pages = [root / "README.md", *sorted((root / "docs").rglob("*.md"))]
    return [page for page in pages if page.is_file() and page.relative_to(root).as_posix() not in GENERATED
            and "lab" not in page.relative_to(root).parts]


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
    rooms = sum(len(floor) for floor in check_floors.FLOORS)
    pages = documents(root)
    words = sum(len(page.read_text(encoding="utf-8").split()) for page in pages)
    print(f"Product: {lines:,} lines of C++ in {len(files)} files, {rooms} rooms on {len(check_floors.FLOORS)} floors, "
          f"{1000.0 * types / lines:.1f} types per 1,000 lines")
    print(f"Documentation: {words:,} words on {len(pages)} pages")
    return 0


if __name__ == "__main__":
    sys.exit(main())
