"""Adaptive designs: what their procedures find, against theory and known parameters."""

from collections import Counter
from itertools import pairwise, product
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.errors import InputError
from experiments.planning.adaptive.active_pairs import ScalePosterior
from experiments.planning.adaptive.quest_plus import QuestPlusTrack
from experiments.planning.adaptive.staircase import StaircaseTrack, staircase_target
from experiments.planning.course import course_of, next_trial
from experiments.planning.presentations import Answer, Assignment
from experiments.planning.trials import planned_trials
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.observers import Observer, psychometric_function
from experiments.simulated.simulation import simulate_rows
from experiments.study import Study
from experiments.study_parts import QuestPlus, Staircase
from stimuli.manifest import StimulusSet
from tests.adaptive_studies import active_study, adaptive_study, answered
from tests.comparison_studies import comparison_study

LEVELS = tuple(float(level) for level in range(0, 101, 4))


# Targets as printed: Levitt 1971, table 1; Kaernbach 1991 (75 % with steps up three times as long).
@pytest.mark.parametrize(
    ("rule", "printed"),
    [
        (Staircase(down=2, up=1), 0.707),
        (Staircase(down=3, up=1), 0.794),
        (Staircase(down=1, up=1), 0.5),
        (Staircase(down=1, up=2), 0.293),
        (Staircase(down=1, up=1, up_factor=3), 0.75),
    ],
)
def test_a_staircase_settles_at_its_target(rule: Staircase, printed: float) -> None:
    target = staircase_target(rule)
    assert target == pytest.approx(printed, abs=5e-4)
    rule = rule.model_copy(update={"steps": (2, 1), "trials": 1000})
    generator = np.random.default_rng(1971)
    shares, levels = [], []
    for _ in range(10):
        track = StaircaseTrack(rule, LEVELS)
        right = []
        while not track.done:
            level = track.choose()
            p = float(psychometric_function(level, 50, 60, 0.0, 0.0))
            right.append(bool(generator.random() < p))
            track.learn(level, right=right[-1])
        shares.append(np.mean(right[50:]))
        levels.append(float(track.estimate()["estimate"] or 0))
    # In the balance of steps the share of right answers itself is the target.
    assert np.mean(shares) == pytest.approx(target, abs=0.025)
    at_estimate = psychometric_function(np.mean(levels), 50, 60, 0.0, 0.0)
    assert float(at_estimate) == pytest.approx(target, abs=0.04)


def test_quest_plus_chooses_and_learns_as_its_formulas_say() -> None:
    """Against the definition, written out over outcomes: expected entropy, then Bayes' rule."""
    rule = QuestPlus(thresholds=5, widths=(10.0, 40.0), lapse_rates=(0.0, 0.05))
    track = QuestPlusTrack(rule, LEVELS, 0.125)
    grid = np.array(list(product((0, 25, 50, 75, 100), (10.0, 40.0), (0.0, 0.05))))
    belief = np.full(len(grid), 1 / len(grid))
    for right in (True, False, False, True, True, False):
        left = {}
        for level in LEVELS:
            p = psychometric_function(level, grid[:, 0], grid[:, 1], 0.125, grid[:, 2])
            left[level] = 0.0
            for likely in (p, 1 - p):
                after = belief * likely
                chance = after.sum()
                with np.errstate(divide="ignore", invalid="ignore"):
                    left[level] -= np.nansum(after * np.log(after / chance))
        level = track.choose()
        assert left[level] == pytest.approx(min(left.values()), abs=1e-8)
        p = psychometric_function(level, grid[:, 0], grid[:, 1], 0.125, grid[:, 2])
        belief = belief * (p if right else 1 - p)
        belief /= belief.sum()
        track.learn(level, right=right)
        assert track.estimate()["estimate"] == pytest.approx(belief @ grid[:, 0])


def test_quest_plus_finds_thresholds_with_fewer_trials_than_constant_levels() -> None:
    """Recovery: after a third of the trials its error is still the smaller one."""
    generator = np.random.default_rng(2017)
    rule = QuestPlus(trials=30)
    errors: dict[str, list[float]] = {"adaptive": [], "constant": []}
    for _ in range(60):
        threshold = generator.uniform(20, 80)
        for kind, trials in (("adaptive", 30), ("constant", 90)):
            track = QuestPlusTrack(rule, LEVELS, 0.125)
            for number in range(trials):
                level = track.choose() if kind == "adaptive" else LEVELS[number % len(LEVELS)]
                p = float(psychometric_function(level, threshold, 25, 0.125, 0.02))
                track.learn(level, right=bool(generator.random() < p))
            errors[kind].append(float(track.estimate()["estimate"] or 0) - threshold)
    rms = {kind: float(np.sqrt(np.mean(np.square(each)))) for kind, each in errors.items()}
    assert rms["adaptive"] < rms["constant"]
    assert rms["adaptive"] < 6
    assert abs(np.mean(errors["adaptive"])) < 2


def entropy_bits(p: NDArray[np.float64]) -> NDArray[np.float64]:
    return -(p * np.log2(p) + (1 - p) * np.log2(1 - p))


def test_information_of_a_pair_is_the_mutual_information() -> None:
    """Against integration over the posterior's difference, for few and for many comparisons."""
    generator = np.random.default_rng(3)
    nodes, weights = np.polynomial.hermite_e.hermegauss(61)
    weights = weights / weights.sum()
    for count in (0, 3, 30):
        wins = generator.poisson(count, (4, 4)).astype(float)
        np.fill_diagonal(wins, 0)
        posterior = ScalePosterior(wins, spread=1.5)
        covariance = posterior.covariance
        for i, j in ((0, 1), (2, 3)):
            sd = np.sqrt(covariance[i, i] + covariance[j, j] - 2 * covariance[i, j])
            mean = posterior.qualities[i] - posterior.qualities[j]
            p = psychometric_function(mean + sd * nodes, 0, 2 * 1.6448536, 0, 0)
            p = np.clip(p, 1e-12, 1 - 1e-12)
            exact = entropy_bits(np.atleast_1d(weights @ p))[0] - weights @ entropy_bits(p)
            assert posterior.information()[i, j] == pytest.approx(exact, abs=0.012)


def test_qualities_are_the_most_likely_ones() -> None:
    """The slope of the log posterior, by finite differences, is zero there."""
    wins = np.array([[0, 8, 3], [2, 0, 6], [1, 1, 0]], float)
    best = ScalePosterior(wins, spread=2.0).qualities

    def log_posterior(q: np.ndarray) -> float:
        p = psychometric_function(q[:, None] - q, 0, 2 * 1.6448536269514722, 0, 0)
        return float((wins * np.log(p)).sum() - (q**2).sum() / 8)

    for place in range(3):
        step = 1e-4 * np.eye(3)[place]
        assert log_posterior(best + step) - log_posterior(best - step) == pytest.approx(0, abs=1e-8)


@pytest.mark.parametrize("kind", ["staircase", "quest-plus", "active-pairs"])
def test_the_same_answers_lead_to_the_same_trials(
    study: Study, drawn_set: StimulusSet, kind: str
) -> None:
    """One course led on by its answers, and anew from all answers before each trial: the same."""
    asked = adaptive_study(study, kind)
    course = course_of(asked, drawn_set, Assignment(5))
    answers: dict[int, Answer] = {}
    generator = np.random.default_rng(5)
    while (trial := course.next) is not None:
        assert next_trial(asked, drawn_set, Assignment(5), answers) == trial
        answers[trial.index] = answered(asked, drawn_set, trial, generator)
        course.take(trial.index, answers[trial.index])
    assert next_trial(asked, drawn_set, Assignment(5), answers) is None
    assert course_of(asked, drawn_set, Assignment(5), answers).trials == course.trials
    assert course_of(asked, drawn_set, Assignment(6), answers).trials != course.trials
    assert len(course.trials) <= course.limit
    assert all(left.stimuli != right.stimuli for left, right in pairwise(course.trials))
    assert {image for trial in course.trials for image in trial.stimuli} <= set(
        course_of(asked, drawn_set, Assignment(5)).possible
    )
    with pytest.raises(InputError, match="another answer"):
        course.take(3, None if answers[3] is not None else 1)
    with pytest.raises(InputError, match="not decided yet"):
        course.take(len(course.trials), 1)


def test_tracks_of_conditions_are_interleaved_and_end_by_their_rule(
    study: Study, drawn_set: StimulusSet
) -> None:
    asked = adaptive_study(study, "quest-plus", quest_plus={"trials": 30, "sd": 9.0})
    course = course_of(asked, drawn_set, Assignment(1))
    generator = np.random.default_rng(1)
    while (trial := course.next) is not None:
        course.take(trial.index, answered(asked, drawn_set, trial, generator))
    decisions = [course.decision(trial.index) for trial in course.trials if trial.phase == "main"]
    tracks = [str(each["track"]) for each in decisions if each is not None]
    assert set(tracks) == {"placement=front", "placement=back", "placement=front-back"}
    assert tracks[:9] != sorted(tracks[:9])
    told = course.estimates()
    assert told is not None
    estimates = told["estimates"]
    for name, found in estimates.items():
        assert found["sd"] <= 9.0 or found["trials"] == 30
        assert found["trials"] == Counter(tracks)[name]
    assert any(found["trials"] < 30 for found in estimates.values())


def with_answer(stimuli: StimulusSet, answer: int) -> StimulusSet:
    """Return a set with the same right answer everywhere."""
    content = stimuli.model_dump()
    for stimulus in content["stimuli"]:
        stimulus["answer"] = answer
    return StimulusSet.model_validate(content)


def test_judgements_of_single_images_adapt_to_what_is_right(
    study: Study, drawn_set: StimulusSet
) -> None:
    """Yes or no: all images are edited, and seen to be so the more often the higher the level."""
    content = comparison_study(study, "yes-no").model_dump(mode="json")
    design = {"kind": "quest-plus", "seed": 5, "quest_plus": {"trials": 150}}
    level = {"level": "divergence_deg", "conditions": []}
    asked = Study.model_validate(
        content | {"design": design, "stimuli": content["stimuli"] | level}
    )
    edited = with_answer(drawn_set, 0)
    rows = simulate_rows(asked, edited, Observer(40, 30), 1, np.random.default_rng(1))
    course = course_of(asked, edited, Assignment(1), {row.trial_index: row.answer for row in rows})
    (found,) = (course.estimates() or {})["estimates"].values()
    assert found["estimate"] == pytest.approx(40, abs=2.5 * found["sd"])
    assert found["sd"] < 5
    with pytest.raises(InputError, match="no main stimulus has a right answer"):
        course_of(asked, with_answer(drawn_set, 5), Assignment(1))


def test_pairs_adapt_by_how_far_they_lie_apart(study: Study, drawn_set: StimulusSet) -> None:
    """Recovery: 75 % prefer the image with 30 degrees more, so 84.1 % that with 44 degrees more."""
    content = active_study(study).model_dump(mode="json")
    asked = Study.model_validate(
        content
        | {"design": {"kind": "staircase", "seed": 5, "staircase": {"down": 4, "trials": 60}}}
        | {"stimuli": content["stimuli"] | {"level": "divergence_deg", "conditions": ["material"]}}
        | {"practice": {"trials": 0, "best_first": [str(level) for level in range(90, -1, -10)]}}
    )
    observer = ItemObserver({str(level): level / 30 for level in range(0, 91, 10)}, lapse_rate=0)
    rows = simulate_rows(asked, drawn_set, observer, 8, np.random.default_rng(1))
    found, higher_first = [], []
    for number in range(1, 9):
        own = [row for row in rows if row.participant == f"P{number:04d}"]
        answers = {row.trial_index: row.answer for row in own}
        course = course_of(asked, drawn_set, Assignment(number), answers)
        for trial in course.trials:
            first, second = (drawn_set[each].factors for each in trial.stimuli)
            levels = [float(each["divergence_deg"]) for each in (first, second)]
            assert (course.decision(trial.index) or {})["level"] == abs(levels[0] - levels[1])
            assert first["material"] == second["material"]
            higher_first.append(levels[0] > levels[1])
        found += [each["estimate"] for each in (course.estimates() or {})["estimates"].values()]
    assert len(found) == 16
    assert np.mean(found) == pytest.approx(44, abs=5)
    assert np.mean(higher_first) == pytest.approx(0.5, abs=0.06)
    with pytest.raises(ValueError, match=r"practice\.best_first: missing"):
        Study.model_validate(asked.model_dump(mode="json") | {"practice": {"trials": 0}})


def test_active_pairs_cover_every_image_then_ask_what_is_unknown(
    study: Study, drawn_set: StimulusSet
) -> None:
    asked = active_study(study, trials=25, each_image=2)
    course = course_of(asked, drawn_set, Assignment(1))
    generator = np.random.default_rng(1)
    while (trial := course.next) is not None:
        course.take(trial.index, answered(asked, drawn_set, trial, generator))
    main = [trial.stimuli for trial in course.trials if trial.phase == "main"]
    assert len(main) == 25
    assert len({frozenset(pair) for pair in main}) == 25
    often = Counter(image for pair in main for image in pair)
    assert set(often) == set(course_of(asked, drawn_set, Assignment(1)).possible)
    assert min(often.values()) >= 2
    left = Counter(pair[0] for pair in main)
    assert all(abs(2 * left[image] - count) <= 2 for image, count in often.items())
    reasons = [(course.decision(n) or {})["reason"] for n in range(len(main))]
    assert reasons == sorted(reasons)
    assert set(reasons) == {"coverage", "information"}


def test_catch_trials_stand_among_active_pairs_and_teach_nothing(
    study: Study, drawn_set: StimulusSet
) -> None:
    content = active_study(study, trials=20).model_dump(mode="json")
    catch = {"better": "90", "worse": "0", "trials": 1}
    caught = Study.model_validate(
        content
        | {"catch": catch, "exclusion": {"least_catch_share": 0.5}}
        | {"stimuli": content["stimuli"] | {"only": {"material": ["diffuse"]}}}
    )
    places = set()
    for number in range(1, 9):
        course = course_of(caught, drawn_set, Assignment(number))
        assert course.limit == 21
        while (trial := course.next) is not None:
            course.take(trial.index, 1)
        (place,) = (trial.index for trial in course.trials if trial.phase == "catch")
        levels = [drawn_set[e].factors["divergence_deg"] for e in course.trials[place].stimuli]
        assert set(levels) == {0, 90}
        assert course.decision(place) is None
        counts = [(course.decision(n) or {}).get("comparisons") for n in range(21) if n != place]
        assert counts == list(range(20))
        places.add(place)
    assert len(places) > 3


def test_what_others_answered_changes_what_is_asked(study: Study, drawn_set: StimulusSet) -> None:
    asked = active_study(study, trials=10, each_image=1)
    images = sorted(course_of(asked, drawn_set, Assignment(1)).possible)
    settled = images[:4]
    pool = tuple(
        (better, worse, 40)
        for place, better in enumerate(settled)
        for worse in settled[place + 1 :]
    )
    course = course_of(asked, drawn_set, Assignment(1, pool))
    generator = np.random.default_rng(1)
    while (trial := course.next) is not None:
        assert not set(trial.stimuli) <= set(settled)
        course.take(trial.index, answered(asked, drawn_set, trial, generator))


@pytest.mark.parametrize(
    ("kind", "design", "message"),
    [
        ("staircase", {"staircase": {"down": 0}}, r"design\.staircase\.down"),
        ("staircase", {"staircase": {"steps": []}}, r"design\.staircase\.steps"),
        ("staircase", {"quest_plus": {}}, r"design\.quest_plus"),
        ("staircase", {"blocks": "placement"}, r"design\.blocks"),
        ("quest-plus", {"quest_plus": {"sd": 0}}, r"design\.quest_plus\.sd"),
        ("quest-plus", {"quest_plus": {"widths": [-1.0]}}, r"design\.quest_plus\.widths"),
        ("quest-plus", {"repeats": 2}, r"design\.repeats"),
        ("active-pairs", {"active_pairs": None}, r"design\.active_pairs: missing"),
        ("active-pairs", {"active_pairs": {"trials": 0}}, r"design\.active_pairs\.trials"),
    ],
)
def test_wrong_rules_are_refused_by_their_key(
    study: Study, kind: str, design: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        adaptive_study(study, kind, **design)


def test_sets_without_levels_to_choose_among_are_refused(
    study: Study, drawn_set: StimulusSet
) -> None:
    asked = adaptive_study(study, "staircase")
    content = asked.model_dump(mode="json")
    few = Study.model_validate(
        content | {"stimuli": content["stimuli"] | {"only": {"divergence_deg": [0, 90]}}}
    )
    with pytest.raises(InputError, match=r"stimuli\.conditions: placement=front has 1 level"):
        course_of(few, drawn_set, Assignment(1))
    with pytest.raises(InputError, match=r"design\.kind: 'staircase' given"):
        planned_trials(asked, drawn_set, Assignment(1))
