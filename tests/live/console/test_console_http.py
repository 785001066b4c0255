# SPDX-License-Identifier: Apache-2.0
"""Every call of the OpenAPI document against the real server: good, bad, large, unauthorised."""
import json
import re
import socket
import unittest

from console_kit import ROOT, TOKEN, Bench, Interface, eventually

INTERFACE = Interface()
OPERATIONS = [o for o in INTERFACE.operations() if o[2]["operationId"] != "stream"]
# From which state of the session a good request succeeds.
SCAN_NEEDED = {"scanEnd", "scanStop", "pressStart", "samples"}
MIB = 1 << 20


def filled(path, operation):
    """A path with the example of its parameter."""
    for parameter in operation.get("parameters", []):
        if parameter["in"] == "path":
            path = path.replace("{" + parameter["name"] + "}",
                                parameter["example"].replace(" ", "%20"))
    return path


def example(operation):
    if "requestBody" not in operation:
        return None
    return operation["requestBody"]["content"]["application/json"]["example"]


def wrong_values(schema):
    """Bodies that a schema does not allow, one mistake each."""
    schema = INTERFACE.resolve(schema)
    if "oneOf" in schema:
        single, many = schema["oneOf"]
        for wrong in wrong_values(single):
            yield wrong
            yield [wrong]
        yield []
        return
    wrong_by_type = {"string": 7, "number": "7", "integer": 7.5, "array": {}, "object": []}
    good = {"sensor": "md", "values": [1]} if "sensor" in schema["properties"] else {}
    for name, part in schema["properties"].items():
        yield {**good, name: wrong_by_type[part["type"]]}
        if "maximum" in part:
            yield {**good, name: part["maximum"] * 2}
        if "minimum" in part:
            yield {**good, name: part["minimum"] * 2 - 1}
    yield {**good, "no-such-field": 1}
    yield from (7, "text", True)


class EveryCall(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bench = Bench()
        cls.bench.ask("picture")
        cls.bench.ask("pose 1")
        # Publishing returns before the pose has become text, so that no session waits for that.
        eventually(lambda: cls.bench.call("GET", "/api/v1/pose")[0] == 200, "the pose")

    @classmethod
    def tearDownClass(cls):
        cls.bench.end()

    def check(self, operation, answer, statuses):
        status, headers, body = answer
        self.assertIn(status, statuses, body)
        problems = INTERFACE.response_problems(operation, status, headers["Content-Type"], body)
        self.assertEqual(problems, [])
        self.assertEqual(headers["Cache-Control"], "no-store")
        self.assertNotIn("Access-Control-Allow-Origin", headers)

    def each(self):
        for path, method, operation in OPERATIONS:
            with self.subTest(method=method, path=path):
                self.bench.ask("scan lane" if operation["operationId"] in SCAN_NEEDED else "scan")
                yield filled(path, operation), method, operation

    def test_a_good_request_succeeds_as_documented(self):
        for path, method, operation in self.each():
            answer = self.bench.call(method, path, example(operation))
            self.check(operation, answer, (200, 201, 202))

    def test_nobody_enters_without_the_token(self):
        for path, method, operation in self.each():
            for token in (None, "", TOKEN[:-1], TOKEN + "0"):
                answer = self.bench.call(method, path, example(operation), token=token)
                self.check(operation, answer, (401,))
                self.assertIn("Bearer", answer[1]["WWW-Authenticate"])

    def test_foreign_hosts_and_origins_are_refused(self):
        for path, method, operation in self.each():
            for headers in ({"Host": "evil.example"}, {"Origin": "http://evil.example"},
                            {"Origin": "null"}, {"Sec-Fetch-Site": "cross-site"}):
                answer = self.bench.call(method, path, example(operation), headers)
                self.check(operation, answer, (403,))

    def test_other_methods_are_told_the_right_ones(self):
        allowed = {}
        for path, method, operation in OPERATIONS:
            allowed.setdefault(filled(path, operation), []).append((method, operation))
        for path, calls in allowed.items():
            for method in ("GET", "POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "NONSENSE"):
                if method in [m for m, _ in calls]:
                    continue
                with self.subTest(method=method, path=path):
                    answer = self.bench.call(method, path)
                    self.check(calls[0][1], answer, (405,))
                    self.assertEqual(sorted(answer[1]["Allow"].split(", ")),
                                     sorted(m for m, _ in calls))

    def test_bodies_where_none_belongs_are_refused(self):
        for path, method, operation in self.each():
            if "requestBody" not in operation:
                self.check(operation, self.bench.call(method, path, {}), (400,))

    def test_bodies_of_the_wrong_kind_size_form_and_depth_are_refused(self):
        for path, method, operation in self.each():
            if "requestBody" not in operation:
                continue
            answer = self.bench.call(method, path, {}, {"Content-Type": "text/plain"})
            self.check(operation, answer, (415,))
            self.check(operation, self.bench.call(method, path, {}, {"Content-Type": None}), (415,))
            self.check(operation, self.bench.call(method, path, raw=b" " * (MIB + 1)), (413,))
            for raw in (b"{", b"nul", b'{"name":NaN}', b"\xff\xfe", b"[" * 1000, b"[1]]",
                        b'{"a":1e999}', b"[" * 17 + b"]" * 17):
                self.check(operation, self.bench.call(method, path, raw=raw), (400,))

    def test_each_field_of_a_wrong_type_or_value_is_refused(self):
        for path, method, operation in self.each():
            if "requestBody" not in operation:
                continue
            schema = operation["requestBody"]["content"]["application/json"]["schema"]
            for wrong in wrong_values(schema):
                with self.subTest(body=wrong):
                    self.assertTrue(list(INTERFACE.problems(schema, wrong)), "it is not wrong")
                    self.check(operation, self.bench.call(method, path, wrong), (422,))

    def test_queries_of_the_wrong_value_are_refused(self):
        for path, method, operation in self.each():
            for parameter in operation.get("parameters", []):
                if parameter["in"] == "query":
                    answer = self.bench.call(method, f"{path}?{parameter['name']}=wrong")
                    self.check(operation, answer, (400,))

    def test_what_is_not_in_the_session_s_state_is_a_conflict(self):
        for path, method, operation in self.each():
            if "409" in operation["responses"]:
                needs_scan = operation["operationId"] in SCAN_NEEDED
                self.bench.ask("scan" if needs_scan else "scan lane")
                answer = self.bench.call(method, path, example(operation))
                self.check(operation, answer, (409,))

    def test_unknown_paths_are_not_found(self):
        for path in ("/", "/api", "/api/v1/", "/api/v2/state", "/api/v1/scans/a/b", "/etc/passwd",
                     "/api/v1/../../etc/passwd", "/api/v1/state/"):
            self.assertEqual(self.bench.call("GET", path)[0], 404, path)

    def test_the_document_has_each_route_of_the_server_and_no_other(self):
        source = (ROOT / "host-tools/console/api_handler.cpp").read_text(encoding="utf-8")
        table = source[source.index("ROUTES = {{"):source.index("}};")]
        routes = {(m, "/api/v1/" + (p or "scans/{name}"))
                  for m, p in re.findall(r'\{"(\w+)", (?:"([\w/]+)"|SCANS),', table)}
        self.assertGreater(len(routes), 5)
        self.assertEqual(routes, {(m, p) for p, m, _ in OPERATIONS})


class RawHttp(unittest.TestCase):
    """What no library would send."""

    @classmethod
    def setUpClass(cls):
        cls.bench = Bench()

    @classmethod
    def tearDownClass(cls):
        cls.bench.end()

    def exchange(self, data):
        with socket.create_connection(("127.0.0.1", self.bench.port), timeout=60) as connection:
            try:
                connection.sendall(data)
            except ConnectionError:
                pass
            answer = b""
            try:
                while chunk := connection.recv(65536):
                    answer += chunk
            except ConnectionError:
                pass
            return answer

    def head(self, *lines):
        return "\r\n".join([*lines, "Host: localhost", f"Authorization: Bearer {TOKEN}",
                            "Connection: close", "", ""]).encode()

    def status(self, data):
        answer = self.exchange(data)
        head, _, body = answer.partition(b"\r\n\r\n")
        self.assertTrue(head.startswith(b"HTTP/1.1 "), answer)
        status = int(head.split()[1])
        if status >= 400:
            self.assertIn("error", json.loads(body))
        return status

    def test_headers_that_are_too_large_are_refused(self):
        self.assertEqual(self.status(self.head("GET /api/v1/state HTTP/1.1", "X: " + "x" * 20000)),
                         431)
        many = [f"X-{i}: {i}" for i in range(3000)]
        self.assertEqual(self.status(self.head("GET /api/v1/state HTTP/1.1", *many)), 431)

    def test_what_is_no_http_is_refused(self):
        for data in (b"hello\r\n\r\n", b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n",
                     b"\x16\x03\x01\x00\x05hello\r\n\r\n", b"GET / HTTP/1.1\r\nBad Header\r\n\r\n"):
            self.assertEqual(self.status(data), 400, data)

    def test_lengths_that_contradict_are_refused(self):
        for lines in (["Content-Length: 3", "Content-Length: 5"], ["Content-Length: -1"],
                      ["Content-Length: many"], ["Content-Length: 99999999999999999999"],
                      ["Content-Length: 3", "Transfer-Encoding: chunked"]):
            data = self.head("POST /api/v1/samples HTTP/1.1", "Content-Type: application/json",
                             *lines) + b"0\r\n\r\n"
            self.assertIn(self.status(data), (400, 413), lines)

    def test_a_body_without_its_length_is_refused(self):
        data = self.head("POST /api/v1/samples HTTP/1.1", "Content-Type: application/json")
        self.assertEqual(self.status(data), 411)

    def test_a_chunked_body_is_read_up_to_the_limit(self):
        head = self.head("POST /api/v1/samples HTTP/1.1", "Content-Type: application/json",
                         "Transfer-Encoding: chunked")
        self.assertEqual(self.status(head + b"2\r\n{}\r\n0\r\n\r\n"), 422)
        chunk = b"10000\r\n" + b" " * 65536 + b"\r\n"
        self.assertEqual(self.status(head + chunk * 17 + b"0\r\n\r\n"), 413)

    def test_a_body_is_not_read_from_who_may_not_send_it(self):
        data = (b"POST /api/v1/samples HTTP/1.1\r\nHost: localhost\r\n"
                b"Content-Type: application/json\r\nContent-Length: 1000000\r\n\r\n")
        self.assertEqual(self.status(data), 401)  # though no byte of the body was sent

    def test_who_waits_for_100_continue_gets_it(self):
        head = self.head("POST /api/v1/samples HTTP/1.1", "Content-Type: application/json",
                         "Content-Length: 2", "Expect: 100-continue")
        answer = self.exchange(head + b"{}")
        self.assertTrue(answer.startswith(b"HTTP/1.1 100 Continue\r\n\r\nHTTP/1.1 422"), answer)

    def test_who_sends_too_slowly_is_let_go_and_others_are_served(self):
        with Bench("--request-ms", 1500) as bench, \
                socket.create_connection(("127.0.0.1", bench.port), timeout=60) as slow:
            slow.sendall(b"GET /api/v1/state HTTP/1.1\r\nHost: local")
            self.assertEqual(bench.call("GET", "/api/v1/version")[0], 200)
            self.assertEqual(slow.recv(100), b"")  # closed by the server

    def test_a_connection_serves_request_after_request(self):
        one = (f"GET /api/v1/version HTTP/1.1\r\nHost: localhost\r\n"
               f"Authorization: Bearer {TOKEN}\r\n\r\n").encode()
        last = self.head("GET /api/v1/version HTTP/1.1")
        answer = self.exchange(one + one + last)
        self.assertEqual(answer.count(b"HTTP/1.1 200 OK"), 3)


if __name__ == "__main__":
    unittest.main()
