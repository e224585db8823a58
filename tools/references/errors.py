"""Errors of images: their reference, bias, mean squared errors, FLIP and fireflies, and times to an error."""

import math
from dataclasses import dataclass

import numpy as np

# Added to the squared reference in relative errors, as `spherule compare` does.
EPSILON = 0.01
# Edge of the blocks in which two renderers are compared, as a fraction of the image's.
BLOCKS = 16
# A firefly is brighter than the reference around it by this factor, and by this share of the image's mean.
FIREFLY, FIREFLY_SHARE = 10.0, 0.01


class LongRender:
    """Independent images of one renderer, of the same scene and settings."""

    def __init__(self, images):
        self.images = images
        self.count = len(images)
        self.mean = np.mean(images, axis=0)
        # Variance of the mean.
        self.variance = np.var(images, axis=0, ddof=1) / self.count
        self.block_means = [blocks(image) for image in images]

    def noise(self):
        """Returns the relative mean squared error of the mean."""
        return float((self.variance / (self.mean**2 + EPSILON)).mean())

    def block_variance(self):
        """Returns the variance of each block's mean over pixels and channels.

        The variances of pixels are more certain than that of the few block means; their sum is raised if the blocks vary more than
        independent pixels would.
        """
        channels, size = self.mean.shape[2], self.mean[:, :, 0].size // BLOCKS**2
        # Channels of a pixel are dependent: the standard deviation of their mean is at most the mean of theirs.
        pixels = blocks(np.sqrt(self.variance).mean(axis=2, keepdims=True) ** 2) / size
        between = np.var(self.block_means, axis=0, ddof=1) / self.count
        lit = pixels > 0
        ratio = np.mean(between[lit] / pixels[lit]) if lit.any() and channels else 1.0
        return pixels * max(ratio, 1.0)


@dataclass
class Agreement:
    """The comparison of two long renders."""

    means: tuple[float, float]
    sigma: float
    """Difference of the means in standard errors."""
    squared: float
    """Mean over blocks of the squared difference divided by its variance; 1 if images differ only by noise."""
    worst: float
    """Largest difference of a block in standard errors."""


def blocks(image):
    """Returns the means of an image over blocks and channels."""
    height, width, channels = image.shape
    h, w = height // BLOCKS, width // BLOCKS
    whole = image[: h * BLOCKS, : w * BLOCKS]
    return whole.reshape(BLOCKS, h, BLOCKS, w, channels).mean(axis=(1, 3, 4))


def agreement(first, second):
    """Compares two long renders, as a whole and by blocks."""
    scale = second.mean.mean()
    # Blocks without noise differ by single precision.
    floor = (2e-5 * scale) ** 2
    variance = first.block_variance() + second.block_variance() + floor
    difference = blocks(first.mean) - blocks(second.mean)
    sigma = difference.mean() / math.sqrt(variance.sum() / variance.size**2)
    z = difference / np.sqrt(variance)
    noisy = variance > 2 * floor
    squared = float((z[noisy] ** 2).mean()) if noisy.any() else 0.0
    return Agreement((first.mean.mean(), scale), float(sigma), squared, float(np.abs(z).max()))


class Reference:
    """The mean of long renders, each weighted by the reciprocal of its noise."""

    def __init__(self, renders):
        noise = np.array([max(render.noise(), 1e-12) for render in renders])
        weights = 1 / noise / (1 / noise).sum()
        self.mean = sum(weight * render.mean for weight, render in zip(weights, renders))
        self.variance = sum(weight**2 * render.variance for weight, render in zip(weights, renders))
        luminance = self.mean.mean(axis=2)
        padded = np.pad(luminance, 1, mode="edge")
        height, width = luminance.shape
        around = [padded[y : y + height, x : x + width] for y in range(3) for x in range(3)]
        self.limit = FIREFLY * np.max(around, axis=0) + FIREFLY_SHARE * luminance.mean()

    def squared_error(self, image):
        """Returns the mean squared error of an image, without the reference's own."""
        return float(((image - self.mean) ** 2 - self.variance).mean())

    def relative_error(self, image):
        """Returns the relative mean squared error of an image, without the reference's own."""
        return float((((image - self.mean) ** 2 - self.variance) / (self.mean**2 + EPSILON)).mean())

    def fireflies(self, image):
        """Counts the pixels that are far brighter than the reference around them."""
        return int((image.mean(axis=2) > self.limit).sum())


def flip(reference, image):
    """Returns the mean of NVIDIA's LDR-FLIP of two images of linear radiance, both shown as sRGB, which clips them."""
    # Only one script needs it.
    from flip_evaluator import evaluate

    return evaluate(srgb(reference), srgb(image), "LDR", applyMagma=False)[1]


def srgb(image):
    """Returns linear radiance as numbers of sRGB from 0 to 1, clipped."""
    clipped = np.clip(image, 0, 1)
    return np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055).astype(np.float32)


def time_to(levels, error, key, time, power=1.0):
    """Returns the time at which a renderer reaches an error, and how it is known.

    `levels` are measurements with more and more samples; `key` and `time` name their error and their time. Between two of them,
    error and time are interpolated in logarithms. Beyond the last they are extrapolated, marked by "~": for squared errors, whose
    `power` is 1, to an error 1.5 times lower at most, or 30 times if it falls there as 1 / samples within 20 %; for others, which fall
    as 1 / samples^power, to these factors to that power. Otherwise the time is only bounded.
    """
    for earlier, later in zip(levels, levels[1:]):
        if earlier[key] >= error >= later[key] and earlier[key] > later[key] > 0:
            part = math.log(earlier[key] / error) / math.log(earlier[key] / later[key])
            return earlier[time] * (later[time] / earlier[time]) ** part, ""
    if levels[0][key] < error:
        return levels[0][time], "<"
    earlier, later = levels[-2:]
    if earlier[key] > later[key] > 0:
        slope = math.log(earlier[key] / later[key]) / math.log(later["spp"] / earlier["spp"])
        if later[key] < (30 if 0.8 < slope / power < 1.2 else 1.5) ** power * error:
            return later[time] * (later[key] / error) ** (1 / slope), "~"
    return later[time], ">"


def mean(values):
    values = list(values)
    return sum(values) / len(values)


def number(value):
    """Returns a number with two significant digits, or all before the point."""
    return f"{value:.2g}" if value < 10 else f"{value:.0f}"
