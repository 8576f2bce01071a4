#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Pictures made small: lines keep the colours of the project, colour bars stay smooth, and a
picture of few colours loses nothing. Exit 77: a package is missing."""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import packages
with packages():
    import numpy as np
    import palette
    from PIL import Image
    from runfiles import COLOURS, STYLE, WIDTH, plt


def pixels(path):
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def rgb(colour):
    return [int(colour[k:k + 2], 16) for k in (1, 3, 5)]


def test_lines(folder):
    """As the figures of the validation are drawn: thin lines beside a picture of many colours. Each
    line has its very colour, and no pixel of it has turned into another's."""
    path = folder / "lines.png"
    time = np.linspace(0, 1, 400)
    figure, (left, right) = plt.subplots(1, 2, figsize=(WIDTH, 3), layout="constrained")
    for k, colour in enumerate(COLOURS):
        left.plot(time, k + 0.3 * np.sin(20 * time), color=colour, linewidth=0.8)
    shown = right.imshow(np.add.outer(time, time ** 2), cmap="viridis")
    figure.colorbar(shown)
    figure.savefig(path)
    before = pixels(path)
    palette.shrink(path)
    after = pixels(path)
    assert after.shape[1] == 1500, after.shape
    with Image.open(path) as image:
        assert image.mode == "P"
    scale = (after.shape[1] / before.shape[1]) ** 2
    for colour in COLOURS:
        wanted, found = (scale ** own * (np.abs(p - rgb(colour)).max(axis=2) == 0).sum()
                         for p, own in ((before, 1), (after, 0)))
        # Thin as they are, most of their pixels are mixed with white when the picture is scaled.
        assert found > 0.25 * wanted > 100, (colour, wanted, found)
    assert (after == 255).all(axis=2).mean() > 0.3


def test_smooth(folder):
    """Colour bars, one with a pale middle: no pixel is far off, and neighbours that differed still
    do."""
    path = folder / "bar.png"
    bar = np.concatenate([plt.get_cmap(name)(np.linspace(0, 1, 128), bytes=True)[:, :3]
                          for name in ("viridis", "RdBu")])
    noise = np.random.default_rng(1).integers(0, 4, (64, 256, 3))
    Image.fromarray((np.minimum(bar[None] + noise, 255)).astype(np.uint8)).save(path)
    before = pixels(path)
    palette.shrink(path)
    off = np.abs(pixels(path) - before).max(axis=2)
    assert off.max() <= 12 and off.mean() <= 3, (off.max(), off.mean())
    assert len(np.unique(pixels(path)[0], axis=0)) > 100


def test_few(folder):
    path = folder / "few.png"
    few = np.random.default_rng(2).integers(0, 256, (250, 3))[np.arange(10000) % 250]
    Image.fromarray(few.reshape(100, 100, 3).astype(np.uint8)).save(path)
    before = pixels(path)
    palette.shrink(path)
    assert np.array_equal(pixels(path), before)


def main():
    plt.rcParams.update(STYLE)
    with tempfile.TemporaryDirectory() as folder:
        for test in (test_lines, test_smooth, test_few):
            test(Path(folder))
    print("small pictures keep their colours")


if __name__ == "__main__":
    main()
