"""An object in a photograph made of glass.

What is behind the object is filled in, and seen through two refracting surfaces: the relief that
faces the viewer, and its mirror image (Khan et al. 2006; Lopez-Moreno 2011, sec. 7.2). People
hardly judge refraction by its laws: that the background bends, the rim reflects and highlights stay
is enough.
"""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage
from skimage.transform import resize_local_mean

from algorithms.checks import checked_image
from algorithms.color import FloatImage, luminance
from algorithms.depth import Body, mirrored_body
from algorithms.depth.inflation import bounding_box, checked_mask, silhouette_relief
from algorithms.errors import InputError
from algorithms.highlights import separate_highlights
from algorithms.inpainting import fill_behind

Plane = NDArray[np.float32]
Mask = NDArray[np.bool_]
Vectors = NDArray[np.float32]

_VIEW: Final = np.array([0, 0, -1], dtype=np.float32)
_EDGE_PX: Final = 0.7
_CROSSINGS: Final = 4
_FLATTEST: Final = 0.25  # cosine to the viewing axis: flatter rays would meet no background
_LEVELS: Final = 6
_DARKEST: Final = 1e-6
_SHADING, _HIGHLIGHT = 1.5, 2.5  # of the median luminance: what cannot, and must be a highlight
_ENVIRONMENT_PX: Final = 48
_LAMPS: Final = 0.95  # of the pixels are darker


@dataclass(frozen=True)
class Glass:
    """What an object becomes.

    Attributes
    ----------
    refractive_index
        1..3; 1 bends nothing.
    tint
        Red, green and blue of what the object's thickest part lets through, each more than 0, up
        to 1.
    distance
        Of the background behind the object, in the object's larger extent, 0 or more.
    highlights
        0..1: how much of the object's own highlights stays.
    reflections
        0..1: how much of what the surface reflects, by Fresnel's equations, is shown.
    smoothing
        Of the relief, as a share of the object's smaller extent, 0 or more: a photograph's texture
        is not the glass'.

    Raises
    ------
    InputError
        If a value is out of its range.
    """

    refractive_index: float = 1.5
    tint: tuple[float, float, float] = (0.94, 0.97, 0.96)
    distance: float = 0.4
    highlights: float = 1.0
    reflections: float = 1.0
    smoothing: float = 0.03

    def __post_init__(self) -> None:
        if not 1 <= self.refractive_index <= 3:
            raise InputError("refractive_index: 1..3 is accepted")
        if len(self.tint) != 3 or not all(0 < share <= 1 for share in self.tint):
            raise InputError("tint: three numbers of more than 0, up to 1, are accepted")
        for name in ("distance", "smoothing"):
            if not 0 <= getattr(self, name) < np.inf:
                raise InputError(f"{name}: a finite number of 0 or more is accepted")
        for name in ("highlights", "reflections"):
            if not 0 <= getattr(self, name) <= 1:
                raise InputError(f"{name}: 0..1 is accepted")


CLEAR: Final = Glass()


def make_transparent(
    image: NDArray[np.floating[Any]],
    mask: ArrayLike,
    relief: NDArray[np.floating[Any]],
    glass: Glass = CLEAR,
    background: NDArray[np.floating[Any]] | None = None,
) -> FloatImage:
    """Make an object of a photograph of glass.

    Parameters
    ----------
    image
        Linear light, `(height, width, 3)`, finite, 0 or more.
    mask
        bool `(height, width)`: where the object is; not all of the image.
    relief
        `(height, width)`, pixels, larger is nearer.
    glass
        What it becomes.
    background
        The image without the object, of its shape; None to fill in what is around it.

    Returns
    -------
    float32 `(height, width, 3)`; the image's own values beyond three pixels around the object.

    Raises
    ------
    InputError
        If an array is not as described.
    UnavailableError
        If the background is to be filled in and PatchMatch is not installed.
    """
    pixels = checked_image(image)
    inside = checked_mask(mask, pixels.shape[:2])
    behind = fill_behind(pixels, inside) if background is None else checked_image(background)
    if behind.shape != pixels.shape:
        raise InputError(f"background: {pixels.shape} is accepted, not {behind.shape}")
    box = _grown(bounding_box(inside), inside.shape)
    body = _smooth_body(np.asarray(relief), inside, box, glass.smoothing)
    seen = _through(behind, body, inside[box], box, glass)
    seen *= _transmitted(body, glass)
    reflected, environment = _reflection(behind, body, glass)
    seen += reflected[..., None] * (environment - seen)
    if glass.highlights > 0:
        seen += np.float32(glass.highlights) * _highlights(pixels[box], inside[box])
    share = ndimage.gaussian_filter(inside[box].astype(np.float32), _EDGE_PX)[..., None]
    result = pixels.copy()
    result[box] = np.where(share > 0, behind[box] + share * (seen - behind[box]), pixels[box])
    return result


def _smooth_body(relief: Plane, inside: Mask, box: tuple[slice, slice], smoothing: float) -> Body:
    """Return the body within a box, without small features; around it, normals of its rim."""
    within = inside[box]
    if relief.shape != inside.shape or not np.isfinite(relief[inside]).all():
        raise InputError(f"relief: {inside.shape} of finite values in the mask are accepted")
    heights = np.where(within, relief[box], 0).astype(np.float32)
    sigma_px = smoothing * min(within.shape)
    if sigma_px > 0:
        # What the outline alone tells is smooth, and must stay steep along the rim.
        inflated = silhouette_relief(within)
        weights = ndimage.gaussian_filter(within.astype(np.float32), sigma_px, mode="constant")
        rest = ndimage.gaussian_filter(heights - inflated, sigma_px, mode="constant")
        heights = np.where(within, inflated + rest / np.maximum(weights, 1e-3), 0)
    body = mirrored_body(np.maximum(heights - heights[within].min(), 0), within)
    nearest = ndimage.distance_transform_edt(~within, return_distances=False, return_indices=True)
    front, back = (normals[tuple(nearest)] for normals in (body.front_normals, body.back_normals))
    return Body(body.front, body.back, front, back)


def _through(
    behind: FloatImage, body: Body, inside: Mask, box: tuple[slice, slice], glass: Glass
) -> FloatImage:
    """Return the background as it is seen through both surfaces, for all pixels of a box."""
    rows, columns = (np.asarray(place, np.float32) for place in np.indices(inside.shape))
    within: Plane = refracted(_VIEW, body.front_normals, 1 / glass.refractive_index)
    exit_rows, exit_columns, depth = rows, columns, body.front
    for _ in range(_CROSSINGS):
        path = (body.front + _between(body.front, exit_rows, exit_columns)) / -within[..., 2]
        exit_rows, exit_columns = rows - within[..., 1] * path, columns + within[..., 0] * path
        depth = body.front + within[..., 2] * path
    leaving = np.stack(
        [_between(body.back_normals[..., axis], exit_rows, exit_columns) for axis in range(3)],
        axis=-1,
    )
    leaving /= np.linalg.norm(leaving, axis=-1, keepdims=True)
    beyond = refracted(within, -leaving, glass.refractive_index)
    plane = -body.front.max() - glass.distance * max(inside.shape)
    path = (depth - plane) / np.maximum(-beyond[..., 2], _FLATTEST)
    bent = np.where(inside, path, 0)
    seen_rows = np.where(inside, exit_rows, rows) - beyond[..., 1] * bent + box[0].start
    seen_columns = np.where(inside, exit_columns, columns) + beyond[..., 0] * bent + box[1].start
    return _looked_up(behind, seen_rows, seen_columns)


def _highlights(picture: FloatImage, inside: Mask) -> FloatImage:
    """Return the highlights of an object, but for what may as well be the shading of a grey one.

    Where a highlight is so strong that the picture is white, no surface colour is left to tell it
    from; there it is what exceeds the object's ordinary light.
    """
    own = luminance(picture).astype(np.float32)
    ordinary = max(float(np.median(own[inside])), _DARKEST)
    certain = np.clip((own / ordinary - _SHADING) / (_HIGHLIGHT - _SHADING), 0, 1)
    excess = np.maximum(picture.min(axis=2) - np.float32(ordinary), 0)
    specular = np.maximum(separate_highlights(picture, inside).specular, excess[..., None])
    return np.asarray(specular * np.where(inside, certain, 0)[..., None])


def refracted(ray: Vectors, normal: Vectors, ratio: float) -> Vectors:
    """Bend rays at a surface by Snell's law.

    Parameters
    ----------
    ray, normal
        Unit vectors `(..., 3)`; the normal points to where the ray comes from.
    ratio
        Of the refractive index that the ray comes from to the one that it enters.

    Returns
    -------
    Unit vectors `(..., 3)`. What would be reflected totally leaves along the surface, so that there
    is no edge in what is seen.
    """
    cosine = -(ray * normal).sum(axis=-1, keepdims=True)
    beyond = np.sqrt(np.maximum(1 - ratio**2 * (1 - cosine**2), 0))
    bent = ratio * ray + (ratio * cosine - beyond) * normal
    return np.asarray(bent / np.linalg.norm(bent, axis=-1, keepdims=True))


def _looked_up(picture: FloatImage, rows: Plane, columns: Plane) -> FloatImage:
    """Return a picture's colours at places, each averaged over as much as a pixel there sees."""
    steps = [np.hypot(*np.gradient(place)) for place in (rows, columns)]
    level = np.clip(np.log2(np.maximum(np.maximum(*steps), 1)), 0, _LEVELS - 1)
    height, width = picture.shape[:2]
    rows, columns = _mirrored(rows, height), _mirrored(columns, width)
    # The part of the picture that is seen, and what is blurred into it.
    margin_px = 2 * 2**_LEVELS
    top, left = (max(0, int(place.min()) - margin_px) for place in (rows, columns))
    picture = picture[top : int(rows.max()) + margin_px, left : int(columns.max()) + margin_px]
    rows, columns = rows - top, columns - left
    result = np.zeros((*rows.shape, 3), dtype=np.float32)
    for number in range(_LEVELS):
        weight = np.maximum(1 - np.abs(level - number), 0)
        chosen = weight > 0
        if not chosen.any():
            continue
        sigma_px = 0.5 * 2**number if number else 0.0
        for channel in range(3):
            blurred = ndimage.gaussian_filter(picture[..., channel], sigma_px)
            values = _between(blurred, rows[chosen], columns[chosen])
            result[chosen, channel] += weight[chosen] * values
    return result


def _mirrored(places: Plane, extent: int) -> Plane:
    """Return places within a picture, mirrored at its borders."""
    last = max(extent - 1, 1)
    return np.asarray(last - np.abs(places % (2 * last) - last))


def _between(plane: Plane, rows: Plane, columns: Plane) -> Plane:
    return np.asarray(ndimage.map_coordinates(plane, [rows, columns], order=1, mode="nearest"))


def _transmitted(body: Body, glass: Glass) -> Plane:
    """Return what each path lets through: the thicker, the more of the tint."""
    thickness = body.front / max(float(body.front.max()), 1e-6)
    return np.asarray(np.asarray(glass.tint, np.float32) ** thickness[..., None])


def _reflection(behind: FloatImage, body: Body, glass: Glass) -> tuple[Plane, FloatImage]:
    """Return how much the surface reflects, and what: the picture, taken for what is all around."""
    cosine = body.front_normals[..., 2]
    share = glass.reflections * reflectance(cosine, glass.refractive_index)
    height, width = behind.shape[:2]
    factor = min(1.0, _ENVIRONMENT_PX / max(height, width))
    shape = tuple(max(1, round(extent * factor)) for extent in (height, width))
    small = resize_local_mean(behind, (*shape, 3))
    # A lamp is small: spread over its neighbours it would whiten them all.
    small = np.minimum(small, np.quantile(small, _LAMPS, axis=(0, 1)))
    small = ndimage.gaussian_filter(small, (1, 1, 0))
    mirror = 2 * cosine[..., None] * body.front_normals
    rows = (1 - mirror[..., 1]) / 2 * (shape[0] - 1)
    columns = (1 + mirror[..., 0]) / 2 * (shape[1] - 1)
    around = [_between(small[..., channel], rows, columns) for channel in range(3)]
    return share, np.stack(around, axis=-1)


def reflectance(cosine: Plane, refractive_index: float) -> Plane:
    """Return how much unpolarised light a surface reflects, by Fresnel's equations.

    Parameters
    ----------
    cosine
        Of the angle of incidence, 0..1, any shape.
    refractive_index
        Of what is behind the surface over that in front, 1 or more.
    """
    beyond = np.sqrt(1 - (1 - cosine**2) / refractive_index**2)
    across = (cosine - refractive_index * beyond) / (cosine + refractive_index * beyond)
    along = (beyond - refractive_index * cosine) / (beyond + refractive_index * cosine)
    return np.asarray((across**2 + along**2) / 2)


def _grown(box: tuple[slice, slice], shape: tuple[int, ...]) -> tuple[slice, slice]:
    """Return a box with room for a soft edge."""
    rows, columns = (
        slice(max(0, side.start - 3), min(extent, side.stop + 3))
        for side, extent in zip(box, shape, strict=True)
    )
    return rows, columns
