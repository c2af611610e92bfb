# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameters declared once: what is derived from the declaration."""

import itertools
import math
from dataclasses import dataclass, field

import numpy as np
import pytest

from fuzzy_map_building.parameter_schema import (
    ParameterError,
    describe,
    flatten,
    from_mapping,
    parameter,
    suggest,
    validate,
)


@dataclass(frozen=True)
class Wheel:
    radius: float = parameter(0.1, doc="radius", unit="m", minimum=0.01, maximum=1.0)
    spokes: int = parameter(5, doc="spokes", minimum=3)

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class Cart:
    name: str = parameter("cart", doc="name", choices=("cart", "wagon"))
    loaded: bool = parameter(False, doc="loaded")
    offsets: tuple[float, ...] = parameter((0.0, 1.0), doc="offsets", minimum=-1.0)
    wheel: Wheel = field(default_factory=Wheel)

    def __post_init__(self) -> None:
        validate(self)


def test_describe_gives_every_parameter_in_order() -> None:
    infos = describe(Cart)
    assert list(infos) == ["name", "loaded", "offsets", "wheel.radius", "wheel.spokes"]
    radius = infos["wheel.radius"]
    assert (radius.type, radius.default, radius.unit, radius.is_sequence) == (
        float,
        0.1,
        "m",
        False,
    )
    assert infos["offsets"].is_sequence
    assert infos["offsets"].type is float
    assert infos["loaded"].type is bool
    assert infos["name"].choices == ("cart", "wagon")


def test_flatten_and_back() -> None:
    changed = Cart(name="wagon", offsets=(2.0,), wheel=Wheel(0.2, 7))
    flat = flatten(changed)
    assert flat["wheel.spokes"] == 7
    assert from_mapping(Cart(), flat) == changed


def test_nested_and_dotted_names_are_the_same() -> None:
    nested = from_mapping(Cart(), {"wheel": {"radius": 0.3}, "loaded": True})
    dotted = from_mapping(Cart(), {"wheel.radius": 0.3, "loaded": np.bool_(True)})
    assert nested == dotted
    assert nested.wheel.spokes == 5


def test_values_take_the_declared_type() -> None:
    cart = from_mapping(Cart(), {"wheel.radius": 1, "wheel.spokes": np.int64(4), "offsets": [3]})
    assert type(cart.wheel.radius) is float
    assert type(cart.wheel.spokes) is int
    assert cart.offsets == (3.0,)
    assert type(cart.offsets[0]) is float


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"wheel.radius": 2.0}, "'wheel.radius' must be at most 1.0 m, got 2.0"),
        ({"wheel.radius": 0.0}, "at least 0.01 m"),
        ({"wheel.radius": math.nan}, "must be finite"),
        ({"wheel.radius": math.inf}, "must be finite"),
        ({"wheel.radius": "big"}, "must be a number, got 'big'$"),
        ({"wheel.radius": True}, "must be a number, got True"),
        ({"wheel.spokes": 2}, "at least 3"),
        ({"wheel.spokes": 4.5}, "must be a whole number, got 4.5"),
        ({"wheel.spokes": True}, "must be a whole number, got True"),
        ({"loaded": 1}, "must be true or false, got 1"),
        ({"name": 3}, "must be a text, got 3"),
        ({"name": "wagn"}, "one of cart, wagon, got 'wagn'; did you mean 'wagon'"),
        ({"name": "train"}, "one of cart, wagon, got 'train'$"),  # nothing is told twice
        ({"offsets": 1.0}, "is a list"),
        ({"offsets": "1.0"}, "is a list"),
        ({"offsets": [0.0, -2.0]}, "at least -1.0"),
        ({"wheel.radus": 0.1}, "unknown parameter 'wheel.radus'; did you mean 'wheel.radius'"),
        ({"engine": 1}, "unknown parameter 'engine'; known names: loaded, name"),
        ({3: 1}, "parameter names are text"),
        ({"wheel.radius": 10**400}, "must be finite"),
        ({"wheel.spokes": -(10**5000)}, "at least 3, got a number too long to print"),
        ({"wheel.radius": "x" * 9999}, "must be a number, got 'xxx"),
        ({"name": "x" * 9999}, "more than 1024 characters"),
        ({"offsets": itertools.repeat(0.0)}, "more than 1024 elements"),
        ({"e" * 9999: 1}, "unknown parameter 'eee"),
    ],
)
def test_a_bad_value_is_named(values: dict, message: str) -> None:
    with pytest.raises(ParameterError, match=message.replace(".", r"\.")) as caught:
        from_mapping(Cart(), values)
    assert len(str(caught.value)) < 500  # whatever the length of what is refused


def test_the_constructor_checks_as_well() -> None:
    with pytest.raises(ParameterError, match="'radius' must be at most"):
        Wheel(radius=2.0)
    assert type(Wheel(radius=1).radius) is float


def test_an_empty_default_list_has_no_type() -> None:
    @dataclass(frozen=True)
    class Untyped:
        values: tuple[float, ...] = parameter((), doc="of which type?")

    with pytest.raises(TypeError, match="values"):
        describe(Untyped)


def test_suggest() -> None:
    assert suggest("preest", ["preset", "mode"]) == "; did you mean 'preset'?"
    assert suggest("xyz", ["preset", "mode"]) == "; known names: mode, preset"
    assert suggest("xyz", [f"name_{k}" for k in range(26)]) == (
        "; none of the 26 known names is like it"
    )
    assert suggest("xyz", ["preset", "mode"], told=True) == ""
