import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from statsmodels.genmod.cov_struct import Independence
from statsmodels.genmod.generalized_estimating_equations import GEE

from analysis.bounded_means import mean_interval, p_above, ratio_of_sums

SHARES = st.floats(0.02, 0.98)
ERRORS = st.floats(0.0, 0.2)
PARTICIPANTS = st.integers(2, 60)


def test_is_wilsons_interval_for_many_independent_answers() -> None:
    # Another implementation: scipy's Wilson interval; t and normal agree for many answers.
    answers = 20_000
    chosen = np.array([40.0, 9000.0, 19_990.0])
    share = chosen / answers
    low, high = mean_interval(share, np.sqrt(share * (1 - share) / answers), answers)
    for place, k in enumerate(chosen):
        wilson = stats.binomtest(int(k), answers).proportion_ci(0.95, method="wilson")
        assert low[place] == pytest.approx(wilson.low, rel=2e-4)
        assert high[place] == pytest.approx(wilson.high, rel=2e-4)


def test_is_clopper_and_pearsons_where_all_agree() -> None:
    # Published method: for 12 of 12 the lower end is 0.025 ** (1 / 12).
    low, high = mean_interval(np.array([1.0, 0.0]), np.zeros(2), 12)
    np.testing.assert_allclose(low, [0.025 ** (1 / 12), 0], atol=1e-12)
    np.testing.assert_allclose(high, [1, 1 - 0.025 ** (1 / 12)])
    # All give rank 2 of 3: the few others may be anywhere from 1 to 3.
    few = 1 - 0.025 ** (1 / 12)
    low, high = mean_interval(np.array([2.0]), np.zeros(1), 12, (1, 3))
    np.testing.assert_allclose((low[0], high[0]), (2 - few, 2 + few))


@given(SHARES, ERRORS, PARTICIPANTS, st.floats(1.0, 9.0))
def test_stays_within_bounds_and_around_the_mean(
    share: float, error: float, participants: int, span: float
) -> None:
    mean = np.array([2 + span * share])
    low, high = mean_interval(mean, np.array([error]), participants, (2, 2 + span))
    assert 2 - 1e-9 <= low[0] <= mean[0] + 1e-9
    assert mean[0] - 1e-9 <= high[0] <= 2 + span + 1e-9


@given(SHARES, ERRORS, PARTICIPANTS, st.floats(0.05, 0.95), st.sampled_from([0.01, 0.05, 0.2]))
def test_interval_excludes_what_the_test_rejects(
    share: float, error: float, participants: int, value: float, alpha: float
) -> None:
    # Theory: a test and the interval that inverts it.
    arguments = (np.array([share]), np.array([error]), participants)
    low, high = mean_interval(*arguments, confidence=1 - 2 * alpha)
    if min(abs(low[0] - value), abs(high[0] - value)) > 1e-9:
        assert (p_above(*arguments, value)[0] < alpha) == (low[0] > value)
        turned = (1 - arguments[0], *arguments[1:])
        assert (p_above(*turned, 1 - value)[0] < alpha) == (high[0] < value)


def test_test_is_the_sign_test_where_all_agree() -> None:
    # Theory: all of nine participants always prefer the same: 0.5 ** 9.
    assert p_above(np.ones(1), np.zeros(1), 9, 0.5)[0] == pytest.approx(0.5**9)
    assert p_above(np.zeros(1), np.zeros(1), 9, 0.5)[0] == 1


def test_nothing_follows_from_one_participant() -> None:
    assert np.isnan(mean_interval(np.ones(1), np.zeros(1), 1)).all()
    assert np.isnan(p_above(np.ones(1), np.zeros(1), 1, 0.5)).all()


def test_error_of_a_ratio_is_that_of_estimating_equations() -> None:
    # Another implementation: statsmodels' GEE, independence, identity link; its robust error has
    # no correction for the number of participants.
    generator = np.random.default_rng(1)
    asked = generator.integers(1, 9, size=(25, 1))
    chosen = generator.binomial(asked, generator.beta(2, 2, size=(25, 1)))
    totals, counts = np.asarray(chosen, float), np.asarray(asked, float)
    mean, error = ratio_of_sums(totals, counts)
    answers = np.concatenate(
        [np.repeat([1.0, 0.0], [k, n - k]) for k, n in np.hstack([totals, counts]).astype(int)]
    )
    people = np.repeat(np.arange(25), counts[:, 0].astype(int))
    model = GEE(answers, np.ones(len(answers)), groups=people, cov_struct=Independence())
    fit = model.fit(cov_type="robust")
    assert mean[0] == pytest.approx(fit.params[0])
    assert error[0] == pytest.approx(fit.bse[0] * np.sqrt(25 / 24))


@pytest.mark.parametrize(("participants", "answers"), [(16, 3), (16, 18), (30, 6), (44, 4)])
def test_interval_holds_the_share_of_differing_participants(
    participants: int, answers: int
) -> None:
    # Recovery: participants' own shares are beta-distributed, their correlation is 0.1.
    generator = np.random.default_rng(2)
    for share in (0.5, 0.8):
        own = generator.beta(9 * share, 9 * (1 - share), size=(participants, 4000))
        mean, error = ratio_of_sums(
            np.asarray(generator.binomial(answers, own), float), np.full(own.shape, float(answers))
        )
        low, high = mean_interval(mean, error, participants)
        assert 0.93 <= ((low <= share) & (share <= high)).mean() <= 0.975
