# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whether a node would take its parameters, told before any node is started.

Who starts several nodes would otherwise learn of a refusal from the first that ends, and then
wait for the others, which are still loading, to end as well.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from rclpy.context import Context
from rclpy.exceptions import InvalidParameterTypeException
from rclpy.node import Node

from fuzzy_map_building.parameter_schema import ParameterError
from fuzzy_map_building.ros.addressed import Addressed
from fuzzy_map_building.ros.discovery import set_discovery
from fuzzy_map_building.ros.parameters import NodeParameters

__all__ = ["check_parameters"]

T = TypeVar("T")


def check_parameters(
    name: str,
    declare: Callable[[Node], NodeParameters[T]],
    arguments: Sequence[str],
    domain: int | None = None,
) -> NodeParameters[T]:
    """Have a bare node declare the parameters of one that is to be started.

    Parameters
    ----------
    name : str
        Of the node.
    declare : callable
        What the node does with itself to declare its parameters, `declare_parameters`.
    arguments : sequence of str
        What follows ``--ros-args`` of its command line; one that `check_arguments` has passed.
    domain : int, optional
        ROS domain; None: that of the process.

    Returns
    -------
    NodeParameters
        Those that the node would have.

    Raises
    ------
    ValueError
        If the node would refuse a parameter, in the words that it would say itself.
    """
    argv = [name, "--ros-args", *arguments]
    addressed = Addressed(argv)
    set_discovery()  # as a node does
    context = Context()
    context.init(args=argv, domain_id=domain)
    try:
        node = Node(name, context=context, enable_rosout=False, start_parameter_services=False)
        try:
            return declare(node)
        finally:
            node.destroy_node()
    except (ParameterError, InvalidParameterTypeException) as error:
        raise ValueError(
            f"{name}: cannot start: {error}{addressed.origin(str(error), name)}"
        ) from error
    finally:
        context.try_shutdown()
