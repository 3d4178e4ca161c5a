#!/usr/bin/env python3
"""Copies an EuRoC recording with covered lenses: all images in the given gaps are black.

Usage: cover_lens.py RECORDING COPY FROM:TO [FROM:TO ...]      seconds from the first frame

All other files are links to the recording, which stays unchanged. Exit code: 0 done, 1 wrong usage or input.
"""
import csv
import os
import pathlib
import struct
import sys
import zlib


def black_png(width: int, height: int) -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    rows = bytes(height * (width + 1))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def size_of(png: pathlib.Path) -> tuple[int, int]:
    with png.open("rb") as file:
        return struct.unpack(">II", file.read(24)[16:])


def link_all(source: pathlib.Path, target: pathlib.Path) -> None:
    target.mkdir(parents=True)
    for entry in source.iterdir():
        os.symlink(entry.resolve(), target / entry.name)


def cover(camera: pathlib.Path, copy: pathlib.Path, gaps: list[tuple[float, float]]) -> int:
    """Replaces the linked camera by the covered one. Returns the number of black images."""
    copy.unlink()
    link_all(camera, copy)
    (copy / "data").unlink()
    (copy / "data").mkdir()
    with (camera / "data.csv").open() as lines:
        rows = [row for row in csv.reader(lines) if row and not row[0].startswith("#")]
    first = int(rows[0][0])
    black = black_png(*size_of(camera / "data" / rows[0][1].strip()))
    covered = 0
    for stamp, name in ((int(row[0]), row[1].strip()) for row in rows):
        seconds = (stamp - first) * 1e-9
        if any(begin <= seconds < end for begin, end in gaps):
            (copy / "data" / name).write_bytes(black)
            covered += 1
        else:
            os.symlink((camera / "data" / name).resolve(), copy / "data" / name)
    return covered


def main(arguments: list[str]) -> int:
    if len(arguments) < 3:
        print(__doc__, file=sys.stderr)
        return 1
    recording, copy = pathlib.Path(arguments[0]), pathlib.Path(arguments[1])
    gaps = [tuple(float(number) for number in gap.split(":")) for gap in arguments[2:]]
    if copy.exists() or not (recording / "mav0" / "cam0" / "data.csv").exists():
        print(f"cover_lens: {recording} is no EuRoC recording, or {copy} exists already", file=sys.stderr)
        return 1
    link_all(recording, copy)
    (copy / "mav0").unlink()
    link_all(recording / "mav0", copy / "mav0")
    for camera in ("cam0", "cam1"):
        if (recording / "mav0" / camera).exists():
            print(f"{camera}: {cover(recording / 'mav0' / camera, copy / 'mav0' / camera, gaps)} images covered")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
