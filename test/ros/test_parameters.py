# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of a node: where they come from, what is refused at the start and while it runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.parameter import Parameter

from fuzzy_map_building.parameter_schema import describe, flatten
from fuzzy_map_building.params import MapperParameters, mapper_parameters
from fuzzy_map_building.ros import names, qos
from ros.harness import NodeProcess, Probe, wait_until

NODE = names.MAPPER_NODE

FILE = """
fuzzy_mapper:
  ros__parameters:
    preset: map_building
    evidence:
      k_empty: 0.2
    sonar.max_range: 5
    turret.angles: [0, 1]
"""


class Remote:
    """The parameter services of the mapper."""

    def __init__(self, probe: Probe) -> None:
        self._probe = probe
        self._diagnostics = probe.subscribe(DiagnosticArray, names.DIAGNOSTICS, qos.RELIABLE)

    def refused(self) -> int:
        """Return how many changes the next diagnostics count as refused."""
        self._diagnostics.clear()
        values = self._diagnostics.wait_for().status[0].values
        return sum(int(v.value) for v in values if v.key == "rejected.set_parameters.refused")

    def get(self, name: str) -> object:
        request = GetParameters.Request(names=[name])
        response = self._probe.call(GetParameters, f"{NODE}/get_parameters", request)
        return Parameter.from_parameter_msg(
            Parameter(name).to_parameter_msg().__class__(name=name, value=response.values[0])
        ).value

    def set(self, **values: object) -> list[str]:
        """Set each parameter on its own; return why not, empty where it was done."""
        request = SetParameters.Request(parameters=self._messages(values))
        response = self._probe.call(SetParameters, f"{NODE}/set_parameters", request)
        return [r.reason for r in response.results if not r.successful]

    def set_together(self, **values: object) -> str:
        """Set all parameters or none; return why not."""
        request = SetParametersAtomically.Request(parameters=self._messages(values))
        service = f"{NODE}/set_parameters_atomically"
        result = self._probe.call(SetParametersAtomically, service, request).result
        return "" if result.successful else result.reason

    @staticmethod
    def _messages(values: dict[str, object]) -> list[object]:
        return [
            Parameter(name.replace("__", "."), value=value).to_parameter_msg()
            for name, value in values.items()
        ]


@pytest.fixture(scope="module")
def shared_probe() -> Iterator[Probe]:
    probe = Probe()
    yield probe
    probe.close()


@pytest.fixture(scope="module")
def mapper(tmp_path_factory: pytest.TempPathFactory) -> Iterator[NodeProcess]:
    folder = tmp_path_factory.mktemp("mapper")
    (folder / "mapper.yaml").write_text(FILE)
    process = NodeProcess(
        "mapper",
        folder / "mapper.log",
        arguments=["--ros-args", "--params-file", str(folder / "mapper.yaml")],
        parameters={"evidence.k_occupied": 1},
    )
    process.wait_for_output("mapping")
    yield process
    process.close()


@pytest.fixture
def remote(shared_probe: Probe, mapper: NodeProcess) -> Remote:
    return Remote(shared_probe)


def test_preset_file_and_command_line_each_override_what_is_before(remote: Remote) -> None:
    expected = mapper_parameters(
        "map_building",
        {
            "evidence.k_empty": 0.2,
            "evidence.k_occupied": 1.0,
            "sonar.max_range": 5.0,
            "turret.angles": (0.0, 1.0),
        },
    )
    assert remote.get("preset") == "map_building"
    for name in ("fusion.aggregation", "evidence.k_empty", "evidence.k_occupied"):
        assert remote.get(name) == flatten(expected)[name]
    # Whole numbers were given for both: they are doubles here.
    assert remote.get("sonar.max_range") == 5.0
    assert list(remote.get("turret.angles")) == [0.0, 1.0]
    assert list(remote.get("sonar.frame_ids")) == [f"sonar_{i}" for i in range(16)]


def test_every_parameter_is_declared_with_its_meaning_and_range(
    shared_probe: Probe, mapper: NodeProcess
) -> None:
    listed = shared_probe.call(
        ListParameters, f"{NODE}/list_parameters", ListParameters.Request()
    ).result.names
    known = describe(MapperParameters)
    assert set(known) <= set(listed)
    response = shared_probe.call(
        DescribeParameters,
        f"{NODE}/describe_parameters",
        DescribeParameters.Request(names=list(known)),
    )
    for descriptor, info in zip(response.descriptors, known.values(), strict=True):
        assert info.doc in descriptor.description
        assert info.unit in descriptor.description
        assert descriptor.read_only == info.read_only
        if info.type is float and None not in (info.minimum, info.maximum):
            limits = descriptor.floating_point_range[0]
            assert (limits.from_value, limits.to_value) == (info.minimum, info.maximum)
        for choice in info.choices:
            assert str(choice) in descriptor.additional_constraints


def test_changes_while_the_node_runs(remote: Remote) -> None:
    assert remote.set(evidence__k_empty=0.35) == []
    assert remote.get("evidence.k_empty") == 0.35
    assert remote.set(evidence__k_empty=1) == []  # a whole number for a double
    assert remote.get("evidence.k_empty") == 1.0
    assert remote.set(turret__angles=[0, 2]) == []
    assert list(remote.get("turret.angles")) == [0.0, 2.0]
    assert remote.set(fusion__aggregation="max", fusion__max_count=7) == []


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"evidence__k_empty": 1.5}, "must be at most 1.0, got 1.5"),
        ({"evidence__k_empty": float("nan")}, "must be finite, got nan"),
        ({"evidence__range_margin": float("inf")}, "must be finite, got inf"),
        ({"evidence__k_empty": "much"}, "'evidence.k_empty' must be a number, got 'much'"),
        ({"fusion__max_count": 2.5}, "'fusion.max_count' must be a whole number, got 2.5"),
        ({"evidence__k_empty": [0.5]}, "'evidence.k_empty' must be a number, got"),
        ({"turret__angles": 0.5}, "'turret.angles' must be a list of numbers, got 0.5"),
        (
            {"turret__angles": ["a"]},
            "'turret.angles' must be a list of numbers, got ['a']",
        ),
        ({"evidence__k_empty": None}, "'evidence.k_empty' cannot be removed"),
        ({"fusion__aggregation": "mena"}, "did you mean 'mean'"),
        ({"turret__angles": [0.0, 99.0]}, "turret.angles"),
        # Each is in its range; together they are not: the sonar's maximum is 5 m.
        ({"sonar__min_range": 6.0}, "must be less than"),
        ({"area__resolution": 0.05}, "can be set only when the node is started"),
        ({"preset": "oriolo1998"}, "can be set only when the node is started"),
        (
            {"evidence__k_emty": 0.1},
            "unknown parameter 'evidence.k_emty'; did you mean 'evidence.k_empty'?",
        ),
    ],
)
def test_changes_that_are_refused(remote: Remote, change: dict[str, object], reason: str) -> None:
    (name,) = change
    before = None if "emty" in name else remote.get(name.replace("__", "."))
    (answer,) = remote.set(**change)
    assert reason in answer
    if before is not None:
        assert remote.get(name.replace("__", ".")) == before
    assert reason in remote.set_together(**change)


def test_refused_changes_are_counted_and_the_others_of_the_request_are_made(
    remote: Remote,
) -> None:
    before = remote.refused()
    answers = remote.set(evidence__k_empty=0.27, evidence__k_emty=0.1, fusion__max_count="x")
    assert ["unknown" in answer for answer in answers] == [True, False]
    assert remote.get("evidence.k_empty") == 0.27
    assert remote.set_together(evidence__k_empty=0.28, evidence__k_emty=0.1)
    assert remote.get("evidence.k_empty") == 0.27
    wait_until(lambda: remote.refused() == before + 3, "three refusals")


def test_values_of_no_type_are_refused_and_the_node_lives(
    shared_probe: Probe, remote: Remote
) -> None:
    good = Parameter("evidence.k_empty", value=0.11).to_parameter_msg()
    bad = Parameter("evidence.k_occupied", value=0.5).to_parameter_msg()
    bad.value.type = 99
    request = SetParameters.Request(parameters=[good, bad])
    response = shared_probe.call(SetParameters, f"{NODE}/set_parameters", request)
    assert [r.successful for r in response.results] == [True, False]
    assert "'evidence.k_occupied' has a value of type 99" in response.results[1].reason
    assert remote.get("evidence.k_empty") == 0.11
    good = Parameter("evidence.k_empty", value=0.12).to_parameter_msg()
    together = SetParametersAtomically.Request(parameters=[good, bad])
    service = f"{NODE}/set_parameters_atomically"
    assert not shared_probe.call(SetParametersAtomically, service, together).result.successful
    assert remote.get("evidence.k_empty") == 0.11


def test_limits_that_only_hold_together_are_changed_together_or_not_at_all(
    remote: Remote,
) -> None:
    assert remote.set_together(sonar__min_range=7.0, sonar__max_range=8.0) == ""
    assert "must be less than" in remote.set_together(sonar__min_range=3.0, sonar__max_range=2.0)
    assert remote.get("sonar.min_range") == 7.0
    assert remote.set_together(sonar__min_range=0.12, sonar__max_range=5.0) == ""


@pytest.mark.parametrize(
    ("parameters", "reason"),
    [
        ({"evidence.k_emtpy": 0.2}, "unknown parameter 'evidence.k_emtpy'; did you mean"),
        ({"use_simtime": True}, "unknown parameter 'use_simtime'; did you mean 'use_sim_time'?"),
        ({"presett": "oriolo1998"}, "unknown parameter 'presett'; did you mean 'preset'?"),
        ({"use_sim_time": 1.5}, "set parameter 'use_sim_time' to '1.5' of type 'DOUBLE'"),
        ({"preset": "oriolo"}, "did you mean 'oriolo1998'?"),
        ({"evidence.k_empty": "abc"}, "must be a number, got 'abc'"),
        ({"sonar.min_range": 7.0}, "must be less than"),
        ({"area.size_x": 90000.0, "area.resolution": 0.001}, "exceeds the limit"),
    ],
)
def test_a_start_that_is_refused_says_why_in_one_line(
    start_node: Callable[..., NodeProcess], parameters: dict[str, object], reason: str
) -> None:
    process = start_node("mapper", parameters=parameters)
    assert process.wait() == 2
    output = process.output()
    assert reason in output
    assert len(output.strip().splitlines()) == 1


def test_a_file_with_a_misspelt_name_is_refused(
    start_node: Callable[..., NodeProcess], tmp_path: Path
) -> None:
    path = tmp_path / "mapper.yaml"
    path.write_text(FILE.replace("k_empty", "k_emptiness"))
    process = start_node("mapper", arguments=["--ros-args", "--params-file", str(path)])
    assert process.wait() == 2
    assert "unknown parameter 'evidence.k_emptiness'; did you mean" in process.output()


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--world", "lab"], "unknown argument '--world'"),
        (["--ros-args", "--params-file", "/nowhere.yaml"], "/nowhere.yaml: No such file"),
        (
            ["--ros-args", "-p", "mode=continuous"],
            "-p mode=continuous: <name>:=<value> is expected",
        ),
        # ROS itself takes no list of whole and other numbers.
        (["--ros-args", "-p", "turret.angles:=[0, 0.1]"], "the command line was refused"),
    ],
)
def test_a_command_line_that_is_refused(
    start_node: Callable[..., NodeProcess], arguments: list[str], reason: str
) -> None:
    process = start_node("mapper", arguments=arguments)
    assert process.wait() == 2
    assert reason in process.output()
    assert "Traceback" not in process.output()


def test_types_are_those_of_the_declaration(shared_probe: Probe, mapper: NodeProcess) -> None:
    types = {
        "evidence.k_empty": ParameterType.PARAMETER_DOUBLE,
        "fusion.max_count": ParameterType.PARAMETER_INTEGER,
        "mode": ParameterType.PARAMETER_STRING,
        "sonar.bearings": ParameterType.PARAMETER_DOUBLE_ARRAY,
        "sonar.frame_ids": ParameterType.PARAMETER_STRING_ARRAY,
    }
    request = DescribeParameters.Request(names=list(types))
    response = shared_probe.call(DescribeParameters, f"{NODE}/describe_parameters", request)
    assert [d.type for d in response.descriptors] == list(types.values())
