"""Whether rates are above chance, by a test that fits how the answers were given."""

import numpy as np
from scipy import stats

from analysis.bootstrap import Sums
from analysis.bounded_means import p_above, ratio_of_sums

EXACT_TEST = "exact binomial"
CLUSTER_TEST = "score test over participants"


def rates_above(sums: Sums, chance: float) -> tuple[list[float], list[str]]:
    """Return one-sided p-values of "no more often than by chance", and the test of each cell.

    Parameters
    ----------
    sums
        Hits and answers by participant and cell.
    chance
        The rate by chance, 0 or more and below 1.

    Returns
    -------
    p_values, tests
        One entry a cell.

    Notes
    -----
    Exact binomial where each participant answered a cell once, so that answers are independent,
    and for a single participant, of whom it then speaks. Else a score test with the cluster-robust
    error of the rate (as of a generalised estimating equation with independence as working
    correlation) and t with one degree of freedom fewer than participants.
    """
    rates, errors = ratio_of_sums(sums.totals, sums.counts)
    p_values, tests = [], []
    for cell, (hits, answers) in enumerate(zip(sums.totals.T, sums.counts.T, strict=True)):
        if answers.max() <= 1 or len(answers) == 1 or chance == 0:
            exact = stats.binomtest(int(hits.sum()), int(answers.sum()), chance, "greater")
            p_values.append(float(exact.pvalue))
            tests.append(EXACT_TEST)
            continue
        asked = int(np.count_nonzero(answers))
        p_values.append(float(p_above(rates[[cell]], errors[[cell]], asked, chance)[0]))
        tests.append(CLUSTER_TEST)
    return p_values, tests
