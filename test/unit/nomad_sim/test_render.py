# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Pictures, looked at pixel by pixel."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2
from nomad_sim.render import MAX_LABELS, Panel, Scene, draw_panels, save_figure

GEOMETRY = GridGeometry(8, 6, 0.5, (1.0, -2.0))


def pixels(figure: Figure) -> np.ndarray:
    """Return the figure's colours, rows from the top."""
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[:, :, :3].astype(int)


def colour_at(figure: Figure, x: float, y: float, axes: int = 0) -> tuple[int, ...]:
    image = pixels(figure)
    column, up = figure.axes[axes].transData.transform((x, y))
    return tuple(image[image.shape[0] - 1 - int(up), int(column)])


def texts(figure: Figure) -> list[str]:
    return [t.get_text() for t in figure.axes[0].texts]


def test_every_cell_has_the_grey_of_its_risk_where_it_lies() -> None:
    risk = np.linspace(0.0, 1.0, 48).reshape(GEOMETRY.shape)
    figure = draw_panels([[Panel(GEOMETRY, risk)]])
    for row, column in ((0, 0), (0, 7), (5, 0), (5, 7), (2, 3)):
        level = 255.0 * (1.0 - risk[row, column])
        assert colour_at(figure, *GEOMETRY.centre_of(row, column)) == pytest.approx(
            (level,) * 3, abs=2
        )


def test_grey_levels_do_not_depend_on_the_risks_that_occur() -> None:
    figure = draw_panels([[Panel(GEOMETRY, np.full(GEOMETRY.shape, 0.5))]])
    assert colour_at(figure, 2.1, -0.1) == pytest.approx((127.5,) * 3, abs=2)


def test_what_happened_is_drawn_where_it_happened() -> None:
    scene = Scene(
        segments=[[1.5, -1.5, 4.5, -1.5]],
        circles=[[4.0, 0.0, 0.5]],
        travelled=[[1.5, 0.25], [3.0, 0.25]],
        plan=[[1.5, 0.75], [3.0, 0.75]],
    )
    figure = draw_panels([[Panel(GEOMETRY, np.zeros(GEOMETRY.shape), scene)]])
    red, green, blue = colour_at(figure, 3.0, -1.5)
    assert red > 200 > green > blue  # the surfaces' orange
    assert colour_at(figure, 4.5, 0.0) == pytest.approx((red, green, blue), abs=40)
    red, green, blue = colour_at(figure, 2.2, 0.25)
    assert blue > 200 > green > red
    row = [colour_at(figure, x, 0.75) for x in np.arange(1.6, 2.4, 0.05)]
    assert any(r > 150 and b > 150 and g < 100 for r, g, b in row)  # dashes
    assert colour_at(figure, 2.2, -0.5) == (255, 255, 255)


def test_perceptions_carry_their_numbers_until_there_are_too_many() -> None:
    places = np.linspace((1.5, -1.5), (4.5, 0.5), MAX_LABELS)
    numbered = draw_panels([[Panel(GEOMETRY, None, Scene(perceptions=places))]])
    assert texts(numbered) == [str(k) for k in range(1, MAX_LABELS + 1)]
    more = np.vstack([places, places[:1]])
    assert texts(draw_panels([[Panel(GEOMETRY, None, Scene(perceptions=more))]])) == []


def test_axes_have_units_and_the_legend_names_what_is_there() -> None:
    scene = Scene(
        travelled=[[1.5, 0.0], [2.0, 0.0]],
        perceptions=[[1.5, 0.0]],
        start=(1.5, 0.0),
        goal=(4.0, 0.0),
        robot=Pose2(2.0, 0.0, 0.3),
    )
    panel = Panel(GEOMETRY, np.ones(GEOMETRY.shape), scene, "a map")
    figure = draw_panels([[panel, Panel(GEOMETRY, np.ones(GEOMETRY.shape))]], "all")
    first = figure.axes[0]
    assert (first.get_xlabel(), first.get_ylabel()) == ("x [m]", "y [m]")
    assert first.get_title() == "a map"
    assert figure.get_suptitle() == "all"
    assert [t.get_text() for t in figure.legends[0].get_texts()] == [
        "path travelled",
        "perceptions",
        "start",
        "goal",
        "robot",
    ]
    bar = figure.axes[-1]
    assert "risk" in bar.get_ylabel()
    assert bar.get_ylim() == (0.0, 1.0)


def test_a_picture_without_risks_has_no_colour_bar() -> None:
    figure = draw_panels([[Panel(GEOMETRY, None, Scene(segments=[[1.0, 0.0, 5.0, 0.0]]))]])
    assert len(figure.axes) == 1


def test_it_is_written_as_png_and_replaces_an_older_one(tmp_path: Path) -> None:
    file = tmp_path / "new" / "map.png"
    for _ in range(2):
        save_figure(draw_panels([[Panel(GEOMETRY)]]), file)
    assert file.read_bytes().startswith(b"\x89PNG")


def test_global_state_stays_as_it_was(tmp_path: Path) -> None:
    """In a process of its own: others may have imported pyplot."""
    source = """
import sys
import matplotlib
before = (dict(matplotlib.rcParams), matplotlib.rcParams._get_backend_or_none())
import numpy as np
from fuzzy_map_building.grid import GridGeometry
from nomad_sim.render import Panel, draw_panels, save_figure
g = GridGeometry(3, 2, 0.1)
save_figure(draw_panels([[Panel(g, np.zeros((2, 3)))]]), sys.argv[1])
assert before == (dict(matplotlib.rcParams), matplotlib.rcParams._get_backend_or_none())
assert "matplotlib.pyplot" not in sys.modules
"""
    command = [sys.executable, "-c", source, str(tmp_path / "a.png")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Panel(GEOMETRY, np.zeros((8, 6))), r"shape \(8, 6\), its geometry \(6, 8\)"),
        (lambda: Panel(GEOMETRY, np.full(GEOMETRY.shape, 1.1)), r"lie in \[0, 1\]"),
        (lambda: Panel(GEOMETRY, np.full(GEOMETRY.shape, np.nan)), r"lie in \[0, 1\]"),
        (lambda: Scene(travelled=np.zeros((4, 3))), r"Scene.travelled has shape \(any, 2\)"),
        (lambda: draw_panels([]), "got none"),
        (lambda: draw_panels([[Panel(GEOMETRY)], []]), "of one length"),
    ],
)
def test_wrong_shapes_and_values_are_refused(make, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ValueError, match=message):
        make()
