# SPDX-License-Identifier: Apache-2.0
"""Write the corpora of fuzz_api and fuzz_sensor_csv: corpus/api, corpus/sensor_csv."""
from pathlib import Path

HERE = Path(__file__).resolve().parent
TOKEN = b"token-of-the-fuzzer-0123456789"
UPGRADE, TLS, ENTERS = 1, 2, 4
JSON = b"Content-Type:application/json\nContent-Length:9\n"

API = {
    "state": (ENTERS, b"GET /api/v1/state\n\n"),
    "version_tls": (ENTERS | TLS, b"GET /api/v1/version\nOrigin:https://localhost\n\n"),
    "pose": (ENTERS, b"GET /api/v1/pose?squares=1\n\n"),
    "picture": (ENTERS, b"GET /api/v1/picture?format=jpeg\n\n"),
    "start": (ENTERS, b"POST /api/v1/scan\n" + JSON + b"\n" + b'{"name":"lane 3"}'),
    "start_escape": (ENTERS, b"POST /api/v1/scan\n" + JSON + b"\n" + b'{"name":"../\\u0000"}'),
    "stop": (ENTERS, b"POST /api/v1/scan/stop\n\n"),
    "delete": (ENTERS, b"DELETE /api/v1/scan\n\n"),
    "press": (ENTERS, b"POST /api/v1/start\n\n"),
    "scans": (ENTERS, b"GET /api/v1/scans\n\n"),
    "scan": (ENTERS, b"GET /api/v1/scans/lane%203\n\n"),
    "scan_escape": (ENTERS, b"GET /api/v1/scans/%2e%2e%2f%00\n\n"),
    "samples": (ENTERS, b"POST /api/v1/samples\n" + JSON + b"\n"
                b'[{"sensor":"md","t_scan_s":1.25,"t_bound_s":1e-3,"number":7,"values":[1,-2.5]},'
                b'{"sensor":"gpr","t_unix_s":1.8e9,"data":{"a":[{}]}}]'),
    "samples_deep": (ENTERS, b"POST /api/v1/samples\n" + JSON + b"\n" + b"[" * 200),
    "stream": (ENTERS | UPGRADE, b"GET /api/v1/stream?kinds=pose,event&squares=1\n\n"),
    "subscribe": (ENTERS | UPGRADE, b"GET /api/v1/stream\n\n"
                  b'{"type":"subscribe","kinds":["pose"],"squares":true,"id":{"a":1}}'),
    "message": (0, b"GET /\n\n" b'{"type":"samples","samples":{"sensor":"md","values":[1]}}'),
    "browser": (UPGRADE, b"GET /api/v1/stream\nHost:[::1]:1\nSec-WebSocket-Protocol:opms.v1, "
                b"opms.token." + TOKEN + b"\n\n"),
    "foreign": (ENTERS, b"GET /api/v1/state\nOrigin:null\nSec-Fetch-Site:cross-site\n\n"),
    "wrong_token": (0, b"GET /api/v1/state\nHost:localhost\nAuthorization:Bearer x\n\n"),
    "two_hosts": (ENTERS, b"GET /api/v1/state\nHost:a\n\n"),
    "junk": (255, bytes(range(256))),
}
CSV = {
    "scan": b"t_scan_s,number,left,t_bound_s\n0.125,1,-3.5,1e-3\n# remark\n\n0.25,2,,0\n",
    "unix": b"t_unix_s , a\r\n1800000000.25, 7\r\n",
    "wrong": b"a,b\nt_scan_s,a\n1\n1,2,3\n1e9,1\nnan,1\n,1\n1,inf\n",
    "twice": b"t_scan_s,t_unix_s,a\nt_scan_s,a,a\nt_scan_s,,\n",
}


def write(folder, files):
    (HERE / "corpus" / folder).mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (HERE / "corpus" / folder / name).write_bytes(content)


write("api", {name: bytes([flags]) + text for name, (flags, text) in API.items()})
write("sensor_csv", CSV)
