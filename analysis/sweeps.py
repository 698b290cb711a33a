"""Sweeps of an algorithm's error over what makes its task hard, on images with ground truth.

A sweep runs over a rendered set, whose factors are the conditions (shape, texture, gloss, number
and separation of lights, translucency), and over what happens to an image afterwards: size, noise
and a mask that does not fit.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import ndimage
from skimage.transform import resize

from algorithms.errors import InputError
from algorithms.images import read_channels, read_labels
from algorithms.light import Light
from algorithms.lights import LightEstimate, detect_lights
from algorithms.lights.estimate import Method
from analysis.errors import light_error
from stimuli.manifest import Stimulus, StimulusSet

Progress = Callable[[int, int], None]

METHODS: Final[tuple[Method, ...]] = ("fitting", "voting")


@dataclass(frozen=True)
class Degradation:
    """What happens to an image before lights are detected in it.

    Attributes
    ----------
    size
        The factor by which both sides shrink, more than 0, at most 1.
    noise
        Standard deviation of Gaussian noise, as a share of the object's 95th percentile.
    mask_error_px
        By how many pixels the mask is too large; negative where it is too small.

    Raises
    ------
    InputError
        If a value is out of range.
    """

    size: float = 1.0
    noise: float = 0.0
    mask_error_px: int = 0

    def __post_init__(self) -> None:
        if not 0 < self.size <= 1:
            raise InputError(f"size: more than 0 and at most 1 is accepted, not {self.size}")
        if not 0 <= self.noise < np.inf:
            raise InputError(f"noise: 0 or more is accepted, not {self.noise}")

    def __call__(
        self,
        image: NDArray[np.float32],
        mask: NDArray[np.bool_],
        generator: np.random.Generator,
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Return image and mask as they become."""
        pixels, inside = image.astype(np.float64), mask
        if self.size < 1:
            shape = tuple(max(1, round(self.size * extent)) for extent in mask.shape)
            pixels = resize(pixels, (*shape, 3), anti_aliasing=True)
            inside = resize(mask.astype(np.float64), shape, anti_aliasing=True) > 1 / 2
        bright = float(np.percentile(pixels[inside], 95))
        pixels = pixels + generator.normal(0, self.noise * bright, pixels.shape)
        return pixels, _grown(inside, self.mask_error_px)


PLAIN: Final = Degradation()
DEGRADATIONS: Final = (
    *(Degradation(size=size) for size in (0.5, 0.25)),
    *(Degradation(noise=noise) for noise in (0.02, 0.05, 0.1)),
    *(Degradation(mask_error_px=error) for error in (-4, -2, 2, 4)),
)
"""One thing at a time."""


def _grown(mask: NDArray[np.bool_], by_px: int) -> NDArray[np.bool_]:
    if by_px == 0:
        return mask
    change = ndimage.binary_dilation if by_px > 0 else ndimage.binary_erosion
    return np.asarray(change(mask, iterations=abs(by_px)))


def _no_progress(done: int, total: int) -> None:
    """Say nothing."""


def sweep_lights(
    stimuli: StimulusSet,
    generator: np.random.Generator,
    methods: Sequence[Method] = METHODS,
    degradations: Sequence[Degradation] = DEGRADATIONS,
    progress: Progress = _no_progress,
) -> pd.DataFrame:
    """Detect lights in all images of a set, as they are and degraded.

    Parameters
    ----------
    stimuli
        A set that `stimuli.sets.lightprobes` made.
    generator
        Draws the noise.
    methods
        Of `algorithms.detect_lights`.
    degradations
        Applied to images of one or two lights on plain, matt, opaque objects; all images are taken
        as they are, besides.
    progress
        Called after each detection.

    Returns
    -------
    A row for each image, degradation and method: the factors of the set, those of `Degradation`,
    `method`, `found` (lights), `missed`, `extra`, `strong_extra`, `number_is_right`, the mean
    `angle_deg`, `azimuth_error_deg` and `elevation_error_deg` of the assigned lights (NaN if there
    is none), `confidence` and `residual`.

    Raises
    ------
    InputError
        If a stimulus has no lights, radiance or region.
    """
    work = [
        (stimulus, degradation)
        for stimulus in stimuli.with_role("main")
        for degradation in (PLAIN, *(degradations if _is_plain(stimulus) else ()))
    ]
    rows: list[dict[str, Any]] = []
    for number, (stimulus, degradation) in enumerate(work):
        image, mask = degradation(*read_probe(stimuli, stimulus), generator)
        for method in methods:
            found = detect_lights(image, mask, method)
            rows.append(_row(stimulus, degradation, found))
        progress(number + 1, len(work))
    return pd.DataFrame(rows)


def true_lights(stimulus: Stimulus) -> list[Light]:
    """Return the lights that a stimulus was made with, the strongest first.

    Raises
    ------
    InputError
        If the manifest does not say.
    """
    if "lights" not in stimulus.details:
        raise InputError(f"{stimulus.id}: a stimulus whose lights are known is accepted")
    return [Light(**light) for light in stimulus.details["lights"]]


def long_table(rows: pd.DataFrame, factors: Sequence[str]) -> pd.DataFrame:
    """Return mean errors by method and level, one factor after the other.

    Parameters
    ----------
    rows
        From `sweep_lights`.
    factors
        Columns of it. Of the set's own factors only images without degradation count.

    Returns
    -------
    Columns `factor`, `level`, `method`, `n`, `angle_deg` (mean over images), `angle_95_deg` (95th
    percentile), and the shares `number_right` and `within_20_deg`.
    """
    return pd.concat([part for factor in factors for part in _by_level(rows, factor)])


def _by_level(rows: pd.DataFrame, factor: str) -> Iterator[pd.DataFrame]:
    """Yield the table of one factor, all else being as it is."""
    own = set(asdict(PLAIN)) - {factor}
    chosen = rows
    for name in own:
        chosen = chosen[chosen[name] == getattr(PLAIN, name)]
    if factor in asdict(PLAIN):
        varied = set(chosen.loc[chosen[factor] != getattr(PLAIN, factor), "id"])
        chosen = chosen[chosen["id"].isin(varied)]
    elif factor in _GROUPS:
        chosen = chosen[chosen["group"].isin(_GROUPS[factor])]
    if chosen.empty:
        return
    table = (
        chosen.groupby([factor, "method"], observed=True)
        .agg(
            n=("angle_deg", "size"),
            angle_deg=("angle_deg", "mean"),
            angle_95_deg=("angle_deg", lambda values: values.quantile(0.95)),
            number_right=("number_is_right", "mean"),
            within_20_deg=("angle_deg", lambda values: (values <= 20).mean()),
        )
        .reset_index()
        .rename(columns={factor: "level"})
    )
    table.insert(0, "factor", factor)
    yield table


_GROUPS: Final = {
    "complexity": ("single",),
    "texture_frequency": ("texture",),
    "gloss": ("gloss",),
    "lights": ("single", "pair", "three-lights"),
    "separation_deg": ("pair",),
    "intensity_ratio": ("pair",),
    "radius_mm": ("translucent",),
    "distance": ("distance",),
    "area_radius_deg": ("area",),
}

FACTORS: Final = (
    "complexity",
    "texture_frequency",
    "gloss",
    "lights",
    "separation_deg",
    "intensity_ratio",
    "radius_mm",
    *asdict(PLAIN),
)
"""What the figure shows."""


def _is_plain(stimulus: Stimulus) -> bool:
    return stimulus.factors["group"] in ("single", "pair")


def read_probe(
    stimuli: StimulusSet, stimulus: Stimulus
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Return the radiance and the mask of a light probe.

    Raises
    ------
    InputError
        If the stimulus has no region or radiance.
    """
    if stimulus.regions is None or "radiance" not in stimulus.truth:
        raise InputError(f"{stimulus.id}: a stimulus with a region and its radiance is accepted")
    image = read_channels(stimuli.path(stimulus.truth["radiance"]))
    return image, read_labels(stimuli.path(stimulus.regions)) > 0


def _row(stimulus: Stimulus, degradation: Degradation, found: LightEstimate) -> dict[str, Any]:
    error = light_error(found.lights, true_lights(stimulus))
    return {
        "id": stimulus.id,
        **stimulus.factors,
        **asdict(degradation),
        "method": found.method,
        "found": len(found.lights),
        "missed": error.missed,
        "extra": error.extra,
        "strong_extra": error.strong_extra,
        "number_is_right": error.number_is_right,
        "angle_deg": _mean(error.angle_deg),
        "azimuth_error_deg": _mean(error.azimuth_deg),
        "elevation_error_deg": _mean(error.elevation_deg),
        "confidence": found.confidence,
        "residual": found.residual,
    }


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values)) if values else float("nan")
