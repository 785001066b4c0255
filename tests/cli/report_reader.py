# SPDX-License-Identifier: Apache-2.0
"""Reads a calibration's report as a strict reader would: nesting, drawings, traced numbers."""
import json
import math
import re
from html.parser import HTMLParser
from xml.etree import ElementTree

VOID = {"meta", "br", "line", "rect", "circle", "path", "polyline", "polygon"}
DASH = "\N{EN DASH}"


class ReportReader(HTMLParser):
    """Text by cell and by span; raises where tags do not match."""

    def __init__(self, page):
        super().__init__(convert_charrefs=True)
        self.open = []
        self.tags = set()
        self.attributes = []
        self.traced = []  # (pointer, factor, text)
        self.cells = []   # text of each td outside of traced spans
        self.text = ""
        self._span = None
        self.feed(page)
        self.close()
        assert not self.open, f"not closed: {self.open}"

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.attributes += [(tag, name, value) for name, value in attrs]
        if tag == "td":
            self.cells.append("")
        if tag == "span":
            pointer = dict(attrs)
            self._span = [pointer["data-json"], float(pointer["data-factor"]), ""]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, f"</{tag}> within {self.open}"
        self.open.pop()
        if tag == "span":
            self.traced.append(tuple(self._span))
            self._span = None

    def handle_data(self, data):
        if "style" in self.open:
            return
        self.text += data
        if self._span is not None:
            self._span[2] += data
        elif "td" in self.open:
            self.cells[-1] += data


def drawings(page):
    """Each <svg> of the page as an XML tree."""
    return [ElementTree.fromstring(svg) for svg in re.findall(r"<svg\b.*?</svg>", page, re.DOTALL)]


def at_pointer(document, pointer):
    for key in pointer.strip("/").split("/"):
        document = document[int(key)] if isinstance(document, list) else document[key]
    return document


def shows(text, value):
    """Is the text this number, rounded as it is written?"""
    digits = len(text.partition(".")[2])
    return math.isfinite(float(text)) and abs(float(text) - value) <= 0.5000001 * 10 ** -digits


def leaves(document):
    """All keys and values of a document, as texts."""
    if isinstance(document, dict):
        for key, value in document.items():
            yield key
            yield from leaves(value)
    elif isinstance(document, list):
        for value in document:
            yield from leaves(value)
    else:
        yield document if isinstance(document, str) else json.dumps(document)
