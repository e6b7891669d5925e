"""The joints of a URDF between its root and the brush: what MuJoCo would drop of them is refused by name."""

import xml.etree.ElementTree as ET

import numpy as np

from jaxpaint.errors import InputError

_RANGED = ("revolute", "prismatic")
_MOVING = (*_RANGED, "continuous")


def check_joints(root: ET.Element, brush: str, base: tuple[str, ...]) -> None:
    """Raises InputError for joints that imitate others, and for limits that are none.

    brush: the link whose joints are looked at; nothing else of the file is planned with. base: joints that
    need no range.
    """
    above = {_end(joint, "child"): joint for joint in root.findall("joint")}
    link, seen = brush, set()
    while link in above and link not in seen:
        seen.add(link)
        joint = above[link]
        if joint.get("type") in _MOVING:
            _check(joint, ranged=joint.get("type") in _RANGED and joint.get("name") not in base)
        link = _end(joint, "parent")


def _end(joint: ET.Element, which: str) -> str:
    found = joint.find(which)
    return "" if found is None else found.get("link", "")


def _check(joint: ET.Element, ranged: bool) -> None:
    name, limit = joint.get("name"), joint.find("limit")
    if joint.find("mimic") is not None:
        raise InputError(f"joint '{name}' has a <mimic>; allowed: joints that move by themselves, or fixed")
    limits = {} if limit is None else limit.attrib
    if "effort" in limits and not 0 < _number(limits["effort"]) < np.inf:
        raise InputError(
            f"joint '{name}' has effort '{limits['effort']}'; allowed: a number above 0, or no effort at all"
        )
    lower, upper = (_number(limits.get(end, "0")) for end in ("lower", "upper"))
    if ranged and not -np.inf < lower < upper < np.inf:
        found = f"lower '{limits.get('lower', '')}' and upper '{limits.get('upper', '')}'"
        raise InputError(
            f"joint '{name}' has {'no <limit>' if limit is None else found}; allowed: lower below upper, "
            "or type continuous"
        )


def _number(text: str) -> float:
    """NaN for what is none."""
    try:
        return float(text)
    except ValueError:
        return np.nan
