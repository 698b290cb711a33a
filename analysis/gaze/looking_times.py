"""Where people look: time on each region of an image, and saccades.

Coordinates are pixels of the image from its upper left corner, y downwards; a region is a label of
a label image, as stimulus sets have them. Everything is made of fixations
(`analysis.fixations`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.bounded_means import ratio_of_sums
from analysis.estimates import CONFIDENCE, software_version
from analysis.gaze.fixations import Fixations
from analysis.gaze.heat_map import image_pixels
from analysis.gaze.samples import TRIAL

BACKGROUND = 0
_KEY = list(TRIAL)


def dwell_times(
    fixations: Fixations, trials: pd.DataFrame, regions: Mapping[Any, NDArray[Any]]
) -> pd.DataFrame:
    """Return how long each region of each image was looked at.

    Parameters
    ----------
    fixations
        Of all trials.
    trials
        One row a trial: `participant`, `session`, `trial_index`, `stimulus`, and whatever else is
        to be kept, such as `target` (the label of the region that differs) and the level. With a
        column `onset_s` the time to the first fixation counts from there, else from the trial's
        first sample.
    regions
        By stimulus, a label image (height, width): 0 for the background.

    Returns
    -------
    pandas.DataFrame
        One row a trial and region: the columns of `trials`, `region` (its label), `dwell_s` (the
        sum of its fixations), `share` (of the time on all regions; NaN if none was looked at),
        `fixations`, `visits` (stays of one fixation or more in a row), `first_fixation_s` (NaN if
        it was never looked at).

    Raises
    ------
    InputError
        If a column is missing, a trial is named twice or has no gaze, or a stimulus has no regions.
    """
    shown = _shown(fixations, trials, regions)
    table = fixations.table.merge(shown[[*_KEY, "stimulus"]], on=_KEY)
    table["region"] = _labels(table, regions)
    grouped = table.groupby([*_KEY, "region"], observed=True)
    before = table.groupby(_KEY, observed=True)["region"].shift(fill_value=-1)
    stays = (table["region"] != before).groupby([table[name] for name in (*_KEY, "region")])
    times = pd.DataFrame(
        {
            "dwell_s": grouped["duration_s"].sum(),
            "fixations": grouped.size(),
            "visits": stays.sum(),
            "first_s": grouped["start_s"].min(),
        }
    ).reset_index()
    labels = {
        name: np.setdiff1d(np.unique(image), [BACKGROUND]).tolist()
        for name, image in regions.items()
    }
    every = shown.assign(region=shown["stimulus"].map(labels)).explode("region", ignore_index=True)
    every["region"] = every["region"].astype(int)
    found = every.merge(times, on=[*_KEY, "region"], how="left")
    filled = {"dwell_s": 0.0, "fixations": 0, "visits": 0}
    found = found.fillna(filled).astype({"fixations": int, "visits": int})
    found["first_fixation_s"] = found.pop("first_s") - found.pop("start_s")
    total = found.groupby(_KEY, observed=True)["dwell_s"].transform("sum")
    place = found.columns.get_loc("fixations")
    found.insert(int(str(place)), "share", found["dwell_s"] / total.where(total > 0))
    return found


@dataclass(frozen=True)
class DwellRatios:
    """Time on one region against the mean time on the others.

    Attributes
    ----------
    table
        One row a cell: the columns `by`, `ratio`, `low`, `high` (95 %), `dwell_s` (on the region),
        `others_s` (the mean over the other regions), `trials`, `participants`.
    by
        The columns that make the cells.
    participants, version
        How many in all; by which Trompe.
    """

    table: pd.DataFrame
    by: tuple[str, ...]
    participants: int
    version: str
    method: str = "ratio of sums over trials, t interval of its logarithm over participants"

    def to_frame(self) -> pd.DataFrame:
        """Return the table."""
        return self.table.copy()


def dwell_ratios(
    dwell: pd.DataFrame, by: Sequence[str], *, region: int | None = None
) -> DwellRatios:
    """Return how much longer one region was looked at than the others, as Lopez-Moreno 2011, 2.7.

    Parameters
    ----------
    dwell
        As from `dwell_times`.
    by
        The columns that make the cells, such as ``("divergence_deg",)``.
    region
        The label of the region; without it, each trial's own `target` (trials without one are left
        out).

    Raises
    ------
    InputError
        If a column is missing, or no trial has the region and another one.

    Notes
    -----
    The ratio of sums, not the mean of ratios, so that a trial in which the others were hardly
    looked at does not rule. Interval over participants by the delta method on the logarithm.
    """
    needed = [*by, *(["target"] if region is None else [])]
    missing = [name for name in needed if name not in dwell]
    if missing or not by:
        name = missing[0] if missing else "that makes the cells (by)"
        raise InputError(f"dwell: the column {name} is missing")
    trial = dwell.groupby(_KEY, observed=True)["dwell_s"]
    others_s = (trial.transform("sum") - dwell["dwell_s"]) / (trial.transform("size") - 1)
    wanted = dwell["region"] == (dwell["target"] if region is None else region)
    rows = dwell.assign(others_s=others_s)[wanted.fillna(value=False)]
    rows = rows[np.isfinite(rows["others_s"])]
    if rows.empty:
        raise InputError("dwell: no trial with that region and another one, one or more accepted")
    found = []
    for cell, part in rows.groupby(list(by), observed=True, sort=True):
        sums = part.groupby("participant", observed=True)[["dwell_s", "others_s"]].sum()
        ratio, low, high = _ratio(sums["dwell_s"].to_numpy(), sums["others_s"].to_numpy())
        found.append(
            {
                **dict(zip(by, cell, strict=True)),
                "ratio": ratio,
                "low": low,
                "high": high,
                "dwell_s": part["dwell_s"].sum(),
                "others_s": part["others_s"].sum(),
                "trials": len(part),
                "participants": len(sums),
            }
        )
    participants = rows["participant"].nunique()
    return DwellRatios(pd.DataFrame(found), tuple(by), participants, software_version())


def saccades(fixations: Fixations) -> pd.DataFrame:
    """Return the movements from each fixation to the next one of its trial.

    Returns
    -------
    pandas.DataFrame
        `participant`, `session`, `trial_index`, `start_s`, `end_s`, `duration_s`,
        `amplitude_deg`, `direction_deg` (counter-clockwise from +x, 0 to 360). Blinks between
        fixations are not told apart from movements: their duration tells.
    """
    table = fixations.table
    following = table.groupby(_KEY, observed=True).shift(-1)
    across, down = following["x_px"] - table["x_px"], following["y_px"] - table["y_px"]
    moves = table[_KEY].assign(
        start_s=table["end_s"],
        end_s=following["start_s"],
        duration_s=following["start_s"] - table["end_s"],
        amplitude_deg=np.hypot(across, down) / fixations.pixels_per_degree,
        direction_deg=np.degrees(np.arctan2(-down, across)) % 360,
    )
    return moves.dropna(subset="end_s").reset_index(drop=True)


def _shown(
    fixations: Fixations, trials: pd.DataFrame, regions: Mapping[Any, NDArray[Any]]
) -> pd.DataFrame:
    """Check the trials and return them with the time from which first fixations count."""
    missing = [name for name in (*_KEY, "stimulus") if name not in trials]
    if missing:
        raise InputError(f"trials: the column {missing[0]} is missing")
    if trials.duplicated(_KEY).any():
        raise InputError("trials: a trial is named twice, one row a trial accepted")
    unknown = sorted(map(str, set(trials["stimulus"]) - set(regions)))
    if unknown:
        raise InputError(f"regions: none given for stimulus {unknown[0]}")
    for name, image in regions.items():
        if np.ndim(image) != 2:
            raise InputError(f"regions: a label image (height, width) for {name} accepted")
    shown = trials.merge(fixations.trials[[*_KEY, "start_s"]], on=_KEY)
    if len(shown) < len(trials):
        raise InputError("trials: a trial without any gaze given")
    if "onset_s" in shown:
        shown["start_s"] = shown.pop("onset_s")
    return shown


def _labels(table: pd.DataFrame, regions: Mapping[Any, NDArray[Any]]) -> NDArray[np.int64]:
    """Return the label of the region that each fixation is on; the background if beside."""
    labels = np.full(len(table), BACKGROUND, dtype=np.int64)
    for stimulus, places in table.groupby("stimulus", observed=True).indices.items():
        image = regions[stimulus]
        row, column, inside = image_pixels(table.iloc[places], image.shape)
        labels[places[inside]] = image[row[inside], column[inside]]
    return labels


def _ratio(dwell_s: Matrix, others_s: Matrix) -> tuple[float, float, float]:
    """Return the ratio of sums with an interval over participants."""
    if others_s.sum() == 0:
        return np.nan, np.nan, np.nan
    mean, error = ratio_of_sums(dwell_s[:, None], others_s[:, None])
    ratio = float(mean[0])
    if len(dwell_s) < 2 or ratio == 0:
        return ratio, np.nan, np.nan
    reach = stats.t.ppf((1 + CONFIDENCE) / 2, len(dwell_s) - 1) * float(error[0]) / ratio
    return ratio, float(ratio * np.exp(-reach)), float(ratio * np.exp(reach))
