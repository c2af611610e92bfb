# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whoever imports this first ends on Ctrl-C and SIGTERM without a traceback, at any moment.

Importing numpy and matplotlib takes a second or two. The exit code is 128 and the signal's
number, as that of a program that shells see killed; workers are ended on the way out.
"""

import signal
import sys
from types import FrameType


def _leave(number: int, _frame: FrameType | None) -> None:
    sys.exit(128 + number)


for _number in (signal.SIGINT, signal.SIGTERM):
    signal.signal(_number, _leave)
