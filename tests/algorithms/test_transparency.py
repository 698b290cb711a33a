"""Glass: Snell's and Fresnel's laws, what is seen through a body, and nothing beyond it."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.depth import silhouette_relief
from algorithms.errors import InputError, UnavailableError
from algorithms.inpainting import fill_behind
from algorithms.transparency import Glass, make_transparent, reflectance, refracted

Image = NDArray[np.float32]
SHAPE = (80, 110)
BARE: dict[str, Any] = {"tint": (1.0, 1.0, 1.0), "highlights": 0.0, "reflections": 0.0}


def disc(radius_px: float = 25) -> NDArray[np.bool_]:
    row, column = np.mgrid[: SHAPE[0], : SHAPE[1]] + 0.5
    return np.asarray(np.hypot(row - 40, column - 55) < radius_px)


def ramp() -> Image:
    """Return a surface whose red grows to the right and whose green grows downwards."""
    row, column = np.mgrid[: SHAPE[0], : SHAPE[1]]
    red, green = 0.1 + column / 200, 0.1 + row / 200
    return np.stack([red, green, np.full(SHAPE, 0.2)], axis=-1).astype(np.float32)


def with_object(surface: Image) -> Image:
    image = surface.copy()
    image[disc()] = (0.5, 0.05, 0.05)
    return image


# Laws.


@pytest.mark.parametrize("ratio", [1 / 1.5, 1.0, 1.5])
@pytest.mark.parametrize("angle_deg", [0, 10, 35])
def test_rays_bend_by_snell_s_law(ratio: float, angle_deg: float) -> None:
    turn = np.radians(angle_deg)
    ray = np.array([np.sin(turn), 0, -np.cos(turn)], np.float32)
    bent = refracted(ray, np.array([0, 0, 1], np.float32), ratio)
    assert np.linalg.norm(bent) == pytest.approx(1, abs=1e-6)
    assert bent[0] == pytest.approx(ratio * np.sin(turn), abs=1e-6)
    assert bent[2] < 0


def test_what_would_be_reflected_totally_leaves_along_the_surface() -> None:
    ray = np.array([np.sin(1.2), 0, -np.cos(1.2)], np.float32)
    bent = refracted(ray, np.array([0, 0, 1], np.float32), 1.5)
    np.testing.assert_allclose(bent, [1, 0, 0], atol=1e-6)


def test_reflectance_follows_fresnel() -> None:
    cosine = np.array([1.0, np.cos(np.arctan(1.5)), 0.0], np.float32)
    found = reflectance(cosine, 1.5)
    # Head on ((n - 1) / (n + 1))^2; at Brewster's angle half of what is polarised across; all of it
    # when grazing.
    across = ((1.5**2 - 1) / (1.5**2 + 1)) ** 2
    np.testing.assert_allclose(found, [0.04, across / 2, 1], atol=1e-6)


# What is seen.


def test_glass_that_bends_nothing_shows_the_background() -> None:
    surface = ramp()
    glass = Glass(refractive_index=1.0, **BARE)
    relief = silhouette_relief(disc())
    found = make_transparent(with_object(surface), disc(), relief, glass, surface)
    np.testing.assert_allclose(found, surface, atol=1e-5)


def test_a_ball_turns_the_background_upside_down() -> None:
    surface = ramp()
    glass = Glass(refractive_index=1.5, distance=2.0, smoothing=0.0, **BARE)
    relief = silhouette_relief(disc())
    found = make_transparent(with_object(surface), disc(), relief, glass, surface)
    across = found[40, 45:65, 0]
    down = found[30:50, 55, 1]
    assert (np.diff(across) < 0).all()
    assert (np.diff(down) < 0).all()
    # The middle is where it was.
    np.testing.assert_allclose(found[40, 55, :2], surface[40, 55, :2], atol=0.02)


def test_a_pane_moves_nothing() -> None:
    surface = ramp()
    glass = Glass(refractive_index=1.5, smoothing=0.0, **BARE)
    flat = np.where(disc(), 12.0, 0)
    found = make_transparent(with_object(surface), disc(), flat, glass, surface)
    np.testing.assert_allclose(found, surface, atol=1e-3)


def test_the_thickest_part_has_the_tint_and_the_rim_hardly_any() -> None:
    surface = np.full((*SHAPE, 3), 0.5, np.float32)
    glass = Glass(1.2, tint=(0.2, 0.6, 1.0), highlights=0.0, reflections=0.0)
    relief = silhouette_relief(disc())
    found = make_transparent(with_object(surface), disc(), relief, glass, surface)
    np.testing.assert_allclose(found[40, 55], [0.1, 0.3, 0.5], atol=0.01)
    assert found[40, 55 - 24, 0] > 0.25


def test_reflections_brighten_the_rim_most() -> None:
    surface = np.full((*SHAPE, 3), 0.1, np.float32)
    surface[:30] = 2.0  # a bright sky, above
    relief = silhouette_relief(disc())
    plain, shiny = (
        make_transparent(
            with_object(surface), disc(), relief, Glass(1.5, (1, 1, 1), 0.4, 0, share), surface
        )
        for share in (0.0, 1.0)
    )
    added = np.abs(shiny - plain)[..., 1]
    # At the lower rim the floor is reflected, at the upper one the sky.
    assert added[18:24, 55].max() > 5 * added[40, 55]


def test_highlights_stay_if_asked_for() -> None:
    image = with_object(ramp())
    image[30:36, 50:56] += 0.6  # of the light's colour
    relief = silhouette_relief(disc())
    without, kept = (
        make_transparent(image, disc(), relief, Glass(highlights=share), ramp())
        for share in (0.0, 1.0)
    )
    added = kept - without
    assert added[31:35, 51:55].min() > 0.3
    # Pixels of the object's own colour have none.
    assert np.abs(added[45:60, 45:65]).max() < 0.01


def test_nothing_changes_beyond_the_object_s_edge() -> None:
    image = with_object(ramp())
    found = make_transparent(image, disc(), silhouette_relief(disc()), background=ramp())
    np.testing.assert_array_equal(found[~disc(30)], image[~disc(30)])


def test_every_pixel_is_finite_for_any_range() -> None:
    image = with_object(ramp())
    image[:20] = 1e4
    image[60:] = 0
    relief = silhouette_relief(disc()) * np.float32(3)
    found = make_transparent(image, disc(), relief, Glass(2.4, distance=1.0))
    assert found.dtype == np.float32
    assert np.isfinite(found).all()
    assert found.min() >= 0


# What is behind.


def test_a_hole_in_an_even_surface_is_filled_evenly() -> None:
    surface = np.full((*SHAPE, 3), (0.4, 0.3, 0.05), np.float32)
    # 8 bits of a curve that is 1/2 at the median are worth a hundredth there, more at the top.
    np.testing.assert_allclose(fill_behind(with_object(surface), disc()), surface, rtol=0.06)


@pytest.mark.parametrize("enlarged", [1, 4])
def test_stripes_go_on_behind(enlarged: int) -> None:
    stripes = np.where(np.arange(SHAPE[1]) // 5 % 2, 0.6, 0.2)
    surface = np.repeat(np.tile(stripes, (SHAPE[0], 1))[..., None], 3, axis=2).astype(np.float32)
    image, mask = (
        np.kron(each, np.ones((enlarged, enlarged, 1) if each.ndim == 3 else (enlarged, enlarged)))
        for each in (with_object(surface), disc())
    )
    filled = fill_behind(image, mask > 0)[::enlarged, ::enlarged, 1]
    assert np.corrcoef(filled[disc()], surface[..., 1][disc()])[0, 1] > 0.6


def test_only_the_object_and_its_rim_are_filled_and_always_the_same() -> None:
    image = with_object(ramp())
    filled = fill_behind(image, disc())
    np.testing.assert_array_equal(filled[~disc(28)], image[~disc(28)])
    assert filled.tobytes() == fill_behind(image, disc()).tobytes()


# Bad input.


def test_a_missing_library_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "patchmatch", None)
    with pytest.raises(UnavailableError, match="pip install pypatchmatch"):
        fill_behind(ramp(), disc())


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"image": np.zeros((4, 4))}, "image: .height, width, 3."),
        ({"image": np.full((*SHAPE, 3), np.inf)}, "image: finite values"),
        ({"mask": np.ones(SHAPE, bool)}, "mask: a part of the image"),
        ({"mask": np.zeros(SHAPE, bool)}, "mask: at least one pixel"),
        ({"mask": np.ones((3, 3), bool)}, "mask: .80, 110. is accepted"),
        ({"relief": np.zeros((3, 3))}, "relief: .80, 110. of finite values"),
        ({"relief": np.full(SHAPE, np.nan)}, "relief: .80, 110. of finite values"),
        ({"background": np.zeros((3, 3, 3))}, "background: .80, 110, 3. is accepted"),
    ],
)
def test_refuses(changes: dict[str, Any], message: str) -> None:
    arguments = {"image": ramp(), "mask": disc(), "relief": silhouette_relief(disc())} | changes
    with pytest.raises(InputError, match=message):
        make_transparent(**arguments)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"refractive_index": 0.9}, "refractive_index: 1..3"),
        ({"refractive_index": np.nan}, "refractive_index: 1..3"),
        ({"tint": (1.0, 1.0)}, "tint: three numbers"),
        ({"tint": (0.0, 1.0, 1.0)}, "tint: three numbers"),
        ({"distance": -1.0}, "distance: a finite number"),
        ({"smoothing": np.inf}, "smoothing: a finite number"),
        ({"highlights": 1.5}, "highlights: 0..1"),
        ({"reflections": -0.1}, "reflections: 0..1"),
    ],
)
def test_glass_refuses(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Glass(**changes)
