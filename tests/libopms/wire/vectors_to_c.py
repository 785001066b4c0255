# SPDX-License-Identifier: Apache-2.0
"""Turn tests/data/wire/*.json into a C header for test_wire.c.

    vectors_to_c.py FOLDER HEADER

For each kind of report: a table of names, structs and bytes, and a function that compares two
structs field by field (their padding may differ).
"""
import json
import sys
from pathlib import Path

TYPES = {
    "trigger": "opms_trigger_report_t", "pong": "opms_pong_report_t",
    "status": "opms_status_report_t", "event": "opms_event_report_t",
    "command": "opms_command_report_t", "identity": "opms_identity_report_t",
    "settings": "opms_settings_report_t", "settings_set": "opms_settings_t",
    "history_request": "opms_history_request_t", "history": "opms_history_report_t",
}
HEAD = """/* SPDX-License-Identifier: Apache-2.0 */
/* Made by vectors_to_c.py from tests/data/wire. */
#include <unity.h>

#include <opms/wire.h>

"""


def literal(key, value):
    if isinstance(value, dict):
        return "{" + ", ".join(f".{k} = {literal(k, v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "{" + ", ".join(literal(key, v) for v in value) + "}" if value else "{{0}}"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):  # 64-bit numbers are strings in JSON
        return value + "U" if key.endswith("us") else json.dumps(value)
    return f"{value}U"


def leaves(value, path=""):
    """Paths of all numbers and texts below a value, as C writes them."""
    if isinstance(value, dict):
        for key, below in value.items():
            yield from leaves(below, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for i, below in enumerate(value):
            yield from leaves(below, f"{path}[{i}]")
    else:
        yield path


def byte_list(text):
    return "{" + ", ".join(f"0x{byte:02x}" for byte in bytes.fromhex(text)) + "}"


def comparison(kind, vectors):
    yield f"static void compare_{kind}(const {TYPES[kind]} *want, const {TYPES[kind]} *got,"
    yield "    const char *name)"
    yield "{"
    # Of all vectors, because lists may be shorter in some.
    paths = dict.fromkeys(path for vector in vectors for path in leaves(vector["fields"]))
    for path in paths:
        text = path.endswith("git_hash")
        kind_of = "STRING" if text else "HEX64"
        yield f"    TEST_ASSERT_EQUAL_{kind_of}_MESSAGE(want->{path}, got->{path}, name);"
    yield "}"


def table(kind, vectors):
    struct = f"    {TYPES[kind]} report;\n" if kind in TYPES else ""
    yield (f"static const struct {{\n    const char *name;\n{struct}"
           f"    uint8_t bytes[OPMS_WIRE_SIZE];\n}} {kind}_vectors[] = {{")
    for vector in vectors:
        report = f" {literal('', vector['fields'])}," if struct else ""
        name = json.dumps(f"{kind}: {vector['name']}")
        yield f"    {{{name},{report} {byte_list(vector['hex'])}}},"
    yield "};"


def refused(vectors):
    yield ("static const struct {\n    const char *name;\n    const char *report;\n"
           "    opms_wire_result_t result;\n    size_t size;\n"
           "    uint8_t bytes[OPMS_WIRE_SIZE + 1];\n} refused_vectors[] = {")
    for vector in vectors:
        name = json.dumps(f"{vector['report']}: {vector['name']}")
        data = byte_list(vector["hex"]) if vector["hex"] else "{0}"
        yield (f"    {{{name}, \"{vector['report']}\", OPMS_WIRE_{vector['result']}, "
               f"{len(vector['hex']) // 2}, {data}}},")
    yield "};"


def reserved(kind, offsets):
    """A bit for each byte of the report."""
    return f"static const uint64_t {kind}_reserved = 0x{sum(1 << at for at in offsets):016x}U;"


def lines(folder):
    for path in sorted(Path(folder).glob("*.json")):
        document = json.loads(path.read_text(encoding="utf-8"))
        vectors = document["vectors"]
        if "report" not in document:
            yield from refused(vectors)
            continue
        kind = document["report"]
        yield reserved(kind, document["reserved"])
        yield from table(kind, vectors)
        if kind in TYPES:
            yield from comparison(kind, vectors)


def main(folder, header):
    Path(header).write_text(HEAD + "\n".join(lines(folder)) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
