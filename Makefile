# From a bare machine to the running robot: see `make help`.
#
# Where ROS 2 Jazzy is sourced (ROS_DISTRO=jazzy) its packages serve. Elsewhere a virtual
# environment .venv is made from requirements.txt. The steps live in .ci, each in one script.

# Interpreter for .venv; empty: the first of python3, python3.13 ... python3.10 that serves.
PYTHON ?=
# Options of the demonstration, after --world lab --output build/demo (the last one counts).
DEMO_ARGS ?=
# Further options of `colcon test`, such as --packages-select fuzzy_nav_test.
TEST_ARGS ?=
# Further options of pytest for the benchmarks, such as -k maze.
BENCH_ARGS ?=

export PYTHON

.PHONY: help demo build test shell lint coverage bench requirements clean

help:
	@echo 'make demo          the robot crosses an unknown laboratory; results in build/demo'
	@echo '                   (DEMO_ARGS="--world office --seed 3" for other runs)'
	@echo 'make test          build, then every test of every package, in 8 minutes or more'
	@echo '                   (TEST_ARGS="--pytest-args -k planner" for some of them)'
	@echo 'make build         the environment (.venv, or a sourced ROS 2 Jazzy) and all packages'
	@echo 'make shell         a shell in which install/<package>/lib/<package>/<executable> runs'
	@echo 'make lint          ruff, mypy and the import contracts'
	@echo 'make coverage      line and branch coverage: the cores, and all'
	@echo 'make bench         times beside those of other libraries, which it installs; 5 minutes or more'
	@echo '                   (BENCH_ARGS="-k packet" for some of them)'
	@echo 'make requirements  resolve .ci/requirements.in into requirements.txt again'
	@echo 'make clean         remove .venv and everything that was built'
	@echo 'PYTHON=python3.12 chooses the interpreter (3.10-3.13).'

build:
	@.ci/build

demo: build
	@.ci/in_environment install/nomad_sim/lib/nomad_sim/demo --world lab --output build/demo $(DEMO_ARGS)

test: build
	@.ci/in_environment .ci/test $(TEST_ARGS)

# All shells are of one domain, as those of an installed ROS 2 are: what runs in them is to meet.
shell: export ROS_DOMAIN_ID ?= 0
shell: build
	@if [ -t 0 ]; then set -- -i; fi; .ci/in_environment "$${SHELL:-/bin/sh}" "$$@"

lint: build
	@.ci/in_environment .ci/lint

coverage: build
	@.ci/in_environment .ci/coverage

bench: build
	@.ci/in_environment .ci/bench $(BENCH_ARGS)

requirements:
	@.ci/requirements

clean:
	rm -rf .venv build install log .mypy_cache .ruff_cache .import_linter_cache
	find . \( -name __pycache__ -o -name '*.egg-info' -o -name .pytest_cache -o -name .hypothesis \) \
	  -type d -prune -exec rm -rf {} +
