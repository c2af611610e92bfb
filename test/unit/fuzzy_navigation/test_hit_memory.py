# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What is remembered of a perception and of the way since, and what is not."""

import math

import numpy as np
import pytest

from fuzzy_map_building.sonar_guard import RIM_SPREAD
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading
from fuzzy_navigation.hit_memory import HitMemory
from fuzzy_navigation.params import PAPER_PRESET, InfraredParameters, motion_parameters
from fuzzy_navigation.surroundings import Surroundings

RADIUS = 0.23
RING = InfraredParameters()


def reading(
    distance: float, sensor: int = 0, x: float = 1.0, stamp: float = 0.0
) -> InfraredReading:
    """A reading of a robot at (x, 2) that looks along the x axis."""
    return InfraredReading(Pose2(x, 2.0), sensor * math.pi / 8.0, distance, stamp, sensor)


def echo(
    distance: float, sensor: int = 0, turret: float = 0.0, x: float = 1.0, stamp: float = 0.0
) -> SonarReading:
    bearing = math.radians(22.5 * sensor) + turret
    return SonarReading(Pose2(x, 2.0), bearing, distance, stamp, sensor)


def ring(x: float, stamp: float, **distances: float) -> list[InfraredReading]:
    """One sweep; ``s4=0.2`` is what sensor 4 sees."""
    return [reading(distances.get(f"s{k}", math.inf), k, x, stamp) for k in range(16)]


def as_set(points: np.ndarray) -> set[tuple[float, float]]:
    return {(round(x, 9), round(y, 9)) for x, y in points.tolist()}


class TestMemory:
    def test_a_standing_sensor_counts_by_its_median(self) -> None:
        memory = HitMemory(RING)
        for distance in (0.30, 0.28, 0.10, 0.31, math.inf):
            memory.stand([reading(distance)])
        assert as_set(memory.points) == {(1.53, 2.0)}
        memory.stand([reading(0.29)])
        # Of an even number the nearer of the two in the middle.
        assert as_set(memory.points) == {(1.52, 2.0)}

    def test_a_sensor_that_mostly_sees_nothing_hits_nothing(self) -> None:
        memory = HitMemory(RING)
        for distance in (math.inf, 0.1, math.inf, math.nan, math.inf, 0.7):
            memory.stand([reading(distance)])
        assert memory.points.shape == (0, 2)
        assert [r.range for r in memory.infrared] == [math.inf]

    def test_only_the_newest_sweeps_of_a_long_stand_count(self) -> None:
        memory = HitMemory(RING)
        for _ in range(50):
            memory.stand([reading(0.1)])
        for _ in range(11):
            memory.stand([reading(0.4)])
        assert as_set(memory.points) == {(1.63, 2.0)}

    def test_on_the_way_one_sweep_counts_for_each_cell(self) -> None:
        memory = HitMemory(RING)
        memory.stand([reading(math.inf)])
        for k in range(9):
            x = 1.0 + 0.04 * k
            memory.pass_by(Pose2(x, 2.0), np.array([(x, 2.5)]))
        assert as_set(memory.points) == {(1.12, 2.5), (1.24, 2.5)}

    def test_points_of_a_raster_are_one_and_the_first_stays(self) -> None:
        memory = HitMemory(RING)
        memory.add(np.array([(0.0, 1.0), (0.002, 1.001), (0.004, 1.0), (0.0, 1.0)]))
        assert as_set(memory.points) == {(0.0, 1.0), (0.004, 1.0)}

    def test_the_newest_echo_of_each_sonar_and_stand(self) -> None:
        memory = HitMemory(RING)
        stand = math.radians(7.5)
        memory.stand([], [echo(0.5), echo(0.6, turret=stand), echo(0.7, 3)])
        memory.stand([], [echo(0.51), echo(0.61, turret=stand + 0.005)])
        assert sorted(r.range for r in memory.sonar) == [0.51, 0.61, 0.7]

    def test_forgotten_is_everything(self) -> None:
        memory = HitMemory(RING)
        memory.stand([reading(0.1)], [echo(0.5)])
        memory.add(np.array([(0.0, 1.0)]))
        memory.forget()
        assert memory.points.shape == memory.added.shape == (0, 2)
        assert memory.infrared == memory.sonar == []
        memory.pass_by(Pose2(1.0, 2.0), np.array([(3.0, 3.0)]))
        assert as_set(memory.points) == {(3.0, 3.0)}

    def test_a_perception_may_renew_only_what_it_can_see(self) -> None:
        memory = HitMemory(RING)
        memory.stand([reading(0.1)], [echo(0.5)])
        memory.add(np.array([(1.7, 2.0), (1.9, 2.0), (1.0, 3.0)]))
        memory.add(np.array([(1.0, 2.7), (0.1, 2.0)]), guessed=True)
        memory.forget_near(Pose2(1.0, 2.0), 0.83)
        assert as_set(memory.points) == {(1.9, 2.0), (1.0, 3.0), (0.1, 2.0)}
        assert as_set(memory.measured) == {(1.9, 2.0), (1.0, 3.0)}
        assert memory.infrared == memory.sonar == []
        # What is seen again is not in doubt any more.
        memory.add(np.array([(1.9, 2.0), (2.5, 2.0)]))
        assert memory.forget_kept()
        assert as_set(memory.points) == {(1.9, 2.0), (2.5, 2.0)}
        assert not memory.forget_kept()

    def test_what_a_perception_keeps_is_forgotten_as_soon_as_without_it(self) -> None:
        memory = HitMemory(RING)
        memory.add(np.array([(1.9, 2.0)]))
        for look in range(8):
            memory.outdate()
            if look == 2:
                memory.forget_near(Pose2(1.0, 2.0), 0.83)
        assert as_set(memory.points) == {(1.9, 2.0)}
        memory.outdate()
        assert memory.points.shape == (0, 2)
        assert not memory.forget_kept()

    def test_a_perception_elsewhere_keeps_what_was_seen_at_the_one_before(self) -> None:
        memory = HitMemory(RING)
        memory.stand([reading(0.3), reading(0.3, sensor=8)])
        memory.forget_near(Pose2(2.0, 2.0), 0.83)
        assert as_set(memory.points) == {(0.47, 2.0)}


LAYER = {"layer.enabled": True}
GUARD = {"sonar_guard.enabled": True, "sonar_guard.spread": math.radians(6.0)}


def around(**overrides: object) -> Surroundings:
    """Return surroundings in which nothing beyond the paper is on but what is given."""
    return Surroundings(motion_parameters(PAPER_PRESET, overrides))


class TestSurroundings:
    def test_without_layer_and_guard_nothing_is_remembered(self) -> None:
        here = around()
        here.begin_perception()
        here.update(1.0, Pose2(1.0, 2.0), ring(1.0, 1.0, s0=0.3), [echo(0.2, 4)])
        here.end_perception()
        here.update(2.0, Pose2(1.5, 2.0), ring(1.5, 2.0, s0=0.2), [echo(0.2, 4, x=1.5)])
        assert here.remembered.shape == (0, 2)
        assert as_set(here.known(2.0)) == as_set(here.seen(2.0)) == {(1.93, 2.0)}

    def test_the_layer_remembers_perception_and_way(self) -> None:
        here = around(**LAYER)
        here.update(0.5, Pose2(1.0, 2.0), ring(1.0, 0.5, s8=0.1), [])  # nobody perceives yet
        here.begin_perception()
        here.update(1.0, Pose2(1.0, 2.0), ring(1.0, 1.0, s0=0.3), [])
        here.end_perception()
        assert as_set(here.remembered) == {(1.53, 2.0)}
        here.update(2.0, Pose2(1.05, 2.0), ring(1.05, 2.0, s4=0.2), [])
        assert as_set(here.remembered) == {(1.53, 2.0)}
        assert as_set(here.known(2.0)) == {(1.53, 2.0), (1.05, 2.43)}
        here.update(3.0, Pose2(1.2, 2.0), ring(1.2, 3.0, s4=0.2), [])
        here.update(4.0, Pose2(1.25, 2.0), ring(1.25, 4.0), [])
        assert as_set(here.known(4.0)) == {(1.53, 2.0), (1.2, 2.43)}
        here.begin_perception()
        assert here.remembered.shape == (0, 2)

    def test_what_may_have_stopped_it_is_near_or_seen_now(self) -> None:
        here = around(**LAYER)
        here.begin_perception()
        here.update(1.0, Pose2(1.0, 2.0), ring(1.0, 1.0, s0=0.5, s8=0.2), [])
        here.end_perception()
        here.update(2.0, Pose2(1.3, 2.0), ring(1.3, 2.0, s4=0.5), [])
        # Ahead at 1.73, remembered; behind at 0.57, too far; beside at 2.73, seen now.
        near = here.near(2.0, Pose2(1.3, 2.0))
        assert as_set(near) == {(1.73, 2.0), (1.3, 2.73)}

    @pytest.mark.parametrize("layer", [True, False])
    def test_an_echo_too_close_to_measure_counts_but_is_kept_only_when_it_lasts(
        self, layer: bool
    ) -> None:
        here = around(**GUARD, **{"layer.enabled": layer})
        here.begin_perception()
        here.update(1.0, Pose2(1.0, 2.0), ring(1.0, 1.0), [])
        here.end_perception()
        here.update(2.0, Pose2(1.05, 2.0), ring(1.05, 2.0), [echo(-math.inf, 4, x=1.05)])
        rim = {
            (round(1.05 + 0.23 * math.cos(a), 9), round(2.0 + 0.23 * math.sin(a), 9))
            for a in (math.pi / 2.0 + d for d in (0.0, RIM_SPREAD, -RIM_SPREAD))
        }
        assert as_set(here.known(2.0)) == rim
        pose = Pose2(1.05, 2.0)
        assert as_set(here.near(2.0, pose, 1)) == set()
        assert as_set(here.near(2.0, pose, 2)) == rim

    def test_what_was_measured_here_before_explains_an_echo_too_close_to_measure(self) -> None:
        """As beside the end of a thin wall, which no ray hits from where the robot looks anew."""
        here = around(**LAYER, **GUARD)
        here.begin_perception()
        here.update(1.0, Pose2(1.0, 2.0), ring(1.0, 1.0), [])
        here.end_perception()
        here.update(2.0, Pose2(1.15, 2.0), ring(1.15, 2.0, s4=0.11), [])
        assert as_set(here.remembered) == {(1.15, 2.34)}
        for time in (3.0, 5.0):
            here.begin_perception()
            here.update(time, Pose2(1.15, 2.0), ring(1.15, time), [])
            here.end_perception()
            beside = [echo(-math.inf, 4, x=1.15)]
            here.update(time + 1.0, Pose2(1.15, 2.0), ring(1.15, time + 1.0), beside)
            # The echo tells that it is still there, and not that it touches the body.
            assert as_set(here.known(time + 1.0)) == {(1.15, 2.34)}
        # Not so of what lies elsewhere.
        other = [echo(-math.inf, 12, x=1.15)]
        here.update(7.0, Pose2(1.15, 2.0), ring(1.15, 7.0), other)
        assert len(here.known(7.0)) == 4
        # The robot has been away, and who knows what stands there now.
        for time, x in ((8.0, 1.8), (9.0, 1.15)):
            here.update(time, Pose2(x, 2.0), ring(x, time), [])
            here.begin_perception()
            here.update(time, Pose2(x, 2.0), ring(x, time), [])
            here.end_perception()
        here.update(10.0, Pose2(1.15, 2.0), ring(1.15, 10.0), [echo(-math.inf, 4, x=1.15)])
        assert len(here.known(10.0)) == 3

    def test_at_rest_nothing_is_remembered(self) -> None:
        here = around(**LAYER, **GUARD)
        here.begin_perception()
        here.end_perception()
        here.rest()
        here.update(2.0, Pose2(1.0, 2.0), ring(1.0, 2.0, s4=0.2), [echo(0.1)])
        assert here.remembered.shape == (0, 2)

    @pytest.mark.parametrize("layer", [True, False])
    def test_the_guard_at_a_perception(self, layer: bool) -> None:
        """Ahead glass at 0.5 m that infrareds do not see, on the left a wall that they see."""
        here = around(**GUARD, **{"layer.enabled": layer})
        here.begin_perception()
        for k in range(3):
            echoes = [echo(0.5), echo(0.2, 4), echo(0.61, 8)]
            here.update(1.0 + k, Pose2(1.0, 2.0), ring(1.0, 1.0 + k, s4=0.2), echoes)
        here.end_perception()
        spread = math.radians(6.0)
        glass = {
            (round(1.0 + 0.73 * math.cos(a), 9), round(2.0 + 0.73 * math.sin(a), 9))
            for a in (0.0, spread, -spread)
        }
        assert as_set(here.remembered) == (glass | {(1.0, 2.43)} if layer else glass)

    def test_the_guard_on_the_way_reaches_less_far(self) -> None:
        here = around(**GUARD)
        here.begin_perception()
        here.end_perception()
        here.update(1.0, Pose2(1.0, 2.0), ring(1.0, 1.0), [echo(0.26)])
        assert here.remembered.shape == (0, 2)
        here.update(2.0, Pose2(1.01, 2.0), ring(1.01, 2.0, s0=0.3), [echo(0.24, x=1.01)])
        assert here.remembered.shape == (0, 2)  # an infrared hit 6 cm farther explains it
        here.update(3.0, Pose2(1.02, 2.0), ring(1.02, 3.0), [echo(0.24, x=1.02)])
        assert (1.49, 2.0) in as_set(here.remembered)
        assert len(here.remembered) == 3
        here.begin_perception()
        assert here.remembered.shape == (0, 2)

    def test_echoes_on_the_way_are_suspected_before_they_count(self) -> None:
        here = around(**GUARD)
        here.begin_perception()
        here.update(0.5, Pose2(1.0, 2.0), ring(1.0, 0.5), [echo(0.5)])
        assert here.suspected(0.5).shape == (0, 2)  # the robot stands
        here.end_perception()
        assert here.suspected(0.5).shape == (0, 2)
        echoes = [echo(0.55, stamp=1.0), echo(0.5, 4, stamp=1.0)]
        here.update(1.0, Pose2(1.0, 2.0), ring(1.0, 1.0, s4=0.5), echoes)
        assert len(here.suspected(1.0)) == 3
        assert as_set(here.suspected(1.0)) >= {(1.78, 2.0)}
        assert len(here.remembered) == 3  # of the perception
        # The newest of a sonar counts, for half a second.
        newer = [echo(0.4, x=1.1, stamp=1.2)]
        here.update(1.2, Pose2(1.1, 2.0), ring(1.1, 1.2, s4=0.5), newer)
        assert as_set(here.suspected(1.2)) >= {(1.73, 2.0)}
        assert len(here.suspected(1.2)) == 3
        assert here.suspected(1.8).shape == (0, 2)
        unguarded = around(**LAYER)
        unguarded.begin_perception()
        unguarded.end_perception()
        unguarded.update(1.0, Pose2(1.0, 2.0), ring(1.0, 1.0), [echo(0.3, stamp=1.0)])
        assert unguarded.suspected(1.0).shape == (0, 2)

    def test_an_unknown_infrared_is_refused_with_all_that_came(self) -> None:
        here = around(**LAYER)
        here.begin_perception()
        with pytest.raises(ValueError, match="sensor 16"):
            here.update(1.0, Pose2(1.0, 2.0), [reading(0.1), reading(0.1, 16)], [])
        assert here.remembered.shape == here.seen(1.0).shape == (0, 2)

    def test_a_clock_that_steps_back_clears_all(self) -> None:
        here = around(**LAYER)
        here.begin_perception()
        here.update(1.0, Pose2(1.0, 2.0), ring(1.0, 1.0, s0=0.3), [])
        here.clear()
        assert here.remembered.shape == here.known(1.0).shape == (0, 2)
        assert "infrared_0, infrared_1, infrared_2, infrared_3 and 12" in here.distrusted(1.0)

    def test_clearance_is_of_what_is_seen_now(self) -> None:
        here = around()
        assert here.clearance(1.0, Pose2(1.0, 2.0)) == math.inf
        here.update(1.0, Pose2(1.0, 2.0), ring(1.0, 1.0, s0=0.3), [])
        assert here.clearance(1.0, Pose2(1.1, 2.0)) == pytest.approx(0.2)
        assert here.clearance(2.0, Pose2(1.1, 2.0)) == math.inf


def test_on_the_way_what_is_not_seen_again_for_some_looks_is_forgotten() -> None:
    memory = HitMemory(RING)
    memory.stand([reading(0.3)])
    memory.add(np.array([(1.0, 1.0), (2.0, 2.0)]))
    memory.add(np.array([(3.0, 3.0)]), guessed=True)
    for _ in range(8):
        memory.outdate()
        assert as_set(memory.points) == {(1.53, 2.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0)}
        assert memory.guesses == 1
    memory.add(np.array([(2.0, 2.0), (4.0, 4.0)]))
    memory.outdate()
    # The perception's own counts from when the robot had left it.
    assert as_set(memory.points) == {(1.53, 2.0), (2.0, 2.0), (4.0, 4.0)}
    assert memory.guesses == 0
    for _ in range(8):
        memory.outdate()
    assert len(memory.points) == 0
    memory.stand([reading(0.3)])
    memory.forget()
    memory.stand([reading(0.3)])
    memory.outdate()
    assert len(memory.points) == 1  # a perception begins anew
