#!/usr/bin/env python3
"""Copies an EuRoC recording with dirt on its lenses: spots that dim and blur the image.

Usage: soil_lens.py RECORDING COPY SHARE [SEED]     SHARE: share of the image behind spots, 0 to 0.9, such as 0.3

The spots are fixed during the recording, and differ between the cameras. All other files are links to the recording,
which stays unchanged. Needs python3-numpy and python3-pil. Exit code: 0 done, 1 wrong usage or input.
"""
import csv
import pathlib
import sys

import numpy
from PIL import Image, ImageFilter

from cover_lens import link_all

BLUR_PIXELS = 10
GREY, TRANSPARENCY = 60.0, 0.25  # dried mud


def blots(size: tuple[int, int], share: float, seed: int) -> numpy.ndarray:
    """Opacity of the dirt at each pixel, 0 to 1, with soft edges."""
    width, height = size
    random = numpy.random.default_rng(seed)
    rows, columns = numpy.mgrid[0:height, 0:width]
    covered = numpy.zeros((height, width))
    while (covered > 0.5).mean() < share:
        radius = random.uniform(0.04, 0.14) * width
        distance = numpy.hypot(columns - random.uniform(0, width), rows - random.uniform(0, height))
        covered = numpy.maximum(covered, numpy.clip((radius - distance) / 12.0 + 0.5, 0.0, 1.0))
    return covered


def soil(camera: pathlib.Path, copy: pathlib.Path, share: float, seed: int) -> int:
    """Replaces the linked camera by the soiled one. Returns its number of images."""
    copy.unlink()
    link_all(camera, copy)
    (copy / "data").unlink()
    (copy / "data").mkdir()
    with (camera / "data.csv").open() as lines:
        names = [row[1].strip() for row in csv.reader(lines) if row and not row[0].startswith("#")]
    covered = None
    for name in names:
        image = Image.open(camera / "data" / name).convert("L")
        if covered is None:
            covered = blots(image.size, share, seed)
        blurred = numpy.asarray(image.filter(ImageFilter.GaussianBlur(BLUR_PIXELS)), dtype=float)
        behind = TRANSPARENCY * blurred + (1.0 - TRANSPARENCY) * GREY
        soiled = (1.0 - covered) * numpy.asarray(image, dtype=float) + covered * behind
        Image.fromarray(numpy.round(soiled).astype(numpy.uint8)).save(copy / "data" / name, compress_level=1)
    return len(names)


def main(arguments: list[str]) -> int:
    if len(arguments) not in (3, 4):
        print(__doc__, file=sys.stderr)
        return 1
    recording, copy, share = pathlib.Path(arguments[0]), pathlib.Path(arguments[1]), float(arguments[2])
    seed = int(arguments[3]) if len(arguments) == 4 else 1
    if copy.exists() or not (recording / "mav0" / "cam0" / "data.csv").exists() or not 0.0 < share < 0.9:
        print(f"soil_lens: {recording} is no EuRoC recording, {copy} exists already, or {share} is not between 0 and "
              "0.9", file=sys.stderr)
        return 1
    link_all(recording, copy)
    (copy / "mav0").unlink()
    link_all(recording / "mav0", copy / "mav0")
    for number, camera in enumerate(("cam0", "cam1")):
        if (recording / "mav0" / camera).exists():
            images = soil(recording / "mav0" / camera, copy / "mav0" / camera, share, 2 * seed + number)
            print(f"{camera}: {images} images soiled")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
