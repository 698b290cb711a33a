"""The objects and the design of the light probes, before anything is rendered."""

from collections import Counter
from itertools import pairwise, product

import numpy as np
import pytest

from stimuli.scenes.probe_lights import TABLE_3_1, TABLE_3_2, light_of_chapter_3
from stimuli.scenes.probe_objects import GLOSS_EXPONENTS, PROBES, SHAPES, TEXTURE_FREQUENCIES
from stimuli.sets.lightprobes import (
    AREA_RADII_DEG,
    AZIMUTHS_DEG,
    DISTANCES,
    ELEVATIONS_DEG,
    RATIOS,
    SEPARATIONS_DEG,
    ProbeImage,
    design,
)
from stimuli.shapes.curvature import bending_energy


def images_of(group: str, seed: int = 1, *, quick: bool = False) -> list[ProbeImage]:
    """Return the images of one group of a design."""
    images = design(np.random.default_rng(seed), quick=quick)
    return [image for image in images if image.group == group]


@pytest.mark.parametrize("shape", SHAPES)
def test_shapes_are_closed_bodies_of_radius_one(shape: str) -> None:
    mesh = SHAPES[shape](np.random.default_rng(1), 8)
    assert mesh.is_closed
    assert mesh.volume > 0
    assert mesh.bounding_radius == pytest.approx(1, abs=0.02)


def test_shapes_o1_to_o4_grow_in_complexity() -> None:
    # Published: Lopez-Moreno 2011, fig. 3.9.
    probes = [PROBES[name] for name in ("O1", "O2", "O3", "O4")]
    energies = [bending_energy(probe.mesh(1, 2)) for probe in probes]
    assert all(first < second for first, second in pairwise(energies))
    assert all(first.complexity < second.complexity for first, second in pairwise(probes))


def test_materials_o5_to_o8_grow_in_frequency() -> None:
    # Published: Lopez-Moreno 2011, fig. 3.9; the shape is the same for all.
    assert list(TEXTURE_FREQUENCIES) == ["O5", "O6", "O7", "O8"]
    steepness = []
    for name in TEXTURE_FREQUENCIES:
        placed = PROBES[name].placed(1, 4)
        assert placed.material.finish == "diffuse"
        steepness.append(np.abs(np.diff(placed.albedo, axis=0)).mean() / placed.albedo.std())
    assert all(1.5 * first < second for first, second in pairwise(steepness))
    assert len({PROBES[name].shape for name in TEXTURE_FREQUENCIES}) == 1


def test_glossy_probes_differ_in_gloss_alone() -> None:
    probes = [PROBES[name] for name in ("gloss-0", *GLOSS_EXPONENTS)]
    assert [round(probe.gloss) for probe in probes] == [0, 10, 40, 160]
    assert len({(p.shape, p.colour, p.material.albedo) for p in probes}) == 1
    assert len(set(probes[0].colour)) > 1  # else nothing tells highlights from the body


def test_size_of_the_set() -> None:
    images = design(np.random.default_rng(1), quick=False)
    assert len(images) <= 150
    assert Counter(image.group for image in images) == {
        "rig": 5,
        "three-lights": 8,
        "area": 4,
        "distance": 7,
        "gloss": 8,
        "texture": 10,
        "single": 48,
        "pair": 36,
        "translucent": 21,
    }
    assert [image.number for image in images] == list(range(len(images)))
    quick = design(np.random.default_rng(1), quick=True)
    assert {image.group for image in quick} == {image.group for image in images}
    assert len(quick) < 50
    assert {image.area_radius_deg for image in quick} >= {0.0, *AREA_RADII_DEG}


def test_rigs_are_those_of_table_3_1() -> None:
    for image, rig in zip(images_of("rig"), TABLE_3_1.values(), strict=True):
        assert image.lights == tuple(light_of_chapter_3(*angles) for angles in rig)
        assert image.ambient > 0  # sec. 3.8.1


def test_three_lights_are_those_of_table_3_2() -> None:
    images = images_of("three-lights")
    assert [image.probe for image in images] == [f"O{number}" for number in range(1, 9)]
    for image in images:
        assert image.lights == tuple(light_of_chapter_3(*angles) for angles in TABLE_3_2)


def test_area_lights_and_distances() -> None:
    # Published: fig. 3.14 has two sizes; six distances.
    assert {image.area_radius_deg for image in images_of("area")} == set(AREA_RADII_DEG)
    lights = [image.lights[0] for image in images_of("distance")]
    assert [light.distance for light in lights] == [*DISTANCES, None]
    # Theory: the inverse-square law from the centre to the nearest point of the unit sphere.
    nearest = [
        light.intensity * (light.distance / (light.distance - 1)) ** 2
        for light in lights
        if light.distance
    ]
    np.testing.assert_allclose(nearest, lights[-1].intensity)


def test_single_lights_meet_every_object_from_all_around() -> None:
    images = images_of("single")
    angles = [(image.lights[0].azimuth_deg, image.lights[0].elevation_deg) for image in images]
    assert Counter(angles) == Counter(product(AZIMUTHS_DEG, ELEVATIONS_DEG))
    for probe in ("O1", "O2", "O3", "O4"):
        of_probe = [image for image in images if image.probe == probe]
        assert {image.lights[0].azimuth_deg for image in of_probe} == set(AZIMUTHS_DEG)
        elevations = Counter(image.lights[0].elevation_deg for image in of_probe)
        assert elevations == dict.fromkeys(ELEVATIONS_DEG, 3)
        assert Counter(image.ambient > 0 for image in of_probe) == {True: 6, False: 6}


def test_pairs_hold_every_separation_and_ratio() -> None:
    images = images_of("pair")
    factors = [image.factors for image in images]
    found = Counter((f["separation_deg"], f["intensity_ratio"]) for f in factors)
    assert found == Counter([*product(SEPARATIONS_DEG, RATIOS)] * 2)
    assert min(SEPARATIONS_DEG) >= 50
    assert max(RATIOS) == 3
    assert Counter(image.probe for image in images) == dict.fromkeys(("O1", "O2", "O3", "O4"), 9)
    for image in images:
        first, second = image.lights
        apart = np.abs(np.angle(np.exp(1j * np.radians(first.azimuth_deg - second.azimuth_deg))))
        assert np.degrees(apart) == pytest.approx(image.factors["separation_deg"])
        assert first.intensity >= second.intensity


def test_factors_have_one_key_for_all() -> None:
    images = design(np.random.default_rng(1), quick=False)
    assert len({tuple(image.factors) for image in images}) == 1
    assert len({image.stimulus().id for image in images}) == len(images)


def test_pairs_are_drawn() -> None:
    assert images_of("pair", 1) == images_of("pair", 1) != images_of("pair", 2)
    assert images_of("single", 1) == images_of("single", 2)
