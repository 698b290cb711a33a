"""Photons: energy, Fresnel's fractions, the focus of a ball lens, reflection, refusals."""

from collections.abc import Sequence
from typing import Any

import mitsuba as mi
import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.errors import InputError, UnavailableError
from algorithms.light import Light
from stimuli.engine import choose_engine
from stimuli.photons.photon_map import EnergyBalance
from stimuli.photons.photon_tracing import PhotonTracer, trace_photons
from stimuli.shapes.mesh import Mesh, to_mitsuba
from tests.stimuli.glass import GLASS, MIRROR, camera, floor, matt, scene, sphere

ABOVE = Light(90, 0)  # +y
OBLIQUE = Light.from_direction((1, 2, 0.5), intensity=3.0)


def fate(balance: EnergyBalance) -> NDArray[np.float64]:
    """Return all that the emitted power may become, `(5, 3)`."""
    causes = ("stored", "missed", "escaped", "absorbed", "bounce_limit")
    return np.array([getattr(balance, cause) for cause in causes])


def generator(seed: int = 1) -> np.random.Generator:
    return np.random.default_rng(seed)


@pytest.mark.usefixtures("llvm")
class TestEnergy:
    def test_what_is_emitted_is_stored_or_lost_for_a_stated_cause(self) -> None:
        # Property: every cause occurs here, and they add up to float precision.
        copper = MIRROR | {"specular_reflectance": {"type": "rgb", "value": [0.9, 0.6, 0.4]}}
        one_sided = {"type": "diffuse"}
        parts = {
            "glass": sphere(GLASS, (0, 0, 0)),
            "metal": sphere(copper, (2.5, 0, 0)),
            "floor": floor(-1.5, half_width=4),
            "shiny": sphere({"type": "roughplastic"}, (-2.5, 0, 0)),
            "lid": floor(1.6, half_width=0.3) | {"bsdf": one_sided},
        }
        lights = [OBLIQUE, Light(30, 20, 2.0, distance=5.0)]
        photons = trace_photons(scene(**parts), 200_000, generator(), lights)
        causes = fate(photons.energy)
        assert (causes[:-1] > 0).all()  # nothing is trapped in spheres
        np.testing.assert_allclose(causes.sum(axis=0), photons.energy.emitted, rtol=1e-6)
        stored = photons.powers.sum(axis=0, dtype=np.float64)
        np.testing.assert_allclose(stored, photons.energy.stored)

    def test_a_clear_ball_absorbs_nothing(self) -> None:
        # Theory: Fresnel's two parts add up to 1.
        lit = scene(ball=sphere(GLASS), floor=floor(-1.5))
        energy = trace_photons(lit, 50_000, generator(), [ABOVE]).energy
        assert (energy.absorbed == 0).all()
        assert (energy.bounce_limit < 1e-4 * energy.emitted).all()

    def test_a_mirror_absorbs_what_it_does_not_reflect(self) -> None:
        # Theory: one reflection at a convex mirror.
        grey = MIRROR | {"specular_reflectance": {"type": "rgb", "value": 0.8}}
        energy = trace_photons(scene(ball=sphere(grey)), 50_000, generator(), [ABOVE]).energy
        met = energy.emitted - energy.missed
        np.testing.assert_allclose(energy.absorbed, 0.2 * met, rtol=1e-4)
        np.testing.assert_allclose(energy.escaped, 0.8 * met, rtol=1e-4)


@pytest.mark.usefixtures("llvm")
class TestEmission:
    def test_a_directional_light_sends_its_irradiance_through_the_disc(self) -> None:
        # Theory: irradiance times the area of the sphere's shadow.
        energy = trace_photons(scene(ball=sphere(GLASS)), 20_000, generator(), [OBLIQUE]).energy
        np.testing.assert_allclose(energy.emitted, 3 * np.pi, rtol=1e-4)

    @pytest.mark.parametrize("distance", [1.5, 4.0, 1000.0])
    def test_a_point_light_fills_the_solid_angle_of_the_sphere(self, distance: float) -> None:
        # Theory: radiant intensity E d^2 times 2 pi (1 - cos), and near the plane wave far away.
        light = Light(30, 40, 2.0, distance)
        energy = trace_photons(scene(ball=sphere(GLASS)), 20_000, generator(), [light]).energy
        solid_angle = 2 * np.pi * (1 - np.sqrt(1 - 1 / distance**2))
        np.testing.assert_allclose(energy.emitted, 2 * distance**2 * solid_angle, rtol=1e-4)

    def test_an_area_light_sends_what_form_factors_say(self) -> None:
        # Theory: a distant small disc of radiance L sends L A cos / d^2 through each unit of area.
        transform: Any = mi.ScalarTransform4f
        place = transform().look_at([30, 40, 0], [0, 0, 0], [0, 1, 0]).scale(0.5)
        emitter = {"type": "area", "radiance": {"type": "rgb", "value": 7.0}}
        lamp = {"type": "disk", "to_world": place, "emitter": emitter}
        energy = trace_photons(scene(ball=sphere(GLASS), lamp=lamp), 20_000, generator()).energy
        np.testing.assert_allclose(energy.emitted, 7 * np.pi * 0.5**2 / 50**2 * np.pi, rtol=2e-3)

    def test_objects_in_each_others_shadow_are_not_lit_twice(self) -> None:
        # Theory: the union of two unit discs whose centres are 1 apart.
        pair = scene(one=sphere(GLASS, (0, 0, 0)), two=sphere(GLASS, (1, -3, 0)))
        energy = trace_photons(pair, 200_000, generator(), [ABOVE]).energy
        lens = 2 * np.arccos(0.5) - np.sqrt(3) / 2
        np.testing.assert_allclose(energy.emitted, 2 * np.pi - lens, rtol=1e-3)

    def test_emitters_of_the_scene_send_what_the_same_lights_send(self) -> None:
        # Two ways to the same: the scene's own emitters, and our lights.
        light = Light(60, 10, 2.0, 3.0)
        at = light.direction * 3.0
        power = {"type": "rgb", "value": 2.0 * 9.0}
        point = {"type": "point", "position": at.tolist(), "intensity": power}
        ways = {
            "directional": (OBLIQUE, _directional(OBLIQUE)),
            "point": (light, point),
        }
        for ours, theirs in ways.values():
            parts = {"ball": sphere(GLASS), "floor": floor(-1.5)}
            one = trace_photons(scene(**parts), 10_000, generator(), [ours])
            other = trace_photons(scene(**parts, light=theirs), 10_000, generator())
            np.testing.assert_allclose(one.positions, other.positions, atol=1e-3)
            np.testing.assert_allclose(one.energy.stored, other.energy.stored, rtol=1e-5)


@pytest.mark.usefixtures("llvm")
@pytest.mark.parametrize("incidence_deg", [0.0, 45.0])
def test_a_slab_transmits_the_fresnel_fraction(incidence_deg: float) -> None:
    # Theory: with all reflections to and fro, (1 - R) / (1 + R) (Hecht, Optics, sec. 9.6, without
    # interference); R is the mean of both polarisations, as Mitsuba's dielectric takes it.
    transform: Any = mi.ScalarTransform4f
    slab = {"type": "cube", "to_world": transform().scale([4, 0.1, 4]), "bsdf": GLASS}
    light = Light(90 - incidence_deg, 0)
    photons = trace_photons(scene(slab=slab, floor=floor(-1)), 1_000_000, generator(), [light])
    # Under the middle of the slab, far from what its edges do.
    middle = np.abs(photons.positions[:, [0, 2]] + [np.tan(np.radians(incidence_deg)), 0]) < 1.5
    power = photons.powers[middle.all(axis=1), 0].sum(dtype=np.float64)
    incident = 3.0**2 * np.cos(np.radians(incidence_deg))
    reflectance = _fresnel(incidence_deg, 1.5)
    assert power / incident == pytest.approx((1 - reflectance) / (1 + reflectance), abs=1e-3)


@pytest.mark.usefixtures("llvm")
def test_a_ball_focuses_where_the_lens_formula_says() -> None:
    # Theory: behind a ball lens the back focal distance is R (2 - n) / (2 (n - 1)) = R / 2 for
    # n = 1.5, for rays near the axis: a screen with a small hole lets no others pass. Before and
    # behind it the spot's size grows linearly, and the lines cross zero at the focus.
    sizes = {gap: _spot_radius(gap) for gap in (0.3, 0.4, 0.6, 0.7)}
    for near, far in ((0.3, 0.4), (0.7, 0.6)):
        slope = (sizes[far] - sizes[near]) / (far - near)
        assert near - sizes[near] / slope == pytest.approx(0.5, abs=0.005)
    hole = 0.05
    # The rays converge from the hole over the effective focal length n R / (2 (n - 1)) = 1.5 R.
    assert sizes[0.4] == pytest.approx(0.1 * hole / 1.5 * np.sqrt(0.5), rel=0.03)


@pytest.mark.usefixtures("llvm")
def test_a_plane_mirror_throws_a_copy_of_itself() -> None:
    # Theory: the law of reflection. The mirror lies in y = 0, -1..1; the light comes from the right
    # at 45 degrees, so that its image on the wall x = -3 reaches from y = 2 to y = 4.
    transform: Any = mi.ScalarTransform4f
    flat = transform().rotate([1, 0, 0], -90)
    grey = MIRROR | {"specular_reflectance": {"type": "rgb", "value": 0.7}}
    mirror = {"type": "rectangle", "to_world": flat, "bsdf": grey}
    upright = transform().translate([-3, 0, 0]).rotate([0, 1, 0], 90).scale(8)
    wall = {"type": "rectangle", "to_world": upright, "bsdf": matt()}
    lit = scene(mirror=mirror, wall=wall)
    photons = trace_photons(lit, 100_000, generator(), [Light(45, 0, 2.0)])
    _, y, z = photons.positions.T
    np.testing.assert_allclose([y.min(), y.max()], [2, 4], atol=0.01)
    np.testing.assert_allclose([z.min(), z.max()], [-1, 1], atol=0.01)
    incident = 2.0 * 4 * np.cos(np.radians(45))
    np.testing.assert_allclose(photons.energy.stored, 0.7 * incident, rtol=1e-2)


@pytest.mark.usefixtures("llvm")
def test_only_light_that_has_met_glass_is_stored() -> None:
    # Property: seen from the light the ball hides the floor's middle, and only the ball is aimed
    # at; a lid over it leaves nothing.
    parts = {"ball": sphere(GLASS), "floor": floor(-1.5)}
    assert len(trace_photons(scene(**parts), 10_000, generator(), [ABOVE])) > 8000
    covered = trace_photons(scene(**parts, lid=floor(2)), 10_000, generator(), [ABOVE])
    assert len(covered) == 0
    np.testing.assert_allclose(covered.energy.missed, covered.energy.emitted, rtol=1e-6)


@pytest.mark.usefixtures("llvm")
def test_same_seed_same_photons() -> None:
    # Property.
    lit = scene(ball=sphere(GLASS), cube={"type": "cube", "bsdf": MIRROR}, floor=floor(-1.5))
    first, again, other = (
        trace_photons(lit, 50_000, generator(seed), [ABOVE, OBLIQUE]) for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first.positions, again.positions)
    np.testing.assert_array_equal(first.powers, again.powers)
    assert first.positions[:100].tolist() != other.positions[:100].tolist()


def _open_box() -> Mesh:
    corners = np.array(np.meshgrid([-1.0, 1.0], [-1.0, 1.0], [-1.0, 1.0])).reshape(3, -1).T
    faces = np.array([[0, 1, 2], [1, 3, 2]])
    return Mesh(corners, corners / np.sqrt(3), None, faces)


@pytest.mark.usefixtures("llvm")
@pytest.mark.parametrize(
    ("parts", "lights", "message"),
    [
        ({"ball": sphere(GLASS)}, [], "lights: none that casts caustics"),
        ({"ball": sphere(GLASS)}, [Light(0, 0, 0.0)], "lights: none that casts caustics"),
        ({"ball": sphere(matt())}, [ABOVE], "scene: no specular object"),
        ({"tube": {"type": "cylinder", "bsdf": GLASS}}, [ABOVE], "tube: glass is accepted as a"),
        ({"ball": sphere(GLASS), "spot": {"type": "spot"}}, None, "lights: emitter 'spot' is a"),
        ({"ball": sphere(GLASS, (np.inf, 0, 0))}, [ABOVE], "ball: its geometry is not finite"),
    ],
)
def test_what_casts_no_caustics_is_refused_in_one_line(
    parts: dict[str, Any], lights: Sequence[Light] | None, message: str
) -> None:
    with pytest.raises(InputError, match=message) as refusal:
        PhotonTracer(scene(**parts), lights)
    assert "\n" not in str(refusal.value)


@pytest.mark.usefixtures("llvm")
def test_open_glass_is_refused_and_an_open_mirror_is_not() -> None:
    def tracer(bsdf: dict[str, Any]) -> PhotonTracer:
        return PhotonTracer(scene(box=to_mitsuba(_open_box(), bsdf, "box")), [ABOVE])

    tracer(MIRROR)
    with pytest.raises(InputError, match=r"box \(glass\): a closed surface"):
        tracer(GLASS)


@pytest.mark.usefixtures("llvm")
def test_a_mesh_that_is_not_finite_is_refused() -> None:
    mesh = _open_box()
    mesh.vertices[0, 0] = np.nan
    broken = scene(box=to_mitsuba(mesh, MIRROR, "box"), ball=sphere(GLASS))
    with pytest.raises(InputError, match="not finite"):
        PhotonTracer(broken, [ABOVE])


@pytest.mark.usefixtures("llvm")
def test_no_photons_are_refused() -> None:
    with pytest.raises(InputError, match="count: 0 given"):
        trace_photons(scene(ball=sphere(GLASS)), 0, generator(), [ABOVE])


def test_the_scalar_engine_is_told_what_to_install() -> None:
    choose_engine("scalar")
    with pytest.raises(UnavailableError, match="apt install libllvm"):
        PhotonTracer(scene(ball=sphere(GLASS), eye=camera((0, 0, 5), (0, 0, 0))), [ABOVE])


def _fresnel(incidence_deg: float, index: float) -> float:
    """Return the reflectance of unpolarised light."""
    incident = np.cos(np.radians(incidence_deg))
    refracted = np.sqrt(1 - (1 - incident**2) / index**2)
    parallel = (index * incident - refracted) / (index * incident + refracted)
    perpendicular = (incident - index * refracted) / (incident + index * refracted)
    return float((parallel**2 + perpendicular**2) / 2)


def _spot_radius(gap: float) -> float:
    """Return the median distance from the axis on a screen behind a unit ball."""
    angles = np.linspace(0, 2 * np.pi, 65)[:-1]
    circle = np.stack([np.cos(angles), np.zeros_like(angles), np.sin(angles)], axis=-1)
    vertices = np.concatenate([0.05 * circle, 4 * circle]) + np.array([0, 1.5, 0])
    inner = np.arange(64)
    following = (inner + 1) % 64
    faces = np.concatenate(
        [
            np.stack([inner, following, inner + 64], axis=1),
            np.stack([following, following + 64, inner + 64], axis=1),
        ]
    )
    ring = Mesh(vertices, np.tile([0.0, 1.0, 0.0], (128, 1)), None, faces)
    lit = scene(
        ball=sphere(GLASS), screen=to_mitsuba(ring, matt(), "screen"), floor=floor(-1 - gap)
    )
    photons = trace_photons(lit, 1_000_000, generator(), [ABOVE])
    assert len(photons) > 1000
    return float(np.median(np.hypot(photons.positions[:, 0], photons.positions[:, 2])))


def _directional(light: Light) -> dict[str, Any]:
    irradiance = {"type": "rgb", "value": light.intensity}
    direction = (-light.direction).tolist()
    return {"type": "directional", "direction": direction, "irradiance": irradiance}
