# SPDX-License-Identifier: Apache-2.0
"""KiCad's text files are nested lists in brackets: read them into Python lists.

A list stays a list, a bare word and a quoted string both become str. Of a node `(at 1 2 90)` the
first element is its name; `children(node, "pin")` gives the nodes of a name inside.
"""
import re

TOKEN = re.compile(r'"((?:[^"\\]|\\.)*)"|([()])|([^\s()"]+)')
ESCAPE = re.compile(r"\\(.)")


class FormatError(ValueError):
    """The text is not what KiCad writes."""


def parse(text):
    """The one node of a text."""
    stack = [[]]
    for match in TOKEN.finditer(text):
        quoted, bracket, word = match.groups()
        if bracket == "(":
            stack.append([])
        elif bracket == ")":
            if len(stack) < 2:
                raise FormatError(f"a bracket too many at character {match.start()}")
            node = stack.pop()
            stack[-1].append(node)
        elif word is not None:
            stack[-1].append(word)
        else:
            stack[-1].append(ESCAPE.sub(_unescape, quoted))
    if len(stack) != 1 or len(stack[0]) != 1 or not isinstance(stack[0][0], list):
        raise FormatError("brackets do not close, or there is more than one node")
    return stack[0][0]


def _unescape(match):
    return {"n": "\n", "t": "\t"}.get(match.group(1), match.group(1))


def quote(text):
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def children(node, name):
    return [child for child in node if isinstance(child, list) and child and child[0] == name]


def child(node, name):
    """The first node of that name, or None."""
    found = children(node, name)
    return found[0] if found else None


def value(node, name, default=None):
    """The first value of the first node of that name: of `(uuid x)` it is x."""
    found = child(node, name)
    return found[1] if found and len(found) > 1 else default


def flag(node, name):
    """Whether a node holds a bare word, or since KiCad 8 `(name yes)`."""
    return name in node[1:] or value(node, name) == "yes"


def properties(node):
    return {entry[1]: entry[2] for entry in children(node, "property")}
