"""Is it real? How often images are judged real, and how well they are told from photographs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from algorithms.errors import InputError
from analysis.bootstrap import RESAMPLES, Sums, sum_by_participant
from analysis.estimates import seed_of, software_version
from analysis.judgements.detection import Correction, Sensitivity, sensitivity
from analysis.judgements.shares import share_table

PHOTOGRAPH, PROCESSED, UNTOLD = "photograph", "processed", "image"


@dataclass(frozen=True)
class Realism:
    """How images of several conditions are judged.

    Attributes
    ----------
    table
        One row a condition and kind of image: the columns `by`, `kind` (`photograph`, `processed`,
        or `image` where that is not told), `yes` (judged real), `answers`, `participants`,
        `share`, `low`, `high` (95 %), `interval` (how it was made).
    conditions
        The factor levels of each condition that has a sensitivity: one row for each entry of
        `sensitivities`.
    sensitivities
        How well each condition's images are told from all the photographs; none where there are
        no photographs. They share the photographs, so they are not independent of each other.
    by
        The columns that make the conditions.
    participants, n
        How many gave how many answers.
    seed, version
        Of the bootstrap's generator, and of Trompe.
    """

    table: pd.DataFrame
    conditions: pd.DataFrame
    sensitivities: tuple[Sensitivity, ...]
    by: tuple[str, ...]
    participants: int
    n: int
    seed: int | None
    version: str
    method: str = "share judged real; d' with photographs as signals"

    def to_frame(self) -> pd.DataFrame:
        """Return the table of shares."""
        return self.table.copy()

    def sensitivity_frame(self) -> pd.DataFrame:
        """Return one row a condition with its sensitivity and bias."""
        rows = pd.DataFrame([each.row() for each in self.sensitivities])
        return pd.concat([self.conditions, rows], axis=1)


def realism(
    table: pd.DataFrame,
    by: Sequence[str],
    *,
    answer: str = "answer",
    photograph: str | None = None,
    correction: Correction = "log-linear",
    generator: np.random.Generator | None = None,
    resamples: int = RESAMPLES,
) -> Realism:
    """Return how often images are judged real, and how well they are told from photographs.

    Parameters
    ----------
    table
        One row an answer: `participant`, the columns `by`, and those named below.
    by
        The columns that make the conditions, such as ``("method",)``.
    answer
        The column that says whether the image was judged real: true or 1; rows where it is missing
        are left out.
    photograph
        The column that says whether it is a true photograph (true or 1), if there are any. Answers
        where it is missing have a share but no sensitivity.
    correction, generator, resamples
        As in `analysis.sensitivity`.

    Raises
    ------
    InputError
        If a column is missing, an answer is neither 0 nor 1, or nothing was answered.
    """
    answered = _answered(table, by, answer, photograph)
    sums = sum_by_participant(answered, "answer", [*by, "kind"])
    conditions, sensitivities = _sensitivities(sums, by, correction, generator, resamples)
    return Realism(
        table=share_table(sums),
        conditions=conditions,
        sensitivities=sensitivities,
        by=tuple(by),
        participants=len(sums.totals),
        n=len(answered),
        seed=seed_of(generator) if generator is not None else None,
        version=software_version(),
    )


def _answered(
    table: pd.DataFrame, by: Sequence[str], answer: str, photograph: str | None
) -> pd.DataFrame:
    """Return the answered rows: `participant`, the columns `by`, `answer` as 0 or 1, `kind`."""
    judged = [answer] if photograph is None else [answer, photograph]
    missing = [name for name in ("participant", *by, *judged) if name not in table]
    if missing:
        raise InputError(f"table: the column {missing[0]} is missing")
    if not by:
        raise InputError("by: none given, one column or more that make the conditions accepted")
    rows = table[table[answer].notna()]
    if rows.empty:
        raise InputError("table: nothing to analyse, there is no answer")
    for name in judged:
        if not rows[name].dropna().isin([0, 1]).all():
            raise InputError(f"table: in column {name} true, false, 1, 0 or nothing accepted")
    kinds = pd.Series(UNTOLD, index=rows.index)
    if photograph is not None:
        is_photograph = rows[photograph].astype("Float64")
        kinds[(is_photograph == 1).fillna(value=False)] = PHOTOGRAPH
        kinds[(is_photograph == 0).fillna(value=False)] = PROCESSED
    return rows[["participant", *by]].assign(answer=rows[answer].astype(float), kind=kinds)


def _sensitivities(
    sums: Sums,
    by: Sequence[str],
    correction: Correction,
    generator: np.random.Generator | None,
    resamples: int,
) -> tuple[pd.DataFrame, tuple[Sensitivity, ...]]:
    photographs = (sums.cells["kind"] == PHOTOGRAPH).to_numpy()
    processed = np.flatnonzero(sums.cells["kind"] == PROCESSED)
    if not photographs.any():
        processed = processed[:0]
    found = tuple(
        sensitivity(
            sums.totals[:, photographs].sum(axis=1),
            sums.counts[:, photographs].sum(axis=1),
            sums.totals[:, cell],
            sums.counts[:, cell],
            correction=correction,
            generator=generator,
            resamples=resamples,
        )
        for cell in processed
    )
    return sums.cells.loc[processed, list(by)].reset_index(drop=True), found
