# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""YAML from files that nobody vouches for: plain values, and no more of them than text.

An alias stands for a value written elsewhere, and mappings merged from aliases of merged
mappings grow by a power with each line: a file of one kilobyte can take all memory. Nothing
that is read here needs them.
"""

from __future__ import annotations

import math
import re
import reprlib
from typing import Any

import yaml

__all__ = ["NotPlainError", "PlainLoader", "load_plain", "number_hint", "shown"]

# What people take for a number.
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")

_REPR = reprlib.Repr()
_REPR.maxstring = _REPR.maxother = _REPR.maxlong = 100


class NotPlainError(ValueError):
    """YAML that is more than plain values, each written once."""


class PlainLoader(yaml.SafeLoader):
    """PyYAML's safe loader, without aliases and repeated keys, of which it takes the last."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Compose a node, or raise NotPlainError for an alias."""
        if self.check_event(yaml.AliasEvent):
            event = self.peek_event()  # type: ignore[no-untyped-call]
            raise NotPlainError(
                f"aliases (*{event.anchor[:100]}) are not allowed; write the value out"
            )
        return super().compose_node(parent, index)

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        """Return a mapping, or raise NotPlainError for a repeated key."""
        seen: set[str] = set()
        # What is no mapping the loader refuses itself.
        for key, _ in node.value if isinstance(node, yaml.MappingNode) else ():
            if not isinstance(key, yaml.ScalarNode):
                continue
            if key.value in seen:
                raise NotPlainError(
                    f"line {key.start_mark.line + 1}: {shown(key.value)} is repeated"
                )
            seen.add(key.value)
        return super().construct_mapping(node, deep)


def load_plain(text: str | bytes, loader: type[PlainLoader] = PlainLoader) -> Any:
    """Return the value of a YAML text.

    Parameters
    ----------
    text : str or bytes
        One document, of a length that the caller has bounded.
    loader : type
        `PlainLoader`, or a stricter one.

    Raises
    ------
    ValueError
        If it is no YAML, has an alias or a key twice, is nested too deeply, or holds a value that
        cannot be: a number, a date, or one that does not fit its tag. A class of ValueError that
        the loader raises comes through as it is.
    """
    try:
        return yaml.load(text, Loader=loader)
    except ValueError as error:
        if type(error) is not ValueError:
            raise
        raise ValueError(f"a value that cannot be read: {error}") from error
    except (AttributeError, LookupError, TypeError) as error:
        # How the loader fails at a value that is not of the kind that its tag (!!bool) tells.
        raise ValueError("a value that is not of the kind that its tag tells") from error
    except RecursionError as error:
        raise ValueError("it is nested too deeply") from error
    except OverflowError as error:
        raise ValueError(f"a number is too large: {error}") from error
    except yaml.YAMLError as error:
        raise ValueError(f"it is no YAML document: {_line(error)}") from error


def shown(value: Any) -> str:
    """Return how a message shows a value: its beginning, for the whole of it may be huge.

    Examples
    --------
    >>> len(shown("x" * 1000)), shown([1, "a", None])
    (100, "[1, 'a', None]")
    """
    try:
        return _REPR.repr(value)
    except ValueError:  # the digits of a whole number
        return "a number too long to print"


def number_hint(value: Any) -> str:
    """Return how to write a text that was meant as a number, as the end of a sentence.

    YAML 1.1 takes for texts what is in quotes, and exponents without a point or a sign.

    Parameters
    ----------
    value : Any
        What was read where a number is expected.

    Returns
    -------
    str
        Empty if it is no text that looks like a number.

    Examples
    --------
    >>> number_hint("9.9e6")
    ', which is a text to YAML; write 9900000.0 without quotes, exponents as in 1.0e+3'
    >>> number_hint("many"), number_hint([1])
    ('', '')
    """
    if not isinstance(value, str) or not _NUMBER.fullmatch(value):
        return ""
    number = float(value)
    if not math.isfinite(number):
        return ""
    written = yaml.safe_dump(number).split()[0]
    return f", which is a text to YAML; write {written} without quotes, exponents as in 1.0e+3"


def _line(error: yaml.YAMLError) -> str:
    """Return where the text is wrong and why, in one line."""
    mark, problem = getattr(error, "problem_mark", None), getattr(error, "problem", None)
    if mark is None or problem is None:
        return " ".join(str(error).split())[:500]
    where = f"line {mark.line + 1}, column {mark.column + 1}"
    return " ".join(f"{where}: {problem}".split())[:500]
