import re
from collections.abc import Callable
from pathlib import Path

import pytest

from algorithms.errors import InputError
from experiments.study import READY_MADE, Study, check_stimuli, load_study
from experiments.template import write_template
from stimuli.manifest import StimulusSet

WriteStudy = Callable[[str, str], Path]


_TASK = 'task = "odd-one-out"'

# Each wrong study: what is replaced, by what, and the key that the message must name.
WRONG = [
    ('name = "lights-synthetic"', 'name = "Lights"', "name"),
    ('name = "lights-synthetic"', 'name = ""', "name"),
    ('name = "lights-synthetic"', 'name = "../lights"', "name"),
    ('name = "lights-synthetic"\n', "", "name"),
    ('title = "Which object is lit differently?"', 'title = "  "', "title"),
    ("version = 1\n", "version = 0\n", "version"),
    ("version = 1\n", 'version = "one"\n', "version"),
    ('task = "odd-one-out"', 'task = "odd"', "task"),
    ('task = "odd-one-out"', 'tusk = "odd-one-out"', "task|tusk"),
    ('language = "en"', 'language = "xx"', "language"),
    ('language = "en"', 'languages = "en"', "languages: unknown key"),
    ('"artistic_background"]', '"income"]', r"demographics\.2"),
    ('set = "divergence"', "set = 3", r"stimuli\.set"),
    ("choices = 8", "choices = 1", r"stimuli\.choices"),
    ("choices = 8", "choices = 10", r"stimuli\.choices"),
    ("choices = 8\n", "", r"stimuli\.choices: missing"),
    ('level = "divergence_deg"', "level = 3", r"stimuli\.level"),
    ('conditions = ["placement", "material"]', 'conditions = "placement"', r"stimuli\.conditions"),
    ('encoding = "srgb"', 'encoding = "gamma"', r"stimuli\.encoding"),
    ('encoding = "srgb"', 'colour = "srgb"', r"stimuli\.colour: unknown key"),
    ('kind = "factorial"', 'kind = "adaptive"', r"design\.kind"),
    ("seed = 2010", "seed = -1", r"design\.seed"),
    ("seed = 2010\n", "", r"design\.seed: missing"),
    ("seed = 2010", "seed = 2010\nrepeats = 0", r"design\.repeats"),
    ("seed = 2010", "seed = 2010\nrepeat = 2", r"design\.repeat: unknown key"),
    ("trials = 3", "trials = -1", r"practice\.trials"),
    ("feedback = true", 'feedback = "perhaps"', r"practice\.feedback"),
    ("blank_s = 0.5", "blank_s = -0.5", r"timing\.blank_s"),
    ("blank_s = 0.5", "blank = 0.5", r"timing\.blank: unknown key"),
    ("blank_s = 0.5", "blank_s = nan", r"timing\.blank_s"),
    ("blank_s = 0.5", "time_limit_s = 0", r"timing\.time_limit_s"),
    ('version = "1"', 'version = ""', r"consent\.version"),
    ("minimum_width_px = 640", "minimum_width_px = 640.5", r"screen\.minimum_width_px"),
    ("minimum_width_px = 640", "minimum_width = 640", r"screen\.minimum_width: unknown key"),
    ("participants = 24", "participants = 0", r"stopping\.participants"),
    ("[stopping]\nparticipants = 24", "", "stopping: missing"),
    ("incomplete = true", 'incomplete = "maybe"', r"exclusion\.incomplete"),
    ("shortest_median_s = 0.3", "shortest_median_s = 0", r"exclusion\.shortest_median_s"),
    ("shortest_median_s = 0.3", "shortest_mean_s = 0.3", r"exclusion\.shortest_mean_s"),
    ("shortest_median_s = 0.3", "catch_level = 80", r"exclusion\.catch_level"),
    ("shortest_median_s = 0.3", "largest_late_share = 1", r"exclusion\.largest_late_share"),
    (_TASK, 'task = "pick"', r"answers\.picks: missing"),
    (_TASK, 'task = "pick"\nanswers.picks = [2, 1]', r"answers\.picks: \[2, 1\] given"),
    (_TASK, 'task = "pick"\nanswers.picks = [1, 9]', r"answers\.picks: \[1, 9\] given"),
    (_TASK, _TASK + "\nanswers.picks = [1, 1]", r"answers\.picks: the task odd-one-out"),
    ("minimum_width_px = 640", 'color_gamut = "adobe"', r"screen\.color_gamut"),
    ("minimum_width_px = 640", 'rule = "warn"', r"screen\.rule"),
    ("minimum_width_px = 640", "distance = true", "screen: distance: needs calibrate"),
    ("[stopping]", "[stopping]\nabandoned_after_s = 0", r"stopping\.abandoned_after_s"),
    ("[stopping]", '[recruitment]\nparameters = ["a b"]\n[stopping]', r"recruitment\.parameters"),
    ("[stopping]", '[recruitment]\nparameters = ["a", "a"]\n[stopping]', "recruitment: parameters"),
    (
        "[stopping]",
        '[recruitment]\ncompletion_url = "done"\n[stopping]',
        "recruitment: completion_url: an http",
    ),
    (
        "[stopping]",
        '[recruitment]\ncompletion_url = "https://a.example/{PID}"\n[stopping]',
        r"recruitment: completion_url: \{PID\} given, accepted: completion_code",
    ),
    (
        "[stopping]",
        "[analysis]\nequivalence_margin = 0.1\n[stopping]",
        r"analysis\.equivalence_margin: the task odd-one-out has no use for it",
    ),
    ("[screen]", "[display]\nwidth_deg = 0\n[screen]", "display.width_deg"),
    (
        "[screen]",
        "[display]\nwidth_deg = 9\nwidth_px = 9\n[screen]",
        "display: width_deg, width_px",
    ),
]


@pytest.mark.parametrize(("old", "new", "key"), WRONG)
def test_a_wrong_study_is_refused_in_one_line_that_names_the_key(
    write_study: WriteStudy, old: str, new: str, key: str
) -> None:
    path = write_study(old, new)
    with pytest.raises(InputError) as caught:
        load_study(path)
    message = str(caught.value)
    assert "\n" not in message
    assert re.match(rf"{re.escape(str(path))}: ({key})", message), message


def test_files_that_are_no_study_are_refused(tmp_path: Path) -> None:
    broken = tmp_path / "broken.toml"
    broken.write_text("name = ")
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    for path, message in (
        (broken, "not a TOML file"),
        (binary, "not a TOML file"),
        (tmp_path / "none.toml", "cannot be read"),
        (tmp_path, "cannot be read|no file"),
    ):
        with pytest.raises(InputError, match=message):
            load_study(path)
    with pytest.raises(
        InputError, match=r"no ready-made study 'lights'; there are: .*lights-synthetic"
    ):
        load_study("lights")


@pytest.mark.parametrize("path", sorted(READY_MADE.glob("*.toml")), ids=lambda path: path.stem)
def test_ready_made_studies_load_by_their_name(path: Path) -> None:
    assert load_study(path.stem).name == path.stem


def test_the_digest_is_of_what_is_said_not_of_the_layout(
    write_study: WriteStudy, study: Study
) -> None:
    spaced = load_study(write_study("seed = 2010", "\n\n# a comment\nseed   =   2010"))
    assert spaced.digest == study.digest
    other = load_study(write_study("seed = 2010", "seed = 2011"))
    assert other.digest != study.digest


def test_keys_that_came_later_leave_older_studies_what_they_were(
    write_study: WriteStudy, study: Study
) -> None:
    # Our own past: the digest that answers to this study were stored under.
    assert study.digest.startswith("b1c9ec49357d")
    for said in ("largest_late_share = 0", "catch_level = 0\nleast_catch_share = 0.5"):
        rule = load_study(
            write_study("shortest_median_s = 0.3", f"shortest_median_s = 0.3\n{said}")
        )
        assert rule.digest != study.digest


def test_chance_is_one_in_the_number_of_choices(study: Study) -> None:
    assert study.guess_rate == 1 / study.choices


def test_the_template_is_a_study_of_its_name(tmp_path: Path, drawn_set: StimulusSet) -> None:
    path = write_template("my-study", tmp_path)
    made = load_study(path)
    assert made.name == "my-study"
    check_stimuli(made, drawn_set)


def test_the_template_overwrites_nothing_and_wants_a_name(tmp_path: Path) -> None:
    path = write_template("mine", tmp_path)
    path.write_text("changed")
    with pytest.raises(InputError, match="exists already"):
        write_template("mine", tmp_path)
    assert path.read_text() == "changed"
    for name in ("My study", "", "../mine", "x" * 65):
        with pytest.raises(InputError, match="name: "):
            write_template(name, tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["mine.toml"]


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ('set = "divergence"', 'set = "texture"', "stimuli.set"),
        ("choices = 8", "choices = 7", "stimuli.choices"),
        ('level = "divergence_deg"', 'level = "divergence"', "stimuli.level"),
        ('"placement", "material"', '"placement", "colour"', "stimuli.conditions"),
        ("trials = 3", "trials = 30", "practice.trials"),
    ],
)
def test_a_study_that_does_not_fit_the_stimuli_is_refused_by_key(
    write_study: WriteStudy, drawn_set: StimulusSet, old: str, new: str, key: str
) -> None:
    loaded = load_study(write_study(old, new))
    with pytest.raises(InputError, match=f"^{re.escape(key)}: the study says"):
        check_stimuli(loaded, drawn_set)


def test_stimuli_without_regions_are_refused(study: Study, drawn_set: StimulusSet) -> None:
    bare = [
        stimulus.model_copy(update={"regions": None}) if number == 4 else stimulus
        for number, stimulus in enumerate(drawn_set.stimuli)
    ]
    without = drawn_set.model_copy(update={"stimuli": tuple(bare)})
    with pytest.raises(InputError, match=f"{bare[4].id} of the set has no regions"):
        check_stimuli(study, without)
