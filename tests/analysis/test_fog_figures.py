"""Figures of fog: what their curves and pictures show."""

import numpy as np

from algorithms.fog import apsf
from analysis.figures.fog_series import Scene, fog_series_figure, presets_of, published_series
from analysis.figures.fog_spread import fog_spread_figure
from analysis.figures.style import figure_bytes


def test_the_spread_is_drawn_by_thickness_and_its_share_falls() -> None:
    curves, shares = fog_spread_figure(thicknesses=(1.2, 2.5)).axes
    angles, values = (np.asarray(each) for each in curves.lines[0].get_data())
    np.testing.assert_allclose(values, apsf(angles, 1.2, 0.75))
    assert len(curves.lines) == 2
    for line in shares.lines[:3]:
        assert (np.diff(np.asarray(line.get_ydata())) < 0).all()


def test_published_parameters_are_named() -> None:
    assert list(published_series()) == [
        "sigma = 0.2, k = 0.2",
        "sigma = 0.44, k = 0.5",
        "sigma = 0.75, k = 0.9",
    ]
    assert list(presets_of("forest")) == ["forest-left", "forest-centre", "forest-right"]


def test_a_series_shows_the_picture_first_and_less_contrast_in_thicker_fog() -> None:
    image = np.random.default_rng(1).uniform(0, 1, (30, 40, 3)).astype(np.float32)
    distance = np.full((30, 40), 7, dtype=np.float32)
    generator = np.random.default_rng(2)
    figure = fog_series_figure({"noise": Scene(image, distance)}, published_series(), generator)
    contrasts = [float(np.std(np.asarray(axes.images[0].get_array()))) for axes in figure.axes]
    assert len(contrasts) == 4
    assert contrasts == sorted(contrasts, reverse=True)
    assert contrasts[3] < 0.7 * contrasts[0]
    again = fog_series_figure(
        {"noise": Scene(image, distance)}, published_series(), np.random.default_rng(2)
    )
    assert figure_bytes(figure, "png") == figure_bytes(again, "png")
