"""Published paired comparisons: rows are preferred to columns."""

import numpy as np


def matrix(text: str) -> np.ndarray:
    """Return numbers, one line a row."""
    return np.array([line.split() for line in text.strip().splitlines()], dtype=int)


# Kendall and Babington Smith 1940, Biometrika 31, p. 326: a dog's choice among six foods (meat,
# biscuit, chocolate, apple, pear, cheese); also the example of circular() in R's package eba.
DOG = matrix(
    """
    0 1 1 0 1 1
    0 0 0 1 1 0
    0 1 0 1 1 1
    1 0 0 0 0 0
    0 0 0 1 0 1
    0 1 0 1 0 0
    """
)

# David 1988, The Method of Paired Comparisons, p. 116: four samples tasted by 15 judges; also the
# example of thurstone() in R's package eba.
TASTE = matrix(
    """
     0  3  2  2
    12  0 11  3
    13  4  0  5
    13 12 10  0
    """
)

# Rumelhart and Greeno 1971, Journal of Mathematical Psychology 8: nine celebrities, 234 people;
# also the example of strans() in R's package eba.
CELEBRITIES = matrix(
    """
      0 159 163 175 183 179 173 160 142
     75   0 138 164 172 160 156 122 122
     71  96   0 145 157 138 140 122 120
     59  70  89   0 176 115 124  86  61
     51  62  77  58   0  77  95  72  61
     55  74  96 119 157   0 134  92  71
     61  78  94 110 139 100   0  67  48
     74 112 112 148 162 142 167   0  87
     92 112 114 173 173 163 186 147   0
    """
)

# Stigler 1994, in Agresti 2002, Categorical Data Analysis, p. 448: who is cited by whom (row
# cited): Biometrika, Communications in Statistics, JASA, JRSS-B.
CITATIONS = matrix(
    """
      0 730 498 221
     33   0  68  17
    320 813   0 142
    284 276 325   0
    """
)

# Agresti 2002, table 10.10: baseball games won in 1987, at home and away together: Baltimore,
# Boston, Cleveland, Detroit, Milwaukee, New York, Toronto.
BASEBALL = matrix(
    """
     0  1  7  4  2  3  1
    12  0  7  2  6  7  6
     6  6  0  4  4  6  5
     9 11  9  0  6  5  7
    11  7  9  7  0  7  9
    10  6  7  8  6  0  6
    12  7  8  6  4  7  0
    """
)

# Guilford 1954, Psychometric Methods: how often the row's vegetable was preferred to the column's,
# in per mille of 148 people: turnips, cabbage, beets, asparagus, carrots, spinach, string beans,
# peas, corn.
VEGETABLES_PER_MILLE = matrix(
    """
    500 818 770 811 878 892 899 892 926
    182 500 601 723 743 736 811 845 858
    230 399 500 561 736 676 845 797 818
    189 277 439 500 561 588 676 601 730
    122 257 264 439 500 493 574 709 764
    108 264 324 412 507 500 628 682 628
    101 189 155 324 426 372 500 527 642
    108 155 203 399 291 318 473 500 628
     74 142 182 270 236 372 358 372 500
    """
).T
