# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Real node processes for tests: start them, talk to them, wait with deadlines, end them.

The fixtures `probe` and `start_node` in ``conftest.py`` wrap what is here, in the ROS domain
(variable ``ROS_DOMAIN_ID``) that is reserved for the module's tests::

    def test_reset(probe, start_node):
        mapper = start_node("mapper", parameters={"mode": "continuous"})
        maps = probe.subscribe(OccupancyGrid, "motion_map", qos.LATCHED)
        probe.call(Trigger, "reset_map", Trigger.Request())
        maps.wait_for(lambda message: max(message.data) == 100)
        mapper.assert_clean_stop(signal.SIGINT)

Nothing here sleeps for a fixed time: discovery takes 0.1 s mostly, 3 s at times.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Generic, TypeVar

import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.action.client import ClientGoalHandle
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

T = TypeVar("T")

#: Longest wait for anything that takes a fraction of a second on a machine without load [s].
DEADLINE = 30.0
#: Longest wait for a process to come up, on a machine that is busy compiling as well [s].
START_DEADLINE = 90.0
#: Pause between two looks at a condition [s].
POLL = 0.01

#: Where each executable lives: package and module with its ``main``.
EXECUTABLES: Mapping[str, tuple[str, str]] = {
    "mapper": ("fuzzy_map_building", "fuzzy_map_building.ros.mapper_node"),
    "planner": ("fuzzy_navigation", "fuzzy_navigation.ros.planner_node"),
    "motion": ("fuzzy_navigation", "fuzzy_navigation.ros.motion_node"),
    "bringup": ("fuzzy_navigation", "fuzzy_navigation.ros.bringup"),
    "sim": ("nomad_sim", "nomad_sim.ros.sim_node"),
    "demo": ("nomad_sim", "nomad_sim.ros.demo"),
    "campaign": ("nomad_sim", "nomad_sim.campaign"),
}


def wait_until(
    condition: Callable[[], T], what: str, timeout: float = DEADLINE, step: float = POLL
) -> T:
    """Return the first true value of `condition`, or fail after `timeout` [s]."""
    end = time.monotonic() + timeout
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end:
            raise AssertionError(f"waited {timeout} s in vain for {what}")
        time.sleep(step)


class Received(Generic[T]):
    """The messages that came by a topic, oldest first."""

    def __init__(self, topic: str) -> None:
        self.topic = topic
        self.messages: list[T] = []

    def __len__(self) -> int:
        return len(self.messages)

    @property
    def last(self) -> T:
        """The newest message."""
        return self.messages[-1]

    def clear(self) -> None:
        """Forget what has come so far."""
        self.messages.clear()

    def wait_for(
        self,
        matches: Callable[[T], bool] = lambda _: True,
        timeout: float = DEADLINE,
        what: str = "",
    ) -> T:
        """Return the first message that matches, waiting for it."""

        def find() -> list[T]:
            return [m for m in list(self.messages) if matches(m)][:1]

        return wait_until(find, what or f"a message on {self.topic}", timeout)[0]


class Goal:
    """A goal that was sent; as rclpy's handle, but safe in the thread of the test."""

    def __init__(self, probe: Probe, handle: ClientGoalHandle) -> None:
        self._probe = probe
        self._handle = handle

    @property
    def accepted(self) -> bool:
        """Whether the server took the goal."""
        return bool(self._handle.accepted)

    def get_result_async(self) -> Future:
        """Ask for the result."""
        return self._probe.run(self._handle.get_result_async)

    def cancel_goal_async(self) -> Future:
        """Ask to cancel the goal."""
        return self._probe.run(self._handle.cancel_goal_async)


class Probe:
    """A node of the test itself, spun by one executor in a thread of its own.

    rclpy's action clients lose an answer that comes before the request is entered in their
    books, and an entity that is destroyed while its executor waits for it ends the executor:
    whatever does such things has to be done by the thread that spins, with `run`.
    """

    def __init__(self, name: str = "probe") -> None:
        self._context = Context()
        rclpy.init(context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self.node: Node = rclpy.create_node(name, context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._stop = False
        self._thread = threading.Thread(target=self._spin, name=name, daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        while not self._stop:
            try:
                self._executor.spin_once(timeout_sec=0.05)
            except ExternalShutdownException:
                return

    def run(self, function: Callable[[], T]) -> T:
        """Return what a function returns that is called by the thread that spins."""
        task = self._executor.create_task(function)
        wait_until(task.done, "the thread of the probe", step=0.002)
        if task.exception() is not None:
            raise task.exception()
        result: T = task.result()
        return result

    def close(self) -> None:
        """End the thread and leave the domain.

        Actions are ended first, by the thread that spins: destroying the node would leave
        them for others to find, and their goals keep servers alive as long as they live.
        """
        self.end_actions()
        self._stop = True
        self._thread.join(DEADLINE)
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def end_actions(self) -> None:
        """Offer and use no action any more."""
        for waitable in list(self.node.waitables):
            if isinstance(waitable, (ActionServer, ActionClient)):
                self.run(waitable.destroy)

    def subscribe(self, kind: type[T], topic: str, profile: QoSProfile) -> Received[T]:
        """Subscribe to a topic and keep all that comes."""
        received: Received[T] = Received(topic)
        self.node.create_subscription(kind, topic, received.messages.append, profile)
        return received

    def publisher(
        self, kind: type[Any], topic: str, profile: QoSProfile, subscribers: int = 1
    ) -> Publisher:
        """Return a publisher once that many subscribers have found it."""
        publisher = self.node.create_publisher(kind, topic, profile)
        wait_until(
            lambda: publisher.get_subscription_count() >= subscribers,
            f"{subscribers} subscribers of {topic}",
            START_DEADLINE,
        )
        return publisher

    def call(self, kind: type[Any], service: str, request: Any, timeout: float = DEADLINE) -> Any:
        """Return the response of a service."""
        client = self.node.create_client(kind, service)
        try:
            wait_until(client.service_is_ready, f"the service {service}", START_DEADLINE)
            return self.result_of(client.call_async(request), f"a response of {service}", timeout)
        finally:
            self.run(lambda: self.node.destroy_client(client))

    def action_client(
        self, kind: type[Any], action: str, timeout: float = START_DEADLINE
    ) -> ActionClient:
        """Return a client of an action once its server is there."""
        client = ActionClient(self.node, kind, action)
        wait_until(client.server_is_ready, f"the action {action}", timeout)
        return client

    def send_goal(
        self,
        client: ActionClient,
        goal: Any,
        feedback: Callable[[Any], None] | None = None,
    ) -> Goal:
        """Return a goal that was sent and answered; ``.accepted`` tells the answer."""
        future = self.run(lambda: client.send_goal_async(goal, feedback_callback=feedback))
        return Goal(self, self.result_of(future, "an answer to the goal"))

    def result_of(self, future: Future, what: str = "a result", timeout: float = DEADLINE) -> Any:
        """Return the result of a future that the probe's executor completes."""
        wait_until(future.done, what, timeout, step=0.002)
        return future.result()


class NodeProcess:
    """One of the project's executables as a process in a session of its own.

    `patch` is Python that runs in the process before its ``main``, to break it.
    """

    def __init__(
        self,
        executable: str,
        log: Path,
        arguments: Sequence[str] = (),
        parameters: Mapping[str, Any] | None = None,
        remap: Mapping[str, str] | None = None,
        environment: Mapping[str, str] | None = None,
        patch: str = "",
    ) -> None:
        self.executable = executable
        self.log = log
        ros: list[str] = []
        for name, value in (parameters or {}).items():
            ros += ["-p", _rule(name, value)]
        for name, other in (remap or {}).items():
            ros += ["-r", f"{name}:={other}"]
        command = [*command_of(executable, patch), *arguments]
        if ros:
            command += ["--ros-args", *ros]
        variables = {
            **os.environ,
            "ROS_LOG_DIR": str(log.parent / "ros_log"),
            "PYTHONUNBUFFERED": "1",
            "PYTHONPATH": os.pathsep.join(p for p in sys.path if p),
            **(environment or {}),
        }
        with log.open("ab") as output:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                env=variables,
                start_new_session=True,
            )

    @property
    def pid(self) -> int:
        """Process id, which is also the id of its session and group."""
        return self._process.pid

    @property
    def running(self) -> bool:
        """Whether the process has not ended yet."""
        return self._process.poll() is None

    def output(self) -> str:
        """Return what the process has written to stdout and stderr."""
        return self.log.read_text(errors="replace")

    def wait_for_output(self, text: str, timeout: float = START_DEADLINE) -> str:
        """Return the output once it contains `text`."""

        def found() -> bool:
            written = text in self.output()
            if not written and not self.running:
                raise AssertionError(f"{self.executable} ended:\n{self.output()}")
            return written

        wait_until(found, f"'{text}' in the output of {self.executable}", timeout)
        return self.output()

    def wait(self, timeout: float = START_DEADLINE) -> int:
        """Return the exit code once the process has ended."""
        try:
            return self._process.wait(timeout)
        except subprocess.TimeoutExpired:
            raise AssertionError(
                f"{self.executable} still runs after {timeout} s:\n{self.output()}"
            ) from None

    def send(self, number: signal.Signals) -> None:
        """Send a signal to the process alone."""
        self._process.send_signal(number)

    def assert_clean_stop(
        self, number: signal.Signals = signal.SIGINT, timeout: float = DEADLINE
    ) -> None:
        """Stop the process by a signal: exit code 0, no traceback, nothing left running."""
        assert self.running, f"{self.executable} had ended before:\n{self.output()}"
        self.send(number)
        code = self.wait(timeout)
        output = self.output()
        assert code == 0, f"{self.executable} exits {code} on {number.name}:\n{output}"
        for fault in ("Traceback", "terminate called", "Segmentation", "never retrieved"):
            assert fault not in output, f"'{fault}' in the output of {self.executable}:\n{output}"
        assert not self.group_alive(), f"{self.executable} left processes of its group running"

    def group_alive(self) -> bool:
        """Whether a process of the group that was started is still there."""
        try:
            os.killpg(self.pid, 0)
        except ProcessLookupError:
            return False
        return True

    def close(self) -> None:
        """End whatever is left of the group."""
        if self.running:
            self.send(signal.SIGINT)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(5.0)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.pid, signal.SIGKILL)
        self._process.wait()


def command_of(executable: str, patch: str = "") -> list[str]:
    """Return the command of an executable: the installed one, or its module's ``main``."""
    package, module = EXECUTABLES[executable]
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        installed = Path(prefix) / "lib" / package / executable
        if installed.is_file() and not patch:
            return [str(installed)]
    start = f"""
import sys
from {module} import main
{textwrap.dedent(patch)}
sys.argv[0] = {executable!r}
sys.exit(main())
"""
    return [sys.executable, "-c", start]


def _rule(name: str, value: Any) -> str:
    """Return a parameter as ``name:=value`` in YAML's flow style."""

    def text(v: Any) -> str:
        if isinstance(v, bool):
            return str(v).lower()
        if isinstance(v, (list, tuple)):
            return "[" + ", ".join(text(e) for e in v) + "]"
        return f"'{v}'" if isinstance(v, str) and not v else str(v)

    return f"{name}:={text(value)}"
