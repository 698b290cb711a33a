"""Rendering until the noise is below what is accepted, and saying how much is left."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from algorithms.color import encode_srgb
from algorithms.errors import InputError

Image = NDArray[np.float32]

Pass = Callable[[int], Image]
"""Renders an independent estimate from a seed: radiance, float32 `(height, width, 3)`, or radiance
and the share of each pixel that objects cover, `(height, width, 4)`."""

NOISE_LIMIT: Final = 1.0
"""The accepted noise, RMS in 1/255 of the encoded values as displayed."""

_SAFETY: Final = 1.1


@dataclass(frozen=True)
class Converged:
    """An image whose noise is known.

    Attributes
    ----------
    radiance
        The mean of all passes, float32 `(height, width, 3)`.
    coverage
        Likewise, float32 `(height, width)`; None if the passes do not tell it.
    halves
        The radiance of the passes with even and with odd numbers, counted from 0.
    noise_rms_of_255
        The noise that is left in it, root mean square over pixels and channels, in 1/255 of the
        encoded values as displayed.
    passes
        How many passes it is the mean of; an even number.
    """

    radiance: Image
    coverage: Image | None
    halves: tuple[Image, Image]
    noise_rms_of_255: float
    passes: int


def render_until(
    render: Pass,
    exposure: float,
    *,
    seed: int,
    limit_of_255: float = NOISE_LIMIT,
    most_passes: int = 1024,
) -> Converged:
    """Add up passes until the noise of their mean is below a limit.

    The noise is estimated from the difference of two halves, each the mean of every other pass.

    Parameters
    ----------
    render
        Renders one pass; called with seeds that differ.
    exposure
        From radiance to display-referred linear light.
    seed
        The first pass's; 0 or more.
    limit_of_255
        The accepted noise, in 1/255 of the encoded values.
    most_passes
        Refused when it would take more; an even number.

    Returns
    -------
    The mean, its noise and the number of passes; the same for the same seed.

    Raises
    ------
    InputError
        If the noise does not fall below the limit with that many passes.
    """
    halves = [render(seed).astype(np.float64), render(seed + 1).astype(np.float64)]
    passes = 2
    while (noise := _noise(halves, passes, exposure)) > limit_of_255:
        if passes >= most_passes:
            raise InputError(
                f"noise: {noise:.2f}/255 is left after {passes} passes; more samples a pass, a"
                f" limit above {limit_of_255:g}/255 or a smaller image are accepted"
            )
        # The variance falls with the number of passes.
        wanted = int(np.ceil(passes * _SAFETY * (noise / limit_of_255) ** 2))
        wanted = min(max(passes + 2, wanted + wanted % 2), most_passes)
        for number in range(passes, wanted):
            halves[number % 2] += render(seed + number)
        passes = wanted
    mean = ((halves[0] + halves[1]) / passes).astype(np.float32)
    coverage = mean[..., 3] if mean.shape[-1] == 4 else None
    even, odd = ((half[..., :3] * (2 / passes)).astype(np.float32) for half in halves)
    return Converged(mean[..., :3], coverage, (even, odd), noise, passes)


def render_on_top_of(
    below: Sequence[Image],
    render: Pass,
    exposure: float,
    *,
    seed: int,
    limit_of_255: float = NOISE_LIMIT,
) -> Converged:
    """Add light to an image without much noise, until the noise of their sum is below a limit.

    Even passes get its even half, and odd ones the other: so the sum's noise is estimated.

    Parameters
    ----------
    below
        The image's even and odd `halves`, as in `Converged`.
    render
        Renders one pass of what is added; called with seeds that differ.
    exposure, seed, limit_of_255
        As in `render_until`.

    Raises
    ------
    InputError
        As in `render_until`.
    """
    return render_until(
        lambda number: below[(number - seed) % 2] + render(number),
        exposure,
        seed=seed,
        limit_of_255=limit_of_255,
    )


def _noise(halves: Sequence[NDArray[np.float64]], passes: int, exposure: float) -> float:
    first, second = (half[..., :3] * (2 / passes) for half in halves)
    return half_difference_rms_of_255(first, second, exposure)


def half_difference_rms_of_255(
    first: NDArray[np.floating], second: NDArray[np.floating], exposure: float
) -> float:
    """Return the noise of the mean of two independent estimates of one image.

    Parameters
    ----------
    first, second
        Radiance `(height, width, 3)`, from equally many samples.
    exposure
        From radiance to display-referred linear light.

    Returns
    -------
    Root mean square over pixels and channels, in 1/255 of the encoded values: half of the RMS
    difference, since the variance of the mean is a quarter of the difference's.
    """
    difference = encode_srgb(first * exposure) - encode_srgb(second * exposure)
    return float(255 / 2 * np.sqrt(np.mean(difference**2)))
