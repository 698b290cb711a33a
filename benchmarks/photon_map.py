"""Speed, memory and error of photon-mapped caustics, beside Mitsuba's light tracer, as JSON.

    python -m benchmarks.photon_map [--engine llvm] [--seconds 10] [--repeats 5] [--output FILE]

The limits are those of the project on two processor cores: ten million photons traced and gathered
(50 nearest) into 640 x 480 in ten seconds and 4 GB, and at ten seconds each at most half the error
of `ptracer` on the caustic. The light tracer's long run is the reference; its own noise, known from
its parts, is taken off the squared errors.
"""

import argparse
import resource
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from benchmarks.results import machine, write_result
from stimuli.engine import choose_engine
from stimuli.making import current_versions
from stimuli.photons.caustic_render import CausticRenderer
from stimuli.photons.eye_paths import Eye
from stimuli.photons.kernel_values import rows_of
from stimuli.photons.photon_tracing import PhotonTracer
from tests.stimuli.glass import GLASS, camera, floor, scene, sphere

Picture = NDArray[np.float64]

PHOTONS, NEAREST, SIZE = 10_000_000, 50, (640, 480)
LIMITS = {"seconds": 10.0, "gigabytes": 4.0, "error_ratio": 0.5}
ALBEDO = 0.1  # what light does after a caustic is left out of ours, and is little here
LIGHTS: dict[str, dict[str, Any]] = {
    "point": {
        "type": "point",
        "position": [-2, 5, -1],
        "intensity": {"type": "rgb", "value": 100.0},
    },
    "directional": {
        "type": "directional",
        "direction": [2, -4, 1],
        "irradiance": {"type": "rgb", "value": 5.0},
    },
}
REFERENCE_PARTS, PARTS, DEPTH = 24, 4, 12


def ball_on_floor(light: str) -> Any:  # noqa: ANN401  # its type depends on the variant
    """Return a glass ball on a floor, which fill most of the view."""
    return scene(
        ball=sphere(GLASS, (0, 1.01, 0)),
        floor=floor(0, albedo=ALBEDO, half_width=4),
        light=LIGHTS[light],
        eye=camera((0, 4, 6), (0.3, 0.3, 0), size=SIZE, field_of_view_deg=36),
    )


@dataclass(frozen=True)
class Speed:
    """What ten million photons take: the least disturbed of several runs, and their median."""

    stored_photons: int
    trace_seconds: float
    gather_seconds: float
    seconds: float
    median_seconds: float
    gigabytes: float


def measure_speed(engine: str | None, repeats: int) -> Speed:
    """Trace and gather; call it in a process of its own."""
    choose_engine(engine)
    lit = ball_on_floor("point")
    sight = Eye(lit, lit.sensors()[0], 1).look(0)
    points, normals = (np.nan_to_num(rows_of(each)) for each in (sight.position, sight.normal))
    albedo = rows_of(sight.weight) * np.array(sight.valid)[:, None]
    tracer = PhotonTracer(lit)
    tracer.trace(1000, np.random.default_rng(0)).radiance(
        points[:100], normals[:100], 1.0, nearest=NEAREST
    )
    runs = []
    for seed in range(repeats):
        started = time.perf_counter()
        photons = tracer.trace(PHOTONS, np.random.default_rng(seed))
        traced = time.perf_counter()
        photons.radiance(points, normals, albedo, nearest=NEAREST)
        runs.append((traced - started, time.perf_counter() - traced))
    totals = np.sum(runs, axis=1)
    trace_s, gather_s = runs[int(totals.argmin())]
    kibibytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return Speed(
        len(photons),
        trace_s,
        gather_s,
        float(totals.min()),
        float(np.median(totals)),
        kibibytes * 1024 / 1e9,
    )


def light_traced(lit: Any, spp: int, seed: int) -> Picture:  # noqa: ANN401
    """Return a picture by Mitsuba's light tracer."""
    integrator = mi.load_dict({"type": "ptracer", "max_depth": DEPTH})
    return np.array(mi.render(lit, integrator=integrator, spp=spp, seed=seed), np.float64)


def shadow(lit: Any) -> NDArray[np.bool_]:  # noqa: ANN401
    """Return the pixels of the floor that no light reaches but through the ball or from it."""
    direct = mi.load_dict({"type": "direct", "emitter_samples": 1, "bsdf_samples": 0})
    straight = np.array(mi.render(lit, integrator=direct, spp=64, seed=0)).max(axis=-1)
    ball = mi.load_dict({"type": "scene", "ball": lit.shapes()[0]})
    depth = mi.load_dict({"type": "depth"})
    seen = np.array(mi.render(ball, sensor=lit.sensors()[0], integrator=depth, spp=64))[..., 0]
    inside: NDArray[np.bool_] = (straight == 0) & (seen == 0)
    return inside


def measure_error(light: str, seconds: float) -> dict[str, float]:
    """Compare errors of the caustic at equal times."""
    lit = ball_on_floor(light)
    inside = shadow(lit)
    path = mi.load_dict({"type": "path", "max_depth": DEPTH})
    base = np.array(mi.render(lit, integrator=path, spp=512, seed=0), np.float64)

    renderer = CausticRenderer(
        PhotonTracer(lit), lit.sensors()[0], photons_per_pass=1_000_000, eye_samples=4
    )
    renderer.render_pass(0, 0)
    started, passes, total = time.perf_counter(), 0, np.zeros_like(base)
    while time.perf_counter() - started < seconds:
        total += renderer.render_pass(passes, 1)[0]
        passes += 1
    ours_s = time.perf_counter() - started

    light_traced(lit, 4, 0)
    started = time.perf_counter()
    light_traced(lit, 16, 0)
    spp = max(1, round(16 * seconds / (time.perf_counter() - started) / PARTS))
    started = time.perf_counter()
    theirs = np.mean([light_traced(lit, spp, seed) for seed in range(1, PARTS + 1)], axis=0)
    theirs_s = time.perf_counter() - started

    parts = [light_traced(lit, spp, 1000 + seed) for seed in range(REFERENCE_PARTS * PARTS)]
    reference = np.mean(parts, axis=0)
    noise = np.var(parts, axis=0, ddof=1) / len(parts)

    def error(picture: Picture) -> float:
        squares = ((picture - reference) ** 2 - noise)[inside]
        return float(np.sqrt(max(0, squares.mean())) / reference[inside].mean())

    result = {
        "passes": float(passes),
        "seconds": ours_s,
        "ptracer_seconds": theirs_s,
        "ptracer_samples": float(spp * PARTS),
        "relative_rms_error": error(total / passes + base),
        "ptracer_relative_rms_error": error(theirs),
        "reference_relative_noise": float(np.sqrt(noise[inside].mean()) / reference[inside].mean()),
    }
    ratio = result["relative_rms_error"] / result["ptracer_relative_rms_error"]
    return result | {"error_ratio": ratio}


def run(engine: str | None, seconds: float, repeats: int) -> dict[str, Any]:
    """Run everything."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        speed = pool.submit(measure_speed, engine, repeats).result()
    load = machine()
    chosen = choose_engine(engine)
    errors = {light: measure_error(light, seconds) for light in LIGHTS}
    return {
        "machine": load,
        "engine": chosen,
        "versions": current_versions(chosen),
        "limits": LIMITS,
        "ten_million_photons": asdict(speed),
        "errors_at_equal_time": errors,
        "within_limits": {
            "seconds": speed.seconds <= LIMITS["seconds"],
            "gigabytes": speed.gigabytes < LIMITS["gigabytes"],
            "error_ratio": max(each["error_ratio"] for each in errors.values())
            <= LIMITS["error_ratio"],
        },
    }


def main() -> None:
    """Read the arguments, run, and write the result as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--engine", help="cuda or llvm; else the fastest that works")
    parser.add_argument("--seconds", type=float, default=10, help="for each picture of a caustic")
    parser.add_argument("--repeats", type=int, default=5, help="of ten million photons")
    parser.add_argument("--output", type=Path, help="a file instead of the terminal")
    given = parser.parse_args()
    write_result(run(given.engine, given.seconds, given.repeats), given.output)


if __name__ == "__main__":
    main()
