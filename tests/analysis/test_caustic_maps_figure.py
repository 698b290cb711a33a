"""The figure of caustics by number of directions."""

import numpy as np
from matplotlib.image import AxesImage

from algorithms.caustics import caustic_map
from algorithms.depth import silhouette_relief
from analysis.figures.caustic_maps import Shape, caustic_maps_figure
from analysis.figures.style import figure_bytes


def test_each_object_has_its_relief_and_a_map_for_each_number_of_directions() -> None:
    row, column = np.mgrid[:60, :40] + 0.5
    mask = ((row - 30) / 25) ** 2 + ((column - 20) / 12) ** 2 < 1
    relief = silhouette_relief(mask)
    figure = caustic_maps_figure({"egg": Shape(relief, mask)}, directions=(1, 12))
    titles = [axes.get_title() for axes in figure.axes]
    assert titles == ["relief", "d = 1", "d = 12"]
    assert figure.axes[0].get_ylabel() == "egg"
    drawn = [child for child in figure.axes[2].get_children() if isinstance(child, AxesImage)]
    expected = caustic_map(relief, mask, 12) ** (1 / 2.2)
    np.testing.assert_allclose(np.asarray(drawn[0].get_array()), expected, atol=1e-5)
    assert figure_bytes(figure, "png").startswith(b"\x89PNG")
