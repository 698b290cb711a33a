"""Fog, against the point-spread function's published form and what must hold for any medium."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from algorithms.errors import InputError
from algorithms.fog import (
    PRESETS,
    Fog,
    add_fog,
    airlight_colour,
    apsf,
    energy_within,
    white_level,
)
from algorithms.fog.apsf import apsf_kernel

GENERATOR = np.random.default_rng(8)
SHAPE = (60, 90)
PICTURE = (GENERATOR.uniform(0, 1, (*SHAPE, 3)) ** 3).astype(np.float32)
DISTANCE = np.broadcast_to(np.linspace(0.5, 30, SHAPE[0])[::-1, None], SHAPE).copy()
DISTANCE[:5] = np.inf
PLAIN = Fog(0.1, desaturation=0, shadow_lift=0, highlight_attenuation=0, glow=0)
THICKNESSES = st.floats(1.05, 20)
FORWARD = st.floats(0, 0.95)


def test_published_values_of_the_point_spread_function() -> None:
    # Narasimhan and Nayar 2003, eq. 17, at T = 1.2 and q = 0.75, relative to 0 degrees.
    assert_allclose(apsf([5, 20, 45, 90], 1.2, 0.75), [0.965, 0.752, 0.478, 0.184], atol=0.002)


@settings(deadline=None)
@given(THICKNESSES, FORWARD)
def test_it_is_positive_and_falls_with_the_angle(thickness: float, forward: float) -> None:
    values = apsf(np.linspace(0, 180, 181), thickness, forward)
    assert values[0] == pytest.approx(1)
    assert (values[:-1] > 0).all()
    assert values[-1] == pytest.approx(0, abs=1e-6)
    assert (np.diff(values) < 1e-7).all()


@settings(deadline=None)
@given(THICKNESSES, FORWARD)
def test_all_of_its_energy_is_within_the_sphere(thickness: float, forward: float) -> None:
    # Another way: numerical integration over the sphere.
    angles = np.linspace(0, 180, 4001)
    density = apsf(angles, thickness, forward) * np.sin(np.radians(angles))
    share = np.trapezoid(density[:445], angles[:445]) / np.trapezoid(density, angles)
    assert energy_within(angles[444], thickness, forward) == pytest.approx(share, abs=1e-4)
    assert energy_within(180, thickness, forward) == pytest.approx(1)


@given(st.sampled_from([0.2, 0.75, 0.9]))
def test_thicker_fog_spreads_more(forward: float) -> None:
    shares = [energy_within(20, thickness, forward) for thickness in (1.05, 1.2, 1.6, 2.5, 4)]
    assert (np.diff(shares) < 0).all()


@pytest.mark.parametrize("shape", [(8, 8), (31, 44)])
def test_kernels_sum_to_one_and_peak_at_their_centre(shape: tuple[int, int]) -> None:
    kernel = apsf_kernel(shape, 40.0, 1.3)
    assert kernel.sum() == pytest.approx(1, abs=1e-5)
    assert kernel.argmax() == 0
    # 40 px at a focal length of 40 px are 45 degrees.
    wide = apsf_kernel((200, 200), 40.0, 1.3)
    assert wide[0, 40] / wide[0, 0] == pytest.approx(float(apsf(45, 1.3)), abs=1e-3)


@pytest.mark.parametrize(
    ("angle", "thickness", "forward", "name"),
    [
        (181, 1.2, 0.75, "angle_deg"),
        (5, 1.0, 0.75, "optical_thickness"),
        (5, 1.2, 1.0, "forward_scattering"),
    ],
)
def test_the_series_refuses_what_it_cannot_do(
    angle: float, thickness: float, forward: float, name: str
) -> None:
    with pytest.raises(InputError, match=name):
        apsf(angle, thickness, forward)
    with pytest.raises(InputError, match=name):
        energy_within(angle, thickness, forward)


def test_attenuation_and_airlight_by_hand() -> None:
    # Eq. 6.4 in its physical form.
    airlight = np.array([0.2, 0.3, 0.4])
    fog = replace(PLAIN, scattering=0.05, airlight=tuple(airlight / white_level(PICTURE)))
    distance = DISTANCE[..., None]
    expected = PICTURE * np.exp(-0.1 * distance) + airlight * (1 - np.exp(-0.05 * distance))
    assert_allclose(add_fog(PICTURE, DISTANCE, fog), expected, atol=1e-5)
    # Without limit: only airlight.
    sky = add_fog(PICTURE, np.full(SHAPE, np.inf), fog)
    assert_allclose(sky, np.broadcast_to(airlight, sky.shape), rtol=1e-5)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.floats(0.01, 3), st.floats(0, 0.95), st.floats(0, 1), st.floats(0.1, 3), st.booleans())
def test_in_a_white_furnace_fog_is_not_seen(
    extinction: float, forward: float, strength: float, scale: float, noisy: bool
) -> None:
    # Theory: where everything has the airlight's radiance, fog that does not absorb changes
    # nothing, however thick; seams between depths would show here.
    furnace = np.full((*SHAPE, 3), 0.4, dtype=np.float32)
    fog = Fog(
        extinction,
        desaturation=strength,
        shadow_lift=strength,
        highlight_attenuation=strength,
        forward_scattering=forward,
        glow=strength,
        glow_scale=scale,
        noise_amplitude=float(noisy),
    )
    foggy = add_fog(furnace, DISTANCE, fog, generator=np.random.default_rng(1))
    assert_allclose(foggy, furnace, rtol=1e-4)


def test_no_fog_changes_nothing() -> None:
    noisy = replace(PRESETS["house-left"], extinction=0, scattering=0)
    assert_array_equal(add_fog(PICTURE, DISTANCE, noisy), PICTURE)
    assert_array_equal(add_fog(PICTURE, DISTANCE, Fog(0)), PICTURE)
    assert add_fog(PICTURE, DISTANCE, Fog(0)) is not PICTURE
    for fog in PRESETS.values():
        at_hand = add_fog(PICTURE, np.zeros(SHAPE), fog, generator=np.random.default_rng(1))
        assert_array_equal(at_hand, PICTURE)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.floats(1e-3, 1e4), st.sampled_from(sorted(PRESETS)))
def test_exposure_does_not_matter(factor: float, preset: str) -> None:
    # Theory: everything is relative to the picture's white.
    fog, distance = PRESETS[preset], DISTANCE / 30
    one, other = (
        add_fog(pixels, distance, fog, generator=np.random.default_rng(3))
        for pixels in (PICTURE, PICTURE * np.float32(factor))
    )
    assert_allclose(other / factor, one, rtol=2e-3, atol=2e-4)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.integers(0, 1000), st.sampled_from(sorted(PRESETS)))
def test_results_are_finite_and_never_negative(seed: int, preset: str) -> None:
    # High dynamic range: from 1e-6 to 1e6, with black pixels.
    generator = np.random.default_rng(seed)
    image = 10 ** generator.uniform(-6, 6, (20, 30, 3)) * (generator.random((20, 30, 1)) > 0.1)
    distance = np.where(generator.random((20, 30)) > 0.2, generator.random((20, 30)), np.inf)
    foggy = add_fog(image, distance, PRESETS[preset], generator=generator)
    assert foggy.dtype == np.float32
    assert foggy.shape == image.shape
    assert np.isfinite(foggy).all()
    assert foggy.min() >= 0


def test_contrast_falls_with_distance() -> None:
    # Koschmieder: contrast against the airlight falls as exp(-k Z), with or without glow.
    board = np.where(np.indices(SHAPE).sum(axis=0) % 2, 0.6, 0.2)[..., None].repeat(3, axis=2)
    distances = (1.0, 5.0, 20.0)
    for glow in (0.0, 1.0):
        fog = replace(PLAIN, glow=glow)
        contrasts = [np.ptp(add_fog(board, np.full(SHAPE, z), fog)) for z in distances]
        assert_allclose(contrasts, 0.4 * np.exp(-0.1 * np.array(distances)), rtol=0.02)


def test_a_lamp_has_a_halo() -> None:
    # The glow falls with the distance from the lamp, and a smaller scale gathers it.
    lamp = np.full((64, 64, 3), 0.01)
    lamp[31:33, 31:33] = 100
    fog = replace(PLAIN, airlight=(0.0, 0.0, 0.0))
    dark = add_fog(lamp, np.full((64, 64), 15.0), fog)[32, :, 1]
    glowing, gathered = (
        add_fog(lamp, np.full((64, 64), 15.0), replace(fog, glow=1, glow_scale=scale))[32, :, 1]
        for scale in (1, 0.1)
    )
    halo, small = (glowing - dark)[34:60], (gathered - dark)[34:60]
    assert (np.diff(halo) < 0).all()
    assert small[0] > 3 * halo[0]
    assert small[-1] < halo[-1]


def test_relighting_softens() -> None:
    # Colours go to grey, shadows up, highlights down; each alone, and more with more fog.
    grey_air = replace(PLAIN, airlight=(0.0, 0.0, 0.0))
    image = np.full((*SHAPE, 3), 0.5, dtype=np.float32)
    image[10:20, 10:20] = (0.6, 0.1, 0.1)
    image[30:40, 10:20] = 0.001
    image[30:34, 40:44] = 4.0
    kept = np.exp(-0.1 * 10)
    plain, paler, lifted, dimmed = (
        add_fog(image, np.full(SHAPE, 10.0), fog) / kept
        for fog in (
            grey_air,
            replace(grey_air, desaturation=0.8),
            replace(grey_air, shadow_lift=0.8),
            replace(grey_air, highlight_attenuation=0.8),
        )
    )
    assert_allclose(plain, image, rtol=1e-5)
    assert np.ptp(paler[15, 15]) < 0.6 * np.ptp(image[15, 15])
    assert lifted[35, 15, 0] > 3 * image[35, 15, 0]
    assert dimmed[31, 41, 0] < 0.7 * image[31, 41, 0]
    for changed, place in ((lifted, (31, 41)), (dimmed, (35, 15)), (dimmed, (5, 5))):
        assert_allclose(changed[place], image[place], rtol=1e-5)


def test_noise_moves_the_density_not_the_picture() -> None:
    # A uniform picture at one distance: what varies is the attenuation, and its mean is right.
    fog = replace(PLAIN, airlight=(0.0, 0.0, 0.0), noise_amplitude=0.5, noise_period_px=12)
    flat = np.ones((200, 200, 3))
    foggy = add_fog(flat, np.full((200, 200), 10.0), fog, generator=np.random.default_rng(4))
    thickness = -np.log(foggy[..., 0])
    assert thickness.mean() == pytest.approx(1, abs=0.05)
    assert 0.05 < thickness.std() < 0.5
    again = add_fog(flat, np.full((200, 200), 10.0), fog, generator=np.random.default_rng(4))
    assert_array_equal(again, foggy)


def test_strips_leave_no_seams() -> None:
    # Larger than one strip of rows: as smooth across their borders as elsewhere.
    shape = (1100, 400)
    image = np.full((*shape, 3), 0.3, dtype=np.float32)
    image[:, 200:] = 0.6
    distance = np.broadcast_to(np.linspace(1, 20, shape[0])[:, None], shape)
    foggy = add_fog(image, distance, Fog(0.15, airlight=(0.5, 0.5, 0.6)))
    steps = np.abs(np.diff(foggy, n=2, axis=0)).max(axis=(1, 2))
    assert steps[3:-3].max() < 1e-4


def test_presets_are_those_of_the_table() -> None:
    # Lopez-Moreno 2011, table 6.1: sums of its columns.
    presets = PRESETS.values()
    assert len(PRESETS) == 9
    assert sum(fog.extinction for fog in presets) == pytest.approx(6.8)
    assert sum(fog.scattering or 0 for fog in presets) == pytest.approx(4.7)
    assert sum(fog.noise_octaves for fog in presets) == 43
    assert sum(fog.noise_period_px for fog in presets) == 5200
    weights = np.array([0.2126, 0.7152, 0.0722])
    assert sum(weights @ (fog.airlight or ()) for fog in presets) == pytest.approx(2.585)


def test_opaque_fog_has_the_mean_of_the_picture_half_as_colourful() -> None:
    opaque = add_fog(PICTURE * (1, 0.5, 0.2), np.full(SHAPE, np.inf), PLAIN)[0, 0]
    mean = (PICTURE * (1, 0.5, 0.2)).mean(axis=(0, 1))
    grey = mean @ [0.2126, 0.7152, 0.0722]
    assert_allclose(opaque, (mean + grey) / 2, rtol=1e-4)


def test_airlight_has_its_luminance_and_hue() -> None:
    red, green, blue = airlight_colour(0.5, 0.3, 240)
    assert 0.2126 * red + 0.7152 * green + 0.0722 * blue == pytest.approx(0.5)
    assert red == green < blue
    assert airlight_colour(0.5, 0) == pytest.approx((0.5, 0.5, 0.5))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("extinction", -1),
        ("extinction", np.nan),
        ("scattering", np.inf),
        ("airlight", (1, 2)),
        ("airlight", (1, 2, -1)),
        ("desaturation", 1.5),
        ("shadow_lift", -0.1),
        ("highlight_attenuation", 2),
        ("forward_scattering", 1),
        ("glow", -1),
        ("glow_scale", 0),
        ("noise_amplitude", 2),
        ("noise_octaves", 0),
        ("noise_period_px", 0),
    ],
)
def test_impossible_fog_is_refused(name: str, value: float | tuple[float, ...]) -> None:
    changed: dict[str, Any] = {name: value}
    with pytest.raises(InputError, match=f"{name}: .* accepted"):
        replace(PLAIN, **changed)


def test_bad_input_is_refused() -> None:
    with pytest.raises(InputError, match="image"):
        add_fog(PICTURE[..., :2], DISTANCE, PLAIN)
    with pytest.raises(InputError, match="image: finite"):
        add_fog(-PICTURE, DISTANCE, PLAIN)
    with pytest.raises(InputError, match="image: finite"):
        add_fog(PICTURE * np.nan, DISTANCE, PLAIN)
    with pytest.raises(InputError, match="distance"):
        add_fog(PICTURE, DISTANCE[1:], PLAIN)
    with pytest.raises(InputError, match="distance: 0 or more"):
        add_fog(PICTURE, np.full(SHAPE, np.nan), PLAIN)
    with pytest.raises(InputError, match="distance: 0 or more"):
        add_fog(PICTURE, -DISTANCE, PLAIN)
    with pytest.raises(InputError, match="field_of_view_deg"):
        add_fog(PICTURE, DISTANCE, PLAIN, field_of_view_deg=180)
    with pytest.raises(InputError, match="generator"):
        add_fog(PICTURE, DISTANCE, replace(PLAIN, noise_amplitude=0.5))
    with pytest.raises(InputError, match="airlight"):
        airlight_colour(-1, 0.5)
