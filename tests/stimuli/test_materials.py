import numpy as np
import pytest
from numpy.testing import assert_allclose

from stimuli.light_linking.materials import TABLE_2_1, Material, exponent_of, roughness_of, squares
from stimuli.shapes.displaced_spheres import sphere_directions

POINTS = sphere_directions(64, 128)


def albedo_of(letter: str, seed: int = 1) -> np.ndarray:
    """Return the albedo over longitude and latitude."""
    return TABLE_2_1[letter].albedo_at(POINTS, np.random.default_rng(seed))


def test_finishes_and_patterns_of_table_2_1() -> None:
    # Published: Lopez-Moreno 2011, table 2.1.
    assert {letter: (m.finish, m.pattern) for letter, m in TABLE_2_1.items()} == {
        "a": ("diffuse", "plain"),
        "b": ("diffuse", "perlin"),
        "c": ("diffuse", "plain"),
        "d": ("shiny", "checkerboard"),
        "e": ("shiny", "checkerboard"),
        "f": ("diffuse", "plain"),
        "g": ("shiny", "perlin"),
        "h": ("shiny", "plain"),
    }
    assert TABLE_2_1["b"].frequency > TABLE_2_1["g"].frequency  # P(h) and P(l)


@pytest.mark.parametrize("letter", TABLE_2_1)
def test_albedo_is_physical_and_spans_its_range(letter: str) -> None:
    low, high = TABLE_2_1[letter].albedo
    albedo = albedo_of(letter)
    assert 0 < low <= albedo.min()
    assert albedo.max() <= high < 1
    assert np.ptp(albedo) >= 0.7 * (high - low)


@pytest.mark.parametrize("letter", TABLE_2_1)
def test_albedo_has_no_seam(letter: str) -> None:
    # Property: the first and the last column of a solid texture show the same points.
    albedo = albedo_of(letter)
    assert (albedo[:, 0] == albedo[:, -1]).all()
    assert_allclose(albedo[[0, -1]], albedo[[0, -1], :1].repeat(albedo.shape[1], axis=1))


def test_checkerboard_has_two_tones_in_equal_parts() -> None:
    albedo = albedo_of("d")
    assert set(np.unique(albedo)) == set(TABLE_2_1["d"].albedo)
    # Rows near the poles are shorter.
    area = np.linalg.norm(POINTS[..., [0, 2]], axis=-1)
    assert_allclose(np.average(albedo == albedo.max(), weights=area), 0.5, atol=0.1)


@pytest.mark.parametrize("frequency", [2.6, 5.2])
def test_neighbouring_tiles_differ(frequency: float) -> None:
    # Definition: a step of a tile's width along the texture's own axis changes the tone.
    board = Material("diffuse", "checkerboard", (0.0, 1.0), frequency)
    line = np.linspace(0, 4, 4001)
    tones = [
        board.albedo_at(line[:, None] * axis, np.random.default_rng(1))
        for axis in np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0].T
    ]
    for tone in tones:
        borders = line[1:][np.diff(tone) != 0]
        assert len(borders) > 5
        assert_allclose(np.diff(borders), 1 / frequency, atol=0.003)


def test_halved_shininess() -> None:
    # Theory: Walter et al. 2007, the roughness that goes with a Blinn-Phong exponent.
    assert exponent_of(0.16) == pytest.approx(76.125)
    assert exponent_of(roughness_of(40)) == pytest.approx(40)


def test_high_frequency_noise_is_finer_than_low() -> None:
    # Property: per unit of contrast, the finer texture is steeper.
    steepness = {}
    for letter in "bg":
        albedo = albedo_of(letter)
        steepness[letter] = np.abs(np.diff(albedo, axis=0)).mean() / albedo.std()
    assert steepness["b"] > 2 * steepness["g"]


def test_objects_of_one_material_do_not_share_a_texture() -> None:
    for letter in "bdg":
        first, second = albedo_of(letter, seed=1), albedo_of(letter, seed=2)
        assert abs(np.corrcoef(first.ravel(), second.ravel())[0, 1]) < 0.5
        assert (albedo_of(letter, seed=1) == first).all()


@pytest.mark.parametrize("tiles", [2, 8])
def test_squares_are_equally_wide_and_alternate(tiles: int) -> None:
    # Definition: from edge to edge of a face, through its centre or beside it, so many tiles of
    # equal angle, and each differs from the next.
    angle_deg = np.linspace(-45, 45, 9001)[1:-1]
    for beside in (0.05, 0.4):
        line = np.stack(
            [
                np.tan(np.radians(angle_deg)),
                np.full(angle_deg.shape, beside),
                np.ones(len(angle_deg)),
            ],
            axis=-1,
        )
        for turned in (line, -line, line[:, [2, 0, 1]], line[:, [1, 2, 0]]):
            borders = angle_deg[1:][np.diff(squares(turned, tiles)) != 0]
            assert_allclose(borders, np.arange(1, tiles) * 90 / tiles - 45, atol=0.02)


def test_squares_alternate_across_eight_of_the_twelve_edges() -> None:
    # Theory: three tiles meet at each corner, so that some neighbours must be alike.
    differ = 0
    for axis in range(3):
        for signs in np.ndindex(2, 2):
            edge = np.full((2, 3), 0.1)
            others = [other for other in range(3) if other != axis]
            edge[:, others] = 1 - 2 * np.array(signs)
            edge[[0, 1], others] *= 1.001
            first, second = squares(edge, 4)
            differ += first != second
    assert differ == 8


def test_squares_come_in_two_tones_of_equal_area() -> None:
    area = np.linalg.norm(POINTS[..., [0, 2]], axis=-1)
    material = Material("diffuse", "squares", (0.0, 1.0), frequency=8 / (np.pi / 2))
    albedo = material.albedo_at(POINTS, np.random.default_rng(1))
    assert set(np.unique(albedo)) == {0, 1}
    assert_allclose(np.average(albedo, weights=area), 0.5, atol=0.02)
