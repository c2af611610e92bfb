# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What all studies share: options, a table beside the paper's values, claims, files.

A claim is a sentence of the paper that a run can confirm or not. Its verdict is always
computed from the run; one that does not hold is printed as such and is no error.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from matplotlib.figure import Figure

from nomad_sim.output_folder import write_result
from nomad_sim.render import save_figure

#: The paper that is reproduced.
PAPER = "Oriolo, Ulivi, Vendittelli, IEEE Trans. SMC-B 28(3), 1998"
#: What stands where the paper gives no value.
NOT_GIVEN = "-"


@dataclass(frozen=True)
class Options:
    """Options of a study's command line."""

    quick: bool
    seed: int
    output: Path
    jobs: int
    seeds: int = 1
    worlds: Sequence[str] = ()


def parse_options(
    description: str,
    argv: Sequence[str] | None = None,
    seeds: int | None = None,
    worlds: Sequence[str] = (),
) -> Options:
    """Read the options that every study takes; with defaults, also how many seeds and where."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--quick", action="store_true", help="the smallest run that tells")
    parser.add_argument("--seed", type=_seed, default=0, help="(first) seed of all noise")
    parser.add_argument(
        "--output", type=Path, default=Path("build/studies"), help="folder of the results"
    )
    parser.add_argument(
        "--jobs", type=_count, default=len(os.sched_getaffinity(0)), help="processes at a time"
    )
    if seeds is not None:
        parser.add_argument("--seeds", type=_count, default=seeds, help="missions of each line")
    if worlds:
        parser.add_argument("--worlds", nargs="+", choices=worlds, default=worlds, help="where")
    return Options(**vars(parser.parse_args(argv)))


def _seed(text: str) -> int:
    seed = int(text)
    if seed < 0:
        raise argparse.ArgumentTypeError(f"a seed is not negative, got {text}")
    return seed


def _count(text: str) -> int:
    count = int(text)
    if count < 1:
        raise argparse.ArgumentTypeError(f"at least one is needed, got {text}")
    return count


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper, and what came of it.

    Parameters
    ----------
    name : str
        Short and unique in its study.
    sentence : str
        What is claimed, as it is tested.
    holds : bool
        Whether it came so.
    found : str
        What was found.
    """

    name: str
    sentence: str
    holds: bool
    found: str

    def __str__(self) -> str:
        verdict = "holds" if self.holds else "does not hold"
        return f"{verdict:<13}  {self.name}: {self.sentence} ({self.found})"


@dataclass
class Study:
    """Gathers a study's results, then prints and writes them.

    Parameters
    ----------
    name : str
        Of the files that are written.
    title : str
        Heading.
    options : Options
        Of the command line.
    header : sequence of str
        Columns of the table.
    """

    name: str
    title: str
    options: Options
    header: Sequence[str] = ("quantity", "paper", "here")
    rows: list[tuple[str, ...]] = field(default_factory=list)
    claims: list[Claim] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def row(self, *cells: str) -> None:
        """Add a line of the table."""
        if len(cells) != len(self.header):
            raise ValueError(f"a row has {len(self.header)} cells, got {cells}")
        self.rows.append(cells)

    def claim(self, name: str, sentence: str, holds: bool, found: str) -> None:
        """Add a claim and its verdict."""
        self.claims.append(Claim(name, sentence, bool(holds), found))

    def note(self, text: str) -> None:
        """Add a remark below the table."""
        self.notes.append(text)

    def finish(self, figure: Figure) -> int:
        """Print everything, write the table and the figure, and return the exit code."""
        table = self._table()
        held = sum(claim.holds for claim in self.claims)
        lines = [self.title, "=" * len(self.title), f"Paper: {PAPER}.", "", *table, ""]
        lines += [*self.notes, ""] if self.notes else []
        print("\n".join([*lines, *map(str, self.claims)]))
        print(f"\n{held} of {len(self.claims)} claims hold", flush=True)
        claims = [
            f"| {c.name} | {c.sentence} | {'holds' if c.holds else '**does not hold**'} "
            f"| {c.found} |"
            for c in self.claims
        ]
        lines += ["| claim | as tested | verdict | found |", "|---|---|---|---|", *claims, ""]
        lines += [f"![{self.title}]({self.name}.png)", ""]
        try:
            self.options.output.mkdir(parents=True, exist_ok=True)
            write_result(self.options.output / f"{self.name}.md", "\n".join(lines))
            save_figure(figure, self.options.output / f"{self.name}.png")
        except OSError as error:
            print(f"{self.name}: {error}", file=sys.stderr)
            return 2
        print(f"written to {self.options.output}")
        return 0

    def _table(self) -> list[str]:
        """Return the table as Markdown that lines up as text as well."""
        cells = [tuple(self.header), *self.rows]
        widths = [max(len(row[i]) for row in cells) for i in range(len(self.header))]
        lines = [
            "| " + " | ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) + " |"
            for row in cells
        ]
        lines.insert(1, "|" + "|".join("-" * (w + 2) for w in widths) + "|")
        return lines
