"""The edit `caustics`: the light that an object, were it of glass, would throw on a surface.

Inputs: `mask` of the object; `depth`, its relief (else it is guessed). Parameters: `caustics`
(`algorithms.caustics.Caustics`), `quad` (four (x, y) in pixels from the top left, clockwise from
where the map's top left goes), `depth_scale`.
"""

import numpy as np
from numpy.typing import NDArray

from algorithms.caustics import Caustics, cast, maps_of
from algorithms.color import FloatImage
from algorithms.depth import perceptual_relief
from algorithms.depth.files import read_relief
from algorithms.edits.request import Request, settings_from
from algorithms.errors import InputError
from algorithms.images import require_size
from algorithms.masks import read_mask


def edit(image: FloatImage, request: Request) -> FloatImage:
    """Add caustics to a picture; none falls on the object itself.

    Raises
    ------
    InputError
        If an input or a setting is not accepted.
    """
    settings = settings_from(Caustics, request.parameters["caustics"])
    mask = read_mask(request.inputs["mask"], image.shape)
    maps = maps_of(relief_of(image, mask, request), mask, settings)
    return cast(image, maps, request.parameters["quad"], settings, spared=mask)


def relief_of(image: FloatImage, mask: NDArray[np.bool_], request: Request) -> NDArray[np.float32]:
    """Return an object's relief, as a file has it or as it looks.

    Raises
    ------
    InputError
        If the file is not accepted, or leaves a part of the object unknown.
    """
    if "depth" not in request.inputs:
        return perceptual_relief(image, mask)
    path = request.inputs["depth"]
    relief = read_relief(path, scale=request.parameters["depth_scale"])
    require_size(path, relief.shape, image.shape)
    if not np.isfinite(relief[mask]).all():
        raise InputError(f"{path}: a relief that is known all over the object is accepted")
    return np.nan_to_num(relief, nan=0.0)
