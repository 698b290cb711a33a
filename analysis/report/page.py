"""One page that holds a study's results and opens without a network."""

import base64
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import jinja2

from algorithms.errors import InputError
from algorithms.files import make_folder, write_atomically
from analysis.answers.exclusions import Who, describe_rule
from analysis.answers.participants import describe_participants
from analysis.estimates import Estimate, to_json
from analysis.figures.style import SIMULATED_TEXT, figure_bytes
from analysis.naming import level_name, p_text
from analysis.report.study_analysis import StudyAnalysis, analyse_study
from analysis.report.tables import study_tables
from analysis.thresholds.chance import ChanceLimit
from experiments.exports.collection import load_collection
from experiments.study import Study
from stimuli.manifest import StimulusSet, load

REPORT_NAME = "report.html"
RESULTS_NAME = "results.json"
DEFAULT_SEED = 1

_TEMPLATES = jinja2.Environment(
    loader=jinja2.FileSystemLoader(Path(__file__).parent / "templates"),
    autoescape=True,
    undefined=jinja2.StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)


def _value(estimate: Estimate) -> str:
    return f"{estimate.value:.1f}"


def _interval(estimate: Estimate) -> str:
    if math.isnan(estimate.low):
        return "none"
    low = f"{estimate.low:.1f}" if math.isfinite(estimate.low) else "<"
    high = f"{estimate.high:.1f}" if math.isfinite(estimate.high) else ">"
    return f"[{low}, {high}]"


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %"


def _limit(limit: ChanceLimit | None) -> str:
    if limit is None:
        return "none"
    if math.isnan(limit.level):
        return f"< {limit.levels[0]:g}"
    return f"{'≥ ' if limit.at_largest_level else ''}{limit.level:g}"


def _interval_of_two_decimals(estimate: Estimate) -> str:
    if math.isnan(estimate.low):
        return ""
    return f"[{estimate.low:.2f}, {estimate.high:.2f}]"


def _decimals(value: float, places: int, sign: str = "") -> str:
    if math.isnan(value):
        return "none"
    if math.isinf(value):
        return ">" if value > 0 else "<"
    return f"{value:{sign}.{places}f}"


def _p_cell(p_value: float) -> str:
    return p_text(p_value).removeprefix("= ")


_TEMPLATES.filters |= {
    "decimals": _decimals,
    "interval2": _interval_of_two_decimals,
    "p": p_text,
    "p_cell": _p_cell,
    "value": _value,
    "interval": _interval,
    "percent": _percent,
    "limit": _limit,
}


@dataclass(frozen=True)
class Images:
    """What a report needs beside the rows of a store, where it shows images.

    Attributes
    ----------
    stimuli
        The folder of the stimulus set; `free-viewing` needs it.
    gaze
        The folder with gaze, where it is not where it was recorded.
    """

    stimuli: Path | None = None
    gaze: Path | None = None

    def located(self, study: Study, recorded: StimulusSet) -> StimulusSet:
        """Return the set with its folder, where there is one.

        Raises
        ------
        InputError
            If it is needed and not given, or another set.
        """
        if self.stimuli is None:
            if study.task == "free-viewing":
                raise InputError(
                    "stimuli: none given; the report of free-viewing needs the images (--stimuli)"
                )
            return recorded
        given = load(self.stimuli)
        if given.digest != recorded.digest:
            raise InputError(f"stimuli: {self.stimuli} is another set than the one that was shown")
        return given

    def folders(self, source: str | Path) -> tuple[Path, ...]:
        """Return where gaze files may be: as written, beside the store, or where it is said."""
        beside = () if "://" in str(source) else (Path(source).parent,)
        return (Path(), *beside) if self.gaze is None else (self.gaze, self.gaze.parent)


def analyse(
    source: str | Path,
    out_folder: str | Path,
    study: str | None = None,
    seed: int = DEFAULT_SEED,
    who: Who | None = None,
    *,
    include_pilot: bool = False,
    stimuli: Path | None = None,
    gaze: Path | None = None,
) -> Path:
    """Analyse what was collected in a study and write the report, its tables and its figures.

    Parameters
    ----------
    source
        A SQLite file, the SQLAlchemy URL of a store, or the folder of a bundle.
    out_folder
        Where `report.html`, `results.json`, `tables/*.csv` and `figures/*.svg` and `*.png` go; it
        is made where it does not exist, and files of these names are replaced.
    study
        The study's name, or None if the store holds only one.
    seed
        Of every random draw, 0 or more; the report states it.
    who
        `people`, `simulated`, or None: people if one of them has finished, simulated observers
        otherwise.
    include_pilot
        Whether sessions that only tried the study out count too.
    stimuli
        The folder of the stimulus set, where images are needed: of `free-viewing`.
    gaze
        The folder with gaze, where it is not where it was recorded.

    Returns
    -------
    pathlib.Path
        The report.

    Raises
    ------
    InputError
        If there is no store, no such study, nothing to analyse yet, or the folder is not writable.
    """
    images = Images(stimuli, gaze)
    analysis = _analysis_of(source, study, seed, who, images, include_pilot=include_pilot)
    return write_report(analysis, Path(out_folder))


def differences(source: str | Path, out_folder: str | Path, images: Images = Images()) -> list[str]:
    """Analyse again what a report is about, and return the results that are not the same.

    Parameters
    ----------
    source
        What the report was made from.
    out_folder
        The report's folder; nothing in it is changed. Study, seed and whose answers count are
        those of its `results.json`.
    images
        As given to the report.

    Returns
    -------
    The names of the results that differ, such as `thresholds` or `versions`; empty if none does.

    Raises
    ------
    InputError
        If there is no report, or nothing to analyse.
    """
    path = Path(out_folder) / RESULTS_NAME
    try:
        told = json.loads(path.read_bytes())
        choices = told["study"], told["seed"], told["flow"]["who"], told["include_pilot"]
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise InputError(f"{path}: there is no report of this Trompe to compare with") from error
    study, seed, who, include_pilot = choices
    analysis = _analysis_of(source, study, seed, who, images, include_pilot=include_pilot)
    again = json.loads(to_json(_results(analysis)))
    return [name for name in {**told, **again} if told.get(name) != again.get(name)]


def _analysis_of(
    source: str | Path,
    study: str | None,
    seed: int,
    who: Who | None,
    images: Images,
    *,
    include_pilot: bool,
) -> StudyAnalysis:
    found = load_collection(source, study)
    return analyse_study(
        found.study,
        images.located(found.study, found.stimuli),
        found.sessions,
        found.responses,
        seed,
        found.events,
        who,
        include_pilot=include_pilot,
        gaze_folders=images.folders(source),
    )


def _results(analysis: StudyAnalysis) -> dict[str, object]:
    return {"verdict": analysis.sentences(), **analysis.summary()}


def write_report(analysis: StudyAnalysis, folder: Path) -> Path:
    """Write the report with its tables and figures, and return its path.

    Raises
    ------
    InputError
        If the folder is not writable.
    """
    tables_folder = make_folder(folder / "tables")
    figures_folder = make_folder(folder / "figures")
    for name, table in study_tables(analysis).items():
        content = table.to_csv(index=False, lineterminator="\n")
        write_atomically(tables_folder / f"{name}.csv", content.encode())
    figures = analysis.figures()
    drawings = {name: figure_bytes(figure, "svg") for name, figure in figures.items()}
    for name, figure in figures.items():
        write_atomically(figures_folder / f"{name}.svg", drawings[name])
        write_atomically(figures_folder / f"{name}.png", figure_bytes(figure, "png"))
    write_atomically(folder / RESULTS_NAME, to_json(_results(analysis)).encode())
    report = folder / REPORT_NAME
    write_atomically(report, render(analysis, drawings).encode())
    return report


def render(analysis: StudyAnalysis, drawings: Mapping[str, bytes]) -> str:
    """Return the report as one HTML page with everything in it.

    Parameters
    ----------
    analysis
        What it tells.
    drawings
        The SVG of each figure of `analysis.figures()`.
    """
    return _TEMPLATES.get_template("report.html").render(
        analysis=analysis,
        study=analysis.study,
        stimuli=analysis.stimuli,
        people="" if analysis.simulated else describe_participants(analysis.sessions),
        flow=analysis.flow.to_frame().to_dict("records"),
        rule=describe_rule(analysis.study.exclusion, analysis.study.stimuli.level_unit),
        sentences=analysis.sentences(),
        level=level_name(analysis.study),
        unit=analysis.study.stimuli.level_unit,
        unanswered=_unanswered(analysis),
        tables=sorted(study_tables(analysis)),
        figures={name: _data_uri(drawing) for name, drawing in drawings.items()},
        simulated_text=SIMULATED_TEXT,
    )


def _unanswered(analysis: StudyAnalysis) -> int:
    if analysis.study.task == "free-viewing":
        return 0  # nothing is asked
    return int(analysis.trials["answer"].isna().sum())


def _data_uri(drawing: bytes) -> str:
    return f"data:image/svg+xml;base64,{base64.b64encode(drawing).decode()}"
