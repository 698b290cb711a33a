"""Make docs/pictures/edits.jpg: edits of photographs that scikit-image ships, with their settings.

    python -m docs.screenshots_edits

Masks are drawn here as a user would, with a few clicks; only the motorcycle's depth was measured.
"""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from skimage import data, draw

from algorithms.caustics import PRESETS as CAUSTICS
from algorithms.color import srgb_digits
from algorithms.edits.request import Request, perform
from algorithms.fog import PRESETS as FOGS
from algorithms.fog import Fog
from algorithms.images import write_picture
from algorithms.transparency import CLEAR
from benchmarks.caustics import BODY, HANDLE, QUAD, RIM, SHADOW
from stimuli.sets.fog_methods import MOTORCYCLE

PICTURE: Final = Path(__file__).parent / "pictures" / "edits.jpg"
COLUMNS: Final = 3
WIDTH_PX: Final = 420
CAPTION_PX: Final = 24
PAPER, INK = (246, 246, 244), (30, 30, 30)

Points = Sequence[tuple[float, float]]

PHOTOGRAPHS: Final[Mapping[str, Callable[[], NDArray[np.uint8]]]] = {
    "motorcycle": lambda: np.asarray(data.stereo_motorcycle()[0]),
    "coffee": data.coffee,
    "rocket": data.rocket,
    "astronaut": data.astronaut,
    "chelsea": data.chelsea,
}
MASKS: Final[Mapping[str, Points]] = {
    "tank": (
        *((326, 238), (345, 228), (375, 205), (405, 182), (440, 165), (472, 168), (487, 182)),
        *((484, 205), (474, 230), (462, 240), (425, 238), (385, 243), (345, 250)),
    ),
    "cup-shadow": SHADOW,
    "woman": (
        *((225, 15), (180, 32), (160, 60), (152, 90), (163, 122), (185, 127), (188, 150)),
        *((150, 150), (124, 165), (116, 185), (118, 212), (105, 216), (80, 245), (55, 262)),
        *((38, 310), (28, 380), (25, 440), (22, 490), (24, 512), (512, 512), (506, 440)),
        *((488, 400), (455, 363), (400, 344), (362, 354), (358, 310), (352, 275), (330, 256)),
        *((303, 241), (300, 215), (285, 195), (262, 184), (254, 178), (260, 150), (270, 132)),
        *((288, 130), (298, 105), (301, 78), (290, 48), (262, 25)),
    ),
    "cat": (
        *((49, 0), (412, 0), (398, 30), (378, 62), (367, 100), (363, 150), (332, 224), (295, 270)),
        *((322, 300), (0, 300), (0, 175), (37, 125), (31, 64)),
    ),
    "all": ((-1, -1), (999, -1), (999, 999), (-1, 999)),
}
FLOOR: Final = ((250, 425), (420, 415), (470, 480), (260, 490))
STEREO: Final = asdict(MOTORCYCLE)
MIST: Final = Fog(extinction=1.6, airlight=(0.62, 0.64, 0.67))


@dataclass(frozen=True)
class Shown:
    """An edit to be shown: photograph, edit, caption, masks by input, and parameters."""

    photograph: str
    edit: str
    caption: str
    masks: Mapping[str, str] = field(default_factory=dict)
    parameters: Mapping[str, Any] = field(default_factory=dict)


def fog(photograph: str, caption: str, settings: Fog, **source: Any) -> Shown:  # noqa: ANN401
    """Return fog; `layers` are masks by name, each with its distance."""
    layers: Mapping[str, float] = source.pop("layers", {})
    distance = {"layers": list(layers.values()), **source}
    parameters = {
        "fog": asdict(settings),
        "distance": distance,
        "scaled": "stereo" in source,
        "field_of_view_deg": 50.0,
        "seed": 2011,
    }
    masks = {f"layer-{number + 1}": name for number, name in enumerate(layers)}
    return Shown(photograph, "fog", caption, masks, parameters)


def caustics(photograph: str, mask: str, quad: Points, preset: str) -> Shown:
    """Return caustics of a preset."""
    parameters = {"caustics": asdict(CAUSTICS[preset]), "quad": quad, "depth_scale": 1.0}
    caption = f"{photograph}: caustics, preset {preset}"
    return Shown(photograph, "caustics", caption, {"mask": mask}, parameters)


def glass(photograph: str, caption: str, masks: Mapping[str, str], **changed: Any) -> Shown:  # noqa: ANN401
    """Return an object of glass; with a `quad`, caustics of a `preset` too."""
    preset, quad = changed.pop("preset", "vase"), changed.pop("quad", None)
    parameters = {
        "glass": asdict(replace(CLEAR, **changed)),
        "depth_scale": 1.0,
        "lifted": 0.7,
        "caustics": asdict(CAUSTICS[preset]),
        "quad": quad,
    }
    return Shown(photograph, "transparent", caption, masks, parameters)


CUP: Final = {"mask": "cup", "shadow": "cup-shadow"}
GREEN: Final = (0.45, 0.85, 0.6)
EDITS: Final = (
    fog("motorcycle", "fog, preset house-left", FOGS["house-left"], stereo=STEREO),
    fog("motorcycle", "fog, preset forest-right", FOGS["forest-right"], stereo=STEREO),
    fog("motorcycle", "fog, extinction=1.6, homogeneous", MIST, stereo=STEREO),
    fog("coffee", "fog, a plane that recedes", MIST, recede=(300, 420, 300, -60, 0.1, 1.2)),
    fog(
        "rocket", "mist of one depth: lamps glow", replace(MIST, extinction=0.9), layers={"all": 1}
    ),
    fog("astronaut", "fog, two layers", MIST, layers={"woman": 0.12}, background=1.0),
    fog("chelsea", "fog, two layers", FOGS["house-left"], layers={"cat": 0.2}, background=1.0),
    caustics("coffee", "cup", QUAD, "can"),
    caustics("coffee", "cup", QUAD, "elephant"),
    glass("coffee", "the cup of glass, preset vase, shadow lifted", CUP, quad=QUAD),
    glass("coffee", "of green glass, index 1.3", CUP, quad=QUAD, tint=GREEN, refractive_index=1.3),
    glass("motorcycle", "a tank of glass, preset car", {"mask": "tank"}, quad=FLOOR, preset="car"),
)


def mask_of(name: str, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Return a mask that was drawn by hand."""
    height, width = shape[:2]
    if name == "cup":
        x, y, half_width, half_height = RIM
        cup = _polygon(BODY, height, width) | _polygon(HANDLE, height, width)
        cup[draw.ellipse(y, x, half_height, half_width, (height, width))] = True
        return cup
    return _polygon(MASKS[name], height, width)


def _polygon(points: Points, height: int, width: int) -> NDArray[np.bool_]:
    corners = np.array(points, dtype=np.float64)[:, ::-1]
    return np.asarray(draw.polygon2mask((height, width), corners))


def made(shown: Shown, folder: Path) -> Image.Image:
    """Make an edit as `trompe edit` does, from files."""
    photograph = PHOTOGRAPHS[shown.photograph]()
    path = folder / f"{shown.photograph}.png"
    Image.fromarray(photograph).save(path)
    inputs: dict[str, Path] = {}
    for role, name in shown.masks.items():
        inputs[role] = folder / f"{name}.png"
        Image.fromarray(mask_of(name, photograph.shape)).save(inputs[role])
    if "stereo" in shown.parameters.get("distance", {}):
        inputs["depth"] = folder / "disparity.npz"
        np.savez(inputs["depth"], data.stereo_motorcycle()[2])
    edited = perform(Request(shown.edit, path, inputs, shown.parameters))
    picture = Image.fromarray(srgb_digits(edited.after))
    height_px = round(picture.height * WIDTH_PX / picture.width)
    return picture.resize((WIDTH_PX, height_px), Image.Resampling.LANCZOS)


def main() -> None:
    """Save the sheet."""
    with tempfile.TemporaryDirectory() as folder:
        pictures = [made(shown, Path(folder)) for shown in EDITS]
    shown_px = min(WIDTH_PX * 2 // 3, *(picture.height for picture in pictures))
    cell_px = shown_px + CAPTION_PX
    rows = -(-len(pictures) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * (WIDTH_PX + 8), rows * (cell_px + 8)), PAPER)
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(13)
    for number, (shown, picture) in enumerate(zip(EDITS, pictures, strict=True)):
        row, column = divmod(number, COLUMNS)
        x, y = column * (WIDTH_PX + 8), row * (cell_px + 8)
        top = (picture.height - shown_px) // 2
        sheet.paste(picture.crop((0, top, WIDTH_PX, top + shown_px)), (x, y))
        pen.text((x, y + cell_px - CAPTION_PX + 3), _caption(shown), INK, font)
    write_picture(PICTURE, sheet)


def _caption(shown: Shown) -> str:
    begins = shown.caption.startswith(shown.photograph)
    return shown.caption if begins else f"{shown.photograph}: {shown.caption}"


if __name__ == "__main__":
    main()
