#!/usr/bin/env python3
"""Checks the relative links and anchors of all Markdown files below a folder. Uses no network.

Usage: check_links.py [FOLDER]        FOLDER: repository, default: the parent of this script's folder

Checks inline links and images, reference definitions, and href, src of HTML tags. A relative link names a file or
folder below FOLDER; an anchor into a Markdown file names a heading, by GitHub's rule, or the id or name of an HTML tag.
Ignores links with a scheme (https:, mailto:), code, and folders named build, node_modules or with a leading dot.
Exit code: 0 no broken link, 1 broken links (one line each), 2 wrong usage.
"""
import pathlib
import re
import sys
from typing import Iterator, NamedTuple
from urllib.parse import unquote

SKIPPED = {"build", "node_modules"}
FENCE = re.compile(r" {0,3}(`{3,}|~{3,})(.*)")
HEADING = re.compile(r" {0,3}(#{1,6})[ \t]+(.*?)[ \t]*#*[ \t]*$")
UNDERLINE = re.compile(r" {0,3}(=+|-+)[ \t]*$")
CODE = re.compile(r"(?<!`)(`+)(?!`).+?(?<!`)\1(?!`)", re.DOTALL)
INLINE = re.compile(r"\]\(\s*(?:<([^<>]*)>|((?:[^\s()]|\([^\s()]*\))*))(?:\s+(?:\"[^\"]*\"|'[^']*'))?\s*\)")
DEFINITION = re.compile(r" {0,3}\[(?!\^)[^\]]+\]:\s*(?:<([^<>]*)>|(\S+))")
TAG = re.compile(r"<[a-z][^<>]*?\s(?:href|src)\s*=\s*[\"']([^\"']*)[\"']", re.IGNORECASE)
TAG_ID = re.compile(r"<[a-z][^<>]*?\s(?:id|name)\s*=\s*[\"']([^\"']*)[\"']", re.IGNORECASE)
SCHEME = re.compile(r"[a-z][a-z0-9+.-]*:|//", re.IGNORECASE)


class Fault(NamedTuple):
    path: pathlib.Path
    line: int
    message: str


class Page(NamedTuple):
    links: list[tuple[int, str]]  # line, counted from 1, and target
    anchors: set[str]


def prose_of(text: str) -> Iterator[tuple[int, str]]:
    """Numbered lines outside of fenced code and HTML comments."""
    fence, is_comment = "", False
    for number, line in enumerate(text.splitlines(), 1):
        if found := FENCE.match(line):
            mark = found[1]
            if not fence:
                fence = mark
                continue
            if mark[0] == fence[0] and len(mark) >= len(fence) and not found[2].strip():
                fence = ""
                continue
        if fence:
            continue
        if is_comment or "<!--" in line:
            start = 0 if is_comment else line.index("<!--")
            end = line.find("-->", start)
            is_comment = end < 0
            line = line[:start] + ("" if is_comment else line[end + 3:])
        yield number, line


def without_code(lines: list[tuple[int, str]]) -> Iterator[tuple[int, str]]:
    """Lines without code spans, which may continue over the lines of a paragraph."""
    paragraph: list[tuple[int, str]] = []
    for number, line in [*lines, (0, "")]:
        if line.strip():
            paragraph.append((number, line))
            continue
        text = CODE.sub(lambda span: "\n" * span[0].count("\n"), "\n".join(line for _, line in paragraph))
        yield from zip((number for number, _ in paragraph), text.split("\n"))
        paragraph = []


def slug_of(heading: str) -> str:
    """Anchor of a heading by GitHub's rule."""
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)  # a link's text
    text = re.sub(r"[`*]|<[^<>]*>", "", text)
    return re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")


def read_page(path: pathlib.Path) -> Page:
    links, anchors = [], set()
    counts: dict[str, int] = {}
    last = ""
    lines = list(prose_of(path.read_text(encoding="utf-8")))
    for _, line in lines:
        heading = HEADING.match(line)
        title = heading[2] if heading else last if UNDERLINE.match(line) and last else None
        if title is not None:
            slug = slug_of(title)
            count = counts.get(slug, 0)
            counts[slug] = count + 1
            anchors.add(f"{slug}-{count}" if count else slug)
        last = "" if heading or line.lstrip().startswith(("|", "-", "*", ">")) else line.strip()
    for number, text in without_code(lines):
        anchors.update(TAG_ID.findall(text))
        found = [first or second for first, second in INLINE.findall(text)]
        if definition := DEFINITION.match(text):
            found.append(definition[1] or definition[2])
        links += [(number, target) for target in found + TAG.findall(text)]
    return Page(links, anchors)


def markdown_files(root: pathlib.Path) -> Iterator[pathlib.Path]:
    for entry in sorted(root.iterdir()):
        if entry.is_symlink() or entry.name.startswith(".") or entry.name in SKIPPED:
            continue
        if entry.is_dir():
            yield from markdown_files(entry)
        elif entry.suffix == ".md":
            yield entry


def fault_of(target: str, path: pathlib.Path, root: pathlib.Path, pages: dict[pathlib.Path, Page]) -> str | None:
    if SCHEME.match(target):
        return None
    name, _, anchor = target.partition("#")
    name = unquote(name.partition("?")[0])
    if name.startswith("/"):
        return "is absolute"
    file = (path.parent / name).resolve() if name else path
    if not file.is_relative_to(root):
        return f"leaves {root.name}"
    if not file.exists():
        return "names no file"
    if anchor and file in pages and unquote(anchor) not in pages[file].anchors:
        return f"names no heading of {file.relative_to(root)}"
    return None


def faults(folder: pathlib.Path) -> list[Fault]:
    root = folder.resolve()
    pages = {path: read_page(path) for path in markdown_files(root)}
    found = []
    for path, page in pages.items():
        for line, target in page.links:
            if fault := fault_of(target, path, root, pages):
                found.append(Fault(path, line, f"link '{target}' {fault}"))
    return found


def main(arguments: list[str]) -> int:
    default = pathlib.Path(__file__).resolve().parent.parent
    folder = pathlib.Path(arguments[0]) if arguments else default
    if len(arguments) > 1 or not folder.is_dir():
        print(__doc__, file=sys.stderr)
        return 2
    found = faults(folder)
    for fault in found:
        print(f"{fault.path.relative_to(folder.resolve())}:{fault.line}: {fault.message}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
