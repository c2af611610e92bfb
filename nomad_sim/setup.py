# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Installs the package nomad_sim."""

from glob import glob

from setuptools import find_packages, setup

setup(
    name="nomad_sim",
    version="0.1.0",
    packages=find_packages(include=["nomad_sim", "nomad_sim.*"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/nomad_sim"]),
        ("share/nomad_sim", ["package.xml"]),
        ("share/nomad_sim/config", sorted(glob("config/*.yaml"))),
        ("share/nomad_sim/worlds", sorted(glob("worlds/*.yaml"))),
    ],
    # For an installation without ROS; what ROS needs is in package.xml.
    install_requires=["matplotlib", "numpy", "PyYAML", "scipy", "tqdm"],
    zip_safe=True,
    maintainer="The fuzzy navigation maintainers",
    maintainer_email="maintainers@example.com",
    description="Simulates a NOMAD 200 with sonar ring, turret and infrared sensors.",
    license="Apache-2.0",
    extras_require={"test": ["pytest"], "cluster": ["distributed"]},
    entry_points={
        "console_scripts": [
            "sim = nomad_sim.ros.entry:sim",
            "demo = nomad_sim.ros.entry:demo",
            "campaign = nomad_sim.ros.entry:campaign",
        ],
    },
)
