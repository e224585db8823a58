"""A view of the program at the other end of a pipe: lines of commands go there, texts and images come back."""

from __future__ import annotations

import collections
import contextlib
import json
import struct
import subprocess
import threading
from collections.abc import Callable, Sequence
from typing import IO, Any

from . import _program
from ._errors import Error

#: Seconds in which the program answers commands that take no time.
_PATIENCE = 60.0

#: Lines of standard error that are kept.
_LINES = 50


class Session:
    """A process of ``spherule view``, and the thread that reads what it says.

    ``text`` and ``data`` are called on that thread with what is for a page; ``data`` returns whether a page shows the
    image, and says so itself. ``lost`` is called at the end.
    """

    #: The files of the page by their names, of which "" is the markup.
    page: dict[str, str]
    #: The state of the view, as src/cli/view/state.rs makes it.
    state: dict[str, Any]

    def __init__(
        self,
        words: Sequence[str],
        text: Callable[[str, dict[str, Any]], object],
        data: Callable[[bytes], bool],
        lost: Callable[[], object],
    ) -> None:
        program = _program.find()
        if program is None:
            raise Error(_program.MISSING)
        self.page, self.state, self.ended = {}, {}, False
        self.warnings: list[str] = []
        self._told = (text, data, lost)
        self._lines: collections.deque[str] = collections.deque(maxlen=_LINES)
        self._changed, self._sending = threading.Condition(), threading.Lock()
        self._mark, self._marked, self._errors = 0, 0, list[str]()
        self._raw: tuple[dict[str, Any], bytes] | None = None
        pipe = subprocess.PIPE
        try:
            # Ctrl-C in a terminal is for Python alone.
            self._process = subprocess.Popen(
                [program, "view", "--pipe", *words], stdin=pipe, stdout=pipe, stderr=pipe, start_new_session=True
            )
        except OSError as error:
            raise Error(f"{program} cannot be started: {error}; SPHERULE names another program") from None
        self._threads = [threading.Thread(target=own, daemon=True) for own in (self._read, self._read_errors)]
        for thread in self._threads:
            thread.start()
        try:
            self.wait(lambda: self.state and not self.state["busy"] and not self.state["loading"])
        except BaseException:
            self.close()
            raise

    def send(self, line: str) -> None:
        """Sends a command, which the program handles later; nothing once it has ended."""
        with self._sending, contextlib.suppress(OSError, ValueError):
            stdin = self._stream(self._process.stdin)
            stdin.write(line.replace("\n", " ").encode() + b"\n")
            stdin.flush()

    def command(self, *lines: str) -> None:
        """Sends commands, and waits until the state is that after them.

        Raises:
            Error: The program refuses one.
        """
        with self._changed:
            self._errors.clear()
            self._mark += 1
        for own in (*lines, f"mark {self._mark}"):
            self.send(own)
        self.wait(lambda: self._marked >= self._mark, _PATIENCE)
        if self._errors:
            raise Error(self._errors[0])

    def pixels(self, samples: int) -> tuple[dict[str, Any], bytes]:
        """The numbers of the image and what is told of it, once it has so many samples per pixel, or is finished.

        Raises:
            Error: The program cannot send them.
        """
        self.command()
        self.wait(lambda: self.state["sampled"] >= max(1, min(samples, self.state["samples"])))
        with self._changed:
            self._errors.clear()
            self._raw = None
        self.send("download raw")
        self.wait(lambda: self._raw is not None or self._errors)
        if self._raw is None:
            raise Error(self._errors[0])
        return self._raw

    def wait(self, is_done: Callable[[], object], seconds: float | None = None) -> None:
        """Waits for what the program says.

        Raises:
            Error: It has ended, or says nothing for so many seconds.
        """
        with self._changed:
            if not self._changed.wait_for(lambda: is_done() or self.ended, seconds):
                raise Error("the viewer does not answer; close it, and open another one")
            if is_done():
                return
        self._threads[1].join(_PATIENCE)
        text = "\n".join(self._lines).removeprefix("error: ")
        raise Error(text or "the viewer is closed; open another one")

    def close(self) -> None:
        """Ends the program."""
        with contextlib.suppress(OSError):
            self._stream(self._process.stdin).close()
        try:
            self._process.wait(5)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    @staticmethod
    def _stream(stream: IO[bytes] | None) -> IO[bytes]:
        assert stream is not None
        return stream

    def _read(self) -> None:
        stdout = self._stream(self._process.stdout)
        while len(head := stdout.read(5)) == 5:
            kind, length = struct.unpack("<cI", head)
            content = stdout.read(length)
            if len(content) < length:
                break
            if kind == b"T":
                self._hear(content.decode())
            else:
                self._receive(content)
        with self._changed:
            self.ended = True
            self._changed.notify_all()
        self._told[2]()

    def _hear(self, text: str) -> None:
        message = json.loads(text)
        with self._changed:
            self.page = message.get("page", self.page)
            self.state = message.get("state", self.state)
            self._marked = int(message.get("mark", self._marked))
            if "error" in message:
                self._errors.append(message["error"])
        if "page" not in message:
            self._told[0](text, message)
        with self._changed:
            self._changed.notify_all()

    def _receive(self, content: bytes) -> None:
        end = 4 + int.from_bytes(content[:4], "little")
        header = json.loads(content[4:end])
        if header.get("file") == "view.raw":
            with self._changed:
                self._raw = (header, content[end:])
                self._changed.notify_all()
        elif not self._told[1](content) and "picture" in header:
            self.send(f"shown {header['picture']}")

    def _read_errors(self) -> None:
        for line in self._stream(self._process.stderr):
            text = line.decode(errors="replace").rstrip()
            if not text.startswith("warning: "):
                self._lines.append(text)
            elif "--frame" not in text:
                # A view has all frames.
                self.warnings.append(text.removeprefix("warning: "))
