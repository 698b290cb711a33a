"""Experiment 3: photographs in which one object was lit from elsewhere (sec. 2.5).

From a folder of the user's (`stimuli.photographs.folder` tells what it holds): aligned photographs
of one scene, its key light moved between them, and the objects' masks. Every object is taken from
every other photograph and put into the reference, one at a time (experiment 3.2) and, where the
description names pairs, two at a time (experiment 3.1); the reference itself, where nothing
diverges, is the control.

The thesis composites by "Poisson-based alpha matting" without saying more;
`stimuli.photographs.cloning` tells what we do. Its band is a hundredth of the image's diagonal
wide, its correction reaches half of that, so that the objects' own light is hardly changed: how
much is recorded with each image. The thesis' scenes stand before a black background, for shadows on
a table would stay behind.
"""

import importlib.metadata
import re
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from skimage.transform import resize

from algorithms.color import FloatImage, encode_srgb, luminance
from algorithms.errors import InputError
from algorithms.files import sha256_of
from algorithms.images import write_labels
from stimuli.exposure import exposure_for, write_shown
from stimuli.making import Job, Plan, Progress, make_set, no_progress, recipe_of
from stimuli.manifest import Stimulus, StimulusSet
from stimuli.photographs.checks import check_alike, check_clipping
from stimuli.photographs.cloning import clone, seam_of_255
from stimuli.photographs.folder import FILE_NAME, PhotographFolder, read_folder
from stimuli.truth import regions_file

NAME: Final = "photographs"

_MARGIN_OF_DIAGONAL: Final = 0.01
_LEAST_MARGIN_PX: Final = 6.0
_REACH_OF_MARGIN: Final = 0.5
_SCENE: Final = "scene"


@dataclass(frozen=True)
class Composite:
    """One image of the set: which objects come from which photograph.

    Attributes
    ----------
    objects
        Their names; none for the control.
    photograph
        The file that they come from, the reference for the control.
    divergence_deg
        The angle between its key light and the reference's.
    """

    objects: tuple[str, ...]
    photograph: str
    divergence_deg: float


def make(
    folder: Path,
    *,
    seed: int = 0,
    quick: bool = False,
    engine: str | None = None,  # noqa: ARG001  # as every set; nothing is rendered
    progress: Progress = no_progress,
    photographs: Path | None = None,
) -> StimulusSet:
    """Make the set from the user's photographs, or what is missing of it.

    Parameters
    ----------
    folder
        New, empty, or begun with the same photographs and arguments.
    seed, engine
        Recorded and not used: nothing is drawn at random, and nothing is rendered.
    quick
        Half the width and height.
    progress
        Called after each image.
    photographs
        The folder with the photographs and their `photographs.toml`.

    Returns
    -------
    The set: factors `divergence_deg`, `object` (pairs joined by +, `none` for the control),
    `inserted` (how many) and `photograph`; answers are labels of `regions`, a tuple for pairs.

    Raises
    ------
    InputError
        If there are no photographs, their description or a mask is not valid, or they differ in
        size, are out of line, unequally exposed or overexposed.
    """
    if photographs is None:
        raise InputError(
            f"photographs: a folder with aligned photographs and their {FILE_NAME} is needed"
            " (--photographs FOLDER)"
        )
    given = read_folder(photographs)
    parameters = {
        "quick": quick,
        "description": given.description.model_dump(mode="json"),
        "files": {
            path.relative_to(photographs).as_posix(): sha256_of(path) for path in given.files
        },
    }
    recipe = recipe_of(NAME, "stimuli.sets.photographs.make", parameters, seed, "none")
    used = {name: importlib.metadata.version(name) for name in ("scipy", "scikit-image")}
    recipe = replace(recipe, versions={**recipe.versions, **used})
    return make_set(folder, recipe, lambda: _plan(given, quick), progress)


def composites(given: PhotographFolder) -> list[Composite]:
    """Return the images of a folder's set: the control, then by objects and divergence."""
    described = given.description
    chosen: list[tuple[str, ...]] = [*((name,) for name in described.objects), *described.pairs]
    return [
        Composite((), described.reference, 0.0),
        *(
            Composite(names, file, round(described.divergence_deg(described.reference, file), 2))
            for names in chosen
            for file in given.others
        ),
    ]


def _plan(given: PhotographFolder, quick: bool) -> Plan:
    exposure, measured = _checked(given)
    scene = _Scene(given, quick, exposure)
    jobs = [
        Job(
            _stimulus(number, composite, given),
            lambda folder, composite=composite, number=number: scene.make(  # type: ignore[misc]
                folder, composite, _file(number, composite)
            ),
        )
        for number, composite in enumerate(composites(given))
    ]
    names = dict(enumerate(given.description.objects, start=1))
    return Plan(jobs, exposure, names, {"photographs": measured, "margin_px": scene.margin_px})


def _checked(given: PhotographFolder) -> tuple[float, dict[str, Any]]:
    """Return the exposure, and what the checks of the photographs measured."""
    described = given.description
    reference = given.photograph(described.reference)
    masks = list(given.masks(reference.shape[:2]).values())
    exposure = _exposure(given)
    measured = {}
    for file in described.photographs:
        photograph = given.photograph(file)
        place = str(given.folder / file)
        if photograph.shape != reference.shape:
            raise InputError(
                f"{place}: {photograph.shape[1]} x {photograph.shape[0]} pixels; the reference's"
                f" {reference.shape[1]} x {reference.shape[0]} are accepted"
            )
        if exposure == 1:
            check_clipping(place, photograph)
        if file != described.reference:
            measured[file] = check_alike(
                place,
                photograph * np.float32(exposure),
                reference * np.float32(exposure),
                masks,
                max_shift_px=described.max_shift_px,
                max_exposure_stops=described.max_exposure_stops,
            )
    return exposure, measured


def _exposure(given: PhotographFolder) -> float:
    """Return 1 for photographs that are ready to be shown, else what brings them there."""
    linear = {file.lower().endswith(".exr") for file in given.description.photographs}
    if linear == {False}:
        return 1.0
    if linear != {True}:
        raise InputError(
            "photographs: OpenEXR files only, or PNG and JPEG files only, are accepted"
        )
    return exposure_for(given.photograph(file) for file in given.description.photographs)


class _Scene:
    """The photographs and masks in the stimuli's size."""

    def __init__(self, given: PhotographFolder, quick: bool, exposure: float) -> None:
        self._given, self._exposure = given, exposure
        reference = given.photograph(given.description.reference)
        height, width = reference.shape[:2]
        wanted = min(given.description.width_px, width) // (2 if quick else 1)
        self._shape = (round(height * wanted / width), wanted)
        self._reference = self._resized(reference)
        self._masks = {
            name: np.pad(self._resized(mask.astype(np.float32))[1:-1, 1:-1] > 0.5, 1)
            for name, mask in given.masks((height, width)).items()
        }
        self.margin_px = max(_LEAST_MARGIN_PX, _MARGIN_OF_DIAGONAL * float(np.hypot(*self._shape)))

    def make(self, folder: Path, composite: Composite, file: str) -> dict[str, float]:
        """Write a composite and the regions, and return what cloning did."""
        self._write_regions(folder)
        source = self._resized(self._given.photograph(composite.photograph))
        image, region = self._reference, np.zeros(self._shape, dtype=bool)
        change = 0.0
        for name in composite.objects:
            others = [mask for other, mask in self._masks.items() if other != name]
            cloned = clone(
                image,
                source,
                self._masks[name],
                margin_px=self.margin_px,
                reach_px=self.margin_px * _REACH_OF_MARGIN,
                protected=np.logical_or.reduce(others) if others else None,
            )
            image, region = cloned.image, region | cloned.region
            change = max(change, self._difference(image, source, self._masks[name]))
        write_shown(folder / file, image, self._exposure)
        if not composite.objects:
            return {}
        shown = [
            picture * np.float32(self._exposure) for picture in (image, self._reference, source)
        ]
        return {
            "seam_of_255": round(seam_of_255(shown[0], shown[1], shown[2], region), 3),
            "object_change_rms_of_255": round(change, 3),
        }

    def _difference(self, image: FloatImage, source: FloatImage, mask: NDArray[np.bool_]) -> float:
        one, other = (
            encode_srgb(luminance(picture[mask]) * self._exposure) for picture in (image, source)
        )
        return float(255 * np.sqrt(np.mean((one - other) ** 2)))

    def _resized(self, image: NDArray[np.float32]) -> NDArray[np.float32]:
        if image.shape[:2] == self._shape:
            return image
        smaller = resize(image, self._shape, order=1, anti_aliasing=True)
        return np.asarray(smaller, dtype=np.float32)

    def _write_regions(self, folder: Path) -> None:
        path = folder / regions_file(_SCENE)
        if not path.is_file():
            labels = np.zeros(self._shape, np.uint8)
            for number, mask in enumerate(self._masks.values(), start=1):
                labels[mask] = number
            write_labels(path, labels)


def _file(number: int, composite: Composite) -> str:
    return f"images/{_id(number, composite)}.png"


def _id(number: int, composite: Composite) -> str:
    what = "-".join(composite.objects) or "control"
    source = re.sub(r"[^A-Za-z0-9]+", "-", Path(composite.photograph).stem)
    return f"main-{number:03d}-{what}-{source}"


def _stimulus(number: int, composite: Composite, given: PhotographFolder) -> Stimulus:
    described = given.description
    labels = [list(described.objects).index(name) + 1 for name in composite.objects]
    lights = {"key": described.reference, "target_key": composite.photograph}
    return Stimulus(
        id=_id(number, composite),
        file=_file(number, composite),
        factors={
            "divergence_deg": composite.divergence_deg,
            "object": "+".join(composite.objects) or "none",
            "inserted": len(labels),
            "photograph": Path(composite.photograph).stem,
        },
        answer=tuple(labels) if len(labels) > 1 else labels[0] if labels else None,
        regions=regions_file(_SCENE),
        details={
            name: asdict(light)
            for name, file in lights.items()
            if (light := described.light(file)) is not None
        },
    )
