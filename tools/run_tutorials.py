#!/usr/bin/env python3
"""Runs the code blocks of documentation pages with an installed byre.

Usage: run_tutorials.py (--prefix DIR | --installed | --check) [--keep DIR] [--timeout SECONDS] PAGE...
  --prefix DIR       byre in DIR: of "cmake --install --prefix DIR", or the folder usr of unpacked Debian packages
  --installed        byre of the system
  --check            check the marks of the blocks, run nothing
  --keep DIR         run the pages in new folders in DIR and keep them; default: temporary folders
  --timeout SECONDS  longest time of a block, default 600

The blocks of a page run in order, in one folder per page. Exported variables and the working folder carry over from
block to block. HTML comments directly above a block, which readers do not see, mark it:

  <!-- file: NAME -->       is written to the file NAME, which the text above the block must name
  <!-- skip: REASON -->     is not run
  <!-- needs: A, B -->      is run only if these exist: programs, absolute paths, or commands that succeed
  <!-- interrupt: N -->     runs until Ctrl-C: receives SIGINT after N seconds, then must end within 30 seconds
  <!-- output -->           is output of the run block above: its lines occur there in this order. Numbers and spaces
                            may differ, lines "..." stand for any lines

A comment of several lines with commands runs as a block, for files that readers have of their own:

  <!-- setup
  byre simulate cowshed --duration 5 -o evening_round
  -->

Blocks without a mark: sh and bash run, and each command must return 0; blocks without a language are ignored; other
languages need a mark. Exit code: 0 all passed, 1 a block failed, 2 wrong usage or marks.
"""
import argparse
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from typing import Iterator, NamedTuple, Optional

SHELLS = {"sh", "bash"}
SETUP = re.compile(r" *<!-- *setup *$")
SYSTEM_PATH = "/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin"
FENCE = re.compile(r"( *)(`{3,}|~{3,}) *([\w+-]*)[^`]*$")
COMMENT = re.compile(r" *<!-- *(.*?) *--> *$")
MARK = re.compile(r"(?:(file|skip|needs): *(\S.*)|(interrupt): *(\d+(?:\.\d+)?)|(output))$")
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?")
GRACE_S = 30.0  # time to end after SIGINT

# Sourced by the shell of a block. Carries over variables and folder, and reports the failing command.
PREAMBLE = """unset BASH_ENV
[[ ! -f "{state}" ]] || source "{state}"
trap 'printf "%s\\t%s" "$LINENO" "$BASH_COMMAND" >"{failed}"' ERR
trap 'code=$?; trap - ERR; {{ export -p; printf "cd %q\\n" "$PWD"; }} >"{state}"; exit $code' EXIT
"""


class Fault(Exception):
    """Fault of the marks of a page."""


class Block(NamedTuple):
    line: int  # of the first line of code, counted from 1
    language: str
    text: str
    marks: dict[str, str]
    text_above: str  # visible text of the page above the block


class Page(NamedTuple):
    path: pathlib.Path
    blocks: list[Block]


class Outcome(NamedTuple):
    code: int
    output: str
    line: int
    command: str


def read_marks(comments: list[tuple[int, str]], path: pathlib.Path) -> dict[str, str]:
    marks: dict[str, str] = {}
    for line, comment in comments:
        found = MARK.match(comment)
        if not found:
            raise Fault(f"{path}:{line}: comment above a block is no mark: {comment}")
        name, value = found[1] or found[3] or found[5], found[2] or found[4] or ""
        if name in marks:
            raise Fault(f"{path}:{line}: repeated mark {name}")
        marks[name] = value
    return marks


def blocks_of(path: pathlib.Path) -> Iterator[Block]:
    lines = path.read_text(encoding="utf-8").splitlines()
    comments: list[tuple[int, str]] = []
    visible: list[str] = []
    i = 0
    while i < len(lines):
        fence = FENCE.match(lines[i])
        comment = COMMENT.match(lines[i])
        if comment:
            comments.append((i + 1, comment[1]))
        elif SETUP.match(lines[i]):
            start = i + 1
            end = next((j for j in range(start, len(lines)) if lines[j].strip() == "-->"), None)
            if end is None:
                raise Fault(f"{path}:{start}: setup without end")
            yield Block(start + 1, "sh", "\n".join(lines[start:end]) + "\n", {}, "")
            comments = []
            i = end
        elif fence:
            start = i + 1
            end = next((j for j in range(start, len(lines)) if lines[j].strip() == fence[2]), None)
            if end is None:
                raise Fault(f"{path}:{start}: block without end")
            indent = len(fence[1])
            code = [line[indent:] if not line[:indent].strip() else line for line in lines[start:end]]
            yield Block(start + 1, fence[3], "\n".join(code) + "\n", read_marks(comments, path), "\n".join(visible))
            visible += code
            comments = []
            i = end
        else:
            visible.append(lines[i])
            comments = []
        i += 1


def check_marks(block: Block, path: pathlib.Path) -> None:
    def refuse(reason: str) -> None:
        raise Fault(f"{path}:{block.line}: {reason}")

    marks = block.marks
    if len({"file", "skip", "output"} & marks.keys()) > 1 or {"file", "interrupt"} <= marks.keys():
        refuse(f"contradicting marks: {', '.join(sorted(marks))}")
    if "output" in marks and block.language:
        refuse("output has no language")
    if not block.language and marks.keys() - {"output"}:
        refuse("block without a language has a mark other than output")
    if block.language and block.language not in SHELLS and not {"file", "skip"} & marks.keys():
        refuse(f"{block.language} block has neither a file nor a reason to skip it")
    if name := marks.get("file"):
        if pathlib.PurePath(name).is_absolute() or ".." in pathlib.PurePath(name).parts:
            refuse(f"file {name} leaves the folder of the page")
        if f"`{name}`" not in block.text_above:
            refuse(f"the text above does not name the file `{name}`")


def read_page(path: pathlib.Path) -> Page:
    page = Page(path, list(blocks_of(path)))
    for block in page.blocks:
        check_marks(block, path)
    return page


def environment(prefix: Optional[pathlib.Path], home: pathlib.Path) -> dict[str, str]:
    """Environment of a reader: system programs first, no settings of byre, and the installed byre if not the system's."""
    env = {name: value for name, value in os.environ.items() if not name.startswith(("BYRE_", "PYTHON", "XDG_"))}
    for name in ("CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH", "PKG_CONFIG_PATH", "MAKEFLAGS", "CDPATH", "DESTDIR",
                 "ROS_DOMAIN_ID", "CYCLONEDDS_URI"):
        env.pop(name, None)
    env.update(HOME=str(home), LC_ALL="C.UTF-8", TERM="dumb", PYTHONDONTWRITEBYTECODE="1")
    env.update(ROS_LOCALHOST_ONLY="1", ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST")  # DDS stays on this machine
    env["PATH"] = SYSTEM_PATH + ":" + env.get("PATH", "")
    if prefix is None:
        return env
    libraries = [str(folder) for folder in (prefix / "lib", *sorted(prefix.glob("lib/*-linux-gnu*"))) if folder.is_dir()]
    packages = [str(folder) for folder in sorted(prefix.glob("lib/python3*/dist-packages"))]
    env["PATH"] = f"{prefix}/bin:{env['PATH']}"
    env["CMAKE_PREFIX_PATH"] = str(prefix)
    env["LD_LIBRARY_PATH"] = ":".join(libraries)
    env["PKG_CONFIG_PATH"] = ":".join(f"{folder}/pkgconfig" for folder in libraries)
    env["PYTHONPATH"] = ":".join(packages)
    return env


def missing_needs(needs: str, env: dict[str, str]) -> list[str]:
    def exists(need: str) -> bool:
        if need.startswith("/") and " " not in need:
            return os.path.exists(need)
        if " " not in need:
            return shutil.which(need, path=env["PATH"]) is not None
        return subprocess.run(["bash", "-c", need], env=env, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, check=False).returncode == 0

    return [need for need in re.split(r" *, *", needs) if not exists(need)]


def shape_of(text: str) -> list[str]:
    """Lines with numbers and spaces made equal, without empty lines."""
    lines = (" ".join(NUMBER.sub("0", line).split()) for line in text.splitlines())
    return [line for line in lines if line]


def missing_line(expected: str, output: str) -> Optional[str]:
    """First line of the expected output that the output lacks."""
    remaining = iter(shape_of(output))
    for line in expected.splitlines():
        shape = shape_of(line)
        if shape and shape[0] != "..." and not any(other == shape[0] for other in remaining):
            return line
    return None


def reset_sigint() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # ignored in background jobs, and then in all their children


class Runner:
    """Runs the blocks of one page."""

    def __init__(self, folder: pathlib.Path, env: dict[str, str], timeout_s: float) -> None:
        self.page_folder = folder / "page"
        self.state = folder / "state"
        self.failed = folder / "failed"
        self.script = folder / "block.sh"
        self.preamble = folder / "preamble.sh"
        self.env = {**env, "BASH_ENV": str(self.preamble)}
        self.timeout_s = timeout_s
        self.page_folder.mkdir(parents=True)
        self.preamble.write_text(PREAMBLE.format(state=self.state, failed=self.failed), encoding="utf-8")

    def write(self, block: Block) -> None:
        path = self.page_folder / block.marks["file"]
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(block.text, encoding="utf-8")

    def run(self, block: Block) -> Outcome:
        self.script.write_text("\n" * (block.line - 1) + block.text, encoding="utf-8")  # line numbers of the page
        self.failed.unlink(missing_ok=True)
        interrupt_s = float(block.marks["interrupt"]) if "interrupt" in block.marks else None
        with subprocess.Popen(["bash", "-eE", "-o", "pipefail", str(self.script)], cwd=self.page_folder, env=self.env,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              start_new_session=True, preexec_fn=reset_sigint) as process:
            try:
                output, _ = process.communicate(timeout=self.timeout_s if interrupt_s is None else interrupt_s)
                code = process.returncode
                if interrupt_s is not None and code == 0:
                    return Outcome(1, output.decode(errors="replace"), block.line, "block ended before Ctrl-C")
            except subprocess.TimeoutExpired:
                if interrupt_s is None:
                    return Outcome(124, self.killed(process), block.line, f"block took more than {self.timeout_s:g} s")
                os.killpg(process.pid, signal.SIGINT)
                try:
                    output, _ = process.communicate(timeout=GRACE_S)
                except subprocess.TimeoutExpired:
                    return Outcome(124, self.killed(process), block.line, "block did not end after Ctrl-C")
                code = 0 if process.returncode in (0, 130, -signal.SIGINT) else process.returncode
        line, command = block.line, "block"
        if code != 0 and self.failed.exists():
            number, _, command = self.failed.read_text(encoding="utf-8").partition("\t")
            line = max(int(number), block.line)
        return Outcome(code, output.decode(errors="replace"), line, command)

    @staticmethod
    def killed(process: subprocess.Popen) -> str:
        """Ends the group of the process, and returns its output."""
        os.killpg(process.pid, signal.SIGKILL)
        return process.communicate()[0].decode(errors="replace")


def print_failure(place: str, reason: str, output: str) -> None:
    print(f"{place}: {reason}")
    for line in output.splitlines():
        print(f"    | {line}")


def run_page(page: Page, folder: pathlib.Path, env: dict[str, str], timeout_s: float) -> bool:
    runner = Runner(folder, env, timeout_s)
    counts = {"run": 0, "written": 0, "compared": 0}
    left_out: list[str] = []
    output: Optional[str] = None  # of the last block, empty if it was not run
    start = time.monotonic()
    for block in page.blocks:
        place = f"{page.path}:{block.line}"
        marks = block.marks
        if not block.language and "output" not in marks:
            continue
        missing = missing_needs(marks["needs"], env) if "needs" in marks else []
        if "skip" in marks or missing:
            left_out.append(f"{place}: not run: {marks['skip'] if 'skip' in marks else 'needs ' + ', '.join(missing)}")
            if block.language in SHELLS:
                output = None
        elif "output" in marks:
            if output is None:
                left_out.append(f"{place}: not compared: the block above was not run")
            elif line := missing_line(block.text, output):
                print_failure(place, f"output lacks: {line}", output)
                return False
            else:
                counts["compared"] += 1
        elif "file" in marks:
            runner.write(block)
            counts["written"] += 1
        else:
            outcome = runner.run(block)
            if outcome.code != 0:
                print_failure(f"{page.path}:{outcome.line}", f"{outcome.command}: exit code {outcome.code}",
                              outcome.output)
                return False
            output = outcome.output
            counts["run"] += 1
    print(f"{page.path}: {counts['run']} blocks run, {counts['written']} files written, {counts['compared']} outputs "
          f"compared, {len(left_out)} blocks left out, {time.monotonic() - start:.1f} s")
    for line in left_out:
        print(f"  {line}")
    return True


def run_pages(pages: list[Page], arguments: argparse.Namespace, folder: pathlib.Path) -> bool:
    env = environment(None if arguments.installed else arguments.prefix.resolve(), folder / "home")
    (folder / "home").mkdir(parents=True, exist_ok=True)
    passed = True
    for index, page in enumerate(pages, 1):
        passed &= run_page(page, folder / f"{index}_{page.path.stem}", env, arguments.timeout)
        sys.stdout.flush()
    return passed


def main() -> int:
    parser = argparse.ArgumentParser(usage=argparse.SUPPRESS, description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("--prefix", type=pathlib.Path, help=argparse.SUPPRESS)
    source.add_argument("--installed", action="store_true", help=argparse.SUPPRESS)
    source.add_argument("--check", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--keep", type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("--timeout", type=float, default=600.0, help=argparse.SUPPRESS)
    parser.add_argument("pages", metavar="PAGE", nargs="+", type=pathlib.Path, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.prefix and not arguments.prefix.is_dir():
        parser.error(f"--prefix {arguments.prefix} is no folder")
    try:
        pages = [read_page(path) for path in arguments.pages]
    except (Fault, OSError, UnicodeDecodeError) as fault:
        print(fault, file=sys.stderr)
        return 2
    if arguments.check:
        return 0
    if arguments.keep:
        arguments.keep.mkdir(parents=True, exist_ok=True)
        folder = pathlib.Path(tempfile.mkdtemp(prefix="tutorials.", dir=arguments.keep.resolve()))
        return 0 if run_pages(pages, arguments, folder) else 1
    with tempfile.TemporaryDirectory(prefix="tutorials.") as folder:
        return 0 if run_pages(pages, arguments, pathlib.Path(folder)) else 1


if __name__ == "__main__":
    sys.exit(main())
