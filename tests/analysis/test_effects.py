from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
import statsmodels.api as sm
from scipy.special import expit
from statsmodels.genmod.cov_struct import Independence

from algorithms.errors import InputError
from analysis.answers.participants import join_demographics
from analysis.answers.trials import trial_table
from analysis.estimates import to_json
from analysis.multiplicity import holm
from analysis.rates.effect_sentences import dependence_sentence, effect_sentences
from analysis.rates.effects import hit_effects, odds_effects, time_effects
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.analysis.answers import rows_of, sessions_of

LEVELS = (10.0, 20.0, 30.0, 40.0)
PLACEMENTS = ("front", "back")
MATERIALS = ("diffuse", "shiny", "matte")


def answers(
    people: int,
    seed: int,
    *,
    artist_odds: float = 0.0,
    back_odds: float = 0.0,
    shiny_time: float = 0.0,
    spread: float = 0.6,
) -> pd.DataFrame:
    """Answers with known effects on the log-odds of a right answer and on the log of the time."""
    generator = np.random.default_rng(seed)
    design = pd.MultiIndex.from_product(
        [range(people), LEVELS, PLACEMENTS, MATERIALS],
        names=["participant", "level", "placement", "material"],
    ).to_frame(index=False)
    own = generator.normal(0, spread, people)[design["participant"]]
    artist = design["participant"] % 3 == 0
    log_odds = -2.2 + 0.08 * design["level"] + own
    log_odds += artist_odds * artist + back_odds * (design["placement"] == "back")
    log_time = 2 + own + shiny_time * (design["material"] == "shiny")
    return design.assign(
        participant=design["participant"].map("P{:03d}".format),
        placement=pd.Categorical(design["placement"], categories=PLACEMENTS),
        artistic_background=np.where(artist, "yes", "no"),
        age=generator.integers(18, 60, people)[design["participant"]],
        answer=1,
        correct=generator.binomial(1, expit(log_odds)).astype(bool),
        reaction_time_s=np.exp(log_time + generator.normal(0, 0.5, len(design))),
    )


FACTORS = ("level", "placement", "material", "artistic_background", "age")


def test_odds_ratios_are_those_of_statsmodels() -> None:
    # Another implementation: statsmodels' GEE by formula, independence as working correlation.
    table = answers(40, 1, artist_odds=0.7, back_odds=0.4)
    found = hit_effects(table, ("level", "placement", "material")).contrasts
    reference = sm.GEE.from_formula(
        "right ~ level + C(placement) + C(material)",
        "participant",
        table.assign(right=table["correct"].astype(int)),
        family=sm.families.Binomial(),
        cov_struct=Independence(),
    ).fit(ctol=1e-10)
    names = ["level", "C(placement)[T.back]", "C(material)[T.matte]", "C(material)[T.shiny]"]
    steps = np.array([10, 1, 1, 1])
    np.testing.assert_allclose(np.log(found["ratio"]), reference.params[names] * steps, rtol=1e-5)
    lengths = np.log(found["ratio_high"] / found["ratio_low"])
    expected = 2 * 2.02 * reference.bse[names] * steps
    np.testing.assert_allclose(lengths, expected, rtol=0.05)


def test_difference_of_hit_rates_is_that_of_statsmodels() -> None:
    # Another implementation: the average marginal effect of a factor with two values.
    table = answers(40, 1, back_odds=0.5)
    rows = hit_effects(table, ("level", "placement")).contrasts.set_index("factor")
    fit = sm.GEE(
        table["correct"].astype(float),
        np.column_stack([np.ones(len(table)), table["level"], table["placement"] == "back"]).astype(
            float
        ),
        groups=table["participant"],
        family=sm.families.Binomial(),
        cov_struct=Independence(),
    ).fit(ctol=1e-10)
    margins = fit.get_margeff(dummy=True)
    placement = rows.loc["placement"]
    assert placement["difference"] == pytest.approx(margins.margeff[-1], rel=1e-4)
    length = placement["difference_high"] - placement["difference_low"]
    assert length == pytest.approx(2 * 2.02 * margins.margeff_se[-1], rel=0.05)


def test_between_participants_the_difference_is_that_of_their_mean_rates() -> None:
    # Theory: alone in the model, a factor's difference is the raw one of the two groups.
    table = answers(30, 2, artist_odds=0.8)
    row = hit_effects(table, ("artistic_background",)).contrasts.iloc[0]
    rates = table.groupby("artistic_background")["correct"].mean()
    assert row["difference"] == pytest.approx(rates["yes"] - rates["no"])
    assert row["contrast"] == "yes against no"


def test_recovers_effects_of_images_and_of_people() -> None:
    # Recovery. The odds ratio is a mean over people, so it is a little nearer to 1 than theirs.
    table = answers(150, 3, artist_odds=0.8, back_odds=0.5, spread=0.3)
    effects = hit_effects(table, FACTORS)
    rows = effects.contrasts.set_index("factor")
    for factor, truth in (("placement", 0.5), ("artistic_background", 0.8)):
        assert rows.loc[factor, "ratio_low"] < np.exp(truth) < rows.loc[factor, "ratio_high"]
    p_values = effects.tests.set_index("factor")["p_holm"]
    assert (p_values[["level", "placement", "artistic_background"]] < 0.01).all()
    assert (p_values[["material", "age"]] > 0.05).all()
    assert effects.tests.set_index("factor")["varies"].to_dict() == {
        "level": "within",
        "placement": "within",
        "material": "within",
        "artistic_background": "between",
        "age": "between",
    }


def test_times_recover_a_ratio_of_geometric_means() -> None:
    table = answers(60, 4, shiny_time=0.3)
    effects = time_effects(table, ("placement", "material", "artistic_background"))
    row = effects.contrasts[effects.contrasts["contrast"] == "shiny against diffuse"].iloc[0]
    assert row["ratio_low"] < np.exp(0.3) < row["ratio_high"]
    logs = np.log(table["reaction_time_s"]).groupby(table["material"]).mean()
    assert np.log(row["ratio"]) == pytest.approx(logs["shiny"] - logs["diffuse"])
    assert "difference" not in effects.contrasts.columns
    assert effects.quantity == "time per answer"


def test_families_are_stated_and_corrected() -> None:
    effects = hit_effects(answers(30, 5), FACTORS)
    assert effects.family.name == "hit rate by factor"
    assert effects.family.size == 5
    np.testing.assert_allclose(effects.tests["p_holm"], holm(effects.tests["p_value"]))
    frame = effects.to_frame()
    assert len(frame) == len(effects.contrasts)
    assert "p_holm" in frame
    assert "CR2" in effects.method
    assert '"family"' in to_json(effects)


def test_those_of_whom_something_is_unknown_still_tell_of_the_images() -> None:
    table = answers(20, 6)
    unknown = table["participant"].isin(["P001", "P004"])
    table["artistic_background"] = table["artistic_background"].mask(unknown)
    effects = hit_effects(table, ("placement", "artistic_background"))
    people = effects.tests.set_index("factor")["participants"]
    assert people.to_dict() == {"placement": 20, "artistic_background": 18}
    assert effects.left_out == {"artistic_background": "unknown for 2 participants, left out"}
    alone = hit_effects(table, ("placement",)).contrasts.iloc[0]
    pd.testing.assert_series_equal(effects.contrasts.iloc[0], alone)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"extra": "one"}, "only one value, one"),
        ({"extra": np.nan}, "unknown for all participants"),
        ({"extra": lambda t: t["placement"]}, "cannot be told from the factors before it"),
        ({"extra": lambda t: t["participant"]}, "fewer than two groups of two participants"),
        (
            {"extra": lambda t: np.where(t.index == 0, "rare", "usual")},
            "rare: answered by one participant",
        ),
        (
            {
                "extra": lambda t: np.where(t["level"] > 30, "easy", "hard"),
                "correct": lambda t: t["correct"] | (t["level"] > 30),
            },
            "all answers are right at easy: no odds exist",
        ),
    ],
)
def test_a_factor_of_which_nothing_can_be_told_is_left_out_with_the_reason(
    change: dict[str, Any], reason: str
) -> None:
    table = answers(12, 7).assign(**change)
    effects = hit_effects(table, ("placement", "extra"))
    assert effects.tests["factor"].tolist() == ["placement"]
    assert effects.left_out["extra"].startswith(reason)


def test_a_group_of_one_person_is_left_out_with_the_reason() -> None:
    table = answers(13, 8)
    table["gender"] = table["participant"].map(
        lambda name: "other" if name == "P000" else ("female", "male")[int(name[1:]) % 2]
    )
    effects = hit_effects(table, ("placement", "gender"))
    assert effects.left_out == {"gender": "other: one participant, left out"}
    assert effects.contrasts["contrast"].tolist() == ["back against front", "male against female"]


def test_more_values_than_participants_have_no_test() -> None:
    table = answers(4, 9)
    table["kind"] = np.arange(len(table)) % 6
    effects = hit_effects(table.assign(kind=table["kind"].astype(str)), ("kind",))
    assert np.isnan(effects.tests["p_value"].item())
    assert effects.family.size == 0
    assert "too few participants for a test" in effect_sentences(effects)[0]
    assert dependence_sentence(effects).endswith("too few participants to test what it depends on.")


def test_what_single_participants_determine_has_no_interval_and_no_test() -> None:
    # Theory: a line through two people's rates leaves nothing to judge it by; its spread is 0,
    # which would be the surest of all tests.
    two = answers(2, 12).assign(age=lambda t: np.where(t["participant"] == "P000", 20.0, 40.0))
    effects = hit_effects(two, ("level", "age"))
    age = effects.contrasts.set_index("factor").loc["age"]
    assert np.isnan(age[["ratio_low", "ratio_high", "difference_low"]].to_numpy(float)).all()
    assert np.isfinite(age["ratio"])
    p_values = effects.tests.set_index("factor")["p_value"]
    assert np.isfinite(p_values["level"])
    assert np.isnan(p_values["age"])
    assert "[nan" not in " ".join(effect_sentences(effects))


def test_effects_within_stand_where_those_between_cannot_be_told() -> None:
    table = answers(6, 13, back_odds=1.0)
    table["club"] = np.where(table["participant"] < "P003", "a", "b")
    table["correct"] |= table["club"] == "a"
    effects = hit_effects(table, ("level", "club"))
    assert effects.tests["factor"].tolist() == ["level"]
    assert effects.left_out["club"] == "all answers are right at a: no odds exist"


def test_one_sentence_for_each_factor() -> None:
    table = answers(60, 10, artist_odds=1.2)
    table["extra"] = "same"
    effects = hit_effects(table, ("level", "artistic_background", "age", "extra"))
    sentences = effect_sentences(effects, {"level": "divergence"}, {"level": "deg"})
    assert sentences[0].startswith("Hit rate by divergence: per 10 deg +")
    assert " percentage points [" in sentences[1]
    assert "by Holm's correction for 3 factors." in sentences[1]
    assert sentences[2].endswith("No difference can be told; that does not show there is none.")
    assert sentences[3] == "Hit rate by extra: only one value, same."


def test_one_sentence_for_all_factors() -> None:
    effects = hit_effects(answers(60, 10, artist_odds=1.2), ("level", "artistic_background", "age"))
    told = dict(zip(effects.tests["factor"], effects.tests["p_holm"] < 0.05, strict=True))
    assert told["level"]
    assert not told["age"]
    found, not_found = dependence_sentence(effects, {"level": "divergence"}).split("; ")
    assert found.startswith("Hit rate depends on divergence")
    assert found.endswith("(p < 0.05 by Holm's correction for 3 factors)")
    assert "age is found, which does not show that there is none." in not_found
    assert ("artistic background" in found) == told["artistic_background"]
    assert ("artistic background" in not_found) != told["artistic_background"]


def test_demographics_join_the_answers(study: Study, drawn_set: StimulusSet) -> None:
    rows = rows_of(study, drawn_set, 4, seed=1)
    table = trial_table(rows, study, drawn_set)
    said = [
        {"age": 20, "gender": "female", "artistic_background": True},
        {"age": 30, "gender": "undisclosed", "artistic_background": False},
        {"age": 40, "gender": "male", "artistic_background": False},
        {"age": 50, "gender": "male", "artistic_background": True},
    ]
    sessions = [
        replace(one, demographics=own) for one, own in zip(sessions_of(rows), said, strict=True)
    ]
    joined = join_demographics(table, sessions)
    assert len(joined) == len(table)
    first = joined.drop_duplicates("participant").sort_values("participant")
    assert first["age"].tolist() == [20, 30, 40, 50]
    assert first["artistic_background"].tolist() == ["yes", "no", "no", "yes"]
    assert first["gender"].isna().tolist() == [False, True, False, False]
    plain = join_demographics(table, sessions_of(rows))
    assert not {"age", "gender", "artistic_background"} & set(plain.columns)


def test_refuses() -> None:
    table = answers(5, 11)
    with pytest.raises(InputError, match="factors: 'colour' given, columns of the table"):
        hit_effects(table, ("level", "colour"))
    with pytest.raises(InputError, match="factors: 'level' given, the names of one or more"):
        hit_effects(table, "level")
    with pytest.raises(InputError, match=r"factors: \(\) given"):
        hit_effects(table, ())
    with pytest.raises(InputError, match="participants: 1 left to compare, two or more"):
        hit_effects(table[table["participant"] == "P000"], ("level",))
    with pytest.raises(InputError, match="no answered trial that has a right answer"):
        hit_effects(table[:0], ("level",))
    with pytest.raises(InputError, match="all 120 answers are alike in correct"):
        hit_effects(table.assign(correct=True), ("level",))
    with pytest.raises(InputError, match=r"factors: none can be estimated \(same: only one"):
        hit_effects(table.assign(same=1), ("same",))
    with pytest.raises(InputError, match="no answer with a time"):
        time_effects(table.assign(reaction_time_s=np.nan), ("level",))
    with pytest.raises(InputError, match="all 120 answers took equally long"):
        time_effects(table.assign(reaction_time_s=2.0), ("level",))
    with pytest.raises(InputError, match="reaction_time_s: 0 or less given"):
        time_effects(table.assign(reaction_time_s=0.0), ("level",))
    with pytest.raises(InputError, match="table: the column participant is missing"):
        hit_effects(table.drop(columns="participant"), ("level",))
    with pytest.raises(InputError, match="factors: age has infinite values"):
        hit_effects(table.assign(age=np.inf), ("age",))
    with pytest.raises(InputError, match="they separate right from wrong"):
        odds_effects(table.assign(high=table["level"] > 20), "high", ("level",), "share of high")
