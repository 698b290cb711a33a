"""The cameras that look at a scene, and how their frame relates to the scene's."""

from dataclasses import dataclass
from typing import Any, Final, Literal, Protocol

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.light import Light
from stimuli.shapes.mesh import Value

Point = tuple[float, float, float]
Sampler = Literal["independent", "centre", "grid", "jittered"]

CAMERA_DISTANCE: Final = 10.0
"""From the plane of the objects' centres to the camera's, in object radii."""

_FAR: Final = 1e4


class Camera(Protocol):
    """What every camera offers."""

    @property
    def width_px(self) -> int:
        """Width of the image."""
        ...

    @property
    def height_px(self) -> int:
        """Height of the image."""
        ...

    @property
    def axes(self) -> NDArray[np.float64]:
        """The project's frame in the scene: rows are x (right), y (up) and z (to the viewer)."""
        ...

    def sensor(self, sampler: Sampler = "independent") -> Value:
        """Return Mitsuba's sensor.

        Parameters
        ----------
        sampler
            See `sampler_of`.
        """
        ...

    def depth(self, points: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return how far points `(..., 3)` of the scene lie behind the camera's plane `(...)`."""
        ...

    def distance(self, points: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return the length of the way of light from points `(..., 3)` to the camera `(...)`."""
        ...

    def pixels_per_unit(self, depth: float) -> float:
        """Return the size in pixels of one unit of the scene at that depth."""
        ...


@dataclass(frozen=True)
class View:
    """An orthographic camera that looks along -z: every object is seen from the same side.

    Attributes
    ----------
    width_px, height_px
        Size of the image.
    radius_px
        The length of an object's radius in the image.
    samples
        Samples a pixel on a regular grid, a square number; of renderers without noise.
    """

    width_px: int
    height_px: int
    radius_px: float
    samples: int

    def box_px(self, centre: tuple[float, float]) -> tuple[int, int, int, int]:
        """Return (left, top, right, bottom) of the pixels that an object can touch."""
        x = self.width_px / 2 + centre[0] * self.radius_px
        y = self.height_px / 2 - centre[1] * self.radius_px
        reach = self.radius_px + 1
        return (
            max(0, int(np.floor(x - reach))),
            max(0, int(np.floor(y - reach))),
            min(self.width_px, int(np.ceil(x + reach))),
            min(self.height_px, int(np.ceil(y + reach))),
        )

    @property
    def axes(self) -> NDArray[np.float64]:
        """The project's frame in the scene: here they are the same."""
        return np.eye(3)

    def sensor(
        self, sampler: Sampler = "independent", box_px: tuple[int, int, int, int] | None = None
    ) -> Value:
        """Return Mitsuba's sensor, or the part of it that sees a box (left, top, right, bottom).

        Parameters
        ----------
        sampler
            As of `Camera`, or `grid` for `samples` on a regular grid: every engine takes the same
            ones, and edges show no noise.
        box_px
            In pixels from the top left corner; None for the whole image.
        """
        half_width = self.width_px / 2 / self.radius_px
        look = mi.ScalarTransform4f().look_at(
            origin=[0, 0, CAMERA_DISTANCE], target=[0, 0, 0], up=[0, 1, 0]
        )
        left, top, right, bottom = box_px or (0, 0, self.width_px, self.height_px)
        crop = {
            "crop_offset_x": left,
            "crop_offset_y": top,
            "crop_width": right - left,
            "crop_height": bottom - top,
        }
        return mi.load_dict(
            {
                "type": "orthographic",
                "to_world": look @ mi.ScalarTransform4f().scale([half_width, half_width, 1]),
                "near_clip": 0.1,
                "far_clip": 2 * CAMERA_DISTANCE,
                "film": film_of(self.width_px, self.height_px) | crop,
                "sampler": sampler_of(sampler, self.samples),
            }
        )

    def depth(self, points: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return how far points `(..., 3)` of the scene lie behind the camera's plane `(...)`."""
        return np.asarray(CAMERA_DISTANCE - points[..., 2])

    def distance(self, points: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return the length of the way of light from points `(..., 3)` to the camera `(...)`."""
        return self.depth(points)

    def pixels_per_unit(self, depth: float) -> float:  # noqa: ARG002  # the same at any depth
        """Return the size in pixels of one unit of the scene at that depth."""
        return self.radius_px


@dataclass(frozen=True)
class Perspective:
    """A pinhole camera.

    Attributes
    ----------
    position, target
        Where it stands and where it looks, in the scene.
    field_of_view_deg
        Horizontal, from edge to edge, more than 0 and less than 180.
    width_px, height_px
        Size of the image.
    up
        The direction in the scene that is upright in the image.

    Raises
    ------
    InputError
        If a value is outside its range, or the camera looks along `up`.
    """

    position: Point
    target: Point
    field_of_view_deg: float
    width_px: int
    height_px: int
    up: Point = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        if not 0 < self.field_of_view_deg < 180:
            raise InputError(
                f"field_of_view_deg: {self.field_of_view_deg} given, 0 to 180 accepted (excluded)"
            )
        if self.width_px < 1 or self.height_px < 1:
            raise InputError("width_px, height_px: 1 or more are accepted")
        away = np.subtract(self.target, self.position)
        if np.linalg.norm(np.cross(away, self.up)) <= 1e-9 * np.linalg.norm(away):
            raise InputError("target: a point that is not straight above or below is accepted")

    @property
    def axes(self) -> NDArray[np.float64]:
        """The project's frame in the scene: rows are x (right), y (up) and z (to the viewer)."""
        backward = np.subtract(self.position, self.target)
        backward = backward / np.linalg.norm(backward)
        right = np.cross(self.up, backward)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(backward, right), backward])

    @property
    def focal_length_px(self) -> float:
        """From the pinhole to the image plane, in pixels."""
        return self.width_px / 2 / float(np.tan(np.radians(self.field_of_view_deg) / 2))

    def sensor(self, sampler: Sampler = "independent") -> Value:
        """Return Mitsuba's sensor; see `Camera`."""
        look = mi.ScalarTransform4f().look_at(
            origin=list(self.position), target=list(self.target), up=list(self.up)
        )
        return mi.load_dict(
            {
                "type": "perspective",
                "to_world": look,
                "fov": self.field_of_view_deg,
                "fov_axis": "x",
                "near_clip": 1e-2,
                "far_clip": _FAR,
                "film": film_of(self.width_px, self.height_px),
                "sampler": sampler_of(sampler),
            }
        )

    def depth(self, points: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return how far points `(..., 3)` of the scene lie behind the camera's plane `(...)`."""
        return np.asarray((np.asarray(self.position) - points) @ self.axes[2])

    def distance(self, points: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return the length of the way of light from points `(..., 3)` to the camera `(...)`."""
        return np.asarray(np.linalg.norm(points - np.asarray(self.position), axis=-1))

    def pixels_per_unit(self, depth: float) -> float:
        """Return the size in pixels of one unit of the scene at that depth."""
        return self.focal_length_px / depth

    def project(self, points: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return where points of the scene appear.

        Parameters
        ----------
        points
            `(..., 3)`, in front of the camera.

        Returns
        -------
        Columns and rows `(..., 2)` from the image's top left corner, in pixels.
        """
        x, y, _ = np.moveaxis((points - np.asarray(self.position)) @ self.axes.T, -1, 0)
        scale = self.focal_length_px / self.depth(points)
        return np.stack([self.width_px / 2 + x * scale, self.height_px / 2 - y * scale], axis=-1)


def camera_of(scene: Value) -> Perspective:
    """Return the camera of a Mitsuba scene: its first sensor.

    Raises
    ------
    InputError
        If there is none, or it is not a `perspective` one.
    """
    sensors = scene.sensors()
    if not sensors or not str(sensors[0]).startswith("PerspectiveCamera"):
        raise InputError("camera: the scene has no `perspective` sensor, and none is given")
    parameters = mi.traverse(sensors[0])
    to_world = np.array(parameters["to_world"].matrix, dtype=np.float64).reshape(4, 4)
    width_px, height_px = (int(extent) for extent in sensors[0].film().size())
    position, ahead, up = to_world[:3, 3], to_world[:3, 2], to_world[:3, 1]
    target = position + ahead
    return Perspective(
        tuple(position.tolist()),
        tuple(target.tolist()),
        float(np.ravel(parameters["x_fov"])[0]),
        width_px,
        height_px,
        tuple(up.tolist()),
    )


def light_in_frame(light_in_scene: Light, camera: Camera) -> Light:
    """Return a directional light given by the scene's axes in the project's frame of a camera."""
    return Light.from_direction(
        camera.axes @ light_in_scene.direction, light_in_scene.intensity, light_in_scene.distance
    )


def light_in_scene(light: Light, camera: Camera) -> Light:
    """Return a light given in the project's frame of a camera by the axes of the scene."""
    return Light.from_direction(light.direction @ camera.axes, light.intensity, light.distance)


def film_of(width_px: int, height_px: int) -> dict[str, Any]:
    """Return Mitsuba's film: linear RGB and coverage, every sample counted in its own pixel."""
    return {
        "type": "hdrfilm",
        "width": width_px,
        "height": height_px,
        "pixel_format": "rgba",
        "component_format": "float32",
        "rfilter": {"type": "box"},
    }


def sampler_of(name: Sampler, samples: int = 1) -> dict[str, Any]:
    """Return Mitsuba's sampler.

    Parameters
    ----------
    name
        `independent` for random samples, `centre` for one sample in each pixel's centre, `grid` for
        samples on a regular grid, `jittered` for a random sample in each cell of such a grid, in
        every pair of dimensions (Kensler 2013, *Correlated multi-jittered sampling*): a third to an
        eighth of the noise's variance of independent ones, in scenes under an environment.
    samples
        Of the grid, a square number; a renderer's `spp` goes before it.
    """
    if name == "independent":
        return {"type": "independent"}
    if name == "jittered":
        return {"type": "multijitter", "sample_count": samples}
    count = 1 if name == "centre" else samples
    return {"type": "stratified", "sample_count": count, "jitter": False}
