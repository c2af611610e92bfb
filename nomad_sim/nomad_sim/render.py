# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Pictures of risk maps with what happened on them: arrays in, figures out.

The grey levels are those of the paper's figures: the darker, the higher the risk. Nothing
here touches matplotlib's global state: no ``pyplot``, no chosen backend, no changed setting.
"""

from __future__ import annotations

import io
import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2
from nomad_sim.output_folder import write_result

__all__ = ["MAX_LABELS", "Figure", "Panel", "Scene", "draw_panels", "save_figure"]

FloatArray = NDArray[np.float64]

#: Perceptions up to which each carries its number; more of them would hide the map.
MAX_LABELS = 60

# Colours that are told apart from each other, from black and from white.
_TRUTH = "#ff7f0e"
_TRAVELLED = "#1e90ff"
_PLAN = "#d62ad6"
_ENDS = "#12a150"
_HALO = [withStroke(linewidth=2.5, foreground="white")]
_LABEL = "#0b4f9e"
# Length of a map's longer side [inch]: in figures of one or two columns, and of more.
_SIDE_FEW, _SIDE_MANY = 5.2, 3.9


def _nothing(columns: int) -> FloatArray:
    return np.empty((0, columns))


@dataclass(frozen=True, eq=False)
class Scene:
    """What is drawn over a map; what is left out does not appear.

    Parameters
    ----------
    segments : ndarray of float64, shape (N, 4)
        True surfaces: end points x0, y0, x1, y1 [m].
    circles : ndarray of float64, shape (M, 3)
        True cylinders: centre and radius [m].
    travelled : ndarray of float64, shape (n, 2)
        Where the robot has been [m], in order.
    perceptions : ndarray of float64, shape (m, 2)
        Where it perceived [m], in order.
    plan : ndarray of float64, shape (k, 2)
        Planned path [m].
    start, goal : tuple of float, optional
        Positions [m].
    robot : Pose2, optional
        Where the robot is.
    robot_radius : float
        Radius of its body [m].
    """

    segments: FloatArray = field(default_factory=lambda: _nothing(4))
    circles: FloatArray = field(default_factory=lambda: _nothing(3))
    travelled: FloatArray = field(default_factory=lambda: _nothing(2))
    perceptions: FloatArray = field(default_factory=lambda: _nothing(2))
    plan: FloatArray = field(default_factory=lambda: _nothing(2))
    start: tuple[float, float] | None = None
    goal: tuple[float, float] | None = None
    robot: Pose2 | None = None
    robot_radius: float = 0.23

    def __post_init__(self) -> None:
        columns = {"segments": 4, "circles": 3, "travelled": 2, "perceptions": 2, "plan": 2}
        for name, count in columns.items():
            value = np.asarray(getattr(self, name), dtype=np.float64)
            if value.size == 0:
                value = _nothing(count)
            if value.ndim != 2 or value.shape[1] != count:
                raise ValueError(f"Scene.{name} has shape (any, {count}), got {value.shape}")
            object.__setattr__(self, name, value)


@dataclass(frozen=True, eq=False)
class Panel:
    """One map of a figure.

    Parameters
    ----------
    geometry : GridGeometry
        Where the map lies; the panel shows its area.
    risk : ndarray of float64, shape (height, width), optional
        Risks in [0, 1]. None: the scene alone.
    scene : Scene
        What is drawn over it.
    title : str
        Line above it.

    Raises
    ------
    ValueError
        If the risks have another shape than the geometry, or values outside [0, 1].
    """

    geometry: GridGeometry
    risk: FloatArray | None = None
    scene: Scene = field(default_factory=Scene)
    title: str = ""

    def __post_init__(self) -> None:
        if self.risk is None:
            return
        if np.shape(self.risk) != self.geometry.shape:
            raise ValueError(
                f"Panel.risk has shape {np.shape(self.risk)}, its geometry {self.geometry.shape}"
            )
        if not ((self.risk >= 0.0) & (self.risk <= 1.0)).all():
            raise ValueError("Panel.risk must lie in [0, 1] everywhere")


def draw_panels(panels: Sequence[Sequence[Panel]], title: str = "") -> Figure:
    """Return a figure of maps in rows and columns with one colour bar and one legend.

    Parameters
    ----------
    panels : sequence of sequence of Panel
        Rows from top to bottom, all of one length.
    title : str
        Line above all.

    Raises
    ------
    ValueError
        If there is no panel, or the rows differ in length.
    """
    widths = {len(row) for row in panels}
    if len(widths) != 1 or 0 in widths:
        raise ValueError(f"rows of panels must be of one length, got {sorted(widths) or 'none'}")
    rows, columns = len(panels), widths.pop()
    x0, y0, x1, y1 = panels[0][0].geometry.bounds
    scale = (_SIDE_FEW if columns <= 2 else _SIDE_MANY) / max(x1 - x0, y1 - y0)
    size = (columns * (x1 - x0) * scale + 1.6, rows * ((y1 - y0) * scale + 0.3) + 0.9)
    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, columns, squeeze=False)
    handles: dict[str, Artist] = {}
    image: AxesImage | None = None
    for i, row in enumerate(panels):
        for j, panel in enumerate(row):
            drawn = _draw_panel(axes[i, j], panel, handles)
            image = image if drawn is None else drawn
            axes[i, j].label_outer()
    if image is not None:
        bar = figure.colorbar(image, ax=axes, fraction=0.05, pad=0.01, aspect=30)
        bar.set_label("risk [-]: the darker, the higher")
    if handles:
        figure.legend(
            list(handles.values()),
            list(handles),
            loc="outside lower center",
            ncols=len(handles) if columns > 1 else 3,
            frameon=False,
        )
    if title:
        figure.suptitle(title)
    return figure


def save_figure(figure: Figure, path: str | os.PathLike[str], dpi: int = 130) -> None:
    """Write a figure as PNG; folders that are missing are made.

    Parameters
    ----------
    figure : Figure
        As `draw_panels` returns it.
    path : path-like
        File to write; an older one is replaced.
    dpi : int
        Dots per inch.

    Raises
    ------
    OSError
        If it cannot be written; an older one is then still there.
    """
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=dpi)
    file = Path(path)
    file.parent.mkdir(parents=True, exist_ok=True)
    write_result(file, picture.getvalue())


def _draw_panel(axes: Axes, panel: Panel, handles: dict[str, Artist]) -> AxesImage | None:
    x0, y0, x1, y1 = panel.geometry.bounds
    image = None
    if panel.risk is not None:
        # Row 0 is the lowest y (grid), not the picture's top line.
        image = axes.imshow(
            panel.risk,
            cmap="gray_r",
            vmin=0.0,
            vmax=1.0,
            origin="lower",
            extent=(x0, x1, y0, y1),
            interpolation="nearest",
        )
    for label, artist in _draw_scene(axes, panel.scene):
        handles.setdefault(label, artist)
    # Walls stand just outside the area: a little margin shows them.
    margin = 0.02 * max(x1 - x0, y1 - y0)
    axes.set_xlim(x0 - margin, x1 + margin)
    axes.set_ylim(y0 - margin, y1 + margin)
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.set_title(panel.title, fontsize="medium")
    return image


def _draw_scene(axes: Axes, scene: Scene) -> Iterator[tuple[str, Artist]]:
    """Draw the scene from the ground up, and yield what the legend has to explain."""
    if len(scene.segments) or len(scene.circles):
        ends = scene.segments.reshape(-1, 2, 2)
        axes.add_collection(
            LineCollection(list(ends), colors=_TRUTH, linewidths=1.6), autolim=False
        )
        for x, y, radius in scene.circles:
            axes.add_patch(Circle((x, y), radius, fill=False, edgecolor=_TRUTH, linewidth=1.6))
        yield "true surfaces", Line2D([], [], color=_TRUTH, linewidth=1.6)
    if len(scene.plan):
        yield "planned path", _line(axes, scene.plan, _PLAN, "--")
    if len(scene.travelled):
        yield "path travelled", _line(axes, scene.travelled, _TRAVELLED, "-")
    if len(scene.perceptions):
        yield "perceptions", _draw_perceptions(axes, scene.perceptions)
    for label, place, marker, size in (
        ("start", scene.start, "s", 8.0),
        ("goal", scene.goal, "*", 15.0),
    ):
        if place is not None:
            (artist,) = axes.plot(
                *place,
                marker=marker,
                markersize=size,
                color=_ENDS,
                markeredgecolor="white",
                linestyle="none",
                zorder=5,
            )
            yield label, artist
    if scene.robot is not None:
        yield "robot", _draw_robot(axes, scene.robot, scene.robot_radius)


def _line(axes: Axes, points: FloatArray, colour: str, style: str) -> Line2D:
    (artist,) = axes.plot(
        points[:, 0], points[:, 1], style, color=colour, linewidth=1.5, path_effects=_HALO
    )
    return artist


def _draw_perceptions(axes: Axes, places: FloatArray) -> Line2D:
    (marks,) = axes.plot(
        places[:, 0],
        places[:, 1],
        "o",
        markersize=4.5,
        color="white",
        markeredgecolor=_TRAVELLED,
        markeredgewidth=1.3,
        zorder=4,
    )
    if len(places) > MAX_LABELS:
        return marks
    for number, (x, y) in enumerate(places, start=1):
        axes.annotate(
            str(number),
            (x, y),
            xytext=(4.0, 3.0),
            textcoords="offset points",
            fontsize=7.0,
            color=_LABEL,
            path_effects=_HALO,
            zorder=6,
            clip_on=True,
        )
    return marks


def _draw_robot(axes: Axes, pose: Pose2, radius: float) -> Line2D:
    axes.add_patch(
        Circle((pose.x, pose.y), radius, fill=False, edgecolor=_ENDS, linewidth=1.5, zorder=4)
    )
    nose = (pose.x + radius * math.cos(pose.theta), pose.y + radius * math.sin(pose.theta))
    axes.plot([pose.x, nose[0]], [pose.y, nose[1]], color=_ENDS, linewidth=1.5, zorder=4)
    return Line2D(
        [],
        [],
        marker="o",
        markersize=9.0,
        color="none",
        markeredgecolor=_ENDS,
        markeredgewidth=1.5,
        linestyle="none",
    )
