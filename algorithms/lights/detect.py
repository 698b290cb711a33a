"""`detect_lights`: from an image and an object's mask to its lights."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.light import Light
from algorithms.lights.contour import contour_of
from algorithms.lights.estimate import LightEstimate, Method
from algorithms.lights.fitting import fit_lights
from algorithms.lights.probe import prepare_probe
from algorithms.lights.shading import Shading, Sources, predict, shading_of
from algorithms.lights.shape import interior_of
from algorithms.lights.trim import trimmed
from algorithms.lights.voting import vote_lights


def detect_lights(
    image: NDArray[Any], mask: NDArray[Any], method: Method = "fitting"
) -> LightEstimate:
    """Detect the lights of a picture from one object in it.

    Parameters
    ----------
    image
        Linear light, `(height, width, 3)`, or luminance, `(height, width)`, in any unit.
    mask
        `(height, width)`, bool or numbers: where the object is. Best is a matt, convex one that
        the mask follows closely. Of several components the largest is used.
    method
        `fitting`, the more accurate one, or `voting`, the faster one (Lopez-Moreno 2011,
        sec. 3.6.2 and 3.6.1).

    Returns
    -------
    The lights, the ambient light, and how well they explain what is seen.

    Raises
    ------
    InputError
        If an argument is not as described, or the object is black, clipped or not finite.
    """
    if method not in ("fitting", "voting"):
        raise InputError(f"method: {method!r} given, fitting or voting accepted")
    probe = trimmed(prepare_probe(image, mask))
    interior = interior_of(probe)
    contour = contour_of(probe, interior)
    shading = shading_of(interior, contour)
    sources = fit_lights(shading) if method == "fitting" else vote_lights(contour, shading)
    return _estimate(shading, sources, method, probe.remarks)


def _estimate(
    shading: Shading, sources: Sources, method: Method, remarks: tuple[str, ...]
) -> LightEstimate:
    squares = shading.mean_squares(predict(shading, sources) - shading.luminance)
    brightest = float(shading.luminance[shading.inside :].max())
    lights = [
        Light.from_direction(
            vector, float(intensity) * shading.unit, float(1 / near) if near > 0 else None
        )
        for vector, intensity, near in zip(
            sources.vectors, sources.intensities, sources.nearness, strict=True
        )
        if intensity > 0
    ]
    explained = 1 - float(squares.mean()) / max(shading.variance, 1e-12)
    return LightEstimate(
        tuple(sorted(lights, key=lambda light: -light.intensity)),
        sources.ambient * shading.unit,
        float(np.sqrt(squares[1])) / max(brightest, 1e-12),
        float(np.clip(explained, 0, 1)),
        method,
        remarks,
    )
