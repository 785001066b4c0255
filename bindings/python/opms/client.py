# SPDX-License-Identifier: Apache-2.0
"""A Master PC's side of the interface (docs/interface.md): start, stop and follow a scan.

    with Client("http://127.0.0.1:47660", token) as client:
        client.scan("lane 3")
        for pose in client.poses():
            print(pose["t_scan_s"], pose["t_ground_detector_m"])

Calls need Python's standard library alone; the stream (``poses()``, ``stream()``) needs the package
``websockets``: ``pip install opms[client]``.
"""

from __future__ import annotations

import http.client
import json
import ssl
import urllib.parse
from collections.abc import Iterable, Iterator, Mapping
from types import TracebackType
from typing import Any

__all__ = ["Client", "ClientError", "Stream"]

Json = dict[str, Any]
KINDS = ("pose", "event", "state")


class ClientError(Exception):
    """The interface refused a call, or nobody answered.

    ``status`` is HTTP's (0: no answer); ``code`` is stable, for programs.
    """

    def __init__(self, status: int, code: str, message: str) -> None:
        super().__init__(message)
        self.status = status
        self.code = code


class Client:
    """One interface. ``url`` is what ``opms serve`` prints, with or without its path.

    ``context`` is for TLS with a certificate of one's own:
    ``ssl.create_default_context(cafile=...)``. Not for several threads at a time.
    """

    def __init__(
        self,
        url: str,
        token: str,
        *,
        timeout_s: float = 30.0,
        context: ssl.SSLContext | None = None,
    ) -> None:
        parts = urllib.parse.urlsplit(url)
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise ValueError(f"{url!r} is not http://ADDRESS:PORT or https://ADDRESS:PORT")
        self._secure = parts.scheme == "https"
        self._netloc = parts.netloc
        self._token = token
        self._timeout_s = timeout_s
        self._context = context or (ssl.create_default_context() if self._secure else None)
        self._connection: http.client.HTTPConnection | None = None

    def __enter__(self) -> Client:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the connection; the next call makes another one."""
        if self._connection:
            self._connection.close()
        self._connection = None

    # --- calls ---------------------------------------------------------------------------------

    def version(self) -> Json:
        """Versions of the program and of the interface."""
        return self._json("GET", "version")

    def state(self) -> Json:
        """Where the session stands (opms.state/1)."""
        return self._json("GET", "state")

    def scan(self, name: str = "") -> str:
        """The software start. Returns the name that the scan got."""
        body = {"name": name} if name else {}
        return str(self._json("POST", "scan", body)["scan"])

    def stop(self) -> Json:
        """Stop the scan; returns when its recording is closed."""
        return self._json("POST", "scan/stop")

    def press_start(self) -> None:
        """The hardware start by software: simulated and emulated boxes only."""
        self._json("POST", "start")

    def pose(self, squares: bool = False) -> Json:
        """The newest pose (opms.pose/1)."""
        return self._json("GET", "pose?squares=1" if squares else "pose")

    def picture(self, format: str = "png") -> bytes:
        """The newest picture as a file's bytes, ``"png"`` or ``"jpeg"``."""
        return self._call("GET", f"picture?format={urllib.parse.quote(format)}")

    def scans(self) -> list[Json]:
        """Recorded scans (opms.scan/1), by their beginning."""
        return list(self._json("GET", "scans")["scans"])

    def scan_summary(self, name: str) -> Json:
        """One recorded scan."""
        return self._json("GET", "scans/" + urllib.parse.quote(name, safe=""))

    def send_samples(self, samples: Mapping[str, Any] | Iterable[Mapping[str, Any]]) -> int:
        """Samples of other sensors for the scan that goes on: one, or several.

        ``{"sensor": "md", "t_scan_s": 1.25, "values": [1.5]}``; the time may also be ``t_unix_s``,
        or missing: then it is that of the arrival. All of them are taken, or none.
        """
        body = dict(samples) if isinstance(samples, Mapping) else [dict(s) for s in samples]
        return int(self._json("POST", "samples", body)["samples"])

    # --- the stream ----------------------------------------------------------------------------

    def stream(self, kinds: Iterable[str] = KINDS, squares: bool = False) -> Stream:
        """All messages of some kinds as they come; a context manager and an iterator."""
        query = urllib.parse.urlencode({"kinds": ",".join(kinds), "squares": int(squares)})
        scheme = "wss" if self._secure else "ws"
        return Stream(
            f"{scheme}://{self._netloc}/api/v1/stream?{query}",
            self._token,
            self._context,
            self._timeout_s,
        )

    def poses(self, squares: bool = False) -> Iterator[Json]:
        """Poses as they come, until the server goes. Poses that this client was too slow for are
        left out; a pose that follows such a gap has their number as ``"missed"``."""
        with self.stream(("pose",), squares) as stream:
            missed = 0
            for message in stream:
                if message["schema"] == "opms.missed/1":
                    missed += message["missed"]["pose"]
                elif message["schema"] == "opms.pose/1":
                    message["missed"] = missed
                    missed = 0
                    yield message

    # --- how -----------------------------------------------------------------------------------

    def _json(self, method: str, path: str, body: Any = None) -> Json:
        answer = json.loads(self._call(method, path, body))
        if not isinstance(answer, dict):
            raise ClientError(0, "answer", "the answer is not an object")
        return answer

    def _call(self, method: str, path: str, body: Any = None) -> bytes:
        headers = {"Authorization": f"Bearer {self._token}"}
        data = None
        if body is not None:
            data = json.dumps(body, allow_nan=False).encode()
            headers["Content-Type"] = "application/json"
        status, answer = self._exchange(method, "/api/v1/" + path, data, headers)
        if status >= 300:
            raise _error_of(status, answer)
        return answer

    def _exchange(
        self, method: str, path: str, data: bytes | None, headers: dict[str, str]
    ) -> tuple[int, bytes]:
        # A connection that was kept may have been closed by the server meanwhile. Only a call
        # that changes nothing is tried again.
        for last_try in (False, True):
            kept = self._connection is not None
            connection = self._connect()
            try:
                connection.request(method, path, data, headers)
                response = connection.getresponse()
                return response.status, response.read()
            except (OSError, http.client.HTTPException) as error:
                self.close()
                if last_try or not kept or method != "GET":
                    raise ClientError(0, "connection", f"{self._netloc}: {error}") from error
        raise AssertionError("not reached")

    def _connect(self) -> http.client.HTTPConnection:
        if self._connection is None:
            if self._secure:
                self._connection = http.client.HTTPSConnection(
                    self._netloc, timeout=self._timeout_s, context=self._context
                )
            else:
                self._connection = http.client.HTTPConnection(
                    self._netloc, timeout=self._timeout_s
                )
        return self._connection


class Stream:
    """Messages of the stream. Iterating ends when the server goes, or after ``close()``."""

    def __init__(
        self, url: str, token: str, context: ssl.SSLContext | None, timeout_s: float
    ) -> None:
        try:
            from websockets.sync.client import connect
        except ImportError as error:
            raise ImportError(
                "the stream needs the package websockets: pip install opms[client]"
            ) from error
        from websockets.exceptions import InvalidStatus

        try:
            self._manager = connect(
                url,
                additional_headers={"Authorization": f"Bearer {token}"},
                subprotocols=["opms.v1"],  # type: ignore[list-item]
                ssl=context,
                open_timeout=timeout_s,
                max_size=None,
                proxy=None,
            )
            self._socket = self._manager.__enter__()
        except InvalidStatus as error:
            raise _error_of(error.response.status_code, error.response.body) from error
        except OSError as error:
            raise ClientError(0, "connection", f"{url}: {error}") from error

    def __enter__(self) -> Stream:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __iter__(self) -> Iterator[Json]:
        for text in self._socket:
            yield json.loads(text)

    def receive(self, timeout_s: float | None = None) -> Json:
        """The next message; TimeoutError where none came."""
        message: Json = json.loads(self._socket.recv(timeout_s))
        return message

    def send_samples(self, samples: Mapping[str, Any] | Iterable[Mapping[str, Any]]) -> None:
        """As Client.send_samples(), without a wait: the reply comes among the messages, as
        opms.accepted/1 or opms.error/1."""
        body = dict(samples) if isinstance(samples, Mapping) else [dict(s) for s in samples]
        self._socket.send(json.dumps({"type": "samples", "samples": body}, allow_nan=False))

    def close(self) -> None:
        self._manager.__exit__(None, None, None)


def _error_of(status: int, answer: bytes | bytearray | None) -> ClientError:
    try:
        error = json.loads(answer or b"")["error"]
        return ClientError(status, str(error["code"]), str(error["message"]))
    except (ValueError, KeyError, TypeError):
        return ClientError(status, "http", f"HTTP status {status}")
