# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""ROS parameters from the one declaration in a package's ``params.py``.

In a node's constructor::

    self._settings = declare_parameters(
        self, mapper_parameters, PRESETS, on_change=self._use_parameters
    )
    self._settings.values  # the frozen dataclass that is valid now

(not ``self._parameters``: that is rclpy's own, and its parameter services die of it).

Every field becomes a ROS parameter with its dotted name, description, unit and range, and
``preset`` chooses where the values that are not given come from. A name that does not
exist, in a YAML file or on the command line, and a value that must not be, end the start
(`ParameterError`, which `run.spin_node` turns into one line and exit code 2). While the
node runs every change is checked as a whole, cross-checks included, before it is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any, Final, Generic, TypeVar

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.service import Service

from fuzzy_map_building.parameter_schema import (
    ParameterError,
    ParameterInfo,
    checked_value,
    describe,
    flatten,
    from_mapping,
    kind_of,
    suggest,
    unknown_parameter,
)
from fuzzy_map_building.plain_yaml import shown

__all__ = ["PRESET", "NodeParameters", "declare_parameters"]

T = TypeVar("T")

#: Name of the parameter that chooses the preset.
PRESET: Final = "preset"
#: Overrides that rclpy itself looks up, by prefix.
_RCLPY_PREFIX: Final = "qos_overrides."
#: The one parameter of every node that rclpy declares.
_SIM_TIME: Final = "use_sim_time"
_INTEGER_LIMIT: Final = 2**63 - 1
_SCALARS: Final = {
    bool: Parameter.Type.BOOL,
    int: Parameter.Type.INTEGER,
    float: Parameter.Type.DOUBLE,
    str: Parameter.Type.STRING,
}
_ARRAYS: Final = {
    bool: Parameter.Type.BOOL_ARRAY,
    int: Parameter.Type.INTEGER_ARRAY,
    float: Parameter.Type.DOUBLE_ARRAY,
    str: Parameter.Type.STRING_ARRAY,
}


class NodeParameters(Generic[T]):
    """The parameters of a node that are valid now.

    Attributes
    ----------
    values : dataclass instance
        Replaced as a whole when a parameter changes.
    on_refusal : callable, optional
        ``on_refusal(source, reason, message)`` for each change at run time that was refused,
        as `Diagnostics.reject` takes it.
    remark : callable, optional
        ``remark(names)`` returns what whoever has just set parameters is told of a change that
        was taken, such as from when on it holds; empty: nothing.
    """

    def __init__(self, values: T, on_change: Callable[[T], None] | None) -> None:
        self.values = values
        self.on_refusal: Callable[[str, str, str], None] | None = None
        self.remark: Callable[[Iterable[str]], str] = lambda _: ""
        self._on_change = on_change
        self._infos = describe(type(values))

    @property
    def names(self) -> Collection[str]:
        """Their dotted names."""
        return self._infos.keys()

    def convert(self, parameters: Iterable[Parameter]) -> list[Parameter]:
        """Return the parameters with whole numbers made floats where floats belong.

        rclpy refuses ``1`` for a parameter of type double; people write it all the time.
        """
        return [self._converted(p) for p in parameters]

    def _converted(self, parameter: Parameter) -> Parameter:
        info = self._infos.get(parameter.name)
        if info is None:
            return parameter
        kind, value = parameter.type_, parameter.value
        if info.is_sequence and kind.name.endswith("_ARRAY") and len(value) == 0:
            return Parameter(parameter.name, _type_of(info), [])
        if info.type is float and kind is Parameter.Type.INTEGER and not info.is_sequence:
            return Parameter(parameter.name, Parameter.Type.DOUBLE, float(value))
        if info.type is float and kind is Parameter.Type.INTEGER_ARRAY and info.is_sequence:
            return Parameter(
                parameter.name, Parameter.Type.DOUBLE_ARRAY, [float(v) for v in value]
            )
        return parameter

    def refusal(self, parameter: Parameter) -> str:
        """Return why a parameter cannot be set, whatever the others are; empty if it can.

        rclpy refuses the same, but names neither the parameter nor what it should be.
        """
        info = self._infos.get(parameter.name)
        if info is None:
            return unknown_parameter(parameter.name, self._infos)
        if info.read_only:
            return _only_at_the_start(parameter.name)
        converted = self._converted(parameter)
        kind = converted.type_
        if kind is _type_of(info):
            try:
                checked_value(info, converted.value)
            except ParameterError as error:
                return str(error)
            return ""
        wanted = kind_of(info)
        if kind is Parameter.Type.NOT_SET:
            return f"parameter '{parameter.name}' cannot be removed; it must be {wanted}"
        return f"parameter '{parameter.name}' must be {wanted}, got {shown(parameter.value)}"

    def check(self, parameters: Iterable[Parameter]) -> SetParametersResult:
        """Return whether the node may take the changed parameters, and why not."""
        try:
            self._changed(parameters)
        except ValueError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def apply(self, parameters: Iterable[Parameter]) -> None:
        """Take changed parameters that `check` has passed."""
        changed = self._changed(parameters)
        if changed == self.values:
            return
        self.values = changed
        if self._on_change is not None:
            self._on_change(changed)

    def _changed(self, parameters: Iterable[Parameter]) -> T:
        changes = {p.name: p.value for p in parameters if p.name in self._infos}
        return from_mapping(self.values, changes) if changes else self.values


def declare_parameters(
    node: Node,
    factory: Callable[[str, Mapping[str, Any]], T],
    presets: Iterable[str] = (),
    *,
    default_preset: str = "",
    on_change: Callable[[T], None] | None = None,
) -> NodeParameters[T]:
    """Declare every parameter of a dataclass on a node.

    Parameters
    ----------
    node : Node
        Parameters that it declared before are left alone, and are known names.
    factory : callable
        ``factory(preset, overrides)`` returns the frozen parameter dataclass or raises
        `ParameterError`. For a dataclass without presets:
        ``lambda _, overrides: from_mapping(SimulatorParameters(), overrides)``.
    presets : iterable of str
        Names of the presets. When there are none, no parameter ``preset`` is declared, and one
        that is given, as by a file's section for all nodes, is not used.
    default_preset : str
        The preset used when none is chosen; empty: the first of `presets`.
    on_change : callable, optional
        Called with the new dataclass after a change at run time was accepted. To refuse a
        change, declare the parameter ``read_only`` or check it in the dataclass.

    Returns
    -------
    NodeParameters
        ``.values`` is the dataclass valid now.

    Raises
    ------
    ParameterError
        For an unknown name or a refused value among the overrides.
    """
    # rclpy offers the overrides of undeclared parameters in no other way.
    given = {
        name: parameter.value
        for name, parameter in node._parameter_overrides.items()
        if not node.has_parameter(name) and not name.startswith(_RCLPY_PREFIX)
    }
    names = tuple(presets)
    preset = default_preset or (names[0] if names else "")
    preset = given.pop(PRESET, preset)
    if not names and preset:
        node.get_logger().warning(f"there are no presets here: {preset!r} is not used")
    if names and preset not in names:
        raise ParameterError(f"unknown preset {preset!r}{suggest(str(preset), names)}")
    known = describe(type(factory(preset, {})))
    for name, value in given.items():
        if name not in known:
            own = (PRESET, _SIM_TIME) if names else (_SIM_TIME,)
            raise ParameterError(unknown_parameter(name, (*known, *own)))
        if value is None and known[name].is_sequence:
            given[name] = ()  # ROS hands an empty list on as no value
    parameters = NodeParameters(factory(preset, given), on_change)
    if names:
        node.declare_parameter(PRESET, preset, _preset_descriptor(names), ignore_override=True)
    values = flatten(parameters.values)
    for name, info in known.items():
        value = list(values[name]) if info.is_sequence else values[name]
        node.declare_parameter(name, value, _descriptor(info, value), ignore_override=True)
    node.add_pre_set_parameters_callback(parameters.convert)
    node.add_on_set_parameters_callback(parameters.check)
    node.add_post_set_parameters_callback(parameters.apply)
    _guard_services(node, parameters)
    return parameters


def _guard_services(node: Node, parameters: NodeParameters[T]) -> None:
    """Look at requests to set parameters before rclpy does, and at its refusals after it."""
    kinds = {kind.value for kind in Parameter.Type}

    def reason(message: Any) -> str:
        # rclpy's callbacks die of a value of no type.
        if message.value.type not in kinds:
            return f"{shown(message.name)} has a value of type {message.value.type}, unknown"
        parameter = Parameter.from_parameter_msg(message)
        if message.name in parameters.names or not node.has_parameter(message.name):
            return parameters.refusal(parameter)
        if node.describe_parameter(message.name).read_only:
            return _only_at_the_start(message.name)
        if message.name == _SIM_TIME and parameter.type_ is not Parameter.Type.BOOL:
            return f"parameter '{_SIM_TIME}' must be true or false, got {shown(parameter.value)}"
        return ""

    def told(result: SetParametersResult, *messages: Any) -> SetParametersResult:
        if result.successful:
            # rclpy keeps no reason of what was done.
            result.reason = parameters.remark(message.name for message in messages)
        elif parameters.on_refusal is not None:
            parameters.on_refusal("set_parameters", "refused", result.reason)
        return result

    def guarded(service: Service) -> Callable[[Any, Any], Any]:
        callback = service.callback

        def each(request: Any, response: Any) -> Any:
            results = [
                SetParametersResult(successful=False, reason=reason(p)) for p in request.parameters
            ]
            messages = request.parameters
            good = [i for i, result in enumerate(results) if not result.reason]
            request.parameters = [messages[i] for i in good]
            answered = callback(request, response).results
            for i, result in zip(good, answered, strict=True):
                results[i] = result
            response.results = [told(*each) for each in zip(results, messages, strict=True)]
            return response

        def together(request: Any, response: Any) -> Any:
            reasons = list(filter(None, map(reason, request.parameters)))
            if reasons:
                response.result = SetParametersResult(
                    successful=False, reason=f"nothing was set: {reasons[0]}"
                )
            else:
                response = callback(request, response)
            told(response.result, *request.parameters)
            return response

        return each if service.srv_type is SetParameters else together

    for service in node.services:
        if service.srv_type in (SetParameters, SetParametersAtomically):
            service.callback = guarded(service)


def _only_at_the_start(name: str) -> str:
    return f"parameter '{name}' can be set only when the node is started"


def _type_of(info: ParameterInfo) -> Parameter.Type:
    return (_ARRAYS if info.is_sequence else _SCALARS)[info.type]


def _preset_descriptor(names: tuple[str, ...]) -> ParameterDescriptor:
    return ParameterDescriptor(
        description="set of values that all parameters not given are taken from",
        additional_constraints="one of " + ", ".join(names),
        read_only=True,
    )


def _descriptor(info: ParameterInfo, value: Any) -> ParameterDescriptor:
    """Return what ROS tools show of a parameter, and the range that rclpy enforces."""
    unit = f" [{info.unit}]" if info.unit else ""
    source = f" ({info.source})" if info.source else ""
    descriptor = ParameterDescriptor(
        description=f"{info.doc}{unit}{source}",
        additional_constraints=_constraints(info),
        read_only=info.read_only,
        # ROS infers a type from the elements, which an empty list has not.
        dynamic_typing=info.is_sequence and not value,
    )
    # A range with one open end would show as a slider over all floats: the schema checks it.
    if info.minimum is None or info.maximum is None:
        return descriptor
    if info.type is float:
        descriptor.floating_point_range = [
            FloatingPointRange(from_value=float(info.minimum), to_value=float(info.maximum))
        ]
    elif info.type is int:
        low, high = (
            max(-_INTEGER_LIMIT, min(_INTEGER_LIMIT, int(v))) for v in (info.minimum, info.maximum)
        )
        descriptor.integer_range = [IntegerRange(from_value=low, to_value=high, step=1)]
    return descriptor


def _constraints(info: ParameterInfo) -> str:
    if info.choices:
        return "one of " + ", ".join(repr(choice) for choice in info.choices)
    bounds = []
    if info.minimum is not None:
        bounds.append(f"at least {info.minimum}")
    if info.maximum is not None:
        bounds.append(f"at most {info.maximum}")
    return (("each " if info.is_sequence else "") + ", ".join(bounds)) if bounds else ""
