# SPDX-License-Identifier: Apache-2.0
"""The real server over a session that is a double, for tests."""
import http.client
import json
import os
import re
import subprocess
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
TOKEN = "token-of-the-tests-0123456789"


def eventually(test, what, seconds=120):
    """What @p test gives once that is true."""
    end = time.monotonic() + seconds
    while True:
        found = test()
        if found:
            return found
        if time.monotonic() > end:
            raise AssertionError(f"this never came: {what}")
        time.sleep(0.05)


class Bench:
    """The program console_bench (see there)."""

    def __init__(self, *options):
        self.process = subprocess.Popen(
            [os.environ["CONSOLE_BENCH"], TOKEN, *map(str, options)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        first = self.process.stdout.readline().strip()
        if not first.isdigit():
            self.process.stdin.close()
            self.process.stdout.close()
            self.process.wait(timeout=60)
            raise ValueError(first)
        self.port = int(first)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()

    def end(self):
        """Its exit code; sanitizers speak by it."""
        if not self.process.stdin.closed:
            self.process.stdin.close()
        code = self.process.wait(timeout=120)
        self.process.stdout.close()
        assert code == 0, f"console_bench ended with {code}"

    def ask(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        return self.process.stdout.readline().strip()

    def figures(self):
        return json.loads(self.ask("figures"))

    def call(self, method, path, body=None, headers=None, token=TOKEN, raw=None):
        """@return status, headers, body as JSON (or bytes, of a picture)."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        sent = {"Authorization": f"Bearer {token}"} if token else {}
        data = raw
        if body is not None:
            data = json.dumps(body).encode()
        if data is not None:
            sent["Content-Type"] = "application/json"
        sent.update(headers or {})
        try:
            connection.request(method, path, data,
                               {k: v for k, v in sent.items() if v is not None})
            response = connection.getresponse()
            content = response.read()
            if response.headers["Content-Type"] == "application/json":
                content = json.loads(content)
            return response.status, response.headers, content
        finally:
            connection.close()


class Interface:
    """docs/interface.openapi.json, and what it says of a value."""

    def __init__(self):
        text = (ROOT / "docs/interface.openapi.json").read_text(encoding="utf-8")
        self.document = json.loads(text)

    def resolve(self, node):
        while "$ref" in node:
            found = self.document
            for part in node["$ref"].removeprefix("#/").split("/"):
                found = found[part]
            node = found
        return node

    def operations(self):
        """Path, METHOD, operation: of all calls."""
        for path, methods in self.document["paths"].items():
            for method, operation in methods.items():
                yield path, method.upper(), operation

    def response_problems(self, operation, status, content_type, body):
        """Everything in which a response is not as the document has it."""
        response = operation["responses"].get(str(status))
        if response is None:
            return [f"status {status} is not in the document: {body}"]
        content = self.resolve(response).get("content", {})
        if content_type not in content:
            return [f"{content_type} is not in the document"]
        schema = content[content_type].get("schema")
        return list(self.problems(schema, body)) if schema else []

    def problems(self, schema, value, where="$"):
        """JSON Schema, as much of it as the document uses."""
        schema = self.resolve(schema)
        if "const" in schema and value != schema["const"]:
            yield f"{where} is not {schema['const']!r}"
        if "enum" in schema and value not in schema["enum"]:
            yield f"{where} is none of {schema['enum']}"
        if "oneOf" in schema:
            if sum(not list(self.problems(s, value, where)) for s in schema["oneOf"]) != 1:
                yield f"{where} fits not exactly one of its forms"
        if "type" in schema and not _has_type(value, schema["type"]):
            yield f"{where} is {value!r}, not of type {schema['type']}"
        elif isinstance(value, dict):
            yield from self._object_problems(schema, value, where)
        elif isinstance(value, list):
            yield from self._list_problems(schema, value, where)
        elif isinstance(value, str):
            if "pattern" in schema and not re.search(schema["pattern"], value):
                yield f"{where} does not match {schema['pattern']}"
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            if not schema.get("minimum", value) <= value <= schema.get("maximum", value):
                yield f"{where} is out of bounds"

    def _object_problems(self, schema, value, where):
        known = schema.get("properties", {})
        for name in schema.get("required", []):
            if name not in value:
                yield f"{where}.{name} is missing"
        for name, item in value.items():
            if name in known:
                yield from self.problems(known[name], item, f"{where}.{name}")
            elif schema.get("additionalProperties") is False:
                yield f"{where}.{name} is not in the document"

    def _list_problems(self, schema, value, where):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            yield f"{where} has {len(value)} items"
        for i, item in enumerate(value):
            if "items" in schema:
                yield from self.problems(schema["items"], item, f"{where}[{i}]")


def _has_type(value, types):
    kinds = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}
    for name in [types] if isinstance(types, str) else types:
        if name == "number" and isinstance(value, (int, float)) and not isinstance(value, bool):
            return True
        if name == "integer" and isinstance(value, int) and not isinstance(value, bool):
            return True
        if name in kinds and isinstance(value, kinds[name]):
            return True
    return False
