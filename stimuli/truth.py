"""What is known exactly at every pixel of a picture: object, distance, relief, normal, albedo."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.images import write_channels, write_labels
from stimuli.camera import Camera
from stimuli.shapes.mesh import Value

Image = NDArray[np.float32]

_CHANNELS: Final = "position:position,normal:sh_normal,albedo:albedo"
_SAME_PLACE: Final = 1e-4  # of the distance: what rounding may move a point that is seen twice


@dataclass(frozen=True)
class GroundTruth:
    """What is known exactly at every pixel's centre.

    Attributes
    ----------
    regions
        uint8 `(height, width)`: the object's number from 1, 0 where there is none.
    distance
        float32 `(height, width)`: from the camera, in scene units; infinite for the background.
    relief
        float32 `(height, width)`: in pixels, larger is nearer, 0 at the farthest visible point of
        the same object; NaN where there is none.
    normal
        float32 `(height, width, 3)`: unit vectors in the project's frame, 0 for the background.
    albedo
        float32 `(height, width, 3)`: diffuse albedo, 0 for the background.
    """

    regions: NDArray[np.uint8]
    distance: Image
    relief: Image
    normal: Image
    albedo: Image


def ground_truth(scene: Value, camera: Camera, numbers: Mapping[str, int]) -> GroundTruth:
    """Look through every pixel's centre and note what is there.

    Parameters
    ----------
    scene
        Mitsuba's scene.
    camera
        Where it is seen from.
    numbers
        The number of each object, 1 to 255, by the id of its shape; several shapes may share one.
        Shapes that are not named (a ground, a wall) have distance, normal and albedo, but count as
        no object.

    Returns
    -------
    Arrays of the camera's size.

    Raises
    ------
    InputError
        If a shape is not in the scene, or an object is nowhere to be seen.
    """
    aovs = _look(scene, camera)
    position, normal, albedo = aovs[..., 0:3], aovs[..., 3:6], aovs[..., 6:9]
    hit = np.any(normal, axis=-1)
    distance = np.where(hit, camera.distance(position), np.inf)
    regions = _regions(scene, camera, numbers, distance)
    background = ~hit[..., None]
    return GroundTruth(
        regions,
        distance.astype(np.float32),
        relief_of(regions, camera.depth(position), camera.pixels_per_unit),
        np.where(background, 0, normal @ camera.axes.T).astype(np.float32),
        np.where(background, 0, albedo).astype(np.float32),
    )


def relief_of(
    regions: NDArray[np.uint8],
    depth: NDArray[np.floating],
    pixels_per_unit: Callable[[float], float],
) -> Image:
    """Return the relief of each object: in pixels, larger is nearer, 0 at its farthest point.

    Parameters
    ----------
    regions
        `(height, width)`: the object's number, 0 where there is none.
    depth
        `(height, width)`: behind the camera's plane, in scene units.
    pixels_per_unit
        The size in pixels of a scene unit at a depth; an object is scaled as at its mean depth.
    """
    relief = np.full(regions.shape, np.nan, np.float32)
    for number in np.unique(regions[regions > 0]):
        inside = regions == number
        within = depth[inside]
        relief[inside] = (within.max() - within) * pixels_per_unit(float(within.mean()))
    return relief


TRUTH_NAMES: Final = ("distance", "relief", "normal", "albedo")
"""The channels of a ground truth that are written as OpenEXR files, by these names."""


def truth_files(stem: str) -> dict[str, str]:
    """Return where a ground truth's channels go, by name, relative to the set's folder."""
    return {name: f"truth/{stem}-{name}.exr" for name in TRUTH_NAMES}


def regions_file(stem: str) -> str:
    """Return where a ground truth's label image goes, relative to the set's folder."""
    return f"truth/{stem}-regions.png"


def write_truth(folder: Path, stem: str, measure: Callable[[], GroundTruth]) -> None:
    """Write a ground truth that images may share, unless all its files are there.

    Parameters
    ----------
    folder
        The set's.
    stem
        Names the scene; see `truth_files` and `regions_file`.
    measure
        Returns the ground truth; called if a file is missing.
    """
    files = truth_files(stem)
    if all((folder / file).is_file() for file in (regions_file(stem), *files.values())):
        return
    truth = measure()
    (folder / "truth").mkdir(exist_ok=True)
    write_labels(folder / regions_file(stem), truth.regions)
    for name, file in files.items():
        write_channels(folder / file, getattr(truth, name))


def _look(scene: Value, camera: Camera) -> NDArray[np.float32]:
    """Return position, normal and albedo at each pixel's centre: `(height, width, 9)`."""
    integrator = mi.load_dict({"type": "aov", "aovs": _CHANNELS})
    sensor = camera.sensor("centre")
    return np.array(mi.render(scene, sensor=sensor, integrator=integrator, spp=1))[..., :9]


def _regions(
    scene: Value,
    camera: Camera,
    numbers: Mapping[str, int],
    distance: NDArray[np.float64],
) -> NDArray[np.uint8]:
    """Find each object where it, looked at alone, is as far away as what is seen."""
    shapes = {shape.id(): shape for shape in scene.shapes()}
    if unknown := numbers.keys() - shapes.keys():
        raise InputError(f"objects: shape {min(unknown)!r} is not in the scene")
    regions = np.zeros(distance.shape, np.uint8)
    for number in sorted(set(numbers.values())):
        parts = {name: shapes[name] for name in numbers if numbers[name] == number}
        alone = _look(mi.load_dict({"type": "scene", **parts}), camera)
        there = np.any(alone[..., 3:6], axis=-1)
        away = np.where(there, camera.distance(alone[..., :3]), np.inf)
        seen = there & (away <= distance * (1 + _SAME_PLACE))
        if not seen.any():
            raise InputError(f"objects: {min(parts)!r} lies outside the view or is hidden")
        regions[seen] = number
    return regions
