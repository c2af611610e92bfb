# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Table and figure of a run: ``python report.py RESULTS.json FOLDER``."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt

PEER = "pyastar2d"


def table(results: list[dict[str, Any]]) -> str:
    """Return the results as Markdown."""
    lines = [
        f"| work | who | median [ms] | of {PEER} | first time [ms] | peak bytes a cell | cost |",
        "|---|---|---|---|---|---|---|",
    ]
    peers = {
        r["group"]: r["stats"]["median"] for r in results if r["extra_info"]["contender"] == PEER
    }
    for result in results:
        info, median = result["extra_info"], result["stats"]["median"]
        share = f"{median / peers[result['group']]:.2f}" if result["group"] in peers else ""
        if info["contender"] == "A3":
            cost = "least maximum"
        else:
            cost = "least" if abs(info["excess"]) <= 1e-12 else f"+{info['excess']:.0e}"
        lines.append(
            f"| {result['group']} | {info['contender']} | {1e3 * median:.4g} | {share} "
            f"| {1e3 * info['cold']:.4g} | {info['bytes_per_cell']:.0f} | {cost} |"
        )
    return "\n".join(lines) + "\n"


def figure(results: list[dict[str, Any]], file: Path) -> None:
    """Draw how the time grows with the map."""
    rows = [r for r in results if re.match("rooms", r["group"])]
    _, axes = plt.subplots(figsize=(7.0, 4.5))
    for name in dict.fromkeys(r["extra_info"]["contender"] for r in rows):
        points = sorted(
            (r["extra_info"]["cells"], 1e3 * r["stats"]["median"])
            for r in rows
            if r["extra_info"]["contender"] == name
        )
        bold = {"linewidth": 2.5} if name in ("A2", "A3") else {"linewidth": 1.0}
        axes.loglog(*zip(*points, strict=True), marker="o", label=name, **bold)
    axes.set_xlabel("cells of the map")
    axes.set_ylabel("median processor time of a search [ms]")
    axes.grid(True, which="both", alpha=0.3)
    axes.legend()
    plt.savefig(file, dpi=110, bbox_inches="tight")


def main(arguments: Sequence[str]) -> None:
    """Print the table and write both beside the results."""
    results = json.loads(Path(arguments[0]).read_text(encoding="utf-8"))["benchmarks"]
    results = [r for r in results if r["extra_info"]]  # those that did not fail
    folder = Path(arguments[1])
    text = table(results)
    print(text, flush=True)  # first, for it needs no room on a disk
    (folder / "table.md").write_text(text, encoding="utf-8")
    figure(results, folder / "growth.png")


if __name__ == "__main__":
    main(sys.argv[1:])
