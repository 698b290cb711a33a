"""Speed and accuracy of translucent objects by the dipole, as JSON.

    python -m benchmarks.dipole [--engine llvm] [--output FILE]

The limits are those of the project on two processor cores: 640 x 480 with 50,000 irradiance points
in three seconds, and the hierarchical sum within 1 % of the plain one. That error is relative to
the plain sum or, where this is darker, to the darkest grey but black that a display shows (1/255
encoded, 1/3295 of the brightest point in linear light): below it nothing can be seen.

The dipole itself is compared with Mitsuba's volumetric path tracer, which knows no diffusion.
"""

import argparse
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, Final

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.light import Light
from benchmarks.results import machine, write_result
from stimuli.camera import View
from stimuli.engine import choose_engine
from stimuli.making import current_versions
from stimuli.shapes.displaced_spheres import AbstractShape
from stimuli.shapes.mesh import to_mitsuba
from stimuli.translucency.dipole import Dipole
from stimuli.translucency.hierarchical_sum import TOLERANCE, HierarchicalSum
from stimuli.translucency.irradiance import entering_irradiance
from stimuli.translucency.media import MEASURED, Medium
from stimuli.translucency.renderer import Translucent, TranslucentRenderer, exitance_sum
from stimuli.translucency.surface_pieces import cut_surface
from tests.stimuli.bodies import UnitSphere
from tests.stimuli.volumetric_path_tracer import slab_reflectance, sphere_radiance

LIMITS: Final = {"seconds": 3.0, "largest_error": 0.01}
VIEW: Final = View(width_px=640, height_px=480, radius_px=225, samples=1)
POINTS: Final = 50_000
RADIUS_MM: Final = 20.0
REPETITIONS: Final = 5
PLACES: Final = 2000
DARKEST_SHOWN: Final = 1 / 3295
LIGHTS: Final = {
    "front": Light(30, 50, np.pi),
    "side": Light(0, 0, np.pi),
    "back": Light(60, -60, np.pi),
}
TIMED_MEDIA: Final = ("marble", "skin1", "wholemilk", "ketchup")
SLAB_SAMPLES: Final = 50_000


def took(work: Callable[[], object]) -> dict[str, float]:
    """Time some work, the median of several times, after a first time that compiles."""
    work()
    times = []
    for _ in range(REPETITIONS):
        started = time.perf_counter(), time.process_time()
        work()
        times.append((time.perf_counter() - started[0], time.process_time() - started[1]))
    seconds, processor_seconds = np.median(times, axis=0).tolist()
    return {"seconds": seconds, "processor_seconds": processor_seconds}


def body_of(medium: Medium) -> Translucent:
    """Return an abstract object, 40 mm across, of fewer faces than irradiance points."""
    mesh = AbstractShape(np.random.default_rng(1)).mesh(64, 128)
    return Translucent(mesh, medium, RADIUS_MM)


def speed() -> dict[str, Any]:
    """Time whole pictures: cutting, irradiance, octree and rendering."""
    result: dict[str, Any] = {}
    for name in TIMED_MEDIA:
        renderer = TranslucentRenderer(body_of(MEASURED[name]), POINTS)
        result[name] = {
            f"{samples}_samples_a_pixel": took(
                partial(renderer.radiance, VIEW, [LIGHTS["front"]], samples=samples)
            )
            for samples in (1, 4)
        }
    return result


def sums_at(total: HierarchicalSum, places: Any, tolerance: float) -> NDArray[np.float64]:  # noqa: ANN401
    """Return the sums at places by channel `(n, 3)`."""
    return np.array(total(places, mi.Bool(True), dr.opaque(mi.Float, tolerance)), np.float64).T


def hierarchical_against_plain() -> dict[str, Any]:
    """Return errors and time of the hierarchical sum beside those of the plain one."""
    result: dict[str, Any] = {}
    for name, medium in MEASURED.items():
        body = body_of(medium)
        pieces = cut_surface(body.mesh, POINTS, np.random.default_rng(0))
        scene = mi.load_dict({"type": "scene", "body": to_mitsuba(body.mesh, body.bsdf(), "body")})
        chosen = np.random.default_rng(1).choice(len(pieces.areas), PLACES, replace=False)
        # Not at a piece's centre, where no point of a picture lies but by chance.
        places = mi.Point3f((pieces.centres[chosen] + 0.3 * pieces.spacing).T.astype(np.float32))
        errors: list[NDArray[np.float64]] = []
        for light in LIGHTS.values():
            entering = entering_irradiance(
                scene, pieces.centres, pieces.normals, [light], medium.refractive_index
            )
            total = exitance_sum(body, pieces, entering)
            every, clustered = (sums_at(total, places, each) for each in (0.0, TOLERANCE))
            floor = DARKEST_SHOWN * every.max()
            errors.append(np.abs(clustered - every) / np.maximum(every, floor))
        result[name] = {
            "largest_error": float(np.max(errors)),
            "mean_error": float(np.mean(errors)),
        }
        if name in TIMED_MEDIA:
            plain, fast = (took(partial(sums_at, total, places, each)) for each in (0.0, TOLERANCE))
            ratio = plain["processor_seconds"] / fast["processor_seconds"]
            result[name]["times_as_fast_as_the_plain_sum"] = ratio
    return result


def grey(albedo: float, refractive_index: float) -> Medium:
    """Return a medium with a mean free path of 1 mm, alike in all channels."""
    return Medium("grey", (albedo,) * 3, (1 - albedo,) * 3, refractive_index)


def slabs() -> dict[str, Any]:
    """Return the reflectance of thick slabs by the dipole relative to the path tracer's."""
    result: dict[str, Any] = {}
    for index in (1.0, 1.3, 1.5):
        passing = 1 - ((index - 1) / (index + 1)) ** 2
        for albedo in (0.5, 0.8, 0.9, 0.95, 0.99):
            traced = slab_reflectance(albedo, index, SLAB_SAMPLES)
            dipole = passing * float(Dipole.of(grey(albedo, index)).total_reflectance[0])
            result[f"albedo {albedo}, index {index}"] = {
                "traced": traced,
                "noise": float(np.sqrt(traced * (1 - traced) / SLAB_SAMPLES)),
                "dipole": dipole,
                "ratio": dipole / traced,
            }
    return result


def spheres() -> dict[str, Any]:
    """Compare pictures of spheres without a boundary, of several sizes in mean free paths."""
    view = View(width_px=32, height_px=32, radius_px=15, samples=1)
    mesh = UnitSphere().mesh(64, 128)
    result: dict[str, Any] = {}
    for radius in (5.0, 10.0, 20.0):
        for name, light in LIGHTS.items():
            started = time.process_time()
            traced = sphere_radiance(view, light, 0.99, radius, samples=900)
            traced_s = time.process_time() - started
            renderer = TranslucentRenderer(Translucent(mesh, grey(0.99, 1.0), radius), POINTS)
            started = time.process_time()
            radiance, coverage = renderer.radiance(view, [light])
            dipole_s = time.process_time() - started
            whole = coverage == 1
            dipole, path = radiance[whole, 0].astype(np.float64), traced[whole].astype(np.float64)
            result[f"radius {radius:g} mean free paths, {name}"] = {
                "ratio_of_means": float(dipole.mean() / path.mean()),
                "correlation": float(np.corrcoef(dipole, path)[0, 1]),
                "processor_seconds_traced": traced_s,
                "processor_seconds_dipole": dipole_s,
            }
    return result


def run(engine: str | None) -> dict[str, Any]:
    """Run everything."""
    chosen = choose_engine(engine)
    result: dict[str, Any] = {
        "machine": machine(),
        "engine": chosen,
        "versions": current_versions(chosen),
        "limits": LIMITS,
        "picture": {"size": [VIEW.width_px, VIEW.height_px], "points": POINTS} | speed(),
        "hierarchical": hierarchical_against_plain(),
        "slabs_against_volpath": slabs(),
        "spheres_against_volpath": spheres(),
    }
    slowest = max(
        each["4_samples_a_pixel"]["seconds"]
        for name, each in result["picture"].items()
        if name in TIMED_MEDIA
    )
    largest = max(each["largest_error"] for each in result["hierarchical"].values())
    result["within_limits"] = {
        "seconds": slowest <= LIMITS["seconds"],
        "largest_error": largest <= LIMITS["largest_error"],
    }
    return result


def main() -> None:
    """Read the arguments, run, and write the result as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--engine", help="cuda or llvm; else the fastest that works")
    parser.add_argument("--output", type=Path, help="a file instead of the terminal")
    given = parser.parse_args()
    write_result(run(given.engine), given.output)


if __name__ == "__main__":
    main()
