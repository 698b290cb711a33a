"""Rendering an object of a translucent medium by the dipole.

Light enters at the pieces of its surface; what leaves a point towards the camera is the dipole's
R_d summed over all pieces, times the Fresnel transmittance on the way in and on the way out (Jensen
et al. 2001, eq. 5; Lopez-Moreno 2011, eq. 9.1). Light that has left is not followed further.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.light import Light
from stimuli.camera import Camera, light_in_scene
from stimuli.engine import require_kernels
from stimuli.shapes.mesh import Mesh, to_mitsuba
from stimuli.translucency.dipole import Dipole
from stimuli.translucency.hierarchical_sum import TOLERANCE, HierarchicalSum
from stimuli.translucency.irradiance import entering_irradiance
from stimuli.translucency.media import Medium
from stimuli.translucency.power_octree import cluster
from stimuli.translucency.single_scattering import SingleScattering
from stimuli.translucency.surface_pieces import (
    SurfacePieces,
    check_count,
    cut_surface,
    surface_area,
)
from stimuli.translucency.translucent_integrator import translucent_integrator_class

Image = NDArray[np.float32]

FEWEST_POINTS: Final = 50_000
MOST_POINTS: Final = 400_000
"""Between these, the number of irradiance points is chosen by the medium's mean free path."""

_POINTS_PER_FREE_PATH: Final = 2.0


@dataclass(frozen=True)
class Translucent:
    """A closed body of one medium.

    Attributes
    ----------
    mesh
        Around the origin of the scene.
    medium
        What it is filled with.
    mm_per_unit
        Its size: millimetres in a unit of the scene, more than 0. The smaller, the more light
        passes through.
    roughness
        Of the surface's highlights (Beckmann's alpha, 0.001 to 1); None for a surface without.

    Raises
    ------
    InputError
        If a value is outside its range, or the mesh is not closed.
    """

    mesh: Mesh
    medium: Medium
    mm_per_unit: float
    roughness: float | None = None

    def __post_init__(self) -> None:
        if not 0 < self.mm_per_unit < np.inf:
            raise InputError(f"mm_per_unit: more than 0 accepted, not {self.mm_per_unit}")
        if self.roughness is not None and not 0.001 <= self.roughness <= 1:
            raise InputError(f"roughness: 0.001 to 1 or None accepted, not {self.roughness}")
        if self.roughness is not None and self.medium.refractive_index == 1:
            raise InputError("roughness: None accepted at refractive index 1, where nothing shines")
        if not self.mesh.is_closed:
            raise InputError("mesh: a closed one is accepted, as light goes through its inside")

    def bsdf(self) -> dict[str, Any]:
        """Return Mitsuba's description of what the surface reflects."""
        if self.roughness is None:
            return {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}
        return {
            "type": "roughplastic",
            "alpha": self.roughness,
            "int_ior": self.medium.refractive_index,
            "diffuse_reflectance": {"type": "rgb", "value": 0.0},
        }


class TranslucentRenderer:
    """Renders one translucent body under any lights, from any camera.

    Parameters
    ----------
    body
        What is seen.
    points
        About how many samples of irradiance, `FEWEST_PIECES` to `MOST_PIECES` of
        `stimuli.translucency.surface_pieces`; None for as many as the medium asks for. Where they
        are farther apart than light goes straight on in the medium, the picture is blurred by their
        spacing.

    Raises
    ------
    InputError
        If the number of points is out of range.
    UnavailableError
        If the engine that was chosen is the scalar one.
    """

    def __init__(self, body: Translucent, points: int | None = None) -> None:
        require_kernels("translucent objects")
        self.body = body
        self.points = self._points_for_medium() if points is None else points
        check_count(self.points)
        self._scene = mi.load_dict(
            {"type": "scene", "body": to_mitsuba(body.mesh, body.bsdf(), "body")}
        )

    def radiance(
        self,
        camera: Camera,
        lights: Sequence[Light],
        *,
        samples: int = 4,
        seed: int = 0,
        tolerance: float = TOLERANCE,
        single_scattering: bool = False,
    ) -> tuple[Image, Image]:
        """Render an image.

        Parameters
        ----------
        camera
            Where it is seen from.
        lights
            One or more, in the project's frame of that camera.
        samples
            A pixel, in jittered strata: a square number.
        seed
            Draws where irradiance and pixels are sampled; 0 or more.
        tolerance
            See `HierarchicalSum`.
        single_scattering
            Whether to add light that scatters once; see `stimuli.translucency.single_scattering`.

        Returns
        -------
        Radiance float32 `(height, width, 3)`, zero where there is no object, and the share of
        each pixel that it covers, float32 `(height, width)`.

        Raises
        ------
        InputError
            If there is no light.
        """
        if not lights:
            raise InputError("lights: one or more are accepted")
        in_scene = [light_in_scene(light, camera) for light in lights]
        body, single = self.body, None
        if single_scattering:
            single = SingleScattering(body.medium, body.mm_per_unit, in_scene)
        integrator = translucent_integrator_class()(
            self._exitance(in_scene, np.random.default_rng([seed, 9])),
            body.medium.refractive_index,
            tolerance,
            in_scene if body.roughness else (),
            single,
        )
        sensor = camera.sensor("jittered")
        pixels = np.array(
            mi.render(self._scene, sensor=sensor, integrator=integrator, spp=samples, seed=seed)
        )
        return pixels[..., :3], pixels[..., 3]

    def _exitance(self, lights: Sequence[Light], generator: np.random.Generator) -> HierarchicalSum:
        """Return the radiant exitance of the surface, to be asked for anywhere on it."""
        body = self.body
        pieces = cut_surface(body.mesh, self.points, generator)
        entering = entering_irradiance(
            self._scene, pieces.centres, pieces.normals, lights, body.medium.refractive_index
        )
        return exitance_sum(body, pieces, entering)

    def _points_for_medium(self) -> int:
        """Return how many pieces are as small as the shortest mean free path asks for."""
        free_path = self.body.medium.mean_free_path_mm.min() / self.body.mm_per_unit
        wanted = _POINTS_PER_FREE_PATH**2 * surface_area(self.body.mesh) / free_path**2
        return int(np.clip(wanted, FEWEST_POINTS, MOST_POINTS))


def exitance_sum(
    body: Translucent, pieces: SurfacePieces, entering: NDArray[np.float64]
) -> HierarchicalSum:
    """Return the radiant exitance of a surface as a sum over its pieces.

    Parameters
    ----------
    body
        Whose medium and size fix the profile.
    pieces
        Of its surface.
    entering
        Irradiance that enters each piece `(n,)`.
    """
    scale = body.mm_per_unit
    dipole = Dipole.of(body.medium).smoothed(pieces.spacing * scale)
    depth_mm = float((dipole.source_depth_mm + dipole.sinking_mm).min())
    return HierarchicalSum(
        cluster(pieces, entering * pieces.areas),
        lambda distance: dipole(distance * scale) * scale**2,
        finest=depth_mm / scale / 2,
        farthest=2 * body.mesh.bounding_radius,
    )
