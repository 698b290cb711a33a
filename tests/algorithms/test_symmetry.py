"""Phase symmetry: theory, another implementation, and what it refuses."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from algorithms import symmetry
from algorithms.errors import InputError
from algorithms.log_gabor import LogGaborBank, polar_angles
from algorithms.symmetry import Polarity, phase_symmetry

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # it recommends a faster transform
    from phasepack import phasesym  # type: ignore[import-untyped]

SIZE_PX = 129
Image = NDArray[np.float64]


def places(turned_deg: float = 0) -> tuple[Image, Image]:
    """Return coordinates about the middle, in pixels: y up, the axes turned."""
    row, column = np.mgrid[:SIZE_PX, :SIZE_PX] - SIZE_PX // 2
    turn = np.radians(turned_deg)
    return (
        column * np.cos(turn) - row * np.sin(turn),
        -column * np.sin(turn) - row * np.cos(turn),
    )


def ridge(turned_deg: float = 0) -> Image:
    """Return a ridge through the middle, its profile along the angle, that ends in a round spot."""
    across, along = places(turned_deg)
    return np.asarray(np.exp(-((across / 4) ** 2) - (along / 25) ** 2))


def step() -> Image:
    """Return a bright half, whose edges are at columns 32 and 96: left up, right down."""
    return np.tile((np.abs(np.arange(128) - 63.5) < 32).astype(float), (128, 1))


def natural(seed: int, size_px: int = 128) -> Image:
    """Return noise with the spectrum of natural images, in 0..1."""
    frequency = np.hypot(*np.meshgrid(*[np.fft.fftfreq(size_px)] * 2))
    frequency[0, 0] = 1
    white = np.random.default_rng(seed).normal(size=(size_px, size_px))
    image = np.fft.ifft2(np.fft.fft2(white) / frequency**1.2).real
    return np.asarray((image - image.min()) / np.ptp(image))


# Theory.


def test_a_ridge_is_symmetric_on_its_crest_alone() -> None:
    found = phase_symmetry(ridge(), orientations=6, polarity="bright")
    middle = SIZE_PX // 2
    assert np.argmax(found[middle]) == middle
    assert found[middle, middle] > 3 * found[middle, middle - 6 : middle - 4].max()


def test_a_line_s_even_response_is_all_of_its_amplitude_without_noise() -> None:
    image = np.tile(np.exp(-(((np.arange(128) - 64) / 4) ** 2)), (128, 1))
    found = phase_symmetry(image, orientations=1, noise_deviations=0)
    # What is taken off for noise is the median response, which is tiny beside that on the line.
    assert found[:, 64].min() > 0.9


def test_a_step_is_antisymmetric() -> None:
    found = phase_symmetry(step(), orientations=6)
    assert found[:, 31:33].max() == 0
    assert found[:, 95:97].max() == 0


def test_polarity_tells_bright_lines_from_dark_ones() -> None:
    image, middle = ridge(), SIZE_PX // 2
    values: dict[Polarity, float] = {}
    for polarity in ("both", "bright", "dark"):
        found = phase_symmetry(image, polarity=polarity)
        values[polarity] = float(found[middle, middle])
        inverse = phase_symmetry(-image, polarity=polarity)
        other: dict[str, Polarity] = {"both": "both", "bright": "dark", "dark": "bright"}
        np.testing.assert_allclose(
            inverse, phase_symmetry(image, polarity=other[polarity]), atol=1e-5
        )
    assert values["bright"] == pytest.approx(values["both"], abs=1e-5)
    assert values["bright"] > 0.3
    assert values["dark"] == 0


@pytest.mark.parametrize(("contrast", "brightness"), [(1e-3, 0), (40, 0), (1, 3), (0.2, -0.5)])
def test_contrast_and_brightness_change_nothing(contrast: float, brightness: float) -> None:
    image = natural(1)
    changed = phase_symmetry(contrast * image + brightness)
    # float32 keeps 1e-7 of the brightness, the filters' smallest responses are 1e-4 of the range.
    np.testing.assert_allclose(changed, phase_symmetry(image), atol=2e-3)


@pytest.mark.parametrize("orientations", [1, 2, 5])
def test_a_quarter_turn_of_image_and_filters_turns_the_result(orientations: int) -> None:
    # An odd number of pixels, so that the frequency plane has no row without a counterpart.
    image = natural(2, SIZE_PX)
    turned = phase_symmetry(np.rot90(image), orientations=orientations, first_deg=90)
    np.testing.assert_allclose(
        turned, np.rot90(phase_symmetry(image, orientations=orientations)), atol=1e-4
    )


@pytest.mark.parametrize("turned_deg", [17, 45, 130])
def test_any_turn_of_a_ridge_and_the_filters_keeps_its_crest(turned_deg: float) -> None:
    settings = {"orientations": 3, "shortest_px": 6.0, "scales": 3}
    upright = phase_symmetry(ridge(), **settings)  # type: ignore[arg-type]
    turned = phase_symmetry(ridge(turned_deg), first_deg=turned_deg, **settings)  # type: ignore[arg-type]
    middle = slice(SIZE_PX // 2 - 1, SIZE_PX // 2 + 2)
    # The grid of frequencies is square, so that turned filters differ a little in the corners.
    np.testing.assert_allclose(turned[middle, middle].mean(), upright[middle, middle].mean(), 0.03)


def test_noise_alone_has_next_to_no_symmetry() -> None:
    noise = np.random.default_rng(3).normal(size=(256, 256))
    without = phase_symmetry(noise, noise_deviations=0)
    assert phase_symmetry(noise, noise_deviations=3).mean() < 0.1 * without.mean()


@pytest.mark.parametrize("orientations", [1, 2, 3, 6, 20])
def test_gaussian_filters_pass_one_side_of_the_plane(orientations: int) -> None:
    bank = LogGaborBank(orientations=orientations)
    angles = polar_angles((64, 64), slice(0, 64))
    for angle_deg in bank.angles_deg:
        part = bank.angular_part(angle_deg, angles)
        behind = np.cos(angles - np.radians(angle_deg)) < -1e-6
        assert part.max() > 0.5
        assert part[behind].max() < 0.06


def test_cosine_filters_cover_all_orientations_evenly() -> None:
    bank = LogGaborBank(orientations=6, angular="cosine")
    angles = polar_angles((64, 64), slice(0, 64))
    both_sides = np.zeros(angles.shape)
    for angle_deg in bank.angles_deg:
        both_sides += bank.angular_part(angle_deg, angles)
        both_sides += bank.angular_part(angle_deg + 180, angles)
    np.testing.assert_allclose(both_sides, both_sides[0, 0], rtol=1e-5)


# Another implementation: Kovesi's programs in Python (phasepack).


@pytest.mark.parametrize(("polarity", "number"), [("both", 0), ("bright", 1), ("dark", -1)])
@pytest.mark.parametrize("shape", [(128, 128), (96, 160)])
def test_equal_to_phasepack(polarity: Polarity, number: int, shape: tuple[int, int]) -> None:
    image = natural(4, 160)[: shape[0], : shape[1]]
    image = (image - image.min()) / np.ptp(image)  # its smallest amplitude is absolute
    ours = phase_symmetry(image, scales=4, orientations=5, angular="cosine", polarity=polarity)
    theirs = phasesym(image, nscale=4, norient=5, polarity=number)[0]
    assert theirs.max() > 0.3
    np.testing.assert_allclose(ours, theirs, atol=1e-4)


def test_other_settings_are_equal_to_phasepack_too() -> None:
    image = natural(5)
    ours = phase_symmetry(
        image,
        scales=3,
        orientations=9,
        shortest_px=5,
        scaling=1.6,
        bandwidth=0.7,
        noise_deviations=1,
        angular="cosine",
    )
    theirs = phasesym(image, 3, 9, minWaveLength=5, mult=1.6, sigmaOnf=0.7, k=1)[0]
    np.testing.assert_allclose(ours, theirs, atol=1e-4)


# Properties.


@settings(max_examples=30, deadline=None)
@given(
    arrays(
        np.float32,
        st.tuples(st.integers(1, 17), st.integers(1, 17)),
        elements=st.floats(-1e3, 1e3, width=32),
    ),
    st.integers(1, 4),
)
def test_any_image_gives_finite_shares(image: NDArray[np.float32], orientations: int) -> None:
    found = phase_symmetry(image, orientations=orientations)
    assert found.dtype == np.float32
    assert found.shape == image.shape
    assert np.isfinite(found).all()
    assert found.min() >= 0
    assert found.max() <= 1 + 1e-5


def test_an_even_surface_has_no_symmetry() -> None:
    assert not phase_symmetry(np.full((20, 30), 7.0)).any()


def test_the_cores_do_not_change_a_byte(monkeypatch: pytest.MonkeyPatch) -> None:
    first = phase_symmetry(natural(6))
    monkeypatch.setattr("os.cpu_count", lambda: 5)
    assert phase_symmetry(natural(6)).tobytes() == first.tobytes()


def test_large_images_in_one_stream_give_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    two = phase_symmetry(natural(6))
    monkeypatch.setattr(symmetry, "_SMALL", 0)
    np.testing.assert_allclose(phase_symmetry(natural(6)), two, atol=1e-5)


# Bad input.


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"image": np.zeros((4, 4, 3))}, "image: .height, width. is accepted"),
        ({"image": np.zeros((0, 4))}, "image: .height, width. is accepted"),
        ({"image": np.full((4, 4), np.nan)}, "image: finite values"),
        ({"scales": 0}, "scales: a whole number"),
        ({"scales": 2.5}, "scales: a whole number"),
        ({"orientations": 0}, "orientations: a whole number"),
        ({"first_deg": np.inf}, "first_deg: a finite number"),
        ({"shortest_px": 1.5}, "shortest_px: a finite number of 2 or more"),
        ({"scaling": 1.0}, "scaling: a finite number of more than 1"),
        ({"bandwidth": 1.0}, "bandwidth: a number between 0 and 1"),
        ({"angular": "square"}, "angular: one of gaussian, cosine"),
        ({"noise_deviations": -1}, "noise_deviations: a finite number of 0 or more"),
        ({"polarity": "grey"}, "polarity: one of both, bright, dark"),
    ],
)
def test_refuses(changes: dict[str, object], message: str) -> None:
    arguments: dict[str, object] = {"image": np.zeros((8, 8))} | changes
    with pytest.raises(InputError, match=message):
        phase_symmetry(**arguments)  # type: ignore[arg-type]
