# SPDX-License-Identifier: Apache-2.0
"""Reports of the trigger box: 64 bytes to values and back. docs/wire.md says what they mean."""

import enum

from opms._opms import (
    BoxSettings,
    BoxState,
    BoxTime,
    CommandOpcode,
    CommandReport,
    EventKind,
    EventReport,
    HistoryEntry,
    HistoryReport,
    HistoryRequest,
    IdentityReport,
    PongReport,
    Refusal,
    ReportId,
    ResetCause,
    SettingsReport,
    StatusReport,
    SyncMode,
    TriggerReport,
    WireResult,
)
from opms._opms import wire_check as check
from opms._opms import wire_check_settings as check_settings
from opms._opms import wire_crc16 as crc16
from opms._opms import wire_default_settings as default_settings
from opms._opms import wire_read as read_report
from opms._opms import wire_read_history_request as read_history_request
from opms._opms import wire_read_settings_set as read_settings_set
from opms._opms import wire_write as write_report
from opms._opms import wire_write_bootloader as write_bootloader


class TriggerFlag(enum.IntFlag):
    """Flags of a pulse, in TRIGGER and in HISTORY."""

    PREAMBLE = 1
    RUN = 2
    PREAMBLE_CUT = 4
    STROBE = 8
    STROBE_MISSING = 16
    DELAYED = 32
    NOT_HELD = 64


class Capability(enum.IntFlag):
    """What a box can do, in IDENTITY."""

    STROBE = 1
    SYNC = 2
    HISTORY = 4
    BOOTLOADER = 8


__all__ = [
    "BoxSettings",
    "BoxState",
    "BoxTime",
    "Capability",
    "CommandOpcode",
    "CommandReport",
    "EventKind",
    "EventReport",
    "HistoryEntry",
    "HistoryReport",
    "HistoryRequest",
    "IdentityReport",
    "PongReport",
    "Refusal",
    "ReportId",
    "ResetCause",
    "SettingsReport",
    "StatusReport",
    "SyncMode",
    "TriggerFlag",
    "TriggerReport",
    "WireResult",
    "check",
    "check_settings",
    "crc16",
    "default_settings",
    "read_history_request",
    "read_report",
    "read_settings_set",
    "write_bootloader",
    "write_report",
]
