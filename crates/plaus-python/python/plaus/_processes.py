"""Other processes that evaluate a requirement, so that calls of a slow function do not wait for each other."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import queue
import signal
import sys
import threading
import time
import traceback
import warnings
from collections.abc import Callable
from multiprocessing.connection import Connection
from types import TracebackType
from typing import Any

from plaus import _plaus

# Seconds that a process gets to end by itself before it is terminated.
_PATIENCE = 5.0
# This process's ends of all pipes. Forked processes close them, so that each process notices when its own is closed.
_ours: set[Connection] = set()
_starting = threading.Lock()


class _Elsewhere(Exception):
    """The traceback of an exception in another process."""

    def __str__(self) -> str:
        return f'\n"""\n{self.args[0]}"""'


class Processes:
    """Processes that evaluate a function; they end with the `with` block that they were made for."""

    def __init__(self, function: Callable[[_plaus.Outcome], object], scenario: _plaus.Scenario, count: int) -> None:
        # With fork, functions from notebooks and closures are available; without it, they have to be importable.
        context: Any = multiprocessing.get_context("fork" if sys.platform == "linux" else "spawn")
        self._idle: queue.SimpleQueue[Connection] = queue.SimpleQueue()
        self._all: list[tuple[Connection, Any]] = []
        with _starting, warnings.catch_warnings():
            # The state that a fork leaves of other threads is not used: a process only waits, and calls the function.
            warnings.simplefilter("ignore", DeprecationWarning)
            for _ in range(count):
                ours, theirs = context.Pipe()
                _ours.add(ours)
                close = list(_ours) if context.get_start_method() == "fork" else []
                process = context.Process(target=_serve, args=(theirs, close, function, scenario), daemon=True)
                process.start()
                theirs.close()
                self._all.append((ours, process))
                self._idle.put(ours)

    def ask(self, parcel: bytes) -> tuple[float, object]:
        """Has an idle process, or the next one that becomes idle, call the function with an outcome. Returns the
        seconds that it took, and its answer."""
        connection = self._idle.get()
        try:
            connection.send_bytes(parcel)
            seconds, answer, raised = connection.recv()
        except (EOFError, OSError) as lost:
            raise _plaus.RunError(f"a process that evaluates a requirement has ended{self._how()}") from lost
        finally:
            self._idle.put(connection)
        if raised is not None:
            error, where = raised
            raise error from _Elsewhere(where)
        return seconds, answer

    def _how(self) -> str:
        for _, process in self._all:
            process.join(0.1)
        codes = [process.exitcode for _, process in self._all if process.exitcode is not None]
        return f": exit code {codes[0]}" if codes else ""

    def __enter__(self) -> Processes:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, raised: BaseException | None, trace: TracebackType | None
    ) -> None:
        for connection, process in self._all:
            if kind is not None:
                process.terminate()
            connection.close()
            _ours.discard(connection)
        for _, process in self._all:
            process.join(_PATIENCE)
            if process.is_alive():
                process.terminate()
                process.join()


def _serve(
    connection: Connection,
    close: list[Connection],
    function: Callable[[_plaus.Outcome], object],
    scenario: _plaus.Scenario,
) -> None:
    """Answers until there are no more questions."""
    # Ctrl-C is for the process that samples.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for other in close:
        other.close()
    parcels = _plaus.Parcels(scenario)
    while True:
        try:
            parcel = connection.recv_bytes()
        except (EOFError, OSError):
            return
        begun = time.perf_counter()
        try:
            answer = function(parcels.open(parcel))
            reply = pickle.dumps((time.perf_counter() - begun, answer, None))
        except BaseException as error:  # any exception is for the user to see
            reply = pickle.dumps((time.perf_counter() - begun, None, _parcelled(error)))
        connection.send_bytes(reply)


def _parcelled(error: BaseException) -> tuple[BaseException, str]:
    """An exception in a form that another process can raise, with its traceback as text."""
    where = "".join(traceback.format_exception(error))
    try:
        return pickle.loads(pickle.dumps(error)), where
    except Exception:
        return _plaus.RunError(f"process {os.getpid()}: {type(error).__name__}: {error}"), where
