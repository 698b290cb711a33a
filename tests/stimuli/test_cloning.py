import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.ndimage import binary_dilation, binary_erosion, laplace
from skimage.draw import disk

from algorithms.errors import InputError
from stimuli.photographs.cloning import clone, seam_of_255

SIZE = (70, 90)


def smooth(generator: np.random.Generator, low: float = 0.2, high: float = 0.8) -> np.ndarray:
    """Return an image of broad waves."""
    y, x = np.mgrid[: SIZE[0], : SIZE[1]] / 20
    waves = [np.sin(generator.uniform(-1, 1, 3) @ [x.ravel(), y.ravel(), np.ones(x.size)])]
    waves += [np.cos(generator.uniform(-1, 1, 3) @ [x.ravel(), y.ravel(), np.ones(x.size)])]
    channels = [waves[0], waves[1], waves[0] * waves[1]]
    image = np.stack([channel.reshape(SIZE) for channel in channels], axis=-1)
    return np.asarray((low + high) / 2 + (high - low) / 2 * image, dtype=np.float32)


def round_mask(radius: float = 18) -> np.ndarray:
    mask = np.zeros(SIZE, dtype=bool)
    mask[disk((35, 45), radius)] = True
    return mask


TARGET, SOURCE = (smooth(np.random.default_rng(seed)) for seed in (1, 2))


def test_the_target_stays_outside_and_the_source_comes_inside() -> None:
    cloned = clone(TARGET, SOURCE, round_mask(), margin_px=6, reach_px=1.5)
    assert_array_equal(cloned.image[~cloned.region], TARGET[~cloned.region])
    assert_array_equal(cloned.region, binary_dilation(cloned.region, iterations=0) & cloned.region)
    assert cloned.region[round_mask()].all()
    deep = binary_erosion(round_mask(), iterations=8)
    # Theory: at a distance d from the border the correction has died out to about exp(-d / reach).
    assert np.abs(cloned.image - SOURCE)[deep].max() < np.exp(-14 / 1.5) * 4


def test_without_a_reach_gradients_are_the_sources() -> None:
    # Theory: Poisson's equation; the composite's Laplacian is the source's, within the core.
    cloned = clone(TARGET, SOURCE, round_mask(), margin_px=8)
    core = binary_erosion(round_mask(), iterations=1)
    for channel in range(3):
        found = laplace(cloned.image[..., channel].astype(np.float64))
        assert_allclose(
            found[core], laplace(SOURCE[..., channel].astype(np.float64))[core], atol=1e-5
        )


def test_the_correction_solves_the_screened_equation() -> None:
    # Theory: laplace(u) = u / reach^2 within, u = target - source around.
    cloned = clone(TARGET, SOURCE, round_mask(), margin_px=6, reach_px=5)
    known = np.where(cloned.region[..., None], cloned.correction, TARGET - SOURCE)
    for channel in range(3):
        u = known[..., channel].astype(np.float64)
        assert_allclose(laplace(u)[cloned.region], u[cloned.region] / 25, atol=1e-7)


def test_a_difference_that_is_constant_is_taken_up_whole() -> None:
    # Theory: a constant is harmonic, so that plain cloning gives the target back.
    cloned = clone(TARGET, TARGET + np.float32(0.1), round_mask(), margin_px=5)
    assert_allclose(cloned.image, TARGET, atol=1e-6)


@settings(max_examples=20, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 1000),
    margin=st.floats(1, 12),
    reach=st.one_of(st.floats(0.5, 50), st.just(np.inf)),
)
def test_values_stay_between_what_was_there(seed: int, margin: float, reach: float) -> None:
    # Property: the maximum principle; the correction is nowhere more than around the region.
    target, source = (smooth(np.random.default_rng([seed, i])) for i in range(2))
    cloned = clone(target, source, round_mask(), margin_px=margin, reach_px=reach)
    rim = binary_dilation(cloned.region) & ~cloned.region
    bound = np.abs(target - source)[rim].max(axis=0)
    assert (np.abs(cloned.correction).reshape(-1, 3).max(axis=0) <= bound + 1e-6).all()


def test_alike_photographs_are_left_as_they_are() -> None:
    cloned = clone(TARGET, TARGET, round_mask(), margin_px=5, reach_px=3)
    assert_allclose(cloned.image, TARGET, atol=1e-7)


def test_other_objects_are_protected() -> None:
    other = np.zeros(SIZE, dtype=bool)
    other[30:40, 64:75] = True
    cloned = clone(TARGET, SOURCE, round_mask(), margin_px=6, reach_px=3, protected=other)
    assert_array_equal(cloned.image[other], TARGET[other])
    assert not (cloned.region & other).any()


def test_seams_are_weaker_than_those_of_a_paste() -> None:
    # Definition: the strongest edge that neither photograph has.
    mask = round_mask()
    pasted = np.where(mask[..., None], SOURCE, TARGET)
    cloned = clone(TARGET, SOURCE, mask, margin_px=6, reach_px=3)
    naive = seam_of_255(pasted, TARGET, SOURCE, mask)
    assert seam_of_255(cloned.image, TARGET, SOURCE, cloned.region) < 0.4 * naive
    assert seam_of_255(SOURCE, TARGET, SOURCE, mask) == 0
    step = TARGET.copy()
    step[:, 45:] += 0.1
    assert seam_of_255(step, TARGET, TARGET, mask) > 10


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"source": SOURCE[1:]}, "the target's size"),
        ({"mask": round_mask()[:, 1:]}, "the target's size"),
        ({"mask": np.zeros(SIZE, dtype=bool)}, "mask: one pixel or more"),
        ({"mask": np.ones(SIZE, dtype=bool)}, "clear of the image's border"),
        ({"margin_px": 0.5}, "margin_px: 1 or more"),
        ({"margin_px": np.nan}, "margin_px: 1 or more"),
        ({"reach_px": 0}, "reach_px: more than 0"),
    ],
)
def test_refuses_what_it_cannot_clone(changes: dict[str, object], message: str) -> None:
    arguments = {"target": TARGET, "source": SOURCE, "mask": round_mask(), "margin_px": 5} | changes
    with pytest.raises(InputError, match=message):
        clone(**arguments)  # type: ignore[arg-type]
