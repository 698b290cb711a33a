import choix
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from statsmodels.discrete.conditional_models import ConditionalLogit

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.bounded_means import Flags
from analysis.estimates import to_json
from analysis.ranking.plackett_luce import PlackettLuceScale, plackett_luce
from benchmarks.ranking import LOG_WORTHS, covered_scale, draw_rankings


def column(scale: PlackettLuceScale, name: str) -> Matrix:
    """Return a column in the order of the ranks' columns."""
    table = scale.table.assign(number=scale.table["item"].astype(int)).sort_values("number")
    return np.asarray(table[name], dtype=float)


@pytest.fixture(scope="module")
def ranks() -> Matrix:
    return np.asarray(draw_rankings(LOG_WORTHS, 25, 1, np.random.default_rng(3))[0])


def test_agrees_with_choix(ranks: Matrix) -> None:
    orders = [np.argsort(row).tolist() for row in ranks]
    found = column(plackett_luce(ranks), "log_worth")
    np.testing.assert_allclose(found, choix.ilsr_rankings(5, orders), atol=1e-5)
    np.testing.assert_allclose(found, choix.opt_rankings(5, orders), atol=1e-4)


def test_agrees_with_a_conditional_logit(ranks: Matrix) -> None:
    # Another implementation, of estimates, errors and likelihood: each rank is a choice among the
    # items left (the "exploded logit"); differences to item 1.
    chosen: list[Flags] = []
    design: list[Matrix] = []
    choice: list[Matrix] = []
    for row in ranks:
        for rank in range(1, 5):
            left = np.flatnonzero(row >= rank)
            design.append(np.eye(5)[left][:, 1:])
            chosen.append(row[left] == rank)
            choice.append(np.full(len(left), float(len(choice))))
    model = ConditionalLogit(
        np.concatenate(chosen).astype(int),
        np.concatenate(design),
        groups=np.concatenate(choice),
    )
    fit = model.fit(method="newton", disp=False)
    scale = plackett_luce(ranks)
    worth = column(scale, "log_worth")
    np.testing.assert_allclose(worth[1:] - worth[0], fit.params, atol=1e-5)
    assert scale.log_likelihood == pytest.approx(fit.llf, abs=1e-6)
    # The covariance of log worths with mean 0 follows from that of the differences.
    spread = np.vstack([np.zeros(4), np.eye(4)])
    spread -= spread.mean(axis=0)
    errors = np.sqrt(np.diag(spread @ fit.cov_params() @ spread.T))
    np.testing.assert_allclose(column(scale, "standard_error"), errors, rtol=1e-3)


def test_two_items_have_the_log_odds() -> None:
    # Theory: 14 of 20 prefer the first.
    scale = plackett_luce([[1, 2]] * 14 + [[2, 1]] * 6)
    worth = column(scale, "log_worth")
    assert worth[0] - worth[1] == pytest.approx(np.log(14 / 6))
    assert 2 * column(scale, "standard_error")[0] == pytest.approx(np.sqrt(1 / 14 + 1 / 6))
    np.testing.assert_allclose(column(scale, "first"), [0.7, 0.3])


def test_recovers_known_worths() -> None:
    ranks = draw_rankings(LOG_WORTHS, 20_000, 1, np.random.default_rng(4))[0]
    found = column(plackett_luce(ranks), "log_worth")
    np.testing.assert_allclose(found, LOG_WORTHS - LOG_WORTHS.mean(), atol=0.05)


@settings(deadline=None, max_examples=50)
@given(st.integers(2, 12), st.integers(2, 7), st.integers(0, 2**32 - 1))
def test_expected_choices_are_those_made(participants: int, items: int, seed: int) -> None:
    # Property: at the maximum the probability of being chosen sums to the number of choices; with
    # pseudo-rankings there is a maximum whatever the rankings.
    generator = np.random.default_rng(seed)
    ranks = np.array([generator.permutation(items) + 1.0 for _ in range(participants)])
    scale = plackett_luce(ranks, pseudo_rankings=1e-3)
    worth = np.exp(column(scale, "log_worth"))
    expected = np.zeros(items)
    for row in ranks:
        for rank in range(1, items):
            left = row >= rank
            expected[left] += worth[left] / worth[left].sum()
    np.testing.assert_allclose(expected, (ranks < items).sum(axis=0), atol=2e-3)
    assert column(scale, "log_worth").sum() == pytest.approx(0, abs=1e-9)


def test_names_items_that_are_always_ahead() -> None:
    ranks = [[1, 2, 3, 4], [2, 1, 4, 3], [1, 2, 4, 3]]
    with pytest.raises(InputError, match=r"ranks: every ranking has a, b ahead of all other items"):
        plackett_luce(ranks, items=list("abcd"))
    with pytest.raises(InputError, match="pseudo_rankings: -1 given, 0 or more accepted"):
        plackett_luce(ranks, pseudo_rankings=-1)
    scale = plackett_luce(ranks, pseudo_rankings=0.5)
    assert np.isfinite(scale.table[["low", "high"]].to_numpy()).all()
    assert "NaN" not in to_json(scale)


def test_counts_resamples_without_a_maximum() -> None:
    # One of eight puts the second item first: without that one there is no maximum,
    # which has a probability of (7 / 8) ** 8 = 0.34.
    ranks = [[1, 2]] * 7 + [[2, 1]]
    scale = plackett_luce(ranks, generator=np.random.default_rng(5), resamples=4000)
    missing = (7 / 8) ** 8
    assert scale.unbounded == pytest.approx(missing, abs=4 * np.sqrt(missing / 4000))
    assert np.isfinite(scale.table["high_bootstrap"]).all()


def test_bootstrap_is_that_of_single_fits(ranks: Matrix) -> None:
    # Another way: each resample fitted alone.
    scale = plackett_luce(ranks, generator=np.random.default_rng(6), resamples=150)
    drawn = np.random.default_rng(6).multinomial(25, np.full(25, 1 / 25), size=150)
    alone = [
        column(plackett_luce(np.repeat(ranks, counts, axis=0)), "log_worth") for counts in drawn
    ]
    low, high = np.percentile(alone, [2.5, 97.5], axis=0)
    np.testing.assert_allclose(column(scale, "low_bootstrap"), low, atol=1e-6)
    np.testing.assert_allclose(column(scale, "high_bootstrap"), high, atol=1e-6)


@pytest.mark.slow
def test_intervals_hold_the_log_worth() -> None:
    # Recovery: 200 repetitions of 30 participants and five items.
    covered = covered_scale(30, 200, np.random.default_rng(7))
    assert covered["over_participants"] == pytest.approx(0.95, abs=0.025)
    assert covered["bootstrap"] > 0.9
