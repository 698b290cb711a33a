"""The edit `fog`: a picture and the distance of what it shows, given as a file or in a few numbers.

Inputs: `depth`, or `layer-1`, `layer-2`, ... (masks, each covering those before it). Parameters:
`fog` (`algorithms.fog.Fog`), `distance` (`DistanceSource`), `scaled` (whether distances are brought
to 0..1, which the thesis' presets are meant for), `field_of_view_deg`, `seed`.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from algorithms.color import FloatImage
from algorithms.depth import layered_distance, receding_distance, scaled_distance
from algorithms.depth.files import Stereo, read_distance
from algorithms.edits.request import Request, settings_from
from algorithms.errors import InputError
from algorithms.fog import Fog, add_fog
from algorithms.images import require_size
from algorithms.masks import read_mask

LAYER = "layer-"


@dataclass(frozen=True)
class DistanceSource:
    """What is known of the distance besides files.

    Attributes
    ----------
    scale, stereo
        Of the depth file: see `algorithms.depth.files.read_distance`.
    recede
        x and y of a near point, of a far point, and the distances there: a plane that recedes, in
        place of the background.
    layers
        The distance of each layer.
    background
        Where there is no layer; None for infinite, as the sky.
    """

    scale: float = 1.0
    stereo: Stereo | None = None
    recede: tuple[float, float, float, float, float, float] | None = None
    layers: tuple[float, ...] = ()
    background: float | None = None


def edit(image: FloatImage, request: Request) -> FloatImage:
    """Add fog to a picture.

    Raises
    ------
    InputError
        If an input or a setting is not accepted, or nothing tells the distance.
    """
    fog = settings_from(Fog, request.parameters["fog"])
    distance = _distance(image, request)
    if request.parameters["scaled"]:
        distance = scaled_distance(distance)
    return add_fog(
        image,
        distance,
        fog,
        generator=np.random.default_rng(request.parameters["seed"]),
        field_of_view_deg=request.parameters["field_of_view_deg"],
    )


def _distance(image: FloatImage, request: Request) -> NDArray[np.float32]:
    source = settings_from(DistanceSource, request.parameters["distance"])
    shape = image.shape[:2]
    if "depth" in request.inputs:
        path = request.inputs["depth"]
        distance = read_distance(path, scale=source.scale, stereo=source.stereo)
        require_size(path, distance.shape, shape)
        return distance
    background: float | NDArray[np.float32]
    background = np.inf if source.background is None else source.background
    if source.recede is not None:
        x0, y0, x1, y1, near, far = source.recede
        background = receding_distance((shape[0], shape[1]), (x0, y0), (x1, y1), near, far)
    masks = [read_mask(path, shape) for path in _layers(request)]
    if masks:
        return layered_distance(masks, source.layers, background)
    if isinstance(background, float):
        raise InputError("depth: a depth file, layers or a receding plane are needed for fog")
    return background


def _layers(request: Request) -> list[Path]:
    names = [name for name in request.inputs if name.startswith(LAYER)]
    return [
        request.inputs[name] for name in sorted(names, key=lambda name: int(name[len(LAYER) :]))
    ]
