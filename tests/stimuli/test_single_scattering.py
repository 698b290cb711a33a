"""Light that scatters once, against theory and Mitsuba's volumetric path tracer."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from algorithms.light import Light
from stimuli.camera import Camera, Perspective, View, light_in_frame
from stimuli.translucency.dipole import Dipole
from stimuli.translucency.media import MEASURED, Medium
from stimuli.translucency.renderer import Translucent, TranslucentRenderer
from tests.stimuli.bodies import UnitSphere
from tests.stimuli.test_irradiance import fresnel_transmittance
from tests.stimuli.test_translucent import slab
from tests.stimuli.volumetric_path_tracer import sphere_radiance

pytestmark = pytest.mark.usefixtures("llvm")


def once_scattered(
    body: Translucent, camera: Camera, lights: list[Light], samples: int = 4
) -> NDArray[np.float64]:
    """Return what single scattering adds to a picture `(height, width, 3)`."""
    renderer = TranslucentRenderer(body, points=1000)
    without, with_it = (
        renderer.radiance(camera, lights, samples=samples, single_scattering=single)[0]
        for single in (False, True)
    )
    return (with_it - without).astype(np.float64)


@pytest.mark.parametrize("index", [1.0, 1.5])
@pytest.mark.parametrize("view_deg", [0.0, 50.0])
def test_flat_surface_is_the_closed_form(index: float, view_deg: float) -> None:
    # Theory: L = albedo / (4 pi) E cos_i F_in F_out / (eta^2 (mu_i + mu_o)), mu the cosines inside
    # (single scattering in half of space, with a boundary as in Hanrahan and Krueger 1993).
    medium = Medium("any", (0.8, 2.0, 5.0), (0.4, 0.1, 3.0), index)
    body = Translucent(slab(4.0, 4.0), medium, mm_per_unit=10)
    angle = np.radians(view_deg)
    camera = Perspective((9 * np.sin(angle), 0, 9 * np.cos(angle)), (0, 0, 0), 0.5, 2, 2)
    light = Light(70, 35, intensity=3.0)
    found = once_scattered(body, camera, [light_in_frame(light, camera)]).mean(axis=(0, 1))

    cosines = np.array([np.sin(np.radians(35)), np.cos(angle)])
    inside = np.sqrt(1 - (1 - cosines**2) / index**2)
    passing = fresnel_transmittance(cosines, index).prod() / index**2
    expected = medium.albedo / (4 * np.pi) * 3.0 * cosines[0] * passing / inside.sum()
    assert_allclose(found, expected, rtol=3e-3)


@pytest.mark.parametrize("light", [Light(30, 40, np.pi), Light(0, -50, np.pi)])
def test_sphere_without_a_boundary(light: Light) -> None:
    # Another implementation: the volumetric path tracer stopped after one event, within its noise.
    view = View(width_px=24, height_px=24, radius_px=11, samples=1)
    extinction, albedo = 2.0, 0.7
    scattering, absorption = albedo * extinction, (1 - albedo) * extinction
    medium = Medium("thin", (scattering,) * 3, (absorption,) * 3, 1.0)
    body = Translucent(UnitSphere().mesh(48, 96), medium, mm_per_unit=1)
    found = once_scattered(body, view, [light], samples=16)[..., 0]
    traced = sphere_radiance(view, light, albedo, extinction, samples=1024, once=True)
    inner = np.hypot(*(np.mgrid[:24, :24] - 11.5)) < 9
    assert found[inner].mean() == pytest.approx(traced[inner].mean(), rel=0.01)
    difference = (found - traced)[inner]
    assert np.sqrt((difference**2).mean()) < 0.1 * traced[inner].mean()


def test_the_dipole_has_it_already() -> None:
    # The known limit: of a medium that absorbs nothing the dipole returns all that enters, so that
    # whatever is added is light from nowhere.
    body = Translucent(slab(2.0, 1.0), MEASURED["spectralon"], mm_per_unit=20)
    assert_allclose(Dipole.of(body.medium).total_reflectance, 1)
    view = View(width_px=1, height_px=1, radius_px=50, samples=1)
    light = Light(0, 90, np.pi)
    added = once_scattered(body, view, [light])[0, 0]
    assert (added > 0.05).all()
