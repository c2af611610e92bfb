# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which nodes a command line and its parameter files speak to.

A node takes from a parameter file the sections that bear its name and says nothing of the
others: one for ``fuzzy_maper`` would leave it on its defaults. So names that are nearly
those of a node of this project are refused, and a node that no section of a file speaks to
says so. Sections for nodes of others, and with wildcards, are nobody's mistake.
"""

from __future__ import annotations

import difflib
import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from fuzzy_map_building.plain_yaml import load_plain, shown
from fuzzy_map_building.ros import names

__all__ = ["Addressed", "section_parameters"]

#: Longest parameter file that is read [bytes].
MAX_FILE_SIZE: Final = 1_000_000
#: Likeness from which on a name is taken for a misspelt one, 1 for the same.
_ALIKE: Final = 0.75
_KEY: Final = "ros__parameters"
_KNOWN: Final = (names.MAPPER_NODE, names.PLANNER_NODE, names.MOTION_NODE, names.SIMULATOR_NODE)


def section_parameters(path: str | Path) -> dict[str, frozenset[str]]:
    """Return what a parameter file has sections for, wildcards included.

    Returns
    -------
    dict of str to frozenset of str
        Names of nodes with their namespaces, such as ``/robot/fuzzy_mapper``, and the dotted names
        of the parameters that each is given; none of an empty file.

    Raises
    ------
    ValueError
        If it cannot be read, is no YAML, or is no mapping of node names to parameters.
    """
    try:
        if Path(path).is_fifo():  # to open it would wait for somebody at its other end
            raise ValueError("a pipe is no parameter file")
        with Path(path).open("rb") as file:
            text = file.read(MAX_FILE_SIZE + 1)
        if len(text) > MAX_FILE_SIZE:
            raise ValueError(f"longer than {MAX_FILE_SIZE} bytes is no parameter file")
        content: Any = load_plain(text)
        if content is None:
            return {}
        if not isinstance(content, dict):
            raise ValueError("a mapping of node names to parameters expected")
        out: dict[str, frozenset[str]] = {}
        for name, parameters in _sections(content, ""):
            out[name] = out.get(name, frozenset()) | parameters
        return out
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror}") from error
    except RecursionError as error:
        raise ValueError(f"{path}: it is nested too deeply") from error
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _sections(content: Mapping[Any, Any], above: str) -> Iterator[tuple[str, frozenset[str]]]:
    """Yield the mapping's nodes and parameters; namespaces may be mappings of their own."""
    for key, value in content.items():
        name = f"{above}/{str(key).strip('/')}"
        if not isinstance(value, dict):
            if not above:
                raise ValueError(f"{shown(key)} needs the key '{_KEY}' and its parameters")
            node = shown(above.strip("/"))
            raise ValueError(
                f"{node} needs the key '{_KEY}' above its parameters, such as {shown(key)}"
            )
        if _KEY in value:
            if not isinstance(value[_KEY], dict):
                raise ValueError(f"'{_KEY}' of {shown(key)} must hold parameters by name")
            yield name, frozenset(_parameters(value[_KEY], ""))
        else:
            yield from _sections(value, name)


def _parameters(content: Mapping[Any, Any], above: str) -> Iterator[str]:
    for key, value in content.items():
        if isinstance(value, dict):
            yield from _parameters(value, f"{above}{key}.")
        else:
            yield f"{above}{key}"


@dataclass(frozen=True)
class _Argument:
    """A part of the command line that speaks to nodes by name."""

    text: str
    nodes: Mapping[str, frozenset[str]]


class Addressed:
    """The nodes that a command line speaks to.

    Parameters
    ----------
    argv : sequence of str
        The command line; one that rcl has taken.

    Raises
    ------
    ValueError
        For a name that is nearly that of a node of this project.
    """

    def __init__(self, argv: Sequence[str]) -> None:
        self._files: list[_Argument] = []
        self._values: list[_Argument] = []  # whatever sets parameters; the last one wins
        rules: list[_Argument] = []
        renamed: list[str] = []
        for flag, text in itertools.pairwise(argv):
            if flag == "--params-file":
                self._files.append(_Argument(f"--params-file {text}", section_parameters(text)))
                self._values.append(self._files[-1])
            elif flag in ("-p", "--param", "-r", "--remap"):
                target, rule, value = text.partition(":=")
                if not rule:
                    raise ValueError(f"{flag} {text}: <name>:=<value> is expected, as in a:=1.0")
                node, colon, what = target.rpartition(":")
                if colon and not what.startswith("//"):  # rostopic://name is of no node
                    rules.append(_Argument(f"{flag} {text}", {node: frozenset()}))
                if flag in ("-p", "--param"):
                    given = {node or "**": frozenset([what])}
                    self._values.append(_Argument(f"{flag} {text}", given))
                if (what or target) in ("__node", "__name"):
                    renamed.append(value)
        for argument in (*self._files, *rules):
            for name in argument.nodes:
                _check(argument.text, name, (*_KNOWN, *renamed))

    def origin(self, reason: str, node: str) -> str:
        """Return where a refused parameter was given, to be put behind the reason.

        Parameters
        ----------
        reason : str
            Why the node cannot start; it names the parameter in quotes.
        node : str
            Name of the node, without its namespace.

        Returns
        -------
        str
            The argument, and the section of a file, in brackets; empty if none gives it.
        """
        named = set(re.findall(r"'([^']+)'", reason.partition("did you mean")[0]))
        found = ""
        for argument in self._values:
            for section, parameters in argument.nodes.items():
                if _last(section) in (node, "*", "**") and named & parameters:
                    where = f", section '{section}'" if argument in self._files else ""
                    found = f" ({argument.text}{where})"
        return found

    def unheard(self, node: str) -> list[str]:
        """Return a sentence for each parameter file that has no section for a node.

        Parameters
        ----------
        node : str
            Name of the node, without its namespace.
        """
        return [
            f"{file.text} has no section for '{node}', only for "
            f"{', '.join(map(repr, file.nodes))}: nothing of it is used here"
            if file.nodes
            else f"{file.text} is empty"
            for file in self._files
            if not any(_last(name) in (node, "*", "**", *_KNOWN) for name in file.nodes)
        ]


def _last(name: str) -> str:
    return name.rsplit("/", 1)[-1]


def _check(text: str, name: str, known: Sequence[str]) -> None:
    node = _last(name)
    # A name that holds a known one is a second node's, such as fuzzy_mapper_left.
    if "*" in node or any(name in node for name in known):
        return
    for near in difflib.get_close_matches(node, known, n=1, cutoff=_ALIKE):
        raise ValueError(f"{text}: there is no node '{node}'; did you mean '{near}'?")
