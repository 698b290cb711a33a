"""Who took part: in one sentence, and as factors of the analysis."""

from collections import Counter
from collections.abc import Sequence

import pandas as pd

from experiments.responses import Session

UNDISCLOSED = "undisclosed"


def describe_participants(sessions: Sequence[Session]) -> str:
    """Return the ages, genders and artistic backgrounds that participants gave.

    Parameters
    ----------
    sessions
        Those that are analysed. Answers that were not asked for or not given are not counted.

    Returns
    -------
    str
        Such as `Ages 19 to 41 (median 25); 12 female, 11 male, 1 undisclosed; 8 with an artistic
        background.`, or nothing if nothing is known.
    """
    given = [one.demographics for one in sessions]
    parts = []
    ages = sorted(one["age"] for one in given if isinstance(one.get("age"), int))
    if ages:
        parts.append(f"ages {ages[0]} to {ages[-1]} (median {ages[len(ages) // 2]})")
    genders = Counter(str(one["gender"]) for one in given if one.get("gender"))
    if genders:
        parts.append(", ".join(f"{count} {gender}" for gender, count in sorted(genders.items())))
    artistic = [one["artistic_background"] for one in given if "artistic_background" in one]
    if artistic:
        parts.append(f"{sum(map(bool, artistic))} with an artistic background")
    sentence = "; ".join(parts)
    return f"{sentence[0].upper()}{sentence[1:]}." if sentence else ""


def join_demographics(table: pd.DataFrame, sessions: Sequence[Session]) -> pd.DataFrame:
    """Add what participants said of themselves to their answers.

    Parameters
    ----------
    table
        One row an answer, with `participant` (`analysis.trial_table`).
    sessions
        Those of the answers.

    Returns
    -------
    pandas.DataFrame
        The table with a column for each of `age` (years, float), `gender` and
        `artistic_background` (`yes` or `no`) that anybody stated; missing where a participant did
        not, or did not wish to.
    """
    said = pd.DataFrame([{"participant": one.participant, **one.demographics} for one in sessions])
    said = said.drop_duplicates("participant")
    known = said[["participant"]].copy()
    if "age" in said:
        known["age"] = pd.to_numeric(said["age"]).astype(float)
    if "gender" in said:
        known["gender"] = said["gender"].where(said["gender"] != UNDISCLOSED)
    if "artistic_background" in said:
        known["artistic_background"] = said["artistic_background"].map({True: "yes", False: "no"})
    return table.merge(known.dropna(axis=1, how="all"), on="participant", how="left")
