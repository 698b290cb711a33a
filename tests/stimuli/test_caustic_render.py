"""Pictures of caustics against Mitsuba's tracers, and progressive photon mapping against theory."""

from typing import Any

import mitsuba as mi
import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.light import Light
from stimuli.photons.caustic_free_integrator import caustic_free_integrator
from stimuli.photons.caustic_render import CausticRenderer, render_caustics
from stimuli.photons.photon_tracing import PhotonTracer
from stimuli.shapes.mesh import Mesh, to_mitsuba
from tests.stimuli.glass import GLASS, MIRROR, camera, floor, matt, scene, sphere

Scene = Any  # its type depends on the variant
Picture = NDArray[np.float64]

ABOVE = Light(90, 0)
POINT = {"type": "point", "position": [-2, 5, -1], "intensity": {"type": "rgb", "value": 40.0}}

pytestmark = pytest.mark.usefixtures("llvm")


def pictures(lit: Scene, integrator: dict[str, Any] | Scene, spp: int, count: int = 8) -> Picture:
    """Return independent renders by Mitsuba, their mean over channels: `(count, height, width)`."""
    loaded = mi.load_dict(integrator) if isinstance(integrator, dict) else integrator
    renders = [mi.render(lit, integrator=loaded, spp=spp, seed=seed) for seed in range(count)]
    return np.asarray(np.array(renders, np.float64)[..., :3].mean(axis=-1))


def caustics(lit: Scene, count: int = 4, **options: Any) -> Picture:  # noqa: ANN401
    """Return independent pictures of caustics."""
    arguments = {"photons_per_pass": 200_000, "eye_samples": 16, **options}
    renderer = CausticRenderer(PhotonTracer(lit), lit.sensors()[0], **arguments)
    found = [render_caustics(renderer, passes=2, seed=seed).radiance for seed in range(count)]
    return np.asarray(np.array(found, np.float64).mean(axis=-1))


def z_scores(ours: list[Picture], theirs: list[Picture], block: int = 8) -> Picture:
    """Return by how many standard errors sums of pictures differ, for blocks of pixels."""
    difference, variance = np.zeros(()), np.zeros(())
    for sign, part in [(1, each) for each in ours] + [(-1, each) for each in theirs]:
        count, height, width = part.shape
        blocks = part.reshape(count, height // block, block, width // block, block)
        means = blocks.mean(axis=(2, 4))
        difference = difference + sign * means.mean(axis=0)
        variance = variance + means.var(axis=0, ddof=1) / count
    return np.asarray(difference / np.sqrt(variance + 1e-12))


def assert_within_noise(scores: Picture) -> None:
    """Check that scores are as of Student's distribution with some ten degrees of freedom."""
    assert np.abs(scores).max() < 5
    assert np.sqrt((scores**2).mean()) < 1.5
    assert abs(scores.mean()) < 4 / np.sqrt(scores.size)


def bowl(mirror: dict[str, Any]) -> Scene:
    """Return a small mirror ball in a matt hemisphere, seen and lit from above."""
    polar, longitude = np.meshgrid(
        np.linspace(np.pi, np.pi / 2, 33), np.linspace(0, 2 * np.pi, 65), indexing="ij"
    )
    direction = np.stack(
        [
            np.sin(polar) * np.cos(longitude),
            np.cos(polar),
            np.sin(polar) * np.sin(longitude),
        ],
        axis=-1,
    )
    index = np.arange(33 * 65).reshape(33, 65)
    corners = (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1])
    faces = np.concatenate(
        [np.stack([corners[0], corners[i + 1], corners[i + 2]], -1).reshape(-1, 3) for i in (0, 1)]
    )
    vertices = 2 * direction.reshape(-1, 3)
    mesh = Mesh(vertices, -direction.reshape(-1, 3), None, faces)
    light = POINT | {"position": [0.5, 3, 0.3]}
    eye = camera((0, 6, 3), (0, -1, 0), size=(48, 48), field_of_view_deg=36)
    ball = sphere(mirror, (0.3, -0.9, 0), 0.5)
    return scene(bowl=to_mitsuba(mesh, matt(0.6), "bowl"), ball=ball, light=light, eye=eye)


class TestAgainstMitsuba:
    @pytest.mark.parametrize("finish", ["matt", "glossy"])
    def test_path_plus_caustics_is_what_light_tracing_finds(self, finish: str) -> None:
        # Another implementation: `ptracer` finds every path but those seen through glass, where it
        # is black; the floor is dark, for what light does after a caustic is left out of ours.
        eye = camera((0, 4, 6), (0.3, 0, 0), field_of_view_deg=36)
        ground = floor(0, albedo=0.05)
        if finish == "glossy":
            black = {"type": "rgb", "value": 0.02}
            ground["bsdf"] = {"type": "roughplastic", "alpha": 0.4, "diffuse_reflectance": black}
        lit = scene(ball=sphere(GLASS, (0, 1.01, 0)), floor=ground, light=POINT, eye=eye)
        base = pictures(lit, {"type": "path", "max_depth": 12}, 128)
        traced = pictures(lit, {"type": "ptracer", "max_depth": 12}, 256)
        found = caustics(lit, radius=0.03)
        outside = ~_behind(lit, "ball")
        scores = z_scores([base * outside, found * outside], [traced * outside])
        assert_within_noise(scores)
        share = (found.mean(axis=0) * outside).sum() / (traced.mean(axis=0) * outside).sum()
        assert share > 0.1  # else there would be nothing to test

    @pytest.mark.parametrize("project", [True, False])
    def test_receivers_need_not_be_planes(self, project: bool) -> None:
        # Another implementation, and the same paths in both: with three edges a path holds at most
        # one mirror and one matt surface, or two matt ones, which `path` finds.
        lit = bowl(MIRROR)
        base = pictures(lit, {"type": "path", "max_depth": 3}, 128)
        traced = pictures(lit, {"type": "ptracer", "max_depth": 3}, 256)
        found = caustics(lit, radius=0.06, project=project)
        outside = ~_behind(lit, "ball")
        assert_within_noise(z_scores([base * outside, found * outside], [traced * outside]))
        assert (found.mean(axis=0) * outside).mean() > 0.02 * traced.mean()

    def test_caustics_of_area_lights_are_not_counted_twice(self) -> None:
        # Another implementation, seen through the glass too: `path` finds an area light's caustics
        # by chance, the caustic-free integrator leaves them out, and photons bring them back.
        radiance = {"type": "rgb", "value": 20.0}
        lamp = sphere(matt(0), (-4, 5, -1), 1.2) | {
            "emitter": {"type": "area", "radiance": radiance}
        }
        eye = camera((0, 4, 6), (0, 0.5, 0), size=(48, 48), field_of_view_deg=36)
        lit = scene(
            ball=sphere(GLASS, (0, 1.01, 0)),
            floor=floor(0, albedo=0.1),
            lamp=lamp,
            sky={"type": "constant", "radiance": 0.2},
            eye=eye,
        )
        whole = pictures(lit, {"type": "path", "max_depth": 16, "rr_depth": 99}, 512)
        base = pictures(lit, caustic_free_integrator(), 128)
        found = caustics(lit, radius=0.08)
        assert_within_noise(z_scores([base, found], [whole]))
        assert found.mean() > 0.02 * whole.mean()
        through_the_ball = found.mean(axis=0)[_behind(lit, "ball")]
        assert through_the_ball.mean() > 0.2 * found.mean()


def test_a_mirror_shows_the_mirrored_picture() -> None:
    # Theory: the law of reflection, for eyes. The mirror x = 3 runs along the light, so that it
    # casts no caustics itself; the eye at x = -1 sees in it what an eye at x = 7 would.
    transform: Any = mi.ScalarTransform4f
    turned = transform().translate([3, 0, 0]).rotate([0, 1, 0], -90).scale(4)
    mirror = {"type": "rectangle", "to_world": turned, "bsdf": {"type": "twosided", "b": MIRROR}}
    parts = {"ball": sphere(GLASS, (0, 1.3, 0)), "floor": floor(0)}
    in_mirror = scene(**parts, mirror=mirror, eye=camera((-0.5, 3, 6), (3, 1, 2)))
    directly = scene(**parts, eye=camera((6.5, 3, 6), (3, 1, 2)))
    seen = [
        render_caustics(
            CausticRenderer(
                PhotonTracer(lit, [ABOVE]),
                lit.sensors()[0],
                photons_per_pass=500_000,
                radius=0.2,
                eye_samples=16,
                project=False,
            ),
            passes=2,
            seed=0,
        ).radiance.mean(axis=-1)
        for lit in (in_mirror, directly)
    ]
    # Not through the ball, where both are noisy.
    outside = ~_behind(directly, "ball")
    mirrored, expected = seen[0], (seen[1] * outside)[:, ::-1]
    assert expected.max() > 1
    blocks = [
        each.reshape(12, 4, 16, 4).mean(axis=(1, 3))
        for each in (mirrored * outside[:, ::-1], expected)
    ]
    np.testing.assert_allclose(blocks[0], blocks[1], rtol=0.1, atol=0.01 * blocks[1].max())


class TestProgress:
    def test_the_radius_shrinks_as_printed(self) -> None:
        # Published: r_(i+1)^2 = r_i^2 (i + alpha) / (i + 1) for i = 1, 2, ... (Knaus and Zwicker
        # 2011, eq. 20).
        renderer = _over_the_floor(radius=0.5)
        radii = np.array([renderer.pass_radius(number) for number in range(50)])
        number = np.arange(1, 50)
        assert radii[0] == pytest.approx(0.5)
        np.testing.assert_allclose(
            radii[1:] ** 2, radii[:-1] ** 2 * (number + 2 / 3) / (number + 1), rtol=1e-12
        )

    def test_variance_falls_at_the_rate_of_theory(self) -> None:
        # Theory: the variance of the mean of n passes falls as n^(-alpha) (Knaus and Zwicker 2011,
        # eq. 15), with alpha = 2/3. Few photons a pass, lest the points' evenness lower it further.
        renderer = _over_the_floor(radius=0.15, photons=2000, size=(24, 24))
        counts = np.array([2, 4, 8, 16, 32])
        runs = []
        for seed in range(6):
            passes = np.array([renderer.render_pass(i, seed)[0][..., 0] for i in range(32)])
            runs.append(np.cumsum(passes, axis=0)[counts - 1] / counts[:, None, None])
        variance = np.var(runs, axis=0, ddof=1).mean(axis=(1, 2))
        slope = np.polyfit(np.log(counts), np.log(variance), 1)[0]
        assert slope == pytest.approx(-2 / 3, abs=0.1)

    def test_bias_falls_with_the_radius(self) -> None:
        # Theory: the bias is proportional to the squared radius (Knaus and Zwicker 2011, eq. 11):
        # at a caustic's rim a quarter of it is left when the radius is halved.
        sharp, half, blurred = (
            _over_the_floor(radius=radius, photons=400_000).render_pass(0, 0)[0][..., 0]
            for radius in (0.02, 0.1, 0.2)
        )
        errors = [
            np.abs(each - sharp)[sharp > 0.02 * sharp.max()].mean() for each in (half, blurred)
        ]
        assert 0.15 < errors[0] / errors[1] < 0.4

    def test_halves_tell_the_noise(self) -> None:
        # Recovery: the estimated noise is that among independent pictures.
        renderer = _over_the_floor(radius=0.1, photons=5000)
        found = [render_caustics(renderer, passes=4, seed=seed) for seed in range(8)]
        true = np.std([each.radiance for each in found], axis=0, ddof=1)
        estimated = [(each.halves[0] - each.halves[1]) / 2 for each in found]
        ratio = np.sqrt(np.mean(np.square(estimated)) / np.mean(true**2))
        assert 0.8 < ratio < 1.3  # halves differ a little in radius

    def test_same_seed_same_picture(self) -> None:
        # Property.
        first, again, other = (
            render_caustics(_over_the_floor(radius=0.1), passes=2, seed=seed).radiance
            for seed in (3, 3, 4)
        )
        np.testing.assert_array_equal(first, again)
        assert (first != other).any()


@pytest.mark.parametrize(
    "crop", [{}, {"crop_offset_x": 8, "crop_offset_y": 4, "crop_width": 40, "crop_height": 40}]
)
def test_projecting_photons_is_gathering_them_in_pixels(crop: dict[str, int]) -> None:
    # Two ways to the same, seen at a slant and in part behind the ball.
    eye = camera((0, 2, 5), (0.5, 0.3, 0))
    eye["film"] |= crop
    lit = scene(ball=sphere(GLASS, (0, 1.01, 0)), floor=floor(0), light=POINT, eye=eye)
    projected, gathered = (
        caustics(lit, count=1, radius=0.02, photons_per_pass=500_000, project=project)[0]
        for project in (True, False)
    )
    width = projected.shape[1]
    assert width == crop.get("crop_width", 64)
    blocks = [
        each[:40].reshape(10, 4, width // 4, 4).mean(axis=(1, 3)) for each in (projected, gathered)
    ]
    assert blocks[0].max() > 1
    np.testing.assert_allclose(blocks[0], blocks[1], rtol=0.1, atol=0.02 * blocks[0].max())


def test_caustics_of_one_scene_seen_in_another() -> None:
    # Property: with the ball gone from sight its caustic is still on the floor.
    parts = {"floor": floor(0), "eye": camera((0, 6, 0.1), (0, 0, 0))}
    real = scene(**parts, ball=sphere(GLASS, (0, 1.01, 0)))
    tracer = PhotonTracer(real, [ABOVE])
    empty = scene(**parts)
    options: dict[str, Any] = {"photons_per_pass": 100_000, "radius": 0.05}
    without = CausticRenderer(tracer, real.sensors()[0], seen=empty, **options)
    image = render_caustics(without, passes=2, seed=0).radiance[..., 0]
    assert image[24, 32] > 10 * np.median(image)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"photons_per_pass": 0}, "photons_per_pass, eye_samples: 1 or more"),
        ({"photons_per_pass": 1, "eye_samples": 0}, "photons_per_pass, eye_samples: 1 or more"),
        ({"photons_per_pass": 1, "radius": -1.0}, "radius: -1.0 given"),
    ],
)
def test_numbers_out_of_range_are_refused(options: dict[str, Any], message: str) -> None:
    lit = scene(ball=sphere(GLASS), floor=floor(-2), eye=camera((0, 4, 6), (0, 0, 0)))
    with pytest.raises(InputError, match=message):
        CausticRenderer(PhotonTracer(lit, [ABOVE]), lit.sensors()[0], **options)


def test_a_view_without_receivers_is_refused() -> None:
    lit = scene(ball=sphere(GLASS), eye=camera((0, 0, 6), (0, 0, 0)))
    with pytest.raises(InputError, match="no matt surface"):
        CausticRenderer(PhotonTracer(lit, [ABOVE]), lit.sensors()[0], photons_per_pass=1)


def test_one_pass_is_refused() -> None:
    with pytest.raises(InputError, match="passes: 1 given"):
        render_caustics(_over_the_floor(radius=0.1), passes=1, seed=0)


def _over_the_floor(
    radius: float, photons: int = 20_000, size: tuple[int, int] = (32, 32)
) -> CausticRenderer:
    """Return a renderer of a ball's caustic on a floor, looked at from under the ball."""
    lit = scene(
        ball=sphere(GLASS, (0, 2, 0)),
        floor=floor(0),
        eye=camera((0.1, 0.9, 0.0), (0, 0, 0), size=size, field_of_view_deg=70),
    )
    tracer = PhotonTracer(lit, [ABOVE])
    return CausticRenderer(
        tracer,
        lit.sensors()[0],
        photons_per_pass=photons,
        radius=radius,
        eye_samples=4,
        project=False,
    )


def _behind(lit: Scene, name: str) -> NDArray[np.bool_]:
    """Return the pixels that a shape touches."""
    shapes = {shape.id(): shape for shape in lit.shapes()}
    alone = mi.load_dict({"type": "scene", name: shapes[name]})
    depth = mi.load_dict({"type": "depth"})
    sensor = lit.sensors()[0]
    rendered = np.array(mi.render(alone, sensor=sensor, integrator=depth, spp=64))
    touched: NDArray[np.bool_] = rendered[..., 0] > 0
    return touched
