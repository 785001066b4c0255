# SPDX-License-Identifier: Apache-2.0
import json
import pathlib
import re

import pytest

import opms
from opms import wire

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT / "tests" / "data" / "wire"
HEADER = (ROOT / "libopms" / "include" / "opms" / "wire.h").read_text()
CLASSES = {
    "trigger": wire.TriggerReport, "pong": wire.PongReport, "status": wire.StatusReport,
    "event": wire.EventReport, "command": wire.CommandReport, "identity": wire.IdentityReport,
    "settings": wire.SettingsReport, "settings_set": wire.BoxSettings,
    "history_request": wire.HistoryRequest, "history": wire.HistoryReport,
}  # fmt: skip
# Fields that are values of their own.
INSIDE = {
    "time": wire.BoxTime, "start_edge": wire.BoxTime, "received": wire.BoxTime,
    "sent": wire.BoxTime, "settings": wire.BoxSettings, "state": wire.BoxState,
    "reset_cause": wire.ResetCause, "kind": wire.EventKind, "opcode": wire.CommandOpcode,
    "last_set": wire.Refusal, "sync": wire.SyncMode,
}  # fmt: skip
READERS = {
    "settings_set": wire.read_settings_set,
    "history_request": wire.read_history_request,
}


def value_of(key, value):
    if key == "entries":
        filled = value + [{}] * (2 - len(value))
        return [build(wire.HistoryEntry, fields) for fields in filled]
    if isinstance(value, dict):
        return build(INSIDE[key], value)
    if key in ("us", "uptime_us"):
        return int(value)
    return INSIDE[key](value) if key in INSIDE else value


def build(cls, fields):
    return cls(**{key: value_of(key, value) for key, value in fields.items()})


def vectors(kind):
    document = json.loads((DATA / f"{kind}.json").read_text())
    return [(v["name"], v["fields"], bytes.fromhex(v["hex"])) for v in document["vectors"]]


@pytest.mark.parametrize("kind", CLASSES)
def test_golden_reports_are_read_and_written(kind):
    for name, fields, data in vectors(kind):
        report = build(CLASSES[kind], fields)

        assert wire.write_report(report) == data, name
        assert READERS.get(kind, wire.read_report)(data) == report, name


def test_the_golden_bootloader_report_is_read_and_written():
    (_, _, data), = vectors("bootloader")
    assert wire.write_bootloader() == data
    assert wire.read_report(data) is None


def test_faulty_reports_raise_an_error_that_says_why():
    words = {"LENGTH": "wrong length", "ID": "wrong report id", "VERSION": "another protocol",
             "CRC": "bad CRC", "VALUE": "value out of range"}  # fmt: skip
    tried = 0
    for vector in json.loads((DATA / "refused.json").read_text())["vectors"]:
        if vector["name"] == "another report's id":
            continue  # read_report() goes by the id
        with pytest.raises(opms.Error, match=words[vector["result"]]) as caught:
            READERS.get(vector["report"], wire.read_report)(bytes.fromhex(vector["hex"]))
        assert (caught.value.status, caught.value.stage) == (opms.Status.ERR_ARG, "wire")
        tried += 1
    assert tried > 100


def test_what_cannot_be_written_is_refused():
    with pytest.raises(opms.Error, match="value out of range"):
        wire.write_report(wire.CommandReport(opcode=wire.CommandOpcode.ARM, argument=0))
    with pytest.raises(opms.Error, match="value out of range"):
        wire.write_report(wire.TriggerReport())
    with pytest.raises(TypeError):
        wire.write_report(b"\0" * 64)


def test_a_count_beyond_the_entries_does_not_reach_memory():
    with pytest.raises(opms.Error, match="value out of range"):
        wire.write_report(wire.HistoryReport(boot_id=1, count=1_000_000))


def test_constructors_take_only_fields_of_their_type():
    with pytest.raises(TypeError, match="no such field"):
        wire.BoxTime(seconds=1)
    with pytest.raises(TypeError, match="cycles"):
        wire.BoxTime(cycles=256)
    with pytest.raises(TypeError, match="gap_us"):
        wire.TriggerReport(gap_us=[1, 2, 3])
    with pytest.raises(ValueError, match="too long"):
        wire.IdentityReport(git_hash="0" * 21)


def test_values_compare_and_show_their_fields():
    time = wire.BoxTime(us=3, cycles=4)
    assert time == wire.BoxTime(us=3, cycles=4)
    assert time != wire.BoxTime(us=3, cycles=5)
    assert repr(time) == "BoxTime(us=3, cycles=4)"
    time.us = 9
    assert time.us == 9


def test_the_default_settings_are_those_of_the_box():
    name, fields, _ = vectors("settings_set")[0]
    assert name == "the defaults"
    settings = wire.default_settings()
    assert settings == build(wire.BoxSettings, fields)
    assert wire.check_settings(settings) is None
    settings.width_us = 5
    assert wire.check_settings(settings) == "width_us must be 10 to period_us - 1000"


def test_check_and_crc():
    data = vectors("pong")[0][2]
    assert wire.check(data) is wire.WireResult.OK
    assert wire.check(data[:-1]) is wire.WireResult.LENGTH
    assert wire.check(data[:-1] + b"\0") is wire.WireResult.CRC
    assert wire.crc16(b"123456789") == 0x29B1


@pytest.mark.parametrize(
    ("python", "prefix"),
    [
        (wire.ReportId, "OPMS_REPORT_"), (wire.BoxState, "OPMS_BOX_"),
        (wire.ResetCause, "OPMS_RESET_"),
        (wire.EventKind, "OPMS_EVENT_"), (wire.Refusal, "OPMS_REFUSAL_"),
        (wire.CommandOpcode, "OPMS_COMMAND_"), (wire.WireResult, "OPMS_WIRE_"),
        (wire.TriggerFlag, "OPMS_TRIGGER_"), (wire.Capability, "OPMS_CAPABILITY_"),
    ],
)  # fmt: skip
def test_enums_have_the_names_and_numbers_of_the_header(python, prefix):
    rows = re.findall(rf"^ +{prefix}(\w+) = (1U << )?(\w+)", HEADER, re.MULTILINE)
    expected = {n: 1 << int(v, 0) if shift else int(v, 0) for n, shift, v in rows}
    assert {item.name: int(item.value) for item in python} == expected


def test_the_sync_modes_have_the_numbers_of_the_header():
    # 1HZ is no name in Python.
    assert [(mode.name, int(mode)) for mode in wire.SyncMode] == [
        ("OFF", 0), ("ONE_HZ", 1), ("RUN", 2)
    ]  # fmt: skip


def test_everything_public_is_documented():
    for name in wire.__all__:
        item = getattr(wire, name)
        assert item.__doc__, name
        for member, value in vars(item).items() if isinstance(item, type) else ():
            if isinstance(value, property):
                assert value.__doc__, f"{name}.{member}"
