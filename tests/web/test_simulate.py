from pathlib import Path

import httpx
import numpy as np
import pytest

from algorithms.errors import InputError
from experiments.planning.trials import Assignment, planned_trials
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.observers import Observer
from experiments.storage.store import Store
from experiments.study import Study
from experiments.web import create_app, running_server
from experiments.web.simulate import simulate_over_http
from stimuli.manifest import StimulusSet
from tests.comparison_studies import comparison_study
from tests.drawn_set import draw_set

# Notices everything above 45 degrees and nothing below.
SHARP = Observer(threshold=45, width=0.001, lapse_rate=0)


def simulate(
    url: str, study: Study, stimuli: StimulusSet, concurrency: int = 4, images: int = 1
) -> list[str]:
    generator = np.random.default_rng(1)
    return simulate_over_http(
        url, 3, SHARP, study, stimuli, generator, concurrency=concurrency, images=images
    )


def test_simulated_participants_take_the_whole_study_flagged(
    client: httpx.Client, study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    completed: list[str] = []
    sessions = simulate_over_http(
        str(client.base_url),
        3,
        SHARP,
        study,
        drawn_set,
        np.random.default_rng(1),
        on_completed=completed.append,
    )
    assert sorted(completed) == sessions == [session.id for session in store.sessions()]
    assert all(session.simulated and session.completed_at for session in store.sessions())
    rows = store.responses()
    planned = planned_trials(study, drawn_set, Assignment(1))
    assert len(rows) == 3 * len(planned)
    assert all(row.simulated and row.device.startswith("simulated observer") for row in rows)


def test_answers_follow_the_observer(
    client: httpx.Client, study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    simulate(str(client.base_url), study, drawn_set)
    for row in store.responses():
        stimulus = drawn_set[row.stimuli[0]]
        if float(stimulus.factors["divergence_deg"]) > 45:
            assert row.answer == stimulus.answer


def test_answers_depend_on_seed_and_number_not_on_who_comes_first(
    study: Study, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    def answers(name: str, concurrency: int) -> list[object]:
        with (
            Store.open(tmp_path / name) as store,
            running_server(create_app(study, drawn_set, store)) as url,
        ):
            simulate(url, study, drawn_set, concurrency=concurrency)
            return [(row.id, row.answer, row.reaction_time_s) for row in store.responses()]

    assert answers("one", concurrency=1) == answers("three", concurrency=3)


def test_a_server_that_is_not_there_is_named(study: Study, drawn_set: StimulusSet) -> None:
    for url in ("http://127.0.0.1:9", "nonsense", "http://[", "http://localhost:port"):
        with pytest.raises(InputError, match="url: "):
            simulate(url, study, drawn_set)


def test_other_stimuli_than_those_served_are_refused(
    client: httpx.Client, study: Study, store: Store, tmp_path: Path
) -> None:
    url = str(client.base_url)
    fewer = draw_set(tmp_path, levels_deg=(0, 90))
    with pytest.raises(InputError, match="trials"):
        simulate(url, study, fewer)
    other = study.model_validate({**study.model_dump(), "design": {"seed": 1}})
    with pytest.raises(InputError, match="other images"):
        simulate(url, other, draw_set(tmp_path), images=10)
    assert store.responses() == []


@pytest.mark.parametrize("name", ["concurrency", "participants"])
def test_counts_below_one_are_refused(study: Study, drawn_set: StimulusSet, name: str) -> None:
    counts = {"participants": 1, "concurrency": 1, name: 0}
    with pytest.raises(InputError, match=f"{name}: 0 given"):
        simulate_over_http(
            "http://127.0.0.1:9",
            counts["participants"],
            SHARP,
            study,
            drawn_set,
            np.random.default_rng(1),
            concurrency=counts["concurrency"],
        )


def test_rankings_are_simulated_through_the_interface(
    study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    """Qualities far apart: everybody ranks alike, whatever the order shown."""
    ranking = comparison_study(study, "ranking")
    observer = ItemObserver({"front": 0.0, "back": 30.0, "front-back": -30.0}, lapse_rate=0.0)
    with running_server(create_app(ranking, drawn_set, store)) as url:
        generator = np.random.default_rng(1)
        simulate_over_http(url, 2, observer, ranking, drawn_set, generator, images=2)
    rows = store.responses()
    assert len(rows) == 2 * 20
    for row in rows:
        items = [str(drawn_set[shown].factors["placement"]) for shown in row.stimuli]
        assert isinstance(row.answer, tuple)
        assert dict(zip(items, row.answer, strict=True)) == {
            "back": 1,
            "front": 2,
            "front-back": 3,
        }
