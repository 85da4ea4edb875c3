"""The sweep's page: its answers follow from the data, and its script works in a browser."""

from __future__ import annotations

import html
import itertools
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from a2rt_cli import experiment
from a2rt_cli.report import price, price_answers, price_page, price_scatter
from a2rt_cli.sweep import plan

EXPERIMENT = """title = "made up"
scenes = ["cornell", "spheres"]

[[knob]]
title = "Box bits"
key = "precision.box_bits"
values = [7, 8, 9, 10]
default = 8
order = "finer"

[[knob]]
title = "Rounding"
key = "precision.rounding"
values = ["conservative", "nearest"]
default = "conservative"

[[factorial]]
title = "Thresholds"
"classify.area_ratio" = [0.01, 0.1]
"classify.length_ratio" = [0.01, 0.1]
"""
# Share of true misses let through, cycles and lost hits of each configuration.
MADE_UP = {
    (): (0.10, 1000, 0),
    ("precision.box_bits=7",): (0.20, 1010, 0),
    ("precision.box_bits=9",): (0.05, 990, 0),
    ("precision.box_bits=10",): (0.04, 980, 0),
    ('precision.rounding="nearest"',): (0.09, 995, 3),
    ("classify.area_ratio=0.01", "classify.length_ratio=0.01"): (0.10, 900, 0),
    ("classify.area_ratio=0.01", "classify.length_ratio=0.1"): (0.10, 905, 0),
    ("classify.area_ratio=0.1", "classify.length_ratio=0.01"): (0.10, 990, 0),
    ("classify.area_ratio=0.1", "classify.length_ratio=0.1"): (0.10, 950, 0),
}
DOT = bytes.fromhex(
    "89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de0000000c4944415478da63f8ff"
    "ff3f0005fe02fea7356e8f0000000049454e44ae426082"
)


def made_up_result(scene: str, overrides: tuple[str, ...], scale: float) -> dict:
    redundant, cycles, lost = MADE_UP[overrides]
    changed = 5 if lost else 0
    name = "pictures/cornell.driver.png" if not lost else "pictures/changed.png"
    return {
        "schema": 1,
        "unit": {"name": "a2rt"},
        "label": "a2rt" + "".join(f" {o}" for o in overrides),
        "overrides": list(overrides),
        "workload": {"name": scene, "rays": 1000},
        "accuracy": {
            "decided": 2000,
            "qbox_tests": 2000,
            "exact_hits": 1000,
            "redundant_hits": int(redundant * 1000),
            "missed_hits": lost,
            "lost_closest_hits": lost,
        },
        "time": {"cycles": cycles * scale},
        "memory": {"by_kind": {"sub_node": {"bytes": 5000}}},
        "energy": {"total_pj": 7.0 * cycles, "by_component": {"qbox_a2rt": 1.0}},
        "area": {"tester": {"um2": 1000.0}},
        "picture": {
            "file": name,
            "difference": "pictures/difference.png" if lost else None,
            "changed_pixels": changed,
            "passes": 2 if lost else 1,
            "rmse": 0.01 * changed,
            "flip": 0.02 * changed,
        },
        "provenance": {"version": "0"},
    }


@pytest.fixture
def sweep(tmp_path: Path) -> tuple[Path, experiment.Experiment]:
    file = tmp_path / "made-up.toml"
    file.write_text(EXPERIMENT, encoding="utf-8")
    found = [
        made_up_result(scene, overrides, scale)
        for (scene, scale), overrides in itertools.product(
            (("cornell", 1), ("spheres", 3)), MADE_UP
        )
    ]
    (tmp_path / "results.json").write_text(json.dumps(found), encoding="utf-8")
    (tmp_path / "pictures").mkdir()
    for name in ("cornell.driver", "spheres.driver", "changed", "difference"):
        (tmp_path / "pictures" / f"{name}.png").write_bytes(DOT)
    return tmp_path, experiment.load(file)


def dom_after(page: Path, script: str = "") -> str:
    """The page's DOM after its script and then `script` ran, from a browser without network."""
    browser = shutil.which("chromium")
    if browser is None:
        pytest.skip("chromium is not installed")
    driven = page.with_name("driven.html")
    text = page.read_text(encoding="utf-8")
    driven.write_text(text.replace("</body>", f"<script>{script}</script></body>"), "utf-8")
    flags = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run "
    flags += "--disable-background-networking --disable-component-update --disable-sync"
    command = [
        browser,
        *flags.split(),
        f"--user-data-dir={page.parent / 'profile'}",
        "--dump-dom",
    ]
    command += ["--virtual-time-budget=5000", driven.resolve().as_uri()]
    reply = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert reply.returncode == 0, reply.stderr[-2000:]
    return html.unescape(reply.stdout)


def part(dom: str, start: str, end: str) -> str:
    found = re.search(f"{start}.*?{end}", dom, re.DOTALL)
    assert found, start
    return found[0]


def test_the_answers_follow_from_the_runs(sweep):
    folder, asked = sweep
    found = price.Found(json.loads((folder / "results.json").read_text(encoding="utf-8")))
    bits, rounding, best = price_answers.answers(asked, found)
    # 1000 / 980, 0.10 / 0.04, equal areas
    assert bits.headline == "+2.04 % time, +150 % redundant hits, ±0 % tester area"
    assert "loses no hit" in bits.detail
    assert "loses the closest hit of 6 rays" in rounding.detail  # 3 in each scene
    assert best.headline == "S_t = 0.01, L_t = 0.01; 2 of 4 settings within 1 %"
    assert "11.11 % slower" in best.detail  # the default's 1000 against 900
    assert "S_t alone anywhere from 0.01 to 0.1 costs at most 10.0 % of time" in best.detail
    assert "L_t alone anywhere from 0.01 to 0.1 costs at most 0.6 % of time" in best.detail


def test_one_more_bit_is_counted_from_the_units_own_value(sweep):
    folder, asked = sweep
    found = price.Found(json.loads((folder / "results.json").read_text(encoding="utf-8")))
    finer, coarser = price_answers.steps(price.prices_of(asked.knobs[0], found))
    assert finer[1:5] == ["8 → 9 (finer)", "−50.0 %", "0", "−1.00 %"]
    assert coarser[1:5] == ["8 → 7 (coarser)", "+100.0 %", "0", "+1.00 %"]
    assert price_answers.steps(price.prices_of(asked.knobs[1], found)) == []


def test_the_front_holds_what_nothing_beats():
    assert price_scatter.front([(1, 5), (2, 4), (3, 4), (0, 9), (2, 3)]) == {3, 0, 4}


def test_knobs_and_factorials_share_their_runs(sweep):
    _, asked = sweep
    specs = plan._specs(asked)
    combined = [tuple(spec.overrides) for spec in specs if spec.unit == "a2rt"]
    assert sorted(combined) == sorted(MADE_UP)


def test_the_report_of_a_sweeps_folder_is_its_price_page(sweep, a2rt, monkeypatch):
    folder, made_up = sweep
    page = price_page.write(folder, made_up).read_text(encoding="utf-8")
    monkeypatch.setattr(plan, "make", lambda one: plan.Plan(one.title, {}, []))
    plan.write(made_up, folder)
    made_up.file.unlink()  # the folder keeps what its page needs
    a2rt.ok("report", folder)
    assert (folder / "report.html").read_text(encoding="utf-8") == page
    (folder / plan.EXPERIMENT).unlink()
    assert "run the same sweep again" in a2rt.refused("report", folder)


def test_the_page_needs_nothing_but_itself(sweep):
    page = price_page.write(*sweep)
    text = page.read_text(encoding="utf-8")
    assert not re.search(r'(src|href)="(?!#|data:)', text)
    assert "http" not in re.sub(r"http://www\.w3\.org/\S+", "", text)


def test_the_scatter_shows_every_configuration_of_the_chosen_scene(sweep):
    page = price_page.write(*sweep)
    together = part(dom_after(page), '<svg id="scatter"', "</svg>")
    assert together.count('class="point') == len(MADE_UP)
    assert "of A²RT's default" in together
    one = "choosers.scene.value = 'spheres'; choosers.scene.dispatchEvent(new Event('change'));"
    dom = dom_after(page, one)
    alone = part(dom, '<svg id="scatter"', "</svg>")
    assert alone.count('class="point') == len(MADE_UP)
    assert "of A²RT's default" not in alone
    assert '<div data-scope="spheres">' in dom and '<div data-scope="all" hidden="">' in dom


def test_pointing_at_a_point_names_it_and_a_click_shows_its_pictures(sweep):
    page = price_page.write(*sweep)
    script = """
    const drawn = [...svg.querySelectorAll('.point')];
    const point = drawn.find((p) => p.dataset.label.includes('nearest'));
    point.dispatchEvent(new Event('mouseenter'));
    point.dispatchEvent(new Event('click'));
    """
    dom = dom_after(page, script)
    assert "a2rt: rounding nearest" in part(dom, '<div id="tip"', "</div>")
    detail = part(dom, '<aside id="detail"', "</aside>")
    assert "a2rt: rounding nearest" in detail
    assert detail.count("<img") == 4  # picture and difference of both scenes
    assert "changed pixels: 5" in detail
