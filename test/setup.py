# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Installs the package fuzzy_nav_test."""

from setuptools import setup

setup(
    name="fuzzy_nav_test",
    version="0.1.0",
    packages=[],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/fuzzy_nav_test"]),
        ("share/fuzzy_nav_test", ["package.xml"]),
    ],
    zip_safe=True,
    maintainer="The fuzzy navigation maintainers",
    maintainer_email="maintainers@example.com",
    description="Tests of all packages: units, properties, whole runs, real nodes.",
    license="Apache-2.0",
    extras_require={"test": ["pytest"]},
)
