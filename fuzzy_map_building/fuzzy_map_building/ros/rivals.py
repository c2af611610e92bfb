# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Others who publish or serve what a robot has one node for.

Two bringups in one domain and namespace are two motions that drive one robot and two mappers
that turn its turret, and each of them finds nothing amiss. Who shares a topic on purpose, as a
teleop does, is told as well; nobody is kept from anything.

A node that was killed stays in the graph for up to 20 s, but only of those who knew it: the one
that is started in its place does not meet it. Whoever else it was a rival of is told of it for
that time more.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Final

from rclpy.node import Node

from fuzzy_map_building.ros import names

__all__ = ["Rivals"]

#: At so many looks in a row somebody has to be there to count: a node that takes over from
#: another may find it leaving.
LOOKS: Final = 3
#: What the middleware calls a node whose name it does not know.
UNKNOWN: Final = "_NODE_NAME_UNKNOWN_"
# An action is served by services; this one takes its goals.
_GOALS_OF_ACTION: Final = "/_action/send_goal"


class Rivals:
    """Looks for others who publish or serve what a node alone should.

    Parameters
    ----------
    node : Node
        Who publishes and serves.
    topics, services, actions : sequence of str
        What no other node should publish and serve, as the node names it.
    """

    def __init__(
        self,
        node: Node,
        topics: Sequence[str] = (),
        services: Sequence[str] = (),
        actions: Sequence[str] = (),
    ) -> None:
        self._node = node
        self._topics = tuple(node.resolve_topic_name(topic) for topic in topics)
        self._services = tuple(
            node.resolve_service_name(service)
            for service in (*services, *(f"{action}{_GOALS_OF_ACTION}" for action in actions))
        )
        self._looks: Counter[str] = Counter()
        self._told: frozenset[str] = frozenset()

    def look(self) -> str:
        """Look who is there now, some microseconds for each name.

        Returns
        -------
        str
            What is shared for `LOOKS` looks by now, with whom, and what to do; empty: nothing.
            The log hears of it once, when it begins.
        """
        counted = dict(self._counted())
        shared = {name for name, count in counted.items() if count > 1}
        self._looks = Counter({name: self._looks[name] + 1 for name in shared})
        lasting = [name for name in counted if self._looks[name] >= LOOKS]
        text = ""
        if lasting:
            told = "; ".join(self._told_of(name, counted[name]) for name in lasting)
            text = f"{told}: stop all but one, or give each robot a namespace of its own"
            if names.CLOCK in lasting:
                # A topic of no namespace, and what time is for all nodes that hear it.
                text += f", and its nodes a clock by -r {names.CLOCK}:=/NAME{names.CLOCK}"
        if not self._told.issuperset(lasting):
            self._node.get_logger().warning(text)
        self._told = frozenset(lasting)
        return text

    def _counted(self) -> Iterator[tuple[str, int]]:
        for topic in self._topics:
            yield topic, self._node.count_publishers(topic)
        for service in self._services:
            yield service, self._node.count_services(service)

    def _told_of(self, name: str, count: int) -> str:
        if name in self._services:
            return f"'{name.removesuffix(_GOALS_OF_ACTION)}' has {count} servers"
        infos = self._node.get_publishers_info_by_topic(name)
        nodes = sorted(
            "one of unknown name"  # the middleware hears of nodes and their topics one by one
            if i.node_name == UNKNOWN
            else f"{i.node_namespace.rstrip('/')}/{i.node_name}"
            for i in infos
        )
        return f"'{name}' has {count} publishers ({', '.join(nodes)})"
