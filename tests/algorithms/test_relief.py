"""Relief from one picture, against bodies whose shape is known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from algorithms.depth import (
    contour_normals,
    mirrored_body,
    perceptual_relief,
    relief_normals,
    silhouette_relief,
)
from algorithms.errors import InputError
from algorithms.light import Light
from tests.algorithms.lit_bodies import ellipsoid, grey, lit

SIDE = 160
MASK, NORMALS, POSITIONS = ellipsoid(SIDE)
RADIUS_PX = 0.8 * SIDE / 2
HEIGHT = POSITIONS[..., 2] * RADIUS_PX
LIGHT = Light(120, 50)
PICTURE = grey(lit(NORMALS, [LIGHT], 0.1) * MASK)


def test_a_disc_becomes_half_a_sphere() -> None:
    # Theory: its square root solves Poisson's equation exactly; pixels make the outline uneven.
    relief = silhouette_relief(MASK)
    assert np.abs(relief - HEIGHT)[MASK].mean() < 0.02 * RADIUS_PX
    assert abs(relief.max() / RADIUS_PX - 1) < 0.03


@pytest.mark.parametrize("axes", [(1, 0.5, 1), (0.6, 1, 1)])
def test_an_ellipse_becomes_half_an_ellipsoid(axes: tuple[float, float, float]) -> None:
    # Theory: h = (1 - x^2/a^2 - y^2/b^2) * 2 / (1/a^2 + 1/b^2) has the Laplacian -4.
    mask, _, _ = ellipsoid(SIDE, axes)
    a, b, _ = axes
    places = ((np.arange(SIDE) + 0.5) / SIDE * 2 - 1) / 0.8
    squared = 1 - (places / a) ** 2 - (places[:, None] / b) ** 2
    height = RADIUS_PX * np.sqrt(np.maximum(squared, 0) * 2 / (1 / a**2 + 1 / b**2))
    assert np.abs(silhouette_relief(mask) - height)[mask].mean() < 0.03 * height.max()


def test_what_the_border_cuts_goes_on_beyond_it() -> None:
    # Theory: the solution is even across the border, so that half a disc is half of the disc's.
    whole, half = silhouette_relief(MASK), silhouette_relief(MASK[: SIDE // 2])
    assert np.abs(half - whole[: SIDE // 2]).max() < 0.06 * RADIUS_PX


def test_contour_normals_of_a_disc_are_those_of_a_sphere() -> None:
    # Theory: the components of a sphere's normals are linear in x and y, so harmonic.
    normals = contour_normals(MASK)
    inside = MASK & (POSITIONS[..., 2] > 0.3)
    assert np.degrees(np.arccos(np.clip((normals * NORMALS).sum(axis=-1)[inside], -1, 1))).max() < 6
    assert_allclose(np.linalg.norm(normals[MASK], axis=-1), 1, atol=1e-5)
    assert (normals[~MASK] == 0).all()


def test_normals_of_a_sphere() -> None:
    # Theory; differences of pixels lose the last few pixels, where the slope grows without limit.
    normals = relief_normals(HEIGHT, MASK)
    inside = MASK & (POSITIONS[..., 2] > 0.5)
    assert np.degrees(np.arccos((normals * NORMALS).sum(axis=-1)[inside].clip(-1, 1))).max() < 2
    assert (normals[~MASK] == 0).all()


@given(st.floats(-3, 3), st.floats(-3, 3))
def test_normals_of_a_plane(right: float, up: float) -> None:
    # Theory, up to the rim: nothing outside plays a part.
    rows, columns = np.indices(MASK.shape)
    plane = np.where(MASK, columns * right - rows * up, np.nan)
    expected = np.array([-right, -up, 1]) / np.sqrt(right**2 + up**2 + 1)
    normals = relief_normals(plane, MASK)[MASK]
    assert_allclose(normals, np.broadcast_to(expected, normals.shape), atol=1e-3)


def test_a_body_is_its_own_mirror_image() -> None:
    body = mirrored_body(HEIGHT, MASK)
    assert_allclose(body.front, -body.back)
    assert_allclose(body.front_normals[..., :2], body.back_normals[..., :2])
    assert (body.back_normals[MASK, 2] < 0).all()


def test_shading_shows_in_the_relief_and_the_silhouette_is_met_at_zero() -> None:
    # A bump that is brighter than its surroundings comes nearer.
    rows, columns = np.indices(MASK.shape)
    spot = np.exp(-((rows - 80) ** 2 + (columns - 60) ** 2) / 2 / 12**2)
    flat = perceptual_relief(grey(np.full(MASK.shape, 0.2)), MASK)
    bump = perceptual_relief(grey(0.2 + 0.4 * spot), MASK)
    assert_allclose(flat, silhouette_relief(MASK), atol=1e-3)
    assert (bump - flat)[80, 60] > 0.05 * RADIUS_PX
    assert (bump - flat)[80, 60] > 2 * (bump - flat)[80, 100]
    rim = MASK & (POSITIONS[..., 2] < 0.2)
    assert bump[rim].max() < 0.35 * RADIUS_PX
    assert (bump[~MASK] == 0).all()


@pytest.mark.parametrize("light", [Light(0, 40), Light(90, 40), Light(200, 40)])
def test_a_sphere_is_recovered_whatever_the_light(light: Light) -> None:
    # Recovery, up to scale and offset (the bas-relief ambiguity).
    relief = perceptual_relief(grey(lit(NORMALS, [light], 0.1) * MASK), MASK)
    assert np.corrcoef(relief[MASK], HEIGHT[MASK])[0, 1] > 0.97


@settings(max_examples=10, deadline=None, derandomize=True)
@given(st.floats(1e-3, 1e4))
def test_exposure_does_not_matter(factor: float) -> None:
    relief = perceptual_relief(PICTURE, MASK)
    assert_allclose(perceptual_relief(PICTURE * factor, MASK), relief, atol=0.02 * RADIUS_PX)


def test_weights_choose_large_and_small_features() -> None:
    # Theory: eq. 4.1 is linear in both weights.
    noisy = PICTURE * np.random.default_rng(5).uniform(0.8, 1.2, (SIDE, SIDE, 1))

    def relief(base: float, detail: float) -> np.ndarray:
        return perceptual_relief(noisy, MASK, base_weight=base, detail_weight=detail)

    assert (relief(0, 0) == 0).all()
    assert_allclose(relief(1, 0.5), relief(1, 0) + relief(0, 0.5), atol=1e-3)
    middle = np.s_[60:100, 60:100]
    rough = [np.diff(relief(1, detail)[middle], n=2, axis=1).std() for detail in (0, 1)]
    assert rough[1] > 1.5 * rough[0]


def test_a_whole_picture_has_no_silhouette() -> None:
    relief = perceptual_relief(PICTURE, np.ones_like(MASK))
    assert np.isfinite(relief).all()
    assert relief[80, 60] > relief[2, 2]


def test_a_single_pixel_is_an_object() -> None:
    mask = np.zeros((9, 9), bool)
    mask[4, 4] = True
    assert np.isfinite(perceptual_relief(np.ones((9, 9, 3)), mask)).all()
    assert silhouette_relief(mask)[4, 4] > 0


def test_bad_input_is_refused() -> None:
    with pytest.raises(InputError, match="mask"):
        perceptual_relief(PICTURE, MASK[1:])
    with pytest.raises(InputError, match="mask: at least one"):
        silhouette_relief(np.zeros((4, 4), bool))
    with pytest.raises(InputError, match="mask"):
        contour_normals(np.ones(4, bool))
    with pytest.raises(InputError, match="image"):
        perceptual_relief(np.full_like(PICTURE, np.nan), MASK)
    with pytest.raises(InputError, match="image"):
        perceptual_relief(-PICTURE - 1, MASK)
    with pytest.raises(InputError, match="image"):
        perceptual_relief(PICTURE[..., :2], MASK)
    for name in ("base_weight", "detail_weight", "inflation", "shading"):
        with pytest.raises(InputError, match=name):
            perceptual_relief(PICTURE, MASK, **{name: -0.1})
    with pytest.raises(InputError, match="relief"):
        relief_normals(np.full(MASK.shape, np.nan), MASK)
