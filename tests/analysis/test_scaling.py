import choix
import numpy as np
import pytest
import statsmodels.api as sm
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import approx_fprime
from scipy.special import expit, ndtr, ndtri

from algorithms.errors import InputError
from analysis.estimates import to_json
from analysis.paired.scale_fit import (
    MODELS,
    ModelName,
    differences,
    fit_values,
    has_maximum,
    information,
    log_likelihood,
    score,
)
from analysis.paired.scale_intervals import INTERVALS, IntervalKind, sandwich
from analysis.paired.scaling import scale_pairs
from tests.analysis.published_pairs import (
    BASEBALL,
    CELEBRITIES,
    CITATIONS,
    TASTE,
    VEGETABLES_PER_MILLE,
)
from tests.analysis.test_consistency import coins

MODEL_NAMES: tuple[ModelName, ...] = ("bradley-terry", "thurstone")
LOGIT, PROBIT = np.log(3), ndtri(0.75)


def test_the_baseball_of_agresti() -> None:
    # Published: Agresti 2002, table 10.11, to four decimals in the tests of R's BradleyTerry2.
    table = scale_pairs(BASEBALL, anchor="first").table
    np.testing.assert_allclose(
        table["jod"] * LOGIT, [0, 1.1077, 0.6839, 1.4364, 1.5814, 1.2476, 1.2945], atol=5e-5
    )
    np.testing.assert_allclose(
        table["fisher_error"] * LOGIT,
        [0, 0.3339, 0.3319, 0.3396, 0.3433, 0.3359, 0.3367],
        atol=5e-5,
    )


def test_the_citations_of_stigler() -> None:
    # Published: the tests of R's BradleyTerry2, with two anchors; R's intervals are Fisher's.
    names = ["Biometrika", "Comm Statist", "JASA", "JRSS-B"]
    result = scale_pairs(CITATIONS, items=names, anchor="JASA")
    np.testing.assert_allclose(
        result.table["jod"] * LOGIT, [0.4795698, -2.4695027, 0, 0.7485238], atol=5e-7
    )
    np.testing.assert_allclose(
        result.table["fisher_error"] * LOGIT,
        [0.06058873, 0.09817049, 0, 0.07294356],
        atol=5e-8,
    )
    centred = scale_pairs(CITATIONS).table
    np.testing.assert_allclose(
        centred["jod"] * LOGIT, [0.7899221, -2.1591504, 0.3103523, 1.0588761], atol=5e-7
    )
    np.testing.assert_allclose(
        centred["fisher_error"] * LOGIT,
        [0.04333047, 0.07257974, 0.04164102, 0.05304699],
        atol=5e-8,
    )
    assert result.anchor == "JASA"
    assert result.method.endswith(INTERVALS["fisher"])


def test_the_vegetables_of_guilford() -> None:
    # Published: Guilford 1954; the least-squares scale of thurstone() in R's package psych. The
    # likelihood weighs proportions differently, hence the tolerance.
    wins = np.rint(148 * VEGETABLES_PER_MILLE / 1000)
    np.fill_diagonal(wins, 0)
    table = scale_pairs(wins, model="thurstone", anchor="first").table
    np.testing.assert_allclose(
        table["jod"] * PROBIT, [0, 0.52, 0.65, 0.98, 1.12, 1.14, 1.40, 1.44, 1.63], atol=0.05
    )


def test_the_taste_of_david() -> None:
    # Published: David 1988, p. 116: Thurstone's case V fits (as R's package eba says).
    result = scale_pairs(TASTE, model="thurstone")
    assert result.fit_p_value > 0.05
    assert result.table.sort_values("jod")["item"].tolist() == ["1", "3", "2", "4"]


@pytest.mark.parametrize("model", MODEL_NAMES)
@pytest.mark.parametrize("wins", [BASEBALL, CITATIONS, TASTE, CELEBRITIES])
def test_agrees_with_a_generalised_linear_model(wins: np.ndarray, model: ModelName) -> None:
    # Another implementation: statsmodels, binomial with logit or probit link.
    first, second = np.triu_indices(len(wins), k=1)
    design = (np.eye(len(wins))[first] - np.eye(len(wins))[second])[:, 1:]
    link = sm.families.links.Logit() if model == "bradley-terry" else sm.families.links.Probit()
    counts = np.column_stack([wins[first, second], wins[second, first]])
    peer = sm.GLM(counts, design, family=sm.families.Binomial(link)).fit(tol=1e-12)
    ours = scale_pairs(wins, model=model, anchor="first")
    unit = MODELS[model].unit
    np.testing.assert_allclose(ours.table["jod"][1:] * unit, peer.params, atol=1e-7)
    # statsmodels' errors are from the expected information too.
    np.testing.assert_allclose(ours.table["fisher_error"][1:] * unit, peer.bse, rtol=1e-5)
    assert ours.deviance == pytest.approx(peer.deviance, rel=1e-6)
    assert ours.freedom == peer.df_resid


@pytest.mark.parametrize("wins", [BASEBALL, TASTE])
def test_agrees_with_choix(wins: np.ndarray) -> None:
    # Another implementation: two algorithms of choix.
    data = [(int(i), int(j)) for i, j in np.argwhere(wins) for _ in range(wins[i, j])]
    ours = scale_pairs(wins).table["jod"] * LOGIT
    newton = choix.opt_pairwise(len(wins), data, alpha=0, method="Newton-CG", tol=1e-10)
    spectral = choix.ilsr_pairwise(len(wins), data, alpha=0)
    np.testing.assert_allclose(ours, newton - newton.mean(), atol=1e-5)
    np.testing.assert_allclose(ours, spectral - spectral.mean(), atol=1e-5)


@pytest.mark.parametrize("model", MODEL_NAMES)
def test_one_unit_is_three_quarters(model: ModelName) -> None:
    # Theory: 75 of 100 answers are one just-objectionable difference.
    table = scale_pairs([[0, 75], [25, 0]], model=model).table
    np.testing.assert_allclose(table["jod"], [0.5, -0.5], atol=1e-9)
    assert MODELS[model].probability(np.array(MODELS[model].unit)) == pytest.approx(0.75)


@pytest.mark.parametrize("model", MODEL_NAMES)
def test_derivatives_are_those_of_the_likelihood(model: ModelName) -> None:
    # Finite differences of log-likelihood and, on average, of the score.
    chosen, values = MODELS[model], np.array([0.3, -0.7, 1.1, 0.2])
    gradient = score(TASTE.astype(float), values, chosen)

    def likelihood(at: np.ndarray) -> float:
        return float(log_likelihood(TASTE.astype(float), at, chosen))

    np.testing.assert_allclose(gradient, approx_fprime(values, likelihood, 1e-7), atol=1e-4)
    expected = 15 * chosen.probability(differences(values))  # at which information is -Hessian

    def expected_score(at: np.ndarray) -> np.ndarray:
        return score(expected * (1 - np.eye(4)), at, chosen)

    hessian = approx_fprime(values, expected_score, 1e-7)
    np.testing.assert_allclose(
        information(TASTE.astype(float), values, chosen), -hessian, atol=1e-4
    )


@pytest.mark.parametrize("model", MODEL_NAMES)
def test_known_values_come_back(model: ModelName) -> None:
    # Recovery: proportions of infinitely many answers give the values exactly.
    values = np.array([-1.5, -0.2, 0.0, 0.4, 1.3])
    chosen = MODELS[model]
    wins = chosen.probability(differences(values)) * (1 - np.eye(5))
    np.testing.assert_allclose(fit_values(wins[None], chosen)[0], values, atol=1e-8)


@pytest.mark.parametrize("model", MODEL_NAMES)
def test_many_fits_are_those_of_each_alone(model: ModelName) -> None:
    counts = np.stack([TASTE, TASTE.T, TASTE + 1 - np.eye(4), 7 * TASTE]).astype(float)
    together = fit_values(counts, MODELS[model])
    alone = [fit_values(one[None], MODELS[model])[0] for one in counts]
    np.testing.assert_allclose(together, alone, atol=1e-9)


@pytest.mark.parametrize("model", MODEL_NAMES)
def test_lopsided_counts_converge(model: ModelName) -> None:
    # A chain of near-certain answers: Newton's full steps overshoot here.
    wins = np.zeros((6, 6))
    for k in range(5):
        wins[k, k + 1], wins[k + 1, k] = 9999, 1
    wins[0, 5] = 9999
    table = scale_pairs(wins, model=model).table
    steps = -np.diff(table["jod"])
    unit = MODELS[model].unit
    expected = (np.log(9999) if model == "bradley-terry" else -ndtri(1e-4)) / unit
    np.testing.assert_allclose(steps, expected, rtol=1e-2)


def test_ties_are_half_a_win_each_and_pairs_may_be_missing() -> None:
    wins = np.array([[0, 2.5, 0], [1.5, 0, 3], [0, 1, 0]])
    result = scale_pairs(wins)
    assert result.n == 8
    assert result.freedom == 0
    assert np.isnan(result.fit_p_value)
    gaps = -np.diff(result.table["jod"]) * LOGIT
    np.testing.assert_allclose(expit(gaps), [2.5 / 4, 3 / 4], atol=1e-9)


@pytest.mark.parametrize("model", MODEL_NAMES)
@given(st.integers(2, 6), st.integers(0, 2**32 - 1))
def test_turning_answers_round_turns_the_scale_round(
    model: ModelName, items: int, seed: int
) -> None:
    generator = np.random.default_rng(seed)
    wins = generator.integers(1, 20, size=(items, items)) * (1 - np.eye(items, dtype=int))
    there = scale_pairs(wins, model=model).table["jod"]
    back = scale_pairs(wins.T, model=model).table["jod"]
    np.testing.assert_allclose(there, -back, atol=1e-7)
    order = generator.permutation(items)
    shuffled = scale_pairs(wins[np.ix_(order, order)], model=model).table["jod"]
    np.testing.assert_allclose(shuffled, there[order], atol=1e-7)


def test_where_a_maximum_exists() -> None:
    # Brute force: reachability of every item from every other by Ford 1957.
    generator = np.random.default_rng(1)
    wins = (generator.random((300, 5, 5)) < 0.3) * (1 - np.eye(5))
    expected = [bool((np.linalg.matrix_power(np.eye(5) + one, 5) > 0).all()) for one in wins]
    assert 20 < sum(expected) < 280
    assert has_maximum(wins).tolist() == expected


@pytest.mark.parametrize(
    ("wins", "message"),
    [
        ([[0, 1, 1], [0, 0, 1], [0, 1, 0]], "wins: item a won every comparison, so that no finite"),
        ([[0, 1, 0], [1, 0, 0], [1, 1, 0]], "wins: item c won every comparison"),
        ([[0, 1, 1], [1, 0, 1], [0, 0, 0]], "wins: item c lost every comparison"),
        (
            [[0, 1, 0], [1, 0, 0], [0, 0, 0]],
            r"wins: the sets of items a, b \| c were never compared",
        ),
    ],
)
def test_no_finite_scale_is_refused(wins: list[list[int]], message: str) -> None:
    with pytest.raises(InputError, match=message):
        scale_pairs(wins, items=["a", "b", "c"])
    with_prior = scale_pairs(wins, items=["a", "b", "c"], prior=1)
    assert np.isfinite(with_prior.table[["jod", "low", "high"]].to_numpy()).all()
    assert with_prior.method.startswith("maximum likelihood with 1 answers added to each pair")


def test_two_sets_where_one_beats_the_other_are_named() -> None:
    wins = np.array([[0, 1, 1, 1], [1, 0, 1, 1], [0, 0, 0, 1], [0, 0, 1, 0]])
    with pytest.raises(InputError, match="items 1, 2 won every comparison with 3, 4, so that"):
        scale_pairs(wins)


def test_a_prior_is_half_an_answer_for_either_item() -> None:
    with_prior = scale_pairs(TASTE, prior=2).table["jod"]
    by_hand = scale_pairs(TASTE + 1 - np.eye(4)).table["jod"]
    np.testing.assert_allclose(with_prior, by_hand, atol=1e-9)


def differing_observers(number: int, items: int, seed: int) -> np.ndarray:
    """Return observers who toss coins but for a taste of their own for the first item."""
    generator = np.random.default_rng(seed)
    wins = coins(generator, number, items)
    for one in np.flatnonzero(generator.random(number) < 0.5):
        wins[one, 0, 1:], wins[one, 1:, 0] = 1, 0
    return wins


@pytest.mark.parametrize("kind", ["bootstrap", "percentile", "basic", "sandwich"])
def test_intervals_over_observers_agree_with_each_other(kind: IntervalKind) -> None:
    # Theory: all of them are the same for many observers, and wider than Fisher's where these
    # differ.
    wins = differing_observers(400, 4, seed=2)
    result = scale_pairs(wins, interval=kind, generator=np.random.default_rng(3), resamples=2000)
    width = (result.table["high"] - result.table["low"]).to_numpy()
    robust = scale_pairs(wins, interval="sandwich").table
    np.testing.assert_allclose(width, robust["high"] - robust["low"], rtol=0.08)
    assert width[0] > 1.1 * 2 * 1.96 * result.table["fisher_error"][0]
    assert result.method == f"maximum likelihood; {INTERVALS[kind]}"


def test_sandwich_is_the_glms_with_clusters() -> None:
    # Another implementation: statsmodels' cluster-robust covariance of the logit model.
    wins = differing_observers(30, 4, seed=4)
    first, second = np.triu_indices(4, k=1)
    design = (np.eye(4)[first] - np.eye(4)[second])[:, 1:]
    observers = np.repeat(np.arange(30), first.size)
    peer = sm.GLM(
        wins[:, first, second].ravel(), np.tile(design, (30, 1)), family=sm.families.Binomial()
    ).fit(
        cov_type="cluster",
        cov_kwds={"groups": observers, "use_correction": False},
        tol=1e-12,
    )
    values = fit_values(wins.sum(axis=0)[None].astype(float), MODELS["bradley-terry"])[0]
    ours = sandwich(wins.astype(float), np.zeros((4, 4)), values, MODELS["bradley-terry"])
    contrast = np.eye(4)[1:] - np.eye(4)[0]
    np.testing.assert_allclose(contrast @ ours @ contrast.T, peer.cov_params() * 30 / 29, rtol=1e-5)


def test_differences_have_intervals_of_their_own() -> None:
    wins = differing_observers(40, 4, seed=5)
    result = scale_pairs(wins, generator=np.random.default_rng(6))
    assert len(result.differences) == 6
    row = result.differences.iloc[0]
    value = result.table.set_index("item")["jod"]
    assert row["jod"] == pytest.approx(value["1"] - value["2"])
    # An anchor at one item makes the other items' intervals those of the differences.
    anchored = scale_pairs(wins, anchor="2", generator=np.random.default_rng(6)).table
    assert anchored["low"][0] == pytest.approx(row["low"])
    assert (anchored["low"][1], anchored["high"][1]) == (0, 0)


def test_resamples_without_a_finite_scale_are_counted() -> None:
    # Of eight observers one alone ever preferred item 3: a third of the resamples lack that one.
    wins = np.array(
        [[[0, 1, 1], [0, 0, 1], [0, 0, 0]]] * 4 + [[[0, 0, 1], [1, 0, 1], [0, 0, 0]]] * 3
    )
    wins = np.concatenate([wins, [[[0, 1, 0], [0, 0, 0], [1, 1, 0]]]])
    result = scale_pairs(wins, generator=np.random.default_rng(7), resamples=1000)
    assert result.regularised == pytest.approx(1000 * (7 / 8) ** 8, abs=50)
    assert np.isfinite(result.table[["low", "high"]].to_numpy()).all()


@pytest.mark.parametrize("kind", ["bootstrap", "sandwich"])
def test_observers_without_spread_have_no_interval(kind: IntervalKind) -> None:
    # Theory: a circle and its reverse give every item the same score, whoever is drawn.
    circle = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    wins = [circle, circle.T] * 2
    table = scale_pairs(
        wins, interval=kind, prior=1, generator=np.random.default_rng(1), anchor="first"
    ).table
    np.testing.assert_allclose(table["jod"], 0, atol=1e-9)
    assert table["low"].isna().tolist() == [False, True, True]  # the anchor is where it is


def test_same_seed_same_result() -> None:
    wins = differing_observers(20, 5, seed=8)
    one, other = (scale_pairs(wins, generator=np.random.default_rng(9)) for _ in range(2))
    assert to_json(one) == to_json(other)
    assert (one.seed, one.resamples, one.observers) == (9, 500, 20)


def test_what_an_interval_needs() -> None:
    wins = differing_observers(20, 4, seed=10)
    assert scale_pairs(wins).method.endswith(INTERVALS["sandwich"])
    assert scale_pairs(wins).over_observers
    assert not scale_pairs(wins.sum(axis=0)).over_observers
    with pytest.raises(InputError, match="interval: 'sandwich' needs the wins of two observers"):
        scale_pairs(wins.sum(axis=0), interval="sandwich")
    with pytest.raises(InputError, match=r"generator: needed to draw observers for .* 'basic'"):
        scale_pairs(wins, interval="basic")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"model": "elo"}, "model: 'elo' given, one of bradley-terry, thurstone accepted"),
        ({"anchor": "9"}, "anchor: '9' given, mean, first or one of"),
        ({"prior": -1}, "prior: -1 given, 0 or more accepted"),
        ({"prior": float("nan")}, "prior: nan given"),
        ({"resamples": 1}, "resamples: 1 given, 2 or more accepted"),
        ({"interval": "bayes"}, "interval: 'bayes' given, one of bootstrap, percentile, basic"),
        ({"items": ["a"]}, "items: .* given, 4 different names accepted"),
    ],
)
def test_refuses(options: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        scale_pairs(TASTE, **options)  # type: ignore[arg-type]


def test_normal_and_logistic_scales_are_nearly_alike() -> None:
    # Theory: in JOD the two models differ by a few per cent over the usual range.
    logistic, normal = (scale_pairs(CELEBRITIES, model=model).table["jod"] for model in MODEL_NAMES)
    np.testing.assert_allclose(logistic, normal, atol=0.05)
    assert ndtr(PROBIT) == pytest.approx(0.75)
