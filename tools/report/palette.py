#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes pictures for the repository small, without changing the colours that their legends name."""
import sys
from pathlib import Path

from PIL import Image  # comes with matplotlib

from common import COLOURS, np

EXACT = ["#ffffff", "#000000", *COLOURS]
NEAR = 20  # of 255: what the eye takes for the same colour, in each of red, green and blue


def as_numbers(colours):
    return np.array([[int(colour[k:k + 2], 16) for k in (1, 3, 5)] for colour in colours])


def choose(image, size):
    """A palette for a picture: EXACT, and colours that spread over all that the picture has. By
    their spread, since a choice by how often colours occur gives thin lines and ends of colour bars
    to none."""
    chosen = image.quantize(size - len(EXACT), method=Image.Quantize.MAXCOVERAGE, kmeans=3,
                            dither=Image.Dither.NONE)
    others = np.array(chosen.getpalette()).reshape(-1, 3)[:size - len(EXACT)]
    exact, lines = as_numbers(EXACT), as_numbers(COLOURS)
    # Scaling has shifted most pixels of a thin line a little: none but its own colour is near.
    # Beside white and black this would take the pale and the dark end of a colour bar.
    away = np.abs(others[:, None] - lines[None]).max(axis=2).min(axis=1)
    return np.concatenate([exact, others[away > NEAR]])


def nearest(colours, palette):
    """The number of the nearest entry of the palette for each colour."""
    found = np.empty(len(colours), dtype=np.uint8)
    for k in range(0, len(colours), 2048):  # a table of all distances would take hundreds of MB
        away = colours[k:k + 2048, None, :].astype(np.int32) - palette[None]
        found[k:k + 2048] = (away ** 2).sum(axis=2).argmin(axis=1)
    return found


def indexed(image, size=256):
    """A picture with a palette, whose colours of EXACT stay what they are."""
    pixels = np.asarray(image).reshape(-1, 3)
    colours, which = np.unique(pixels, axis=0, return_inverse=True)
    palette = colours if len(colours) <= size else choose(image, size)
    small = Image.fromarray(nearest(colours, palette)[which].reshape(image.height, image.width))
    small.putpalette(palette.astype(np.uint8).tobytes())
    return small


def save(figure, path, **look):
    figure.savefig(path, **look)
    shrink(path)


def shrink(path, width=1500):
    """Makes a picture file small: at most `width` pixels wide and 200 kB, from a palette."""
    with Image.open(path) as file:
        image = file.convert("RGB")
    size = (width, round(image.height * width / image.width))
    indexed(image.resize(size, Image.LANCZOS) if image.width > width else image).save(
        path, optimize=True)
    if Path(path).stat().st_size > 200_000:
        shrink(path, min(width, image.width) - 100)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        shrink(name)
