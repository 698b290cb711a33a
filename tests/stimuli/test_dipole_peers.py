"""The dipole against Mitsuba's volumetric path tracer, which knows no diffusion.

`benchmarks/dipole.py` compares more media; these are the cases that bound what the dipole is for.
"""

import numpy as np
import pytest

from algorithms.light import Light
from stimuli.camera import View
from stimuli.translucency.dipole import Dipole
from stimuli.translucency.media import Medium
from stimuli.translucency.renderer import Translucent, TranslucentRenderer
from tests.stimuli.bodies import UnitSphere
from tests.stimuli.volumetric_path_tracer import slab_reflectance, sphere_radiance

pytestmark = pytest.mark.usefixtures("llvm")


def grey(albedo: float, refractive_index: float) -> Medium:
    """Return a medium with a mean free path of 1 mm, alike in all channels."""
    return Medium("grey", (albedo,) * 3, (1 - albedo,) * 3, refractive_index)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("albedo", "refractive_index", "expected_ratio"),
    [(0.99, 1.0, 0.99), (0.99, 1.3, 0.98), (0.9, 1.3, 1.03), (0.8, 1.5, 1.36)],
)
def test_reflectance_of_a_thick_slab(
    albedo: float, refractive_index: float, expected_ratio: float
) -> None:
    # The known limit: within 2 % where little is absorbed; with much absorption and a strong
    # boundary the diffuse approximation inside is far off.
    traced = slab_reflectance(albedo, refractive_index, samples=20_000)
    passing = 1 - ((refractive_index - 1) / (refractive_index + 1)) ** 2
    dipole = passing * Dipole.of(grey(albedo, refractive_index)).total_reflectance[0]
    noise = np.sqrt(traced * (1 - traced) / 20_000) / traced  # of hits among the samples
    assert dipole / traced == pytest.approx(expected_ratio, abs=4 * noise + 0.005)


@pytest.mark.slow
def test_picture_of_a_sphere() -> None:
    # The known limit: the dipole shades a body as it should, somewhat darker, as it takes light
    # that comes in or goes out at a slant for light that goes straight.
    view = View(width_px=24, height_px=24, radius_px=11, samples=1)
    light = Light(0, 30, np.pi)
    traced = sphere_radiance(view, light, albedo=0.99, extinction=20.0, samples=400)
    body = Translucent(UnitSphere().mesh(48, 96), grey(0.99, 1.0), mm_per_unit=20.0)
    radiance, coverage = TranslucentRenderer(body, points=20_000).radiance(view, [light])
    whole = coverage == 1
    dipole, traced = radiance[whole, 0], traced[whole]
    assert np.corrcoef(dipole, traced)[0, 1] > 0.98
    assert 0.88 < dipole.mean() / traced.mean() < 0.94
