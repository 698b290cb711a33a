"""Where do people look? Time on each object, on the odd one against the others, heat maps."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import pandas as pd

from algorithms.errors import InputError
from analysis.answers.trials import KEPT, check_responses
from analysis.bootstrap import bootstrap_means, sum_by_participant
from analysis.gaze.over_set import GazeAnalysis, analyse_gaze
from analysis.gaze.samples import TRIAL
from analysis.report.study_analysis import Collected, StudyAnalysis
from experiments.gaze import load_gaze
from experiments.study import Study
from stimuli.manifest import StimulusSet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Sessions may differ so much in the size of what was seen, and still be put together.
_SAME_SIZE = 1.02


@dataclass(frozen=True)
class FreeViewingAnalysis(StudyAnalysis):
    """The results of a study of free viewing.

    Attributes
    ----------
    gaze
        Fixations, looking times, their ratios and heat maps.
    objects
        One row an object, and whether it is the odd one: `object`, `odd`, `images` (how many looks
        went in), `share` of the time on all objects with `low` and `high` (95 %, bootstrap over
        participants).
    valid_share
        The share of samples that the tracker had.
    """

    gaze: GazeAnalysis
    objects: pd.DataFrame
    valid_share: float

    template: ClassVar[str] = "free-viewing"

    def findings(self) -> Mapping[str, object]:
        """Return the results by name, for JSON."""
        fixations = self.gaze.fixations
        return {
            "objects": self.objects,
            "ratios": self.gaze.ratios,
            "fixations": {
                "number": len(fixations.table),
                "method": fixations.method,
                "settings": fixations.settings,
                "pixels_per_degree": fixations.pixels_per_degree,
            },
            "valid_share": self.valid_share,
        }

    def sentences(self) -> list[str]:
        """Return the results in plain sentences."""
        who = "Simulated viewers, not people," if self.simulated else "People"
        table = self.gaze.fixations.table
        median_s = float(table["duration_s"].median())
        told = [
            f"{who} made {len(table)} fixations in {len(self.trials)} views, of {median_s:.2f} s in"
            f" the median; the tracker had {100 * self.valid_share:.1f} % of the samples."
        ]
        if self.gaze.ratios is not None:
            unit = self.study.stimuli.level_unit
            told += [
                f"At {row[self.gaze.level]:g} {unit}".rstrip()
                + f" they looked {row['ratio']:.2f} times"
                f" [{row['low']:.2f}, {row['high']:.2f}] as long at the odd object as at another."
                for row in self.gaze.ratios.table.to_dict("records")
            ]
        return told

    def tables(self) -> dict[str, pd.DataFrame]:
        """Return the tables that are written beside a report, by name."""
        return {**self.gaze.tables(), "objects": self.objects}

    def figures(self) -> "dict[str, Figure]":
        """Return every figure that the gaze allows, by name."""
        from analysis.figures.free_viewing import free_viewing_figures  # they tell of this class

        return free_viewing_figures(self)


def trials(responses: pd.DataFrame, study: Study, stimuli: StimulusSet) -> pd.DataFrame:
    """Return one row a view: `stimulus` and the columns that all tasks share; `answer` is empty."""
    check_responses(responses, study)
    main = responses[responses["phase"] == "main"]
    table = main.loc[:, list(KEPT)].reset_index(drop=True)
    table["stimulus"] = [shown[0] for shown in main["stimuli"]]
    unknown = sorted(set(table["stimulus"]) - {stimulus.id for stimulus in stimuli.stimuli})
    if unknown:
        raise InputError(f"stimuli: {unknown[0]!r} was shown but is not in the set {stimuli.name}")
    return table.assign(answer=None)


def analyse(collected: Collected) -> FreeViewingAnalysis:
    """Load the gaze and compute where it rested."""
    level = collected.study.stimuli.level
    if level is None:
        raise InputError(
            f"stimuli.level: the study {collected.study.name} names no level to analyse by"
        )
    samples, degrees = load_gaze(collected.events, collected.gaze_folders)
    shown = collected.trials[[*TRIAL, "stimulus"]]
    samples = samples.drop(columns="stimulus").merge(shown[list(TRIAL)], on=list(TRIAL))
    gaze = analyse_gaze(
        samples,
        shown,
        collected.stimuli,
        _one_size(degrees),
        level,
        simulated=collected.simulated,
    )
    generator = np.random.default_rng(collected.seed)
    return FreeViewingAnalysis(
        **vars(collected),
        gaze=gaze,
        objects=_objects(gaze.dwell, collected.stimuli.objects, generator),
        valid_share=float(samples["valid"].mean()),
    )


def _one_size(degrees: Mapping[tuple[str, int], float]) -> float:
    smallest, largest = min(degrees.values()), max(degrees.values())
    if largest > _SAME_SIZE * smallest:
        raise InputError(
            f"gaze: a degree took {smallest:.1f} to {largest:.1f} pixels of the image; sessions"
            " with images of one size on the eye accepted"
        )
    return float(np.median(list(degrees.values())))


def _objects(
    dwell: pd.DataFrame, objects: Mapping[int, str], generator: np.random.Generator
) -> pd.DataFrame:
    named = dwell.assign(
        object=[objects.get(label, str(label)) for label in dwell["region"]],
        odd=(dwell["region"] == dwell["target"]).fillna(value=False).astype(bool),
    )
    sums = sum_by_participant(named, "share", ["object", "odd"])
    low, high = bootstrap_means(sums.totals, sums.counts, generator)
    images = sums.counts.sum(axis=0).astype(int)
    return sums.cells.assign(images=images, share=sums.means, low=low, high=high)
