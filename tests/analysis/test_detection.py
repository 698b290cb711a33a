import re
from typing import Any

import numpy as np
import pytest
import statsmodels.api as sm
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import ndtr, ndtri

from algorithms.errors import InputError
from analysis.estimates import to_json
from analysis.judgements.detection import sensitivity
from benchmarks.judgements import covered_d_prime


@pytest.mark.parametrize(
    ("hit_rate", "false_alarm_rate", "d_prime", "criterion", "beta"),
    [
        # Macmillan and Creelman 2005, ch. 1 and 2: recognition of 20 of 25 and 10 of 25 faces.
        (0.80, 0.40, 1.095, -0.295, None),
        # Schneider, Short notes on the theory of signal detection: three observers.
        (0.70, 0.10, 1.806, None, 1.981),
        (0.50, 0.40, 0.253, None, 1.033),
        (0.85, 0.05, 2.681, None, 2.261),
        # By the table of the normal distribution: z(0.99) = 2.326, z(0.84) = 0.994.
        (0.99, 0.01, 4.653, 0.0, 1.0),
        (0.84, 0.16, 1.989, 0.0, 1.0),
    ],
)
def test_published_values(
    hit_rate: float,
    false_alarm_rate: float,
    d_prime: float,
    criterion: float | None,
    beta: float | None,
) -> None:
    found = sensitivity(100 * hit_rate, 100, 100 * false_alarm_rate, 100, correction="none")
    assert found.d_prime.value == pytest.approx(d_prime, abs=1e-3)
    if criterion is not None:
        assert found.criterion.value == pytest.approx(criterion, abs=1e-3)
    if beta is not None:
        assert np.exp(found.log_beta.value) == pytest.approx(beta, abs=2e-3)
    assert found.log_beta.value == pytest.approx(found.d_prime.value * found.criterion.value)


def test_errors_are_those_of_a_probit_regression() -> None:
    # Another implementation (DeCarlo 1998): d' is the slope of a probit regression on the kind of
    # image, c minus its intercept where kinds are coded -1/2 and 1/2; errors and, clustered by
    # participant, robust errors.
    generator = np.random.default_rng(1)
    people, shown = 30, 8
    criteria = generator.normal(-0.2, 0.5, people)
    yes = [generator.binomial(shown, ndtr(side * 0.5 - criteria)) for side in (1, -1)]
    found = sensitivity(yes[0], [shown] * people, yes[1], [shown] * people, correction="none")
    answer, kind, who = [], [], []
    for side, counts in zip((0.5, -0.5), yes, strict=True):
        for person, count in enumerate(counts):
            answer += [1] * int(count) + [0] * (shown - int(count))
            kind += [side] * shown
            who += [person] * shown
    family = sm.families.Binomial(link=sm.families.links.Probit())
    model = sm.GLM(np.array(answer), sm.add_constant(np.array(kind)), family=family)
    fit = model.fit()
    assert found.d_prime.value == pytest.approx(fit.params[1], rel=1e-6)
    assert found.criterion.value == pytest.approx(-fit.params[0], rel=1e-6)
    assert found.standard_errors["d_prime"] == pytest.approx(fit.bse[1], rel=1e-6)
    assert found.standard_errors["criterion"] == pytest.approx(fit.bse[0], rel=1e-6)
    robust = model.fit(cov_type="cluster", cov_kwds={"groups": who, "use_correction": False})
    scale = 2.045 * np.sqrt(people / (people - 1))  # t with 29 degrees of freedom
    for name, error in (("d_prime", robust.bse[1]), ("criterion", robust.bse[0])):
        interval = getattr(found, name)
        assert (interval.high - interval.low) / 2 == pytest.approx(scale * error, rel=1e-3)


def test_errors_are_the_spread_of_repetitions() -> None:
    # Theory by simulation: Gourevitch and Galanter's errors, many trials.
    generator = np.random.default_rng(2)
    hits, alarms = generator.binomial(400, 0.8, 4000), generator.binomial(250, 0.3, 4000)
    z_hits, z_alarms = ndtri(hits / 400), ndtri(alarms / 250)
    found = sensitivity(320, 400, 75, 250, correction="none")
    spreads = {
        "d_prime": np.std(z_hits - z_alarms),
        "criterion": np.std((z_hits + z_alarms) / 2),
        "log_beta": np.std((z_alarms**2 - z_hits**2) / 2),
    }
    for name, spread in spreads.items():
        assert found.standard_errors[name] == pytest.approx(spread, rel=0.04)


def test_log_linear_correction_as_published() -> None:
    # Hautus 1995: (hits + 0.5) / (signals + 1), whatever the rates are.
    found = sensitivity(10, 10, 0, 20)
    assert found.d_prime.value == pytest.approx(ndtri(10.5 / 11) - ndtri(0.5 / 21))
    assert found.hit_rate == 1
    assert found.false_alarm_rate == 0
    found = sensitivity(8, 10, 6, 20)
    assert found.d_prime.value == pytest.approx(ndtri(8.5 / 11) - ndtri(6.5 / 21))


def test_pooled_answers_of_differing_criteria_hide_sensitivity() -> None:
    # Theory (Macmillan and Creelman 2005, ch. 13): pooled d' is d' / sqrt(1 + variance of criteria)
    # while the mean of the participants' own is not touched.
    generator = np.random.default_rng(3)
    people, shown, spread = 400, 400, 1.0
    criteria = generator.normal(0, spread, people)
    yes = [generator.binomial(shown, ndtr(side * 0.6 - criteria)) for side in (1, -1)]
    found = sensitivity(yes[0], [shown] * people, yes[1], [shown] * people)
    assert found.d_prime.value == pytest.approx(1.2 / np.sqrt(2), abs=0.05)
    assert found.mean_d_prime.value == pytest.approx(1.2, abs=0.03)
    assert len(found.by_participant) == people


def test_participants_with_few_trials_have_none_of_their_own() -> None:
    found = sensitivity([4, 1, 3], [5, 4, 6], [1, 1, 2], [5, 9, 6])
    assert found.by_participant["participant"].tolist() == [0, 2]
    alone = sensitivity(4, 5, 1, 5)
    assert found.by_participant["d_prime"].iloc[0] == pytest.approx(alone.d_prime.value)
    assert np.isnan(alone.mean_d_prime.value)
    assert "NaN" not in to_json(alone)


@given(st.integers(1, 50), st.integers(1, 50), st.data())
def test_calling_things_by_the_other_name_turns_the_bias(
    signals: int, noises: int, data: st.DataObject
) -> None:
    # Property: with "processed" for "real", d' stays and the criterion changes its sign.
    hits = data.draw(st.integers(0, signals))
    alarms = data.draw(st.integers(0, noises))
    one = sensitivity(hits, signals, alarms, noises)
    other = sensitivity(noises - alarms, noises, signals - hits, signals)
    assert one.d_prime.value == pytest.approx(other.d_prime.value, abs=1e-9)
    assert one.criterion.value == pytest.approx(-other.criterion.value, abs=1e-9)


def test_bootstrap_is_seeded_and_optional() -> None:
    counts = ([7, 8, 5, 9], [10] * 4, [2, 3, 1, 4], [10] * 4)
    first, second = (sensitivity(*counts, generator=np.random.default_rng(5)) for _ in range(2))
    assert first.bootstrap == second.bootstrap
    assert first.bootstrap["d_prime"].low < first.d_prime.value < first.bootstrap["d_prime"].high
    assert (first.seed, first.resamples) == (5, 2000)
    none = sensitivity(*counts)
    assert none.bootstrap == {}
    assert (none.seed, none.resamples) == (None, 0)


def test_intervals_hold_the_sensitivity() -> None:
    # Recovery: 600 repetitions of 30 participants with differing criteria, binomial error 0.009.
    found = covered_d_prime(30, 6, 600, np.random.default_rng(6))
    assert found["d_prime_over_participants"] == pytest.approx(0.95, abs=0.025)
    assert found["criterion_over_participants"] == pytest.approx(0.95, abs=0.025)
    # What independent answers would give is too narrow for the criterion.
    assert found["criterion_independent_answers"] < 0.9


@pytest.mark.parametrize(
    ("counts", "message"),
    [
        ((3, 2, 1, 4), "hits: more than signals given"),
        ((1, 2, 5, 4), "false_alarms: more than noises given"),
        ((0, 0, 1, 4), "signals: none given, one or more accepted"),
        ((0, 2, 0, 0), "noises: none given, one or more accepted"),
        ((1.5, 2, 1, 4), "hits: one whole number of 0 or more for each participant accepted"),
        ((1, float("nan"), 1, 4), "signals: one whole number of 0 or more for each participant"),
        (("a", 2, 1, 4), "hits: not a sequence of numbers"),
        (([1, 1], [2, 2], [1], [4]), "hits, signals, false_alarms, noises: 2, 2, 1, 1 entries"),
    ],
)
def test_refuses_impossible_counts(counts: tuple[Any, ...], message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        sensitivity(*counts)


def test_refuses() -> None:
    with pytest.raises(InputError, match="hits, false_alarms: all or none of the images called"):
        sensitivity(4, 4, 1, 4, correction="none")
    with pytest.raises(InputError, match="correction: 'half' given"):
        sensitivity(3, 4, 1, 4, correction="half")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="resamples: 0 given, 1 or more accepted"):
        sensitivity([1, 2], [3, 3], [1, 1], [3, 3], generator=np.random.default_rng(1), resamples=0)
