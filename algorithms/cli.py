"""The command `trompe lights`."""

import json
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.images import read_image_and_alpha, write_picture
from algorithms.light import Light, angle_between_deg
from algorithms.masks import read_mask

if TYPE_CHECKING:
    from algorithms.lights.estimate import LightEstimate, Method


def lights(
    image: Annotated[
        Path,
        typer.Argument(help="A PNG, JPEG or OpenEXR file; what is transparent is not looked at."),
    ],
    mask: Annotated[
        list[Path],
        typer.Option(help="A picture that is white where the object is; once for each object."),
    ],
    method: Annotated[str, typer.Option(help="fitting (accurate) or voting (fast).")] = "fitting",
    out: Annotated[
        Path | None, typer.Option(help="The picture; by default IMAGE's name with -lights.png.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Machine-readable output.")] = False,
) -> None:
    """Detect the lights of a picture from one or more objects in it, and draw them."""
    from algorithms.lights.picture import light_picture

    if method not in ("fitting", "voting"):
        raise InputError(f"method: {method!r} given, fitting or voting accepted")
    out = out or image.with_name(f"{image.stem}-lights.png")
    if out.resolve() in {path.resolve() for path in (image, *mask)}:
        raise InputError(f"out: {out} is an input; another file is accepted")
    pixels, alpha = read_image_and_alpha(image)
    masks = [read_mask(path, pixels.shape) for path in mask]
    if alpha is not None:
        masks = [inside & (alpha > 0) for inside in masks]
    found = [
        _detect(path, pixels, inside, "voting" if method == "voting" else "fitting")
        for path, inside in zip(mask, masks, strict=True)
    ]
    write_picture(out, light_picture(pixels, masks, found))
    agreement = [
        {"first": str(mask[i]), "second": str(mask[j]), "angle_deg": round(angle, 1)}
        for i, j, angle in _agreement(found)
    ]
    if as_json:
        probes = [
            {"mask": str(path), **estimate.to_dict()}
            for path, estimate in zip(mask, found, strict=True)
        ]
        typer.echo(json.dumps({"probes": probes, "agreement": agreement, "picture": str(out)}))
        return
    for path, estimate in zip(mask, found, strict=True):
        _print(path, estimate)
    for pair in agreement:
        typer.echo(
            f"the strongest lights of {pair['first']} and {pair['second']} are "
            f"{pair['angle_deg']} degrees apart"
        )
    typer.echo(f"wrote {out}")


def _detect(
    path: Path, pixels: NDArray[np.float32], inside: NDArray[np.bool_], method: "Method"
) -> "LightEstimate":
    """Detect the lights of one probe; an error says of which."""
    from algorithms.lights import detect_lights

    try:
        return detect_lights(pixels, inside, method)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _agreement(found: "list[LightEstimate]") -> list[tuple[int, int, float]]:
    """Return the angle between the strongest lights of each two probes."""
    strongest: dict[int, Light] = {
        number: estimate.lights[0] for number, estimate in enumerate(found) if estimate.lights
    }
    return [
        (i, j, angle_between_deg(strongest[i], strongest[j])) for i, j in combinations(strongest, 2)
    ]


def _print(path: Path, estimate: "LightEstimate") -> None:
    typer.echo(f"{path}: confidence {estimate.confidence:.2f}")
    for light in estimate.lights:
        place = "far away" if light.distance is None else f"at {light.distance:.1f} radii"
        typer.echo(
            f"  azimuth {light.azimuth_deg:6.1f} deg, elevation {light.elevation_deg:6.1f} deg, "
            f"intensity {light.intensity:.3g}, {place}"
        )
    typer.echo(
        f"  ambient {estimate.ambient:.3g}, residual along the outline {estimate.residual:.3f}"
    )
    for remark in estimate.remarks:
        typer.echo(f"  {remark}")
