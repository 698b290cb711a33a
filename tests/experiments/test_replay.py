"""Sessions decided anew: as they were stored, and as someone altered them."""

import json
import re
import sqlite3
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from algorithms.errors import InputError
from experiments.cli import app
from experiments.exports.collection import load_collection, write_bundle
from experiments.responses import DECISION, ESTIMATES, POOL
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.observers import Observer
from experiments.simulated.simulation import simulate_in_process
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.adaptive_studies import adaptive_study
from tests.comparison_studies import as_toml

OBSERVERS: dict[str, Observer | ItemObserver] = {
    "staircase": Observer(40, 30),
    "quest-plus": Observer(40, 30, fatigue=0.1),
    "fixed": Observer(40, 30),
    "active-pairs": ItemObserver({str(level): level / 30 for level in range(0, 91, 10)}),
}


@pytest.fixture(scope="module")
def stores(
    study: Study, drawn_set: StimulusSet, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, Path]:
    """A store of each adaptive kind, and of a fixed design, with three simulated sessions."""
    folder = tmp_path_factory.mktemp("stores")
    made = {}
    for kind, observer in OBSERVERS.items():
        asked = study if kind == "fixed" else adaptive_study(study, kind)
        made[kind] = folder / f"{kind}.sqlite"
        with Store.open(made[kind]) as store:
            generator = np.random.default_rng(7)
            simulate_in_process(asked, drawn_set, store, observer, 3, generator)
    return made


def replayed(data: Path, *options: str) -> tuple[int, list[dict[str, object]]]:
    result = CliRunner().invoke(app, ["replay", str(data), *options, "--json"])
    return result.exit_code, json.loads(result.stdout)


@pytest.mark.parametrize("kind", ["staircase", "quest-plus", "active-pairs", "fixed"])
def test_untouched_sessions_come_out_as_they_are_stored(
    stores: dict[str, Path], kind: str, tmp_path: Path
) -> None:
    held = load_collection(stores[kind])
    write_bundle(held, tmp_path / "bundle")
    for source in (stores[kind], tmp_path / "bundle"):
        code, sessions = replayed(source)
        assert code == 0
        assert [each["difference"] for each in sessions] == [None] * 3
        assert sum(int(str(each["trials"])) for each in sessions) == len(held.responses)
    main = [each for each in held.responses if each.phase == "main"]
    decisions = [event for event in held.events if event.kind == DECISION]
    assert len(decisions) == (0 if kind == "fixed" else len(main))
    assert sum(e.kind == ESTIMATES for e in held.events) == (0 if kind == "fixed" else 3)
    pools = [event.detail["wins"] for event in held.events if event.kind == POOL]
    counts = [sum(each[2] for each in wins) for wins in pools]
    assert counts == ([0, 12, 24] if kind == "active-pairs" else [])


def change_answer(data: sqlite3.Connection, session: str) -> str:
    data.execute(
        "UPDATE responses SET answer = CASE answer WHEN '1' THEN '2' ELSE '1' END"
        " WHERE session = ? AND trial_index = 6",
        (session,),
    )
    return "trial 7: "


def change_last_answer(data: sqlite3.Connection, session: str) -> str:
    query = "SELECT max(trial_index) FROM responses WHERE session = ?"
    (last,) = data.execute(query, (session,)).fetchone()
    data.execute(
        "UPDATE responses SET answer = CASE answer WHEN '1' THEN '2' ELSE '1' END"
        " WHERE session = ? AND trial_index = ?",
        (session, last),
    )
    return "the answers tell other estimates"


def change_image(data: sqlite3.Connection, session: str) -> str:
    data.execute(
        "UPDATE responses SET stimuli = (SELECT stimuli FROM responses"
        " WHERE session = ?1 AND trial_index = 3) WHERE session = ?1 AND trial_index = 5",
        (session,),
    )
    return "trial 5: .* stored"


def change_reason(data: sqlite3.Connection, session: str) -> str:
    data.execute(
        "UPDATE events SET detail = json_set(detail, '$.estimate', 1.5, '$.bits', 0.5)"
        " WHERE session = ? AND kind = 'decision' AND json_extract(detail, '$.trial_index') = 4",
        (session,),
    )
    return "trial 4: chosen for another reason"


def remove_answer(data: sqlite3.Connection, session: str) -> str:
    data.execute("DELETE FROM responses WHERE session = ? AND trial_index = 7", (session,))
    return "trial 8: stored, but nothing"


@pytest.mark.parametrize("kind", ["staircase", "quest-plus", "active-pairs"])
@pytest.mark.parametrize(
    "tamper", [change_answer, change_last_answer, change_image, change_reason, remove_answer]
)
def test_what_was_altered_is_found(
    stores: dict[str, Path],
    kind: str,
    tamper: Callable[[sqlite3.Connection, str], str],
    tmp_path: Path,
) -> None:
    altered = tmp_path / "altered.sqlite"
    altered.write_bytes(stores[kind].read_bytes())
    session = f"{kind}.P0003.1"
    with sqlite3.connect(altered) as data:
        for (trigger,) in data.execute(
            "SELECT name FROM sqlite_master WHERE type = 'trigger'"
        ).fetchall():
            data.execute(f"DROP TRIGGER {trigger}")  # someone who can write the file can do so
        expected = tamper(data, session)
    code, sessions = replayed(altered)
    assert code == 1
    found = {each["session"]: each["difference"] for each in sessions}
    assert [name for name, difference in found.items() if difference] == [session]
    assert re.match(expected, str(found[session]))
    assert replayed(altered, f"{kind}.P0001.1")[0] == 0


def test_the_command_fills_a_store_for_each_run(
    study: Study, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    """Run n has the seed plus n - 1; a run that is there already is not added to."""
    (tmp_path / "study.toml").write_text(as_toml(adaptive_study(study, "quest-plus")))
    common = ["simulate", str(tmp_path / "study.toml"), "--stimuli", str(drawn_set.folder)]
    common += ["--participants", "1", "--in-process", "--json", "--data"]

    def answers(data: Path, *options: str) -> list[object]:
        told = CliRunner().invoke(app, [*common, str(data), *options])
        assert told.exit_code == 0, told.output
        stores = json.loads(told.stdout).get("stores", [str(data)])
        with_seeds = [load_collection(store).responses for store in stores]
        return [[row.answer for row in rows] for rows in with_seeds]

    first, second = answers(tmp_path / "runs.sqlite", "--repeat", "2", "--seed", "7")
    assert first != second
    assert answers(tmp_path / "alone.sqlite", "--seed", "8") == [second]
    for options, message in (
        ([str(tmp_path / "runs.sqlite"), "--repeat", "2"], "already there"),
        (["postgresql://localhost/none", "--repeat", "2"], "a SQLite file accepted"),
        (["x.sqlite", "--url", "http://localhost"], "no --url"),
    ):
        refused = CliRunner().invoke(app, [*common, *options])
        assert isinstance(refused.exception, InputError)
        assert message in str(refused.exception)
