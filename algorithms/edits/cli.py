"""The commands of `trompe edit`."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from algorithms.edits.request import Request, Settings
from algorithms.errors import InputError

if TYPE_CHECKING:
    from algorithms.depth.files import Stereo

# The edits take a second to import: only the command that makes one does it.

app = typer.Typer(no_args_is_help=True, help="Edit a picture: fog, caustics, glass.")

Picture = Annotated[
    Path, typer.Argument(metavar="IMAGE", help="A PNG, JPEG, TIFF, Radiance HDR or OpenEXR file.")
]
Out = Annotated[
    Path | None, typer.Option(help="The result; by default IMAGE's name with the edit's added.")
]
Preset = Annotated[str | None, typer.Option(help="Settings to begin with: see `presets`.")]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Change a setting; again for another one."),
]
Mask = Annotated[Path, typer.Option(help="A picture that is white where the object is.")]
Depth = Annotated[
    Path | None,
    typer.Option(help="PNG, TIFF, OpenEXR or NumPy file; without it, depth is guessed."),
]
DepthScale = Annotated[float, typer.Option(help="What the depth file's values are multiplied by.")]
Compare = Annotated[bool, typer.Option(help="Write a picture of before and after as well.")]
MaxPixels = Annotated[
    int, typer.Option(min=1, help="Larger pictures are refused before they are decoded.")
]
Json = Annotated[bool, typer.Option("--json", help="Machine-readable output.")]


@app.command()
def fog(
    image: Picture,
    preset: Preset = None,
    assignments: Set = None,
    depth: Depth = None,
    depth_scale: DepthScale = 1.0,
    stereo: Annotated[
        str | None,
        typer.Option(
            metavar="FOCAL_PX,BASELINE[,OFFSET_PX]", help="The depth file holds disparities."
        ),
    ] = None,
    layer: Annotated[
        list[str] | None,
        typer.Option(metavar="MASK=DISTANCE", help="A layer, over those before; again for more."),
    ] = None,
    recede: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y,X,Y,NEAR,FAR", help="A plane recedes from a near point to a far one."
        ),
    ] = None,
    background: Annotated[
        float | None, typer.Option(help="Distance where no layer is; without it, infinite.")
    ] = None,
    scaled: Annotated[
        bool | None,
        typer.Option(
            "--scaled/--as-given",
            help="Bring distances to 0..1, as presets expect; by default with a preset.",
        ),
    ] = None,
    field_of_view: Annotated[float, typer.Option(help="Horizontal, in degrees.")] = 50.0,
    seed: Annotated[int, typer.Option(min=0, help="Of the fog's clouds.")] = 2011,
    out: Out = None,
    compare: Compare = True,
    max_pixels: MaxPixels = 100_000_000,
    as_json: Json = False,
) -> None:
    """Add fog, by a depth file, by layers, or by a plane that recedes."""
    from algorithms.edits.fog import LAYER, DistanceSource
    from algorithms.fog import PRESETS, Fog

    given = layer or []
    source = DistanceSource(
        scale=depth_scale,
        stereo=_stereo(stereo),
        recede=_numbers("recede", recede, 6),
        layers=tuple(_number("layer", text.rpartition("=")[2]) for text in given),
        background=background,
    )
    inputs = {f"{LAYER}{n + 1}": Path(text.rpartition("=")[0]) for n, text in enumerate(given)}
    if depth is not None:
        if given or recede is not None:
            raise InputError("depth: a depth file, or layers and a receding plane, not both")
        inputs["depth"] = depth
    settings = _settings(PRESETS, preset, Fog(extinction=0.5), assignments)
    parameters = {
        "fog": asdict(settings),
        "distance": asdict(source),
        "scaled": preset is not None if scaled is None else scaled,
        "field_of_view_deg": field_of_view,
        "seed": seed,
    }
    request = Request("fog", image, inputs, parameters)
    _run(request, out, compare=compare, max_pixels=max_pixels, as_json=as_json)


@app.command()
def caustics(
    image: Picture,
    mask: Mask,
    quad: Annotated[
        str,
        typer.Option(
            metavar="X,Y,X,Y,X,Y,X,Y",
            help="Where light falls: four corners in pixels, clockwise from the map's top left.",
        ),
    ],
    preset: Preset = None,
    assignments: Set = None,
    depth: Depth = None,
    depth_scale: DepthScale = 1.0,
    out: Out = None,
    compare: Compare = True,
    max_pixels: MaxPixels = 100_000_000,
    as_json: Json = False,
) -> None:
    """Let an object throw caustics on a surface that you mark."""
    from algorithms.caustics import PRESETS, Caustics

    parameters = {
        "caustics": asdict(_settings(PRESETS, preset, Caustics(), assignments)),
        "quad": _corners(quad),
        "depth_scale": depth_scale,
    }
    inputs = {"mask": mask} if depth is None else {"mask": mask, "depth": depth}
    request = Request("caustics", image, inputs, parameters)
    _run(request, out, compare=compare, max_pixels=max_pixels, as_json=as_json)


@app.command()
def transparent(
    image: Picture,
    mask: Mask,
    assignments: Set = None,
    depth: Depth = None,
    depth_scale: DepthScale = 1.0,
    shadow: Annotated[
        Path | None, typer.Option(help="A picture that is white where the object's shadow is.")
    ] = None,
    lifted: Annotated[
        float, typer.Option(min=0, max=1, help="How far the shadow is lifted.")
    ] = 0.7,
    quad: Annotated[
        str | None,
        typer.Option(metavar="X,Y,X,Y,X,Y,X,Y", help="Where caustics fall; without it, none do."),
    ] = None,
    preset: Annotated[str | None, typer.Option(help="Of the caustics: see `presets`.")] = None,
    out: Out = None,
    compare: Compare = True,
    max_pixels: MaxPixels = 100_000_000,
    as_json: Json = False,
) -> None:
    """Make an object of glass, with its shadow lifted and caustics in it."""
    from algorithms.caustics import PRESETS, Caustics
    from algorithms.transparency import CLEAR

    parameters = {
        "glass": asdict(_settings({}, None, CLEAR, assignments)),
        "depth_scale": depth_scale,
        "lifted": lifted,
        "caustics": asdict(_settings(PRESETS, preset, Caustics(), None)),
        "quad": _corners(quad),
    }
    given = {"mask": mask, "depth": depth, "shadow": shadow}
    inputs = {name: path for name, path in given.items() if path is not None}
    request = Request("transparent", image, inputs, parameters)
    _run(request, out, compare=compare, max_pixels=max_pixels, as_json=as_json)


@app.command()
def repeat(
    record: Annotated[Path, typer.Argument(metavar="FILE.json", help="The record of an edit.")],
    out: Annotated[Path | None, typer.Option(help="By default where the result was.")] = None,
    max_pixels: MaxPixels = 100_000_000,
) -> None:
    """Repeat a recorded edit exactly."""
    from algorithms.edits.record import repeat as repeat_edit

    path, same = repeat_edit(record, out, max_pixels=max_pixels)
    typer.echo(f"wrote {path}: {'the same bytes' if same else 'other bytes'} as recorded")


@app.command()
def presets(as_json: Json = False) -> None:
    """List the settings to begin with, and what they are."""
    from algorithms import caustics as caustics_edit
    from algorithms import fog as fog_edit

    known: dict[str, dict[str, Any]] = {
        "fog": {name: asdict(each) for name, each in fog_edit.PRESETS.items()},
        "caustics": {name: asdict(each) for name, each in caustics_edit.PRESETS.items()},
    }
    if as_json:
        typer.echo(json.dumps(known))
        return
    for edit, settings in known.items():
        for name, values in settings.items():
            shown = ", ".join(f"{key}={_shown(value)}" for key, value in values.items())
            typer.echo(f"{edit} {name}: {shown}")


def _run(
    request: Request, out: Path | None, *, compare: bool, max_pixels: int, as_json: bool
) -> None:
    from algorithms.edits.record import run

    suffix = request.image.suffix.lower()
    kept = suffix if suffix in (".jpg", ".jpeg", ".exr", ".hdr") else ".png"
    out = out or request.image.with_name(f"{request.image.stem}-{request.edit}{kept}")
    record = run(request, out, compare=compare, max_pixels=max_pixels)
    if as_json:
        typer.echo(json.dumps({"output": str(out), "record": str(record)}))
        return
    typer.echo(f"wrote {out}; {record} repeats it")


def _settings(
    known: Mapping[str, Settings], preset: str | None, default: Settings, changes: list[str] | None
) -> Settings:
    from algorithms.edits.request import changed

    if preset is not None and preset not in known:
        raise InputError(f"preset: {preset!r} given, {', '.join(known)} accepted")
    return changed(default if preset is None else known[preset], changes or [])


def _stereo(text: str | None) -> "Stereo | None":
    from algorithms.depth.files import Stereo

    if text is None:
        return None
    numbers = [_number("stereo", part) for part in text.split(",")]
    if len(numbers) not in (2, 3):
        raise InputError(f"stereo: {text!r} given, FOCAL_PX,BASELINE[,OFFSET_PX] accepted")
    return Stereo(*numbers)


def _numbers(name: str, text: str | None, count: int) -> Any:  # noqa: ANN401  # count floats
    if text is None:
        return None
    numbers = tuple(_number(name, part) for part in text.split(","))
    if len(numbers) != count:
        raise InputError(f"{name}: {text!r} given, {count} numbers with commas between accepted")
    return numbers


def _corners(text: str | None) -> list[list[float]] | None:
    numbers = _numbers("quad", text, 8)
    return numbers and [list(numbers[place : place + 2]) for place in range(0, 8, 2)]


def _number(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{name}: a number is accepted, not {text!r}") from None


def _shown(value: object) -> str:
    if isinstance(value, tuple):
        return ",".join(map(_shown, value))
    return f"{value:.3g}" if isinstance(value, float) else str(value)
