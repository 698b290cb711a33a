"""Who took part, in one sentence."""

from collections import Counter
from collections.abc import Sequence

from experiments.responses import Session


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
