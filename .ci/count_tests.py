# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Prints how many tests the result files below a folder report; fails when none ran."""

import sys
from pathlib import Path
from xml.etree import ElementTree


def count(folder: Path) -> dict[str, int]:
    """Add up the test cases of every JUnit file that `colcon test` wrote below `folder`."""
    total = {"passed": 0, "failed": 0, "skipped": 0}
    files = [*folder.glob("*/pytest.xml"), *folder.glob("*/test_results/**/*.xml")]
    for file in files:
        for case in ElementTree.parse(file).iter("testcase"):
            outcome = {child.tag for child in case}
            if outcome & {"failure", "error"}:
                total["failed"] += 1
            elif "skipped" in outcome:
                total["skipped"] += 1
            else:
                total["passed"] += 1
    return total


def main() -> int:
    """Print the counts in one line; the exit code is 1 when a test failed or none passed."""
    total = count(Path(sys.argv[1]))
    print(", ".join(f"{number} {outcome}" for outcome, number in total.items()))
    if not any(total.values()):
        print("no test ran: the tests of all packages are those of fuzzy_nav_test")
    return int(total["failed"] > 0 or total["passed"] == 0)


if __name__ == "__main__":
    sys.exit(main())
