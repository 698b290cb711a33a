"""Light-source fitting: as few lights as explain the outline and the interior, all fitted together.

Lopez-Moreno 2011, sec. 3.6.2, with sounder steps in the place of some printed ones. Lights are
added one by one; each time all of them move together over outline and interior, with a loss that
outliers do not rule, instead of the last one alone, along the outline, at a fixed maximum. Azimuth
and elevation come out of one fit.
"""

from collections.abc import Callable
from typing import Final

import numpy as np

from algorithms.lights.shading import Shading, Sources, predict, refine, robust
from algorithms.lights.starts import starting_points

LEAST_APART_DEG: Final = 40.0
"""Lights whose azimuths are closer than this are not told apart: two at one azimuth look like one
on an object that is flatter or deeper than its outline suggests."""

WEAKEST: Final = 0.15
"""A light weaker than this, as a share of the strongest, counts as ambient."""

MOST_LIGHTS: Final = 4
_HOPELESS: Final = 0.05
_SPREAD_DEG: Final = 70.0
_AMBIENT_LESS: Final = 0.05  # of a bright luminance
_THINNED: Final = 2  # half of the places tells which starting point leads to the best fit
_LEAST_GAIN_OF_DISTANCE: Final = 0.2
_OUTLYING: Final = 0.03
# No better than this is expected of a guessed shape, as a share of the variance.
_FLOOR: Final = 0.02
_CONTOUR_SHARE: Final = 0.5
_LEAST_GAIN: Final = 0.07
_LEAST_GAIN_FROM_FRONT: Final = 0.09


def fit_lights(shading: Shading) -> Sources:
    """Find the lights, their number included.

    Parameters
    ----------
    shading
        An object's interior and outline.

    Returns
    -------
    1 to 4 lights: as many as `grown` accepts.
    """
    few = shading.thinned(_THINNED)
    found = grown(shading, lambda last, count: _fitted(shading, few, last, count))
    return _with_distances(shading, found)


def grown(shading: Shading, richer: Callable[[Sources, int], Sources | None]) -> Sources:
    """Find lights one by one as long as another one pays.

    Parameters
    ----------
    shading
        What is to be explained.
    richer
        Returns as many lights as it is told, given one fewer; None where there are none.

    Returns
    -------
    1 to 4 lights: another one is accepted where it lowers the loss by `least_gain`, and two more
    where they do so on average. Half of that is enough for a third or fourth that ambient light had
    stood for: spread around an object, they look much like it.
    """
    last = best = Sources.directional(np.zeros((0, 3)))
    worth = most_worth = needed = 0.0
    for count in range(1, MOST_LIGHTS + 1):
        more = richer(last, count)
        if more is None:
            break
        if count == 1:
            needed = least_gain(more)
        else:
            lowered = gain(shading, last, more)
            least = needed / 2 if _was_ambient(last, more) else needed
            worth += np.log(1 - least) - np.log(1 - lowered)
            if worth < most_worth and (lowered < _HOPELESS or count > len(best.vectors) + 1):
                break
        if worth >= most_worth:
            best, most_worth = more, worth
        last = more
    return best


def _was_ambient(last: Sources, more: Sources) -> bool:
    """Tell whether one of three or more lights all around takes the place of ambient light."""
    spread = len(more.vectors) > 2 and _least_apart_deg(more) >= _SPREAD_DEG
    return spread and last.ambient - more.ambient >= _AMBIENT_LESS


def _fitted(shading: Shading, few: Shading, last: Sources, count: int) -> Sources | None:
    """Fit a given number of lights to few places from all starts, then the best of them to all."""
    fits = [refine(few, start) for start in starting_points(few, last, count)]
    distinct = [fit for fit in fits if _are_distinct(fit[0])]
    if not distinct:
        return None
    best, _ = min(distinct, key=lambda fit: fit[1])
    refined, _ = refine(shading, best)
    return refined if _are_distinct(refined) else best


def are_strong(sources: Sources) -> bool:
    """Tell whether no light is weaker than `WEAKEST` beside the strongest."""
    return bool(sources.intensities.min() >= WEAKEST * sources.intensities.max())


def least_gain(single: Sources) -> float:
    """Return by which share of the loss each light after the first must lower it.

    From the side it is about what an information criterion asks for where some 60 residuals are
    independent, as they are on renders by their autocorrelation. The more the light that explains
    most on its own comes from the viewer, the more: the guessed depth errs most in what it lights,
    and light thrown back by the surroundings is all that the outline then has.

    Parameters
    ----------
    single
        The best single light.
    """
    forward = max(float(single.vectors[0, 2] / max(single.intensities[0], 1e-12)), 0.0)
    return _LEAST_GAIN + _LEAST_GAIN_FROM_FRONT * forward**2


def gain(shading: Shading, simple: Sources, rich: Sources) -> float:
    """Return by which share richer lights lower the loss, above a floor that the shape sets.

    Inside, those places weigh most that are near the outline. Along the outline itself few values
    are independent: all of it weighs half as much.
    """
    left, left_by_rich = (
        shading.mean_squares(robust(predict(shading, sources) - shading.luminance, _OUTLYING))
        + _FLOOR * shading.variance
        for sources in (simple, rich)
    )
    shares = np.array([1.0, _CONTOUR_SHARE])
    return float(1 - shares @ left_by_rich / (shares @ left))


def _are_distinct(sources: Sources) -> bool:
    """Tell whether no light is weak beside the strongest or close to another one in azimuth."""
    return are_strong(sources) and _least_apart_deg(sources) >= LEAST_APART_DEG


def _least_apart_deg(sources: Sources) -> float:
    """Return the least difference of two azimuths; 360 for one light."""
    x, y, _ = sources.vectors.T
    azimuth_deg = np.sort(np.degrees(np.arctan2(y, x)))
    return float(np.diff(azimuth_deg, append=azimuth_deg[0] + 360).min())


def _with_distances(shading: Shading, found: Sources) -> Sources:
    """Take lights for near ones where that explains clearly more."""
    near, _ = refine(shading, found, near=True)
    return near if gain(shading, found, near) > _LEAST_GAIN_OF_DISTANCE else found
