# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The services that save, load and reset the map, beside the mapper's other work.

A large map takes seconds to compress, write, read and check. A thread of its own does that; the
callbacks are coroutines that await it, and the node's only thread goes on with poses and
readings. One request is served after the other: what is saved is the map at the moment at which
its turn comes, what is fused while a map is read goes with the map that the read one replaces, at
once and as a whole.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TypeVar

from fuzzy_msgs.srv import MapFile
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Trigger

from fuzzy_map_building.map_folder import MapFolder, MapNameError
from fuzzy_map_building.map_grids import MapGrids
from fuzzy_map_building.map_io import load_map, save_map
from fuzzy_map_building.map_state import MapState
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.diagnostics import Diagnostics
from fuzzy_map_building.ros.snapshots import SnapshotWriter
from fuzzy_map_building.wording import counted, plain_reason

__all__ = ["MapServices"]

T = TypeVar("T")

#: What a file can bring about: the map is then as it was.
_FAILURES = (ValueError, OSError, MemoryError)


class MapServices:
    """Serves ``save_map``, ``load_map`` and ``reset_map``.

    Parameters
    ----------
    node : Node
        Whose services they are.
    folder : MapFolder
        Where map files may lie.
    mapper : callable
        Returns the mapper that is in use.
    snapshots : SnapshotWriter
        What must not bring a map back that was replaced.
    replaced : callable
        Called when the map has become another one, with its grids if they are known.
    diagnostics : Diagnostics
        Counts what is refused.
    """

    def __init__(
        self,
        node: Node,
        folder: MapFolder,
        mapper: Callable[[], FuzzyMapper],
        snapshots: SnapshotWriter,
        replaced: Callable[[MapGrids | None], None],
        diagnostics: Diagnostics,
    ) -> None:
        self._node = node
        self._folder = folder
        self._mapper = mapper
        self._snapshots = snapshots
        self._replaced = replaced
        self._diagnostics = diagnostics
        self._thread: threading.Thread | None = None
        # While a coroutine waits nothing else of its group is called back: the rest of the node
        # is in another one, and requests to these three wait for each other.
        group = MutuallyExclusiveCallbackGroup()
        for kind, name, callback in (
            (Trigger, names.RESET_MAP, self._on_reset),
            (MapFile, names.SAVE_MAP, self._on_save),
            (MapFile, names.LOAD_MAP, self._on_load),
        ):
            node.create_service(
                kind, name, callback, qos_profile=qos.REQUESTS, callback_group=group
            )

    def finish(self) -> None:
        """Wait for the file that is being written or read, if any; its client is answered next."""
        if self._thread is not None:
            self._thread.join()

    async def _on_reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        await self._snapshot_written()
        self._mapper().reset()
        self._replaced(None)
        response.success = True
        response.message = "the map is empty"
        return response

    async def _on_save(
        self, request: MapFile.Request, response: MapFile.Response
    ) -> MapFile.Response:
        try:
            file = self._folder.file_to_write(request.path)
            perceptions, frozen = self._mapper().perceptions, self._mapper().freeze()
            await self._beside(lambda: save_map(file, frozen.state()))
        except _FAILURES as error:
            return self._refuse(names.SAVE_MAP, response, error)
        response.success = True
        response.message = f"{counted(perceptions, 'perception')} saved to {file}"
        return response

    async def _on_load(
        self, request: MapFile.Request, response: MapFile.Response
    ) -> MapFile.Response:
        mapper = self._mapper()

        def read() -> tuple[MapState, MapGrids]:
            state = load_map(file, mapper.geometry)
            other = FuzzyMapper(mapper.geometry, mapper.parameters)
            other.adopt(state)
            return state, MapGrids(other)

        try:
            file = self._folder.file_to_read(request.path)
            state, grids = await self._beside(read)
        except _FAILURES as error:
            return self._refuse(names.LOAD_MAP, response, error)
        await self._snapshot_written()
        same = self._mapper().parameters is mapper.parameters
        self._mapper().adopt(state)
        self._replaced(grids if same else None)
        response.success = True
        response.message = f"{counted(state.perceptions, 'perception')} loaded from {file}"
        return response

    async def _snapshot_written(self) -> None:
        """Wait for the snapshot that is being written, without which none can be discarded."""
        while self._snapshots.writing:
            await self._beside(self._snapshots.join)

    async def _beside(self, work: Callable[[], T]) -> T:
        """Have a thread of its own do some work, and return what it returns or raises."""
        done = Future()
        executor = self._node.executor

        def run() -> None:
            try:
                done.set_result(work())
            except Exception as error:  # for whoever awaits it
                done.set_exception(error)
            if executor is not None:
                executor.wake()

        self._thread = threading.Thread(target=run, name="map file")
        self._thread.start()
        result: T = await done
        return result

    def _refuse(
        self, service: str, response: MapFile.Response, error: Exception
    ) -> MapFile.Response:
        response.success = False
        response.message = plain_reason(error)
        self._diagnostics.reject(service, _kind(error), response.message)
        return response


def _kind(error: Exception) -> str:
    """Return the word that a refusal is counted under."""
    if isinstance(error, MapNameError):
        return "bad_name"
    if isinstance(error, MemoryError):
        return "no_memory"
    if isinstance(error, OSError) or isinstance(error.__cause__, OSError):
        return "file_system"
    return "unusable_file"
