# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Installs the package fuzzy_map_building."""

from glob import glob

from setuptools import find_packages, setup

setup(
    name="fuzzy_map_building",
    version="0.1.0",
    packages=find_packages(include=["fuzzy_map_building", "fuzzy_map_building.*"]),
    package_data={"fuzzy_map_building.ros": ["discovery.xml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/fuzzy_map_building"]),
        ("share/fuzzy_map_building", ["package.xml"]),
        ("share/fuzzy_map_building/config", sorted(glob("config/*.yaml"))),
    ],
    # For an installation without ROS; what ROS needs is in package.xml.
    install_requires=["numpy", "PyYAML"],
    zip_safe=True,
    maintainer="The fuzzy navigation maintainers",
    maintainer_email="maintainers@example.com",
    description="Builds fuzzy maps of an unknown area from ultrasonic ranges.",
    license="Apache-2.0",
    extras_require={"test": ["pytest"]},
    entry_points={
        "console_scripts": [
            "mapper = fuzzy_map_building.ros.entry:mapper",
        ],
    },
)
