"""Power: against the closed form of the t-test, and for studies as they are written."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy import stats
from statsmodels.stats.power import TTestPower
from typer.testing import CliRunner

import trompe
from algorithms.errors import InputError
from analysis.power import Outcome, PowerCurve, power_curve
from analysis.study_power import study_run
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.observers import Observer
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.adaptive_studies import active_study, adaptive_study
from tests.comparison_studies import as_toml, comparison_study

EFFECT = 0.6


def t_tests(
    participants: "list[int] | tuple[int, ...]", generator: np.random.Generator
) -> list[Outcome]:
    """One study of a normal effect: a t-test of each first n."""
    values = generator.normal(EFFECT, 1, max(participants))
    return [
        Outcome(float(values[:n].mean()), float(stats.ttest_1samp(values[:n], 0).pvalue))
        for n in participants
    ]


def test_power_is_that_of_the_closed_form() -> None:
    curve = power_curve(
        lambda numbers, generator: t_tests(list(numbers), generator),
        (30, 10, 20),
        1000,
        np.random.default_rng(1),
        quantity="mean",
        test="t-test",
    )
    assert curve.participants == (10, 20, 30)
    for number, found, mean, sd in zip(
        curve.participants, curve.power, curve.means, curve.deviations, strict=True
    ):
        exact = TTestPower().power(EFFECT, number, 0.05)
        assert found.low - 0.01 < exact < found.high + 0.01
        assert mean == pytest.approx(EFFECT, abs=0.04)
        assert sd == pytest.approx(number**-0.5, rel=0.1)
    assert curve.needed(0.8) == 30  # by the closed form 24
    assert curve.needed(0.99) is None


def test_a_run_that_tells_nothing_finds_nothing() -> None:
    unknown = Outcome(float("nan"), float("nan"))
    curve = power_curve(
        lambda numbers, _: [unknown for _ in numbers],
        [2, 3],
        5,
        np.random.default_rng(1),
        quantity="",
        test="",
    )
    assert curve.failed == (5, 5)
    assert [each.value for each in curve.power] == [0, 0]
    assert np.isnan(curve.means).all()


def curve_of(study: Study, stimuli: StimulusSet, observer: Observer | ItemObserver) -> PowerCurve:
    between = ("front", "back") if isinstance(observer, Observer) else ("90", "0")
    run, quantity, test = study_run(study, stimuli, observer, between)
    return power_curve(
        run, (8,), 2, np.random.default_rng(3), quantity=quantity, test=test, alpha=0.05
    )


def test_a_difference_of_adaptive_thresholds_is_found(study: Study, drawn_set: StimulusSet) -> None:
    asked = adaptive_study(study, "quest-plus", quest_plus={"trials": 25})
    observer = Observer(
        {"front": 20.0, "back": 60.0, "front-back": 40.0}, 20, condition="placement"
    )
    curve = curve_of(asked, drawn_set, observer)
    assert curve.means[0] == pytest.approx(-40, abs=8)
    assert curve.power[0].value == 1
    pairs = active_study(study, trials=45, each_image=9)
    qualities = {str(level): level / 20 for level in range(0, 91, 10)}
    assert curve_of(pairs, drawn_set, ItemObserver(qualities)).means[0] > 0.9


@pytest.mark.parametrize(
    ("between", "condition", "message"),
    [
        (("front", "front"), "placement", "between: front and front given"),
        (("front", "left"), "placement", "between: front and left given"),
        (("front", "back"), "target", "condition: 'target' given"),
    ],
)
def test_what_the_study_has_not_is_refused(
    study: Study,
    drawn_set: StimulusSet,
    between: tuple[str, str],
    condition: str,
    message: str,
) -> None:
    with pytest.raises(InputError, match=message):
        study_run(study, drawn_set, Observer(25, 30), between, condition)
    with pytest.raises(InputError, match="task: ranking given"):
        study_run(comparison_study(study, "ranking"), drawn_set, ItemObserver({}), between)


def test_the_command_writes_table_and_figure(
    study: Study, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    pairs = comparison_study(study, "two-alternative")
    (tmp_path / "pairs.toml").write_text(as_toml(pairs), encoding="utf-8")
    arguments = ["power", str(tmp_path / "pairs.toml"), "--stimuli", str(drawn_set.folder)]
    arguments += ["--between", "back,front", "--qualities", "front=0,back=2,front-back=0"]
    arguments += ["--participants", "2,4", "--runs", "3", "--out", str(tmp_path / "out")]
    told = CliRunner().invoke(trompe.app, [*arguments, "--json"])
    found = json.loads(told.output)
    assert found["participants"] == [2, 4]
    assert found["needed"] in (2, 4)
    assert found["seed"] == 2011
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "power.csv",
        "power.png",
        "power.svg",
    }
