# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The rules that the sources themselves keep, held by the tools that `make lint` runs."""

import importlib.util
import re
import subprocess
import sys
import sysconfig
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("fuzzy_map_building", "fuzzy_navigation", "nomad_sim")
MANIFESTS = sorted(ROOT.glob("*/package.xml"))
SOURCES = sorted(
    file
    for folder in (*PACKAGES, "test", ".ci")
    for file in (ROOT / folder).rglob("*.py")
    if not {"build", "__pycache__"} & set(file.relative_to(ROOT).parts)
)


@pytest.mark.parametrize(
    ("module", "command"),
    [
        ("ruff", ["ruff", "check", "."]),
        ("ruff", ["ruff", "format", "--check", "."]),
        ("mypy", ["mypy"]),
        ("importlinter", ["lint-imports"]),
    ],
    ids=["style", "format", "types", "imports"],
)
def test_the_tools_find_nothing(module: str, command: list[str]) -> None:
    if importlib.util.find_spec(module) is None:
        pytest.skip(f"{module} is not installed for {sys.executable}")
    executable = Path(sysconfig.get_path("scripts")) / command[0]
    done = subprocess.run(
        [executable, *command[1:]], cwd=ROOT, capture_output=True, text=True, timeout=110
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("file", SOURCES, ids=lambda file: str(file.relative_to(ROOT)))
def test_a_source_says_whose_it_is_and_is_of_one_idea(file: Path) -> None:
    lines = file.read_text(encoding="utf-8").splitlines()
    assert lines[:2] == [
        "# Copyright 2026 The fuzzy navigation maintainers",
        "# SPDX-License-Identifier: Apache-2.0",
    ]
    assert len(lines) <= 400


def test_all_packages_have_one_version() -> None:
    versions = {
        file.parent.name: ElementTree.parse(file).findtext("version") for file in MANIFESTS
    }
    for setup in ROOT.glob("*/setup.py"):
        found = re.search(r'version="([^"]+)"', setup.read_text(encoding="utf-8"))
        versions[f"{setup.parent.name}/setup.py"] = found and found.group(1)
    assert len(versions) == 9
    assert len(set(versions.values())) == 1, versions


@pytest.mark.parametrize("package", PACKAGES)
def test_a_manifest_names_every_ros_package_that_is_imported(package: str) -> None:
    manifest = ElementTree.parse(ROOT / package / "package.xml")
    declared = {entry.text for tag in ("depend", "exec_depend") for entry in manifest.iter(tag)}
    imported = {
        name
        for file in (ROOT / package / package).rglob("*.py")
        for name in re.findall(
            r"^\s*(?:from|import) (rclpy|ament_index_python|fuzzy_map_building|fuzzy_navigation"
            r"|std_srvs|\w+_msgs|\w+_interfaces)\b",
            file.read_text(encoding="utf-8"),
            re.MULTILINE,
        )
    }
    assert imported - {package} <= declared


def test_the_frozen_list_leaves_nothing_open() -> None:
    lines = (ROOT / "requirements.txt").read_text(encoding="utf-8").splitlines()
    entries = [line for line in lines if not line.startswith("#")]
    assert len(entries) > 100
    assert [
        line for line in entries if not re.match(r"[\w.-]+==[\w.]+( ; python_\w+|$| ;)", line)
    ] == []
    frozen = {line.split("==")[0].lower().replace("_", "-") for line in entries}
    asked = re.findall(
        r"^([\w-]+)", (ROOT / ".ci/requirements.in").read_text(encoding="utf-8"), re.MULTILINE
    )
    assert {name.lower() for name in asked} <= frozen
