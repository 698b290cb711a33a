"""Fog against theory: Beer-Lambert, Koschmieder, and the furnace."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import mitsuba as mi
import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from algorithms.errors import InputError
from stimuli.camera import Perspective
from stimuli.scenes.fog_layer import FogLayer

pytestmark = pytest.mark.usefixtures("engine")

FOG = FogLayer(extinction=0.05, albedo=1.0, asymmetry=0.7, top=20.0, reach=200.0)
DISTANCES = np.array([4.0, 10.0, 20.0, 40.0])
EYE = (0.0, 2.0, 0.0)


def radiance(
    scene: Mapping[str, Any], fog: FogLayer, camera: Perspective, samples: int
) -> NDArray[np.float64]:
    sensor = camera.sensor()
    loaded = mi.load_dict(fog.immerse({"type": "scene", **scene}, sensor))
    integrator = mi.load_dict({"type": "volpath", "max_depth": 256})
    pixels = mi.render(loaded, sensor=sensor, integrator=integrator, spp=samples, seed=5)
    return np.array(pixels, dtype=np.float64)[..., :3]


HALF_WIDTH = 0.03  # of a target: so small that it hardly shades the fog before it


def narrow(distance: float) -> Perspective:
    """A camera that sees nothing but the middle of a target at that distance."""
    half_angle = math.degrees(math.atan(0.5 * HALF_WIDTH / distance))
    return Perspective(EYE, (0.0, EYE[1], -distance), 2 * half_angle, 8, 8)


def target(distance: float, reflectance: float = 0.0, emitted: float = 0.0) -> dict[str, Any]:
    """A small square that faces the camera."""
    transform = mi.ScalarTransform4f().translate([0, EYE[1], -distance])
    transform = transform.scale([HALF_WIDTH, HALF_WIDTH, 1])
    shape: dict[str, Any] = {
        "type": "rectangle",
        "to_world": transform,
        "bsdf": {"type": "diffuse", "reflectance": reflectance},
    }
    return {"target": shape | ({"emitter": _area(emitted)} if emitted else {})}


def _area(value: float) -> dict[str, Any]:
    return {"type": "area", "radiance": value}


def sky(value: float = 1.0) -> dict[str, Any]:
    return {"sky": {"type": "constant", "radiance": value}}


def test_absorption_attenuates_exponentially() -> None:
    # Theory: Beer-Lambert; nothing scatters, so a lamp is all there is to see.
    black = replace(FOG, albedo=0.0)
    seen = [
        radiance(target(distance, emitted=3.0), black, narrow(distance), 512).mean()
        for distance in DISTANCES
    ]
    assert_allclose(seen, 3 * np.exp(-FOG.extinction * DISTANCES), rtol=0.03)


def test_fog_that_does_not_absorb_is_invisible_in_even_light() -> None:
    # Theory: in a furnace everything has the radiance of the walls, whatever it scatters.
    view = Perspective(EYE, (0.0, 3.0, -5.0), 60, 12, 9)
    assert_allclose(radiance(sky(0.7), FOG, view, 512).mean(), 0.7, rtol=0.01)


def test_black_things_fade_into_the_airlight() -> None:
    # Koschmieder: in evenly lit fog a black target has 1 - exp(-sigma_t d) of the airlight.
    seen = [
        radiance({**target(distance), **sky()}, FOG, narrow(distance), 512).mean()
        for distance in DISTANCES
    ]
    assert_allclose(seen, 1 - np.exp(-FOG.extinction * DISTANCES), atol=0.02)


def test_contrast_falls_exponentially_under_sun_and_sky() -> None:
    # Koschmieder: a white and a black target under the same light; the airlight before both is the
    # same, so the difference is that of the targets, attenuated. Fitted over a tenfold distance.
    lights = sky(0.4) | {
        "sun": {"type": "directional", "direction": [0.3, -0.8, -0.5], "irradiance": 2.0}
    }
    differences = []
    for distance in DISTANCES:
        dark, bright = (
            radiance({**target(distance, share), **lights}, FOG, narrow(distance), 1024).mean()
            for share in (0.0, 0.9)
        )
        differences.append(bright - dark)
    slope = np.polyfit(DISTANCES, np.log(differences), 1)[0]
    assert_allclose(-slope, FOG.extinction, rtol=0.06)


def test_way_ends_at_what_is_seen_or_where_the_fog_ends() -> None:
    # Theory: geometry of the rays, here straight ahead and to the layer's top.
    view = Perspective(EYE, (0.0, 2.0, -1.0), 90, 3, 5)
    near = FOG.way(view, np.full((5, 3), 7.0))
    assert_allclose(near[2], 7.0)
    far = FOG.way(view, np.full((5, 3), np.inf))
    assert_allclose(far[2], FOG.reach)
    slope = 2 / math.hypot(2, 1.5)  # the top row's middle: two pixels up, 1.5 pixels to the plane
    assert_allclose(far[0, 1], 18 / slope, rtol=1e-6)
    assert_allclose(far[-1], FOG.reach)


def test_visibility_is_where_two_percent_of_contrast_are_left() -> None:
    assert_allclose(math.exp(-FOG.extinction * FOG.visibility), 0.02)
    assert_allclose(FOG.visibility * FOG.extinction, 3.912, atol=1e-3)


@pytest.mark.parametrize(
    ("field", "value"),
    [("extinction", 0.0), ("albedo", 1.1), ("asymmetry", 1.0), ("top", math.inf), ("reach", -1)],
)
def test_impossible_fog_is_refused(field: str, value: float) -> None:
    with pytest.raises(InputError, match=rf"^{field}: .* accepted$"):
        replace(FOG, **{field: value})
