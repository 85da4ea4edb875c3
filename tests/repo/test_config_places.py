"""What is wrong in a configuration is said with file, line and column, and with what to do."""

from __future__ import annotations

import pytest
from a2rt_cli import experiment
from a2rt_cli.config_table import Table
from a2rt_cli.engine import scenes
from a2rt_cli.errors import UserError

BAD_EXPERIMENT = """title = "x"
scenes = ["cornell", "nowhere"]
workloads = ["pt", "dance"]
units = [
  "baseline",
  "nonsense",
]
gpu = "toaster"

[[knob]]
title = "first"
key = "k"
values = [1]
default = 1

[[knob]]
title = "second"
unit = "ghost"
key = "k"
values = [1, 2]
default = 3
labels = ["one"]
order = "upward"

[[factorial]]
title = "t"
unit = "phantom"
"precision.box_bits" = 8

[search]
unit = "spectre"
minimise = "time.cycles"
"""

# Place, what is said, what of the remedy, and how the mistake is mended; in the order of finding.
MISTAKES = [
    ("2:22", "nowhere: not a scene", "cornell", ('"nowhere"', '"forest"')),
    ("3:20", "no workload is called 'dance'", "known: auto, anyhit", (', "dance"', "")),
    ("6:3", "nonsense: no such unit", "aqb8, baseline", ('"nonsense"', '"aqb8"')),
    ("8:7", "toaster: no such gpu", "mobile, table1", ("toaster", "table1")),
    ("18:8", "ghost: no such unit", "aqb8, baseline", ("ghost", "a2rt")),
    ("23:1", "order is 'upward'", "finer or coarser", ("upward", "finer")),
    ("22:1", "1 labels for 2 values", "one label", ('"one"', '"one", "two"')),
    ("21:1", "the default is not in values", "add the unit's own", ("= 3", "= 2")),
    ("27:8", "phantom: no such unit", "aqb8, baseline", ("phantom", "a2rt")),
    ("28:1", "needs a list of values", "[1, 2]", ("= 8", "= [8]")),
    ("32:1", "search.space is missing", "add [search.space]", ("[search]", "[search.space]")),
]


@pytest.mark.parametrize("number", range(len(MISTAKES)), ids=[one[1] for one in MISTAKES])
def test_an_experiment_that_names_the_unknown_is_refused_with_its_place(tmp_path, number):
    text = BAD_EXPERIMENT
    for *_, mended in MISTAKES[:number]:
        assert mended[0] in text
        text = text.replace(*mended)
    place, said, remedy, _ = MISTAKES[number]
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError) as caught:
        experiment.load(path)
    assert str(caught.value).startswith(f"{path}:{place}: ")
    assert said in str(caught.value) and remedy in caught.value.remedy


def test_the_scenes_of_the_command_line_go_before_those_of_the_file(tmp_path):
    path = tmp_path / "far.toml"
    path.write_text('title = "x"\nscenes = ["only on another machine"]\n', encoding="utf-8")
    assert experiment.load(path, ["cornell"]).scenes == ("cornell",)


BAD_SCENE = """title = "x"
credit = "y"
features = ["diffuse", "sparkle"]
runs = ["pt", "dance"]
stand_in = "moon"
"""


@pytest.mark.parametrize(
    ("place", "said", "mended"),
    [
        (":3:24", "no effect of a workload is called 'sparkle'", []),
        (":4:15", "no workload is called 'dance'", [("sparkle", "sky")]),
        (":5:12", "no embedded scene is called 'moon'", [("sparkle", "sky"), ("dance", "ao")]),
        (
            "",
            "neither a scene of its own nor a stand-in",
            [("sparkle", "sky"), ("dance", "ao"), ('stand_in = "moon"', "")],
        ),
    ],
)
def test_a_scene_that_names_the_unknown_is_refused_with_its_place(tmp_path, place, said, mended):
    text = BAD_SCENE
    for one in mended:
        text = text.replace(*one)
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError) as caught:
        scenes._load(path)
    assert str(caught.value).startswith(f"{path}{place}: ")
    assert said in str(caught.value) and caught.value.remedy


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('title = "x"\nscenes = [', ":2:1: Invalid value"),
        ("title = x\n", ":1:9: Invalid value"),
        ('title = "x"\nscenes = 3\n', ":2:1: scenes = 3 has the wrong type"),
        ('title = "x"\nscenes = ["cornell"]\n\n  knob = [3]\n', ":4:3: knob has the wrong type"),
        ('title = "x"\nscenes = [7]\n', ":2:1: 7 is no name"),
    ],
)
def test_what_is_no_experiment_is_refused_with_its_place(tmp_path, text, said):
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError) as caught:
        experiment.load(path)
    assert str(caught.value).startswith(f"{path}{said}") and caught.value.remedy


def test_a_file_that_is_not_text_is_refused(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(UserError, match="not UTF-8"):
        Table.read(path)


def test_a_truth_value_is_a_value_of_a_knob_and_no_number(tmp_path):
    path = tmp_path / "knob.toml"
    knob = '[[knob]]\ntitle = "t"\nkey = "k"\nvalues = [false, true]\ndefault = false\n'
    path.write_text(f'title = "x"\nscenes = ["cornell"]\n{knob}', encoding="utf-8")
    assert experiment.load(path).knobs[0].default is False
    path.write_text('title = "x"\nscenes = ["cornell"]\naudit = true\n', encoding="utf-8")
    with pytest.raises(UserError, match=r":3:1: audit = True has the wrong type"):
        experiment.load(path)
