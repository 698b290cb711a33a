"""Signal detection: how well photographs are told from processed images, whatever the bias.

A photograph called real is a hit, a processed image called real a false alarm. Sensitivity d' is
the distance between what the two evoke, in its standard deviations: 0 if they cannot be told
apart. The criterion c is where "real" begins: below 0 for people who call most images real.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy import stats
from scipy.special import ndtri

from algorithms.errors import InputError
from analysis.bootstrap import PERCENTILES, RESAMPLES, Matrix
from analysis.estimates import CONFIDENCE, Estimate, seed_of, software_version

Correction = Literal["log-linear", "none"]
MEASURES = ("d_prime", "criterion", "log_beta")
FEWEST_TRIALS = 5  # of both kinds, for the sensitivity of a single participant


@dataclass(frozen=True)
class Sensitivity:
    """How well two kinds of images are told apart, over all answers and by participant.

    Attributes
    ----------
    d_prime, criterion, log_beta
        Over all answers, with 95 % intervals over participants: ``z(H) - z(F)``,
        ``-(z(H) + z(F)) / 2`` and their product, the logarithm of the likelihood ratio at the
        criterion.
    bootstrap
        The same with percentile intervals over resampled participants, by name; empty without a
        generator.
    standard_errors
        Of the three for independent answers (Gourevitch and Galanter 1967), by name.
    hit_rate, false_alarm_rate
        As observed, before any correction.
    hits, signals, false_alarms, noises
        Photographs called real of all photographs shown, and processed images of all those.
    by_participant
        One row a participant with five trials of both kinds or more: `participant` (its number
        from 0), `d_prime`, `criterion`, `log_beta`.
    mean_d_prime
        The mean of those with its t interval; NaN for fewer than two. Pooling answers of people
        with different criteria makes d' too small; this does not.
    correction
        How rates were kept from 0 and 1.
    participants, resamples, seed, version
        How many answered; of the bootstrap, its generator, and Trompe.
    """

    d_prime: Estimate
    criterion: Estimate
    log_beta: Estimate
    bootstrap: dict[str, Estimate]
    standard_errors: dict[str, float]
    hit_rate: float
    false_alarm_rate: float
    hits: int
    signals: int
    false_alarms: int
    noises: int
    by_participant: pd.DataFrame
    mean_d_prime: Estimate
    correction: Correction
    participants: int
    resamples: int
    seed: int | None
    version: str
    method: str = "d' of pooled answers, cluster-robust interval over participants"

    def row(self) -> dict[str, object]:
        """Return the row of a table of sensitivities."""
        row: dict[str, object] = {
            name: getattr(self, name)
            for name in ("hits", "signals", "false_alarms", "noises", "participants")
        }
        for name in MEASURES:
            row |= getattr(self, name).columns(name)
            row[f"{name}_standard_error"] = self.standard_errors[name]
        for name, estimate in self.bootstrap.items():
            row[f"{name}_low_bootstrap"] = estimate.low
            row[f"{name}_high_bootstrap"] = estimate.high
        return {**row, **self.mean_d_prime.columns("mean_d_prime"), "correction": self.correction}

    def to_frame(self) -> pd.DataFrame:
        """Return the result as a table of one row."""
        return pd.DataFrame([self.row()])


def sensitivity(
    hits: ArrayLike,
    signals: ArrayLike,
    false_alarms: ArrayLike,
    noises: ArrayLike,
    *,
    correction: Correction = "log-linear",
    generator: np.random.Generator | None = None,
    resamples: int = RESAMPLES,
) -> Sensitivity:
    """Return sensitivity and bias of yes-no answers.

    Parameters
    ----------
    hits, signals, false_alarms, noises
        One entry a participant, or one number each: signals (photographs) called real and shown,
        noises (processed images) called real and shown.
    correction
        `log-linear`: half an answer is added to both kinds, one to their numbers, always (Hautus
        1995: always, as correcting extreme rates only would bias comparisons); `none`: rates of 0
        and 1 are refused.
    generator
        Draws participants for bootstrap intervals, which are left out without it.
    resamples
        How many times.

    Raises
    ------
    InputError
        If the counts or an argument are impossible.

    Notes
    -----
    Green and Swets 1966; Macmillan and Creelman 2005, chs. 1, 2 and 13. Intervals over
    participants by the delta method with t; for a single participant, or single numbers, from the
    standard errors of Gourevitch and Galanter and the normal distribution.

    Examples
    --------
    >>> found = sensitivity(20, 25, 10, 25, correction="none")
    >>> round(found.d_prime.value, 3), round(found.criterion.value, 3)
    (1.095, -0.294)
    """
    counts = _check(hits, signals, false_alarms, noises, correction)
    totals = counts.sum(axis=1)
    values, slopes, rates = _measures(totals, correction)
    errors = _standard_errors(totals, slopes, rates)
    participants = counts.shape[1]
    reach = _reach(counts, slopes, errors)
    alone = _by_participant(counts, correction)
    drawn = _bootstrap(counts, generator, resamples)
    d_prime, criterion, log_beta = (
        Estimate(float(value), float(value - half), float(value + half))
        for value, half in zip(values, reach, strict=True)
    )
    return Sensitivity(
        d_prime=d_prime,
        criterion=criterion,
        log_beta=log_beta,
        bootstrap={
            name: Estimate(float(value), float(low), float(high))
            for name, value, (low, high) in zip(MEASURES, values, drawn, strict=False)
        },
        standard_errors=dict(zip(MEASURES, errors.tolist(), strict=True)),
        hit_rate=float(totals[0] / totals[1]),
        false_alarm_rate=float(totals[2] / totals[3]),
        hits=int(totals[0]),
        signals=int(totals[1]),
        false_alarms=int(totals[2]),
        noises=int(totals[3]),
        by_participant=alone,
        mean_d_prime=_mean(np.asarray(alone["d_prime"], dtype=float)),
        correction=correction,
        participants=participants,
        resamples=resamples if len(drawn) else 0,
        seed=seed_of(generator) if generator is not None else None,
        version=software_version(),
    )


def _check(
    hits: ArrayLike,
    signals: ArrayLike,
    false_alarms: ArrayLike,
    noises: ArrayLike,
    correction: Correction,
) -> Matrix:
    """Return the four counts, shape (4, participants)."""
    if correction not in ("log-linear", "none"):
        raise InputError(f"correction: {correction!r} given, 'log-linear' or 'none' accepted")
    names = ("hits", "signals", "false_alarms", "noises")
    arrays = []
    for name, values in zip(names, (hits, signals, false_alarms, noises), strict=True):
        try:
            array = np.atleast_1d(np.asarray(values, dtype=float))
        except (TypeError, ValueError):
            raise InputError(f"{name}: not a sequence of numbers") from None
        if array.ndim != 1 or not np.all((array >= 0) & (array % 1 == 0)):
            raise InputError(f"{name}: one whole number of 0 or more for each participant accepted")
        arrays.append(array)
    if len({array.size for array in arrays}) > 1:
        sizes = ", ".join(str(array.size) for array in arrays)
        raise InputError(f"{', '.join(names)}: {sizes} entries given, as many of each accepted")
    counts = np.stack(arrays)
    for yes, shown in ((0, 1), (2, 3)):
        if np.any(counts[yes] > counts[shown]):
            raise InputError(f"{names[yes]}: more than {names[shown]} given")
        if not counts[shown].any():
            raise InputError(f"{names[shown]}: none given, one or more accepted")
    return counts


def _measures(counts: Matrix, correction: Correction) -> tuple[Matrix, Matrix, Matrix]:
    """Return d', c and ln beta of counts, shape (4, ...), with their slopes by the two rates.

    Returns
    -------
    values, slopes, rates
        Shapes (3, ...), (3, 2, ...) and (2, ...).
    """
    extra = 0.5 if correction == "log-linear" else 0.0
    rates = np.stack(
        [
            (counts[0] + extra) / (counts[1] + 2 * extra),
            (counts[2] + extra) / (counts[3] + 2 * extra),
        ]
    )
    if np.any((rates <= 0) | (rates >= 1)):
        raise InputError(
            "hits, false_alarms: all or none of the images called real, accepted with"
            " correction='log-linear' only"
        )
    z = np.asarray(ndtri(rates))
    density = np.exp(-(z**2) / 2) / np.sqrt(2 * np.pi)
    values = np.stack([z[0] - z[1], -(z[0] + z[1]) / 2, (z[1] ** 2 - z[0] ** 2) / 2])
    ones = np.ones_like(z[0])
    by_z = np.stack(
        [np.stack([ones, -ones]), np.stack([-ones, -ones]) / 2, np.stack([-z[0], z[1]])]
    )
    return values, by_z / density, rates


def _standard_errors(totals: Matrix, slopes: Matrix, rates: Matrix) -> Matrix:
    """Return the errors of Gourevitch and Galanter 1967: the delta method on binomial rates."""
    variances = rates * (1 - rates) / totals[[1, 3]]
    return np.asarray(np.sqrt(slopes**2 @ variances))


def _reach(counts: Matrix, slopes: Matrix, errors: Matrix) -> Matrix:
    """Return half the length of the intervals: over participants, or of one over its answers."""
    participants = counts.shape[1]
    if participants < 2:
        return np.asarray(stats.norm.ppf((1 + CONFIDENCE) / 2) * errors)
    yes, shown = counts[[0, 2]], counts[[1, 3]]
    total = shown.sum(axis=1, keepdims=True)
    apart = (yes - yes.sum(axis=1, keepdims=True) / total * shown) / total
    variance = ((slopes @ apart) ** 2).sum(axis=1) * participants / (participants - 1)
    t = stats.t.ppf((1 + CONFIDENCE) / 2, participants - 1)
    return np.asarray(t * np.sqrt(variance))


def _by_participant(counts: Matrix, correction: Correction) -> pd.DataFrame:
    enough = (counts[1] >= FEWEST_TRIALS) & (counts[3] >= FEWEST_TRIALS)
    if correction == "none":
        rates = counts[[0, 2]] / np.maximum(counts[[1, 3]], 1)
        enough &= ((rates > 0) & (rates < 1)).all(axis=0)
    values, _, _ = _measures(counts[:, enough], correction)
    table = pd.DataFrame(dict(zip(MEASURES, values, strict=True)))
    table.insert(0, "participant", np.flatnonzero(enough))
    return table


def _mean(values: Matrix) -> Estimate:
    if len(values) < 2:
        return Estimate(*[float("nan")] * 3)
    error = values.std(ddof=1) / np.sqrt(len(values))
    reach = stats.t.ppf((1 + CONFIDENCE) / 2, len(values) - 1) * error
    mean = values.mean()
    return Estimate(float(mean), float(mean - reach), float(mean + reach))


def _bootstrap(counts: Matrix, generator: np.random.Generator | None, resamples: int) -> Matrix:
    """Return the ends of the intervals, shape (3, 2); none without a generator."""
    participants = counts.shape[1]
    if generator is None or participants < 2:
        return np.empty((0, 2))
    if resamples < 1:
        raise InputError(f"resamples: {resamples} given, 1 or more accepted")
    chosen = generator.multinomial(
        participants, np.full(participants, 1 / participants), size=resamples
    )
    # Rates of 0 or 1 may arise in resamples whatever the answers were.
    values, _, _ = _measures(counts @ chosen.T, "log-linear")
    return np.percentile(values, PERCENTILES, axis=1).T
