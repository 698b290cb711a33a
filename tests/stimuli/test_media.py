"""The measured media against what was published, and what follows from a measurement."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from algorithms.errors import InputError
from stimuli.translucency.media import MEASURED, Channels, Medium, medium_named

# Lopez-Moreno 2011, table 9.2, columns "JMLH01": reduced albedo, reduced extinction in 1/mm.
TABLE_9_2: dict[str, tuple[Channels, Channels]] = {
    "apple": ((0.9987, 0.9986, 0.9772), (2.2930, 2.3934, 2.0160)),
    "cream": ((1.0000, 0.9995, 0.9949), (7.3802, 5.4728, 3.1663)),
    "marble": ((0.9990, 0.9984, 0.9976), (2.1921, 2.6241, 3.0071)),
    "potato": ((0.9965, 0.9873, 0.8209), (0.6824, 0.7090, 0.6700)),
    "skimmilk": ((0.9980, 0.9980, 0.9926), (0.7014, 1.2225, 1.9142)),
    "wholemilk": ((0.9996, 0.9993, 0.9963), (2.5511, 3.2124, 3.7840)),
}


@pytest.mark.parametrize("name", TABLE_9_2)
def test_published_albedo_and_extinction(name: str) -> None:
    # Published numbers, to their four decimals.
    albedo, extinction = TABLE_9_2[name]
    medium = medium_named(name)
    assert_allclose(medium.albedo, albedo, atol=0.51e-4)
    assert_allclose(medium.extinction_per_mm, extinction, atol=0.51e-4)


def test_all_measured_media_are_there() -> None:
    # Jensen et al. 2001, fig. 5: twelve materials, of one refractive index but for marble.
    assert len(MEASURED) == 12
    assert {medium.refractive_index for medium in MEASURED.values()} == {1.3, 1.5}
    assert MEASURED["marble"].refractive_index == 1.5
    assert all(name == medium.name for name, medium in MEASURED.items())


positive = st.floats(1e-3, 1e3)


@given(positive, st.floats(0, 1e3), positive)
def test_media_scale_like_lengths(scattering: float, absorption: float, factor: float) -> None:
    # Property: in a medium k times as dense every length is a k-th, and the albedo the same.
    thin = Medium("thin", (scattering,) * 3, (absorption,) * 3, 1.3)
    dense = replace(
        thin,
        scattering_per_mm=(scattering * factor,) * 3,
        absorption_per_mm=(absorption * factor,) * 3,
    )
    assert_allclose(dense.albedo, thin.albedo, rtol=1e-12)
    assert_allclose(dense.mean_free_path_mm, thin.mean_free_path_mm / factor, rtol=1e-12)
    assert_allclose(
        dense.transport_extinction_per_mm, thin.transport_extinction_per_mm * factor, rtol=1e-9
    )
    # Diffuse light goes at most as far as light goes straight on, where nothing is scattered.
    assert (thin.transport_extinction_per_mm <= np.sqrt(3) * thin.extinction_per_mm).all()


def test_unknown_medium_is_refused_with_the_known_ones() -> None:
    message = "medium: 'butter' given, apple, chicken1, chicken2, cream, ketchup, marble,"
    with pytest.raises(InputError, match=re.escape(message)):
        medium_named("butter")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"scattering_per_mm": (1.0, 0.0, 1.0)}, "scattering_per_mm: more than 0 accepted"),
        ({"absorption_per_mm": (0.1, -0.1, 0.1)}, "absorption_per_mm: 0 or more accepted"),
        ({"absorption_per_mm": (0.1, np.nan, 0.1)}, "absorption_per_mm: 0 or more accepted"),
        ({"refractive_index": 0.9}, "refractive_index: 1 to 2 accepted, not 0.9"),
    ],
)
def test_refuses_what_is_no_medium(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        replace(MEASURED["apple"], **change)  # type: ignore[arg-type]
