# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Installs the package fuzzy_navigation."""

from glob import glob

from setuptools import find_packages, setup

setup(
    name="fuzzy_navigation",
    version="0.1.0",
    packages=find_packages(include=["fuzzy_navigation", "fuzzy_navigation.*"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/fuzzy_navigation"]),
        ("share/fuzzy_navigation", ["package.xml"]),
        ("share/fuzzy_navigation/config", sorted(glob("config/*.yaml"))),
    ],
    # For an installation without ROS; what ROS needs is in package.xml.
    install_requires=["numpy", "scipy"],
    zip_safe=True,
    maintainer="The fuzzy navigation maintainers",
    maintainer_email="maintainers@example.com",
    description="Plans paths of least risk on fuzzy maps and follows them.",
    license="Apache-2.0",
    extras_require={"test": ["pytest"]},
    entry_points={
        "console_scripts": [
            "planner = fuzzy_navigation.ros.entry:planner",
            "motion = fuzzy_navigation.ros.entry:motion",
            "bringup = fuzzy_navigation.ros.entry:bringup",
        ],
    },
)
