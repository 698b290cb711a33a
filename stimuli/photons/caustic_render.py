"""The picture of caustics: progressive photon mapping (Knaus and Zwicker 2011).

Every pass traces photons of its own. Those that the camera sees directly are projected onto its
pixels, whatever their surface is made of. For what it sees through glass and in mirrors, rays are
followed to the first matt surface, and the density of photons there is estimated within a radius
that shrinks from pass to pass, so that the mean of many passes loses both its noise and its blur.
Of glossy surfaces seen in that way only the diffuse part is shown.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from math import exp, lgamma
from typing import Final

import drjit as dr
import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from stimuli.photons.eye_paths import Eye
from stimuli.photons.photon_grid import PhotonGrid
from stimuli.photons.photon_map import EnergyBalance, PhotonMap
from stimuli.photons.photon_projection import can_project, projected
from stimuli.photons.photon_tracing import PhotonTracer
from stimuli.shapes.mesh import Value

Image = NDArray[np.float32]

ALPHA: Final = 2 / 3
"""Of Knaus and Zwicker 2011: variance and squared bias of the mean of n passes then both fall as
n^(-2/3)."""


@dataclass(frozen=True)
class Caustics:
    """A picture of caustics alone.

    Attributes
    ----------
    radiance
        float32 `(height, width, 3)`, to be added to a render without caustics.
    halves
        The means of the passes with even and odd numbers; half of their difference is an estimate
        of the noise of `radiance`.
    radii
        Of each pass, in scene units.
    energy
        Where the power of the photons went, the mean of the passes.
    """

    radiance: Image
    halves: tuple[Image, Image]
    radii: tuple[float, ...]
    energy: EnergyBalance


class CausticRenderer:
    """Renders passes of the caustics that one camera sees.

    Parameters
    ----------
    tracer
        Sends the photons.
    sensor
        Mitsuba's; its film's size counts, and every sample falls into its own pixel (a box filter).
    photons_per_pass
        Emitted in each pass.
    radius
        Of the kernel in the first pass, in scene units; None for the size of a pixel on the
        receivers.
    eye_samples
        Rays from the camera by pixel and pass.
    seen
        The scene that the camera sees; None for the one that photons are traced in. Another one
        shows caustics of what is not there, on surfaces that both have.
    project
        Whether photons seen directly are projected; else all are gathered within the radius, as for
        cameras that are no `perspective` ones.

    Raises
    ------
    InputError
        If a number is out of range, or no matt surface is in view.
    """

    def __init__(
        self,
        tracer: PhotonTracer,
        sensor: Value,
        *,
        photons_per_pass: int,
        radius: float | None = None,
        eye_samples: int = 16,
        seen: Value = None,
        project: bool = True,
    ) -> None:
        if photons_per_pass < 1 or eye_samples < 1:
            raise InputError("photons_per_pass, eye_samples: 1 or more are accepted")
        if radius is not None and not 0 < radius < np.inf:
            raise InputError(f"radius: {radius} given, more than 0 accepted")
        self._tracer, self._photons = tracer, photons_per_pass
        self._scene, self._sensor = tracer.scene if seen is None else seen, sensor
        self._project = project and can_project(sensor)
        self._eye = Eye(self._scene, sensor, eye_samples, directly=not self._project)
        self.radius = radius or Eye(self._scene, sensor, 1).footprint()

    def pass_radius(self, number: int) -> float:
        """Return the kernel's radius in the pass of that number, from 0 on."""
        # The product of (k + alpha) / (k + 1) over k = 1 .. number (Knaus and Zwicker 2011, eq. 15)
        logarithm = lgamma(number + 1 + ALPHA) - lgamma(1 + ALPHA) - lgamma(number + 2)
        return self.radius * exp(logarithm / 2)

    def render_pass(self, number: int, seed: int) -> tuple[Image, EnergyBalance]:
        """Render one pass.

        Parameters
        ----------
        number
            From 0 on: sets the radius.
        seed
            0 or more; passes that differ in number or seed are independent.

        Returns
        -------
        Radiance float32 `(height, width, 3)`, and what became of the photons.
        """
        generator = np.random.default_rng([seed, number])
        photons = self._tracer.trace(self._photons, generator)
        image = np.zeros(self._eye.shape, np.float32)
        if len(photons) and not self._eye.is_blind:
            image += self._gathered(photons, number, int(generator.integers(2**31)))
        if len(photons) and self._project:
            image += projected(photons, self._scene, self._sensor)
        return image, photons.energy

    def _gathered(self, photons: PhotonMap, number: int, seed: int) -> Image:
        sight = self._eye.look(seed)
        grid = PhotonGrid(photons.position, photons.normal, photons.power, self.pass_radius(number))
        irradiance = grid.irradiance(sight.position, sight.normal, sight.valid)
        return self._eye.image(sight.weight * irradiance / dr.pi)


def render_caustics(renderer: CausticRenderer, *, passes: int, seed: int) -> Caustics:
    """Return the mean of progressive passes.

    Parameters
    ----------
    renderer
        Of the scene.
    passes
        2 or more.
    seed
        0 or more; the same gives the same picture.

    Raises
    ------
    InputError
        If a number is out of range.
    """
    if passes < 2:
        raise InputError(f"passes: {passes} given, 2 or more accepted")
    sums: list[NDArray[np.float64]] = [np.zeros(()), np.zeros(())]
    energies = []
    for number in range(passes):
        image, energy = renderer.render_pass(number, seed)
        sums[number % 2] = sums[number % 2] + image
        energies.append(energy)
    counts = [(passes + 1) // 2, passes // 2]
    halves = [(each / count).astype(np.float32) for each, count in zip(sums, counts, strict=True)]
    return Caustics(
        ((sums[0] + sums[1]) / passes).astype(np.float32),
        (halves[0], halves[1]),
        tuple(renderer.pass_radius(number) for number in range(passes)),
        _mean(energies),
    )


def _mean(energies: Sequence[EnergyBalance]) -> EnergyBalance:
    names = [field.name for field in fields(EnergyBalance)]
    return EnergyBalance(
        *(np.mean([getattr(energy, name) for energy in energies], axis=0) for name in names)
    )
