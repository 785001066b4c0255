# SPDX-License-Identifier: Apache-2.0
"""A WebSocket by hand (RFC 6455), so that tests can stall, tear and send what no library would."""
import base64
import hashlib
import json
import os
import socket
import struct

TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10
GUID = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"


class Refused(Exception):
    """The server answered by HTTP."""

    def __init__(self, status, body):
        super().__init__(f"{status}: {body}")
        self.status, self.body = status, body


class Closed(Exception):
    """The other side ended the stream; `code` is its reason, or None."""

    def __init__(self, code):
        super().__init__(f"closed with {code}")
        self.code = code


class RawSocket:
    def __init__(self, port, token, target="/api/v1/stream", headers=(), receive_bytes=None,
                 wrap=None, timeout_s=60):
        plain = socket.socket()
        if receive_bytes:
            plain.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_bytes)
        plain.settimeout(timeout_s)
        plain.connect(("127.0.0.1", port))
        self.socket = wrap(plain) if wrap else plain
        self.buffer = b""
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [f"GET {target} HTTP/1.1", f"Host: 127.0.0.1:{port}", "Connection: Upgrade",
                 "Upgrade: websocket", "Sec-WebSocket-Version: 13", f"Sec-WebSocket-Key: {key}"]
        if token:
            lines.append(f"Authorization: Bearer {token}")
        try:
            self.socket.sendall("\r\n".join([*lines, *headers, "", ""]).encode())
            self._read_answer(key)
        except BaseException:
            self.close()
            raise

    def _read_answer(self, key):
        while b"\r\n\r\n" not in self.buffer:
            self._more()
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        lines = head.decode().split("\r\n")
        self.headers = {name.lower(): value.strip()
                        for name, value in (line.split(":", 1) for line in lines[1:])}
        status = int(lines[0].split()[1])
        if status != 101:
            body = self._take(int(self.headers.get("content-length", 0)))
            raise Refused(status, body.decode())
        wanted = base64.b64encode(hashlib.sha1((key + GUID).encode()).digest()).decode()
        assert self.headers["sec-websocket-accept"] == wanted

    def _more(self):
        data = self.socket.recv(65536)
        if not data:
            raise Closed(None)
        self.buffer += data

    def _take(self, count):
        while len(self.buffer) < count:
            self._more()
        taken, self.buffer = self.buffer[:count], self.buffer[count:]
        return taken

    def send_frame(self, opcode, payload, final=True, announced=None):
        """announced: a length that is not the payload's."""
        length = len(payload) if announced is None else announced
        head = bytes([opcode | (0x80 if final else 0)])
        if length < 126:
            head += bytes([0x80 | length])
        elif length < 65536:
            head += bytes([0x80 | 126]) + struct.pack(">H", length)
        else:
            head += bytes([0x80 | 127]) + struct.pack(">Q", length)
        mask = os.urandom(4)
        masked = bytes(b ^ mask[i & 3] for i, b in enumerate(payload))
        self.socket.sendall(head + mask + masked)

    def send(self, message):
        self.send_frame(TEXT, json.dumps(message).encode())

    def receive_frame(self):
        head = self._take(2)
        length = head[1] & 127
        if length == 126:
            length = struct.unpack(">H", self._take(2))[0]
        elif length == 127:
            length = struct.unpack(">Q", self._take(8))[0]
        return head[0] & 15, self._take(length)

    def receive(self):
        """The next message; pings are answered."""
        while True:
            opcode, payload = self.receive_frame()
            if opcode == PING:
                self.send_frame(PONG, payload)
            elif opcode == CLOSE:
                raise Closed(struct.unpack(">H", payload[:2])[0] if payload else None)
            elif opcode == TEXT:
                return json.loads(payload)

    def receive_schema(self, schema):
        """Messages are passed over until one of this schema comes."""
        while True:
            message = self.receive()
            if message["schema"] == schema:
                return message

    def close(self):
        self.socket.close()
