"""Phase symmetry: where an image is symmetric about a point or a line, whatever its contrast.

At a point of symmetry all wavelets are at an extreme of their cycle: the responses of even ones are
large, those of odd ones vanish (Kovesi 1997; Lopez-Moreno 2011, sec. 7.3.2 and annex A).
"""

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from algorithms.errors import InputError
from algorithms.log_gabor import AngularShape, LogGaborBank, Plane, polar_angles

Polarity = Literal["both", "bright", "dark"]
Spectrum = NDArray[np.complex64]

EPSILON: Final = 1e-4
"""Of the image's range: amplitudes and noise below it count as none."""

_BLOCK: Final = 2**15  # pixels, so that what is made of a block stays in the cache
_STREAMS: Final = 2  # as fixed as the order of additions, whatever the cores: the same bytes
_SMALL: Final = 2**20  # pixels: of these each stream may have its own copy


@dataclass(frozen=True)
class SymmetryEnergy:
    """What a bank of filters finds, before the energy is divided by the amplitude.

    Attributes
    ----------
    energy
        float32 `(height, width)`: sum over scales and orientations of |even| - |odd| responses,
        less the noise; negative where the image is rather antisymmetric.
    amplitude
        float32 `(height, width)`: sum of the responses' amplitudes.
    epsilon
        The amplitude that counts as none.
    """

    energy: Plane
    amplitude: Plane
    epsilon: float

    def ratio(self) -> Plane:
        """Return the symmetry, float32 `(height, width)` in 0..1."""
        symmetry = np.maximum(self.energy, 0)
        symmetry /= self.amplitude + np.float32(self.epsilon)
        return symmetry


def phase_symmetry(
    image: NDArray[np.floating[Any]],
    *,
    scales: int = 5,
    orientations: int = 6,
    first_deg: float = 0.0,
    shortest_px: float = 3.0,
    scaling: float = 2.1,
    bandwidth: float = 0.55,
    angular: AngularShape = "gaussian",
    noise_deviations: float = 2.0,
    polarity: Polarity = "both",
) -> Plane:
    """Return how symmetric an image is about each of its points.

    Parameters
    ----------
    image
        `(height, width)`, finite; it is taken as periodic.
    scales, orientations, first_deg, shortest_px, scaling, bandwidth, angular
        The filters, as `LogGaborBank` describes them.
    noise_deviations
        By how many standard deviations a response must exceed the mean of noise, 0 or more.
    polarity
        Of what is looked for: `bright` on dark, `dark` on bright, or `both`.

    Returns
    -------
    float32 `(height, width)` in 0..1; it does not change with the image's contrast or brightness.

    Raises
    ------
    InputError
        If the image is not as described or a setting is out of its range.

    Notes
    -----
    Kovesi 1997; Lopez-Moreno 2011, eq. 7.1. There, eq. 7.7b prints the phase's inverse, and eq. 7.8
    the noise within the sum over scales; here it is taken off once for each orientation, as Kovesi
    does. The noise's amplitude follows a Rayleigh distribution, which the median of the smallest
    scale gives; that of the larger scales falls with their bandwidth.
    """
    bank = LogGaborBank(scales, orientations, first_deg, shortest_px, scaling, bandwidth, angular)
    return symmetry_energy(image, bank, noise_deviations, polarity).ratio()


def symmetry_energy(
    image: NDArray[np.floating[Any]],
    bank: LogGaborBank,
    noise_deviations: float = 2.0,
    polarity: Polarity = "both",
) -> SymmetryEnergy:
    """Return the terms whose ratio is `phase_symmetry`, for the same image and settings."""
    pixels, epsilon = _checked(image, noise_deviations, polarity)
    streams = _STREAMS if pixels.size <= _SMALL else 1
    filtering = _Filtering(pixels, bank, polarity, max(1, _cores() // streams))
    del pixels
    angles_deg = (bank.angles_deg[first::streams] for first in range(streams))
    with ThreadPoolExecutor(streams) as pool:
        sums = list(pool.map(filtering.sums_along, angles_deg))
    energy, amplitude = sums[0].energy, sums[0].amplitude
    for other in sums[1:]:
        energy += other.energy
        amplitude += other.amplitude
    medians = (median for each in sums for median in each.medians)
    noise = sum(max(_noise(median, bank, noise_deviations), epsilon) for median in medians)
    energy -= np.float32(noise)
    return SymmetryEnergy(energy, amplitude, epsilon)


def symmetry_by_angle(
    image: NDArray[np.floating[Any]],
    weights: NDArray[np.floating[Any]],
    bank: LogGaborBank,
    angles_deg: Sequence[float],
) -> NDArray[np.float64]:
    """Return how symmetric an image is as a whole along each of some orientations.

    Parameters
    ----------
    image
        `(height, width)`, finite; it is taken as periodic.
    weights
        `(height, width)`, 0 or more: how much each point counts.
    bank
        The filters; its own orientations do not matter, but how many there are sets their breadth.
    angles_deg
        The orientations, counter-clockwise from +x.

    Returns
    -------
    The energy of symmetry, |even| - |odd| where that is positive, for each orientation.

    Raises
    ------
    InputError
        If the image is not as described.
    """
    pixels, _ = _checked(image, 0.0, "both")
    filtering = _Filtering(pixels, bank, "both", 1)

    def energy(angle_deg: float) -> float:
        found = filtering.sums_along([angle_deg]).energy
        return float((np.maximum(found, 0) * weights).sum())

    with ThreadPoolExecutor(_STREAMS) as pool:
        return np.fromiter(pool.map(energy, angles_deg), dtype=np.float64)


@dataclass(frozen=True)
class _Sums:
    """Energy and amplitude over some orientations; the median of each one's smallest amplitude."""

    energy: Plane
    amplitude: Plane
    medians: list[float]


class _Filtering:
    """An image's spectrum and the filters, shared by all threads."""

    def __init__(self, pixels: Plane, bank: LogGaborBank, polarity: Polarity, workers: int) -> None:
        self._bank, self._polarity, self._workers = bank, polarity, workers
        self._shape = (pixels.shape[0], pixels.shape[1])
        self._spectrum: Spectrum = fft.fft2(pixels, workers=workers)
        self._radial = bank.radial(self._shape)

    def sums_along(self, angles_deg: Sequence[float]) -> _Sums:
        """Filter along some orientations, and add up; 36 bytes a pixel with what is shared."""
        sums = _Sums(np.zeros(self._shape, np.float32), np.zeros(self._shape, np.float32), [])
        product = np.empty(self._shape, np.complex64)
        for angle_deg in angles_deg:
            angular = self._angular(angle_deg)
            for scale, radial in enumerate(self._radial):
                for rows in self._blocks():
                    filters = angular[rows] * self._whole(radial, rows)
                    np.multiply(self._spectrum[rows], filters, out=product[rows])
                product = fft.ifft2(product, overwrite_x=True, workers=self._workers)
                for rows in self._blocks():
                    self._add(product[rows], sums.energy[rows], sums.amplitude[rows])
                if scale == 0:
                    sums.medians.append(_median_in_place(np.abs(product)))
        return sums

    def _blocks(self) -> Iterator[slice]:
        height, width = self._shape
        step = max(1, _BLOCK // width)
        return (slice(row, min(row + step, height)) for row in range(0, height, step))

    def _angular(self, angle_deg: float) -> Plane:
        angular = np.empty(self._shape, np.float32)
        for rows in self._blocks():
            angular[rows] = self._bank.angular_part(angle_deg, polar_angles(self._shape, rows))
        return angular

    def _whole(self, radial: Plane, rows: slice) -> Plane:
        """Return some rows of the frequency plane from what the others mirror."""
        height, width = self._shape
        numbers = np.arange(rows.start, rows.stop)
        right = radial[np.minimum(numbers, height - numbers)]
        return np.concatenate([right, right[:, width - right.shape[1] : 0 : -1]], axis=1)

    def _add(self, response: Spectrum, energy: Plane, amplitude: Plane) -> None:
        amplitude += np.abs(response)
        even, odd = response.real, np.abs(response.imag)
        if self._polarity == "dark":
            energy -= even
        else:
            energy += np.abs(even) if self._polarity == "both" else even
        energy -= odd


def _noise(median: float, bank: LogGaborBank, deviations: float) -> float:
    """Return the energy of noise of one orientation, from the median of the smallest amplitude."""
    rayleigh = median / np.sqrt(np.log(4))
    falling = 1 / bank.scaling
    total = rayleigh * (1 - falling**bank.scales) / (1 - falling)
    return float(total * (np.sqrt(np.pi / 2) + deviations * np.sqrt((4 - np.pi) / 2)))


def _median_in_place(values: Plane) -> float:
    """Return the median; the values' order is lost, but no second copy is made."""
    flat = values.ravel()
    middle = ((flat.size - 1) // 2, flat.size // 2)
    flat.partition(middle)
    return float(flat[list(middle)].mean())


def _cores() -> int:
    return os.cpu_count() or 1


def _checked(
    image: NDArray[np.floating[Any]], noise_deviations: float, polarity: Polarity
) -> tuple[Plane, float]:
    """Return the image about its middle, and the amplitude that counts as none.

    About its middle the numbers are small, so that float32 is enough for a bright image.
    """
    pixels = np.asarray(image, dtype=np.float32)
    if pixels.ndim != 2 or pixels.size == 0:
        raise InputError(f"image: (height, width) is accepted, not {pixels.shape}")
    if not np.isfinite(pixels).all():
        raise InputError("image: finite values are accepted")
    if not 0 <= noise_deviations < np.inf:
        raise InputError("noise_deviations: a finite number of 0 or more is accepted")
    if polarity not in get_args(Polarity):
        raise InputError(f"polarity: one of {', '.join(get_args(Polarity))} is accepted")
    lowest, highest = pixels.min(), pixels.max()
    epsilon = max(EPSILON * float(highest - lowest), float(np.finfo(np.float32).tiny))
    return pixels - (lowest / 2 + highest / 2), epsilon
