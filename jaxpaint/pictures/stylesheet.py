"""CSS as far as drawings use it: declarations, and rules whose selector is one tag.class#id."""

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

from jaxpaint.pictures.markup import Element

Style = dict[str, str]

_COMPOUND = re.compile(r"(\*|[\w-]+)?((?:[.#][\w-]+)*)")
_NAME = re.compile(r"[.#][\w-]+")


@dataclass(frozen=True)
class _Rule:
    """A selector with what it sets; rank orders rules by specificity (ids, classes, tag), then by place."""

    tag: str
    names: frozenset[str]
    rank: tuple[int, int, int, int]
    settings: Style

    def fits(self, tag: str, names: frozenset[str]) -> bool:
        return self.tag in ("", "*", tag) and self.names <= names


class StyleSheet:
    """The rules of all style sheets of a file. Rules with other selectors than tag.class#id are left out."""

    def __init__(self, texts: list[str]):
        self._rules: dict[str, list[_Rule]] = defaultdict(list)
        self._matched: dict[tuple[str, frozenset[str]], Style] = {}
        for place, (selector, settings) in enumerate(pair for text in texts for pair in _rules(text)):
            rule = _compile(selector, settings, place)
            if rule is not None:
                self._rules[min(rule.names, default="")].append(rule)

    def settings(self, element: Element) -> Style:
        """What the rules set for an element."""
        names = {f".{name}" for name in element.attributes.get("class", "").split()}
        names |= {f"#{element.attributes['id']}"} if "id" in element.attributes else set()
        key = (element.tag, frozenset(names))
        if key not in self._matched:
            self._matched[key] = self._match(*key)
        return self._matched[key]

    def _match(self, tag: str, names: frozenset[str]) -> Style:
        candidates = [rule for name in ("", *names) for rule in self._rules.get(name, ())]
        fitting = sorted((rule for rule in candidates if rule.fits(tag, names)), key=lambda rule: rule.rank)
        return {key: value for rule in fitting for key, value in rule.settings.items()}


def declarations(text: str) -> Style:
    """The settings in `key: value; key: value`. Importance is left out."""
    pairs = (declaration.partition(":") for declaration in text.split(";"))
    return {
        key.strip().lower(): value.replace("!important", "").strip() for key, colon, value in pairs if colon
    }


def _rules(text: str) -> Iterator[tuple[str, Style]]:
    """Each selector of a style sheet with its settings. At-rules are passed over with all that is in them."""
    text = _without_comments(text)
    head, depth, start = "", 0, 0
    for mark in re.finditer(r"[{};]", text):
        depth = max(0, depth + {"{": 1, "}": -1, ";": 0}[mark[0]])
        if mark[0] == "{" and depth == 1:
            head = text[start : mark.start()].strip()
        elif mark[0] == "}" and depth == 0 and not head.startswith("@"):
            settings = declarations(text[start : mark.start()])
            yield from ((selector.strip(), settings) for selector in head.split(","))
        if depth == 0 or (mark[0] == "{" and depth == 1):
            start = mark.end()


def _without_comments(text: str) -> str:
    first, *rest = text.split("/*")
    return first + "".join(piece.partition("*/")[2] for piece in rest)


def _compile(selector: str, settings: Style, place: int) -> _Rule | None:
    match = _COMPOUND.fullmatch(selector)
    if match is None or not selector:
        return None
    tag, names = match[1] or "", frozenset(_NAME.findall(match[2]))
    ids = sum(name.startswith("#") for name in names)
    return _Rule(tag, names, (ids, len(names) - ids, int(tag not in ("", "*")), place), settings)
