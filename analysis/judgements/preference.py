"""Which of two is preferred, or whether they are equivalent within a declared margin.

That no difference was found does not say that there is none. So there are three outcomes: the
share differs from one half; it is equivalent to one half within a margin declared before the
answers were seen (two one-sided tests, Schuirmann 1987); or the answers do not decide.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy import stats

from algorithms.errors import InputError
from analysis.bounded_means import p_above
from analysis.estimates import Estimate, software_version
from analysis.judgements.shares import Answers, Binomial, check_answers, share_interval
from analysis.naming import p_text

Outcome = Literal["differs", "equivalent", "undecided"]
ALPHA = 0.05
HALF = 0.5
EXACT, OVER_PARTICIPANTS = "exact binomial test", "Wilson-type t-test over participants"


@dataclass(frozen=True)
class Preference:
    """How often the first of two was preferred.

    Attributes
    ----------
    names
        What the first and the second are called.
    share, interval
        Of answers for the first, with a 95 % interval, and how that was made.
    chosen, answers, participants
        How many answers for the first, how many in all, from how many.
    p_value
        Of "preferred in one half of the answers", two-sided.
    margin
        How far from one half is equivalent, as declared in advance; None if nothing was declared.
    p_equivalence
        The larger one of two one-sided tests of "at least a margin away from one half"; None
        without a margin.
    p_holm, p_equivalence_holm, tests
        The same, corrected for the number of pairs tested together.
    alpha
        The significance.
    test, version
        How it was tested, and by which Trompe.
    """

    names: tuple[str, str]
    share: Estimate
    interval: str
    chosen: int
    answers: int
    participants: int
    p_value: float
    margin: float | None
    p_equivalence: float | None
    p_holm: float
    p_equivalence_holm: float | None
    tests: int
    alpha: float
    test: str
    version: str

    @property
    def outcome(self) -> Outcome:
        """What the tests, corrected for their number, say."""
        if self.p_holm < self.alpha:
            return "differs"
        if self.p_equivalence_holm is not None and self.p_equivalence_holm < self.alpha:
            return "equivalent"
        return "undecided"

    @property
    def sentence(self) -> str:
        """The result in plain words."""
        share = self.share
        return (
            f"{self.names[0]} was preferred to {self.names[1]} in {self.chosen} of {self.answers}"
            f" answers ({100 * share.value:.1f} %, 95 % interval {100 * share.low:.1f} % to"
            f" {100 * share.high:.1f} %): {_verdict(self)}."
        )

    def row(self) -> dict[str, object]:
        """Return the row of a table of preferences."""
        return {
            "chosen": self.chosen,
            "answers": self.answers,
            "participants": self.participants,
            **self.share.columns("share"),
            "interval": self.interval,
            "p_value": self.p_value,
            "p_holm": self.p_holm,
            "margin": self.margin,
            "p_equivalence": self.p_equivalence,
            "p_equivalence_holm": self.p_equivalence_holm,
            "outcome": self.outcome,
            "test": self.test,
        }

    def to_frame(self) -> pd.DataFrame:
        """Return the result as a table of one row."""
        return pd.DataFrame([self.row()])


def preference(
    chosen: ArrayLike,
    asked: ArrayLike | None = None,
    *,
    margin: float | None = None,
    alpha: float = ALPHA,
    names: tuple[str, str] = ("the first", "the second"),
    binomial: Binomial = "clopper-pearson",
) -> Preference:
    """Test whether one of two is preferred.

    Parameters
    ----------
    chosen
        How often each participant preferred the first, shape (participants,).
    asked
        How often each was asked; once, if left out.
    margin
        The distance from one half that is taken as equivalent, above 0 and below 0.5. Declare it
        before the answers are seen.
    alpha
        The significance of each test, above 0 and below 1.
    names
        What the two are called in sentences.
    binomial
        The interval of independent answers, see `analysis.judgements.shares.share_interval`.

    Raises
    ------
    InputError
        If the counts or an argument are impossible.

    Notes
    -----
    With one answer a participant, exact binomial tests. With several, tests over participants (see
    `analysis.bounded_means`), as answers of one participant are alike.

    Examples
    --------
    >>> preference([1] * 17 + [0] * 19, margin=0.1).outcome  # Lopez-Moreno 2011, sec. 7.5
    'undecided'
    """
    _check(margin, alpha)
    answers = check_answers(chosen, asked)
    share, interval = share_interval(answers, binomial)
    p_value, p_equivalence = _p_values(answers, margin)
    return Preference(
        names=names,
        share=share,
        interval=interval,
        chosen=int(answers.yes.sum()),
        answers=int(answers.asked.sum()),
        participants=len(answers.asked),
        p_value=p_value,
        margin=margin,
        p_equivalence=p_equivalence,
        p_holm=p_value,
        p_equivalence_holm=p_equivalence,
        tests=1,
        alpha=alpha,
        test=EXACT if answers.independent else OVER_PARTICIPANTS,
        version=software_version(),
    )


def _check(margin: float | None, alpha: float) -> None:
    if margin is not None and not 0 < margin < HALF:
        raise InputError(f"margin: {margin} given, above 0 and below 0.5 accepted")
    if not 0 < alpha < 1:
        raise InputError(f"alpha: {alpha} given, above 0 and below 1 accepted")


def _p_values(answers: Answers, margin: float | None) -> tuple[float, float | None]:
    """Return the p-values of a difference and of equivalence."""
    difference = min(1.0, 2 * min(_p_above(answers, HALF), _p_below(answers, HALF)))
    if margin is None:
        return difference, None
    return difference, max(_p_above(answers, HALF - margin), _p_below(answers, HALF + margin))


def _p_above(answers: Answers, share: float) -> float:
    if answers.independent:
        yes, asked = int(answers.yes.sum()), int(answers.asked.sum())
        return float(stats.binomtest(yes, asked, share, alternative="greater").pvalue)
    mean, error = np.array([answers.share]), np.array([answers.standard_error])
    return float(p_above(mean, error, len(answers.asked), share)[0])


def _p_below(answers: Answers, share: float) -> float:
    return _p_above(Answers(answers.asked - answers.yes, answers.asked), 1 - share)


def _verdict(result: Preference) -> str:
    difference = _p_in_words(result.p_value, result.p_holm, result.tests)
    if result.outcome == "differs":
        more = "more" if result.share.value > HALF else "less"
        within = _p_within(result, "although within")
        return f"{more} often than one half (p {difference}, {result.test}){within}"
    if result.outcome == "equivalent":
        return _p_within(result, "within").removeprefix(", ")
    if result.margin is None:
        return (
            f"no difference from one half is shown (p {difference}, {result.test}), which does not"
            " show that there is none; no margin of equivalence was declared"
        )
    equivalence = _p_in_words(result.p_equivalence, result.p_equivalence_holm, result.tests)
    return (
        f"neither a difference from one half (p {difference}, {result.test}) nor equivalence within"
        f" {100 * result.margin:g} percentage points (p {equivalence}, two one-sided tests) is"
        " shown"
    )


def _p_within(result: Preference, how: str) -> str:
    p_value, p_holm = result.p_equivalence, result.p_equivalence_holm
    if result.margin is None or p_holm is None or p_holm >= result.alpha:
        return ""
    return (
        f", {how} the margin of {100 * result.margin:g} percentage points around one half that was"
        f" declared in advance (p {_p_in_words(p_value, p_holm, result.tests)}, two one-sided"
        " tests)"
    )


def _p_in_words(p_value: float | None, p_holm: float | None, tests: int) -> str:
    if p_value is None or p_holm is None:
        return ""
    corrected = f"; for {tests} pairs together p {p_text(p_holm)}" if tests > 1 else ""
    return p_text(p_value) + corrected
