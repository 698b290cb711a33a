"""The edit `transparent`: an object becomes glass, and may throw caustics where it threw a shadow.

Inputs: `mask` of the object; `depth`, its relief (else it is guessed); `shadow`, a mask of the
shadow that it casts. Parameters: `glass` (`algorithms.transparency.Glass`), `depth_scale`,
`lifted` (0..1, how far the shadow is lifted), and, where there are to be caustics, `caustics` and
`quad` as for the edit of that name.
"""

from algorithms.caustics import Caustics, cast, maps_of
from algorithms.color import FloatImage
from algorithms.edits.caustics import relief_of
from algorithms.edits.request import Request, settings_from
from algorithms.inpainting import fill_behind
from algorithms.masks import read_mask
from algorithms.shadows import lift_shadow
from algorithms.transparency import Glass, make_transparent


def edit(image: FloatImage, request: Request) -> FloatImage:
    """Make an object of a picture of glass.

    Raises
    ------
    InputError
        If an input or a setting is not accepted.
    UnavailableError
        If what fills in the background is not installed.
    """
    parameters = request.parameters
    glass = settings_from(Glass, parameters["glass"])
    mask = read_mask(request.inputs["mask"], image.shape)
    relief = relief_of(image, mask, request)
    ground = image
    if "shadow" in request.inputs:
        shadow = read_mask(request.inputs["shadow"], image.shape)
        ground = lift_shadow(image, shadow, parameters["lifted"], spared=mask)
    behind = fill_behind(ground, mask)
    if parameters["quad"] is not None:
        settings = settings_from(Caustics, parameters["caustics"])
        maps = maps_of(relief, mask, settings)
        ground, behind = (
            cast(each, maps, parameters["quad"], settings) for each in (ground, behind)
        )
    return make_transparent(ground, mask, relief, glass, behind)
