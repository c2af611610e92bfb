# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The rules that the sources themselves keep, held by the tools that `make lint` runs."""

import os
import re
import subprocess
import sys
import sysconfig
from importlib import metadata
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


def frozen_versions(name: str) -> list[str]:
    """Versions of a distribution in requirements.txt, one for each range of Pythons."""
    text = (ROOT / "requirements.txt").read_text(encoding="utf-8")
    return re.findall(rf"^{re.escape(name)}==([^\s;]+)", text, re.MULTILINE)


@pytest.mark.parametrize(
    ("tool", "command"),
    [
        ("ruff", ["ruff", "check", "."]),
        ("ruff", ["ruff", "format", "--check", "."]),
        ("mypy", ["mypy"]),
        ("import-linter", ["lint-imports"]),
    ],
    ids=["style", "format", "types", "imports"],
)
def test_the_tools_find_nothing(tool: str, command: list[str]) -> None:
    try:
        version = metadata.version(tool)
    except metadata.PackageNotFoundError:
        pytest.skip(f"{tool} is not installed for {sys.executable}")
    if version not in frozen_versions(tool):
        pytest.skip(f"{tool} is {version}: another version finds other things")
    if tool == "mypy" and sys.version_info < (3, 11):
        pytest.skip("numpy for Python 3.10 is older and declares other types")
    executable = Path(sysconfig.get_path("scripts")) / command[0]
    done = subprocess.run(
        [executable, *command[1:]],
        cwd=ROOT,
        # The sources, whether or not they are installed.
        env=os.environ | {"PYTHONPATH": os.pathsep.join(str(ROOT / name) for name in PACKAGES)},
        capture_output=True,
        text=True,
        timeout=110,
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


@pytest.mark.parametrize("package", PACKAGES)
def test_a_manifest_names_the_libraries_that_are_imported(package: str) -> None:
    manifest = ElementTree.parse(ROOT / package / "package.xml")
    declared = {entry.text for entry in manifest.iter("exec_depend")}
    imported = {
        f"python3-{name}"
        for file in (ROOT / package / package).rglob("*.py")
        for name in re.findall(
            r"^\s*(?:from|import) (numpy|scipy|matplotlib|tqdm|yaml)\b",
            file.read_text(encoding="utf-8"),
            re.MULTILINE,
        )
    }
    assert imported <= declared


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
