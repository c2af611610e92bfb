# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The campaign's command line: options and their help."""

from __future__ import annotations

from argparse import ArgumentParser, RawDescriptionHelpFormatter
from typing import NoReturn

from fuzzy_map_building.params import DEFAULT_PRESET
from fuzzy_map_building.wording import real_number, whole_number
from nomad_sim.world_io import world_names
from nomad_sim.worlds import KINDS

__all__ = ["PROGRAM", "CampaignParser", "campaign_parser"]

PROGRAM = "campaign"

_EPILOG = """examples:
  campaign --world lab --seeds 20 --jobs 2
  campaign --world office --set simulator.sonar.beam_half_angle=12.5deg --output results
  campaign --world office --replay 7 --output seed7 --figures every
  campaign --reference --row clutter --row office --seeds 20 --output results
  campaign --generated 1000 --jobs 2 --output results      (again: takes it up where it ended)
  campaign --floor-plan office.yaml --missions 200 --output results
  campaign --generated --kind maze --replay 7 --output seed7

exit code: 0 if every verdict was true and nothing was touched (--reference: if each row
reached at least the method's share and nothing was touched), 1 if not, 2 if the options
cannot be or it could not go on to its end, 130 after Ctrl-C.
"""


class CampaignParser(ArgumentParser):
    """An argument parser whose complaints are one line."""

    def error(self, message: str) -> NoReturn:
        """Leave with code 2 and one line."""
        self.exit(2, f"{self.prog}: {message}\n")

    def known_options(self) -> list[str]:
        """Return the names of all options."""
        return [name for name in self._option_string_actions if name.startswith("--")]


def campaign_parser() -> CampaignParser:
    """Return the parser of the campaign's command line."""
    parser = CampaignParser(
        PROGRAM,
        description="Run many missions without ROS, one for each seed, and sum them up.",
        epilog=_EPILOG,
        formatter_class=RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    what = parser.add_argument_group("what to run")
    what.add_argument("--world", help=f"a world file, or one of {', '.join(world_names())}")
    what.add_argument(
        "--reference", action="store_true", help="the worlds that the method was measured in"
    )
    what.add_argument(
        "--row", action="append", metavar="NAME", help="only this row of --reference; repeatable"
    )
    what.add_argument(
        "--generated",
        type=whole_number,
        nargs="?",
        const=1,
        metavar="N",
        help="N missions, each in a world drawn by its seed",
    )
    what.add_argument(
        "--floor-plan",
        metavar="FILE",
        help="missions in a map_server map (YAML with its image), start and goal by seed",
    )
    what.add_argument(
        "--missions",
        type=whole_number,
        metavar="N",
        help="how many missions with --floor-plan (20)",
    )
    what.add_argument(
        "--kind",
        action="append",
        metavar="NAME",
        help=f"only this kind of --generated; repeatable: {', '.join(KINDS)} in turn",
    )
    what.add_argument("--seeds", type=whole_number, metavar="N", help="missions (20)")
    what.add_argument("--first-seed", type=whole_number, metavar="N", help="seed of the first (1)")
    what.add_argument("--fresh", action="store_true", help="draw the first seed, and say it")
    what.add_argument(
        "--start-spread",
        type=real_number,
        metavar="M",
        help="how far a start is from the world's in x and y at most, in metres, at any "
        "heading; 0: the world's start (0.3)",
    )
    rules = parser.add_argument_group("rules and world")
    rules.add_argument("--preset", default=DEFAULT_PRESET, help=f"rule set ({DEFAULT_PRESET})")
    rules.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="a parameter of mapper, planner, motion or simulator, such as "
        "mapper.evidence.k_empty=0.3; angles with deg behind them; repeatable",
    )
    rules.add_argument(
        "--critical-angle",
        action="append",
        default=[],
        metavar="MATERIAL=DEG",
        help="critical angle of a material, such as painted_wall=25; repeatable",
    )
    how = parser.add_argument_group("how")
    how.add_argument(
        "--jobs",
        type=whole_number,
        metavar="N",
        help="missions at a time (all cores)",
    )
    how.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="let the workers of this Dask scheduler run what is drawn (needs 'distributed')",
    )
    how.add_argument("--output", metavar="FOLDER", help="write CSV and JSON there")
    how.add_argument("--json", action="store_true", help="print JSON in place of tables")
    how.add_argument(
        "--replay",
        type=whole_number,
        metavar="SEED",
        help="run one mission and tell its perceptions",
    )
    how.add_argument(
        "--figures",
        choices=("last", "every"),
        help="draw a replay into --output at its end or at every perception (last)",
    )
    return parser
