# SPDX-License-Identifier: Apache-2.0
"""The codes of events are those that docs/live.md lists, no more and no fewer."""
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
FOLDERS = ("engine", "recording", "sensors", "console")
KINDS = "box|camera|pair|frames|light|blur|recording|sensor|session"
CODE = re.compile(rf'"((?:{KINDS})\.[a-z_]+)"')
# Names of fields and columns look alike: a code stands behind a severity, or is the reason of an
# end.
TOLD = re.compile(r"(?:Severity::\w+,|over_ =|request_finish\(|take_state\(|reason ==)[^;]*;")


def codes_of(text):
    return {code for call in TOLD.findall(text) for code in CODE.findall(call)}


def codes_in_sources():
    found = set()
    for folder in FOLDERS:
        for path in sorted((ROOT / "host-tools" / folder).glob("*.cpp")):
            found |= codes_of(path.read_text(encoding="utf-8"))
    return found


def codes_in_docs():
    text = (ROOT / "docs/live.md").read_text(encoding="utf-8").split("## Events")[1]
    return set(re.findall(rf"^\| `((?:{KINDS})\.[a-z_]+)` \|", text, re.MULTILINE))


class Events(unittest.TestCase):
    def test_each_code_in_the_sources_is_listed(self):
        self.assertEqual(sorted(codes_in_sources() - codes_in_docs()), [])

    def test_each_listed_code_is_in_the_sources(self):
        self.assertEqual(sorted(codes_in_docs() - codes_in_sources()), [])

    def test_codes_are_found_where_they_are_told(self):
        self.assertEqual(codes_of('tell(Severity::info,\n    "box.new", "x");'), {"box.new"})
        self.assertEqual(codes_of('over_ = "box.gone";'), {"box.gone"})
        self.assertEqual(codes_of('key("box.period_us")'), set())


if __name__ == "__main__":
    unittest.main()
