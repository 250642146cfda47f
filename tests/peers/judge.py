"""Are two images, each a mean of independent samples, estimates of the same one?

For each block of pixels and each channel, Welch's t

    t = (a - b) / sqrt(va + vb)

with the variances of the block's means. The first image brings the variance of each pixel's mean, the second is many
independent renderings. t becomes the z of the same tail probability (Wallace 1959), since degrees of freedom are few.
"""

from dataclasses import dataclass

import numpy as np

LIMIT = 4.9  # about 1e-6, two-sided
ROUNDING = 1e-5  # relative, of films that add up in single precision: a deviation, too, where nothing is random


@dataclass
class Verdict:
    largest: float  # |z| of any block
    where: tuple  # block row, column, channel
    mean: float  # of z over blocks
    rms: float
    blocks: int  # that are not without noise
    difference: float  # of the image's means, relative
    resolution: float  # its standard error
    z: float  # of the image's mean, the channel that differs most

    @property
    def agrees(self):
        return self.largest < LIMIT and abs(self.z) < LIMIT


def blocks(image, size):
    """Means over square blocks of the last three axes (height, width, channel)."""
    *outer, height, width, channels = image.shape
    shape = (*outer, height // size, size, width // size, size, channels)
    return image.reshape(shape).mean(axis=(-4, -2))


def welch(mean, variance, renderings, samples):
    """z for each entry; NaN where there is no noise and the same value. `samples`: of the first image, per entry."""
    count = len(renderings)
    other = renderings.mean(0)
    spread = renderings.var(0, ddof=1) / count
    total = variance + spread
    equal = (total == 0) & np.isclose(mean, other, rtol=1e-6, atol=0)
    total = np.maximum(total + (ROUNDING * other) ** 2, 1e-300)
    t = np.where(equal, np.nan, (mean - other) / np.sqrt(total))
    freedom = total**2 / np.maximum(variance**2 / (samples - 1) + spread**2 / (count - 1), 1e-300)
    freedom = np.clip(freedom, 1, 1e9)
    z = (8 * freedom + 1) / (8 * freedom + 3) * np.sqrt(freedom * np.log1p(t * t / freedom))
    return np.copysign(z, t)


def judge(mean, variance, spp, renderings, size=8):
    """`mean`, `variance` of the mean: (height, width, 3); `renderings`: (count, height, width, 3)."""
    pixels = size * size
    z = welch(blocks(mean, size), blocks(variance, size) / pixels, blocks(renderings, size), spp * pixels)
    where = np.unravel_index(np.nanargmax(np.abs(z)), z.shape)
    everything = mean[..., 0].size
    whole = mean.mean((0, 1)), variance.mean((0, 1)) / everything, renderings.mean((1, 2))
    whole_z = welch(*whole, spp * everything)
    channel = np.nanargmax(np.abs(whole_z))
    a, b = whole[0][channel], whole[2][:, channel]
    error = np.sqrt(whole[1][channel] + b.var(ddof=1) / len(b))
    return Verdict(
        largest=float(np.nanmax(np.abs(z))),
        where=tuple(int(i) for i in where),
        mean=float(np.nanmean(z)),
        rms=float(np.sqrt(np.nanmean(z * z))),
        blocks=int(np.isfinite(z).all(-1).sum()),
        difference=float(a / b.mean() - 1),
        resolution=float(error / b.mean()),
        z=float(whole_z[channel]),
    )
