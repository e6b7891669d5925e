"""The parts of a body that its controller keeps apart: few stand for all, chosen by looking at postures."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from jaxpaint.kinematics import BodyParts, KinematicChain, LinkBoxes, LinkSpheres, Spheres
from sims.robots.robot import Robot

# Parts of links so many joints apart may be near each other always, as in `jaxpaint.trajectories.own_gap`.
_JOINED = 2
# Postures that are looked at, and gaps that matter [m].
_POSTURES, _SEED, _NEAR = 4000, 0, 0.2
# What the few may show more of a gap than all do [m].
_SLACK = 0.004
# Directions from which a link is looked at.
_DIRECTIONS = 400
# Gap of pairs that do not count [m].
_FAR = 1e3


class _Balls(NamedTuple):
    center: Float[np.ndarray, "s 3"]
    radius: Float[np.ndarray, "s"]


class _Boxes(NamedTuple):
    middle: Float[np.ndarray, "k 3"]
    half: Float[np.ndarray, "k 3"]
    radius: Float[np.ndarray, "k"]


class _Pair(NamedTuple):
    """gap: [posture, sphere, box], home first. balls, boxes: which are kept."""

    outer: int
    inner: int
    gap: Float[np.ndarray, "n s k"]


def body_parts(robot: Robot) -> BodyParts:
    """Spheres and rounded boxes whose least gap, where it is below 0.2 m, is right to 4 mm at 4,000 random
    postures of the arm.

    Pairs of links that are joined, and those that overlap at home, do not count, as in
    `jaxpaint.trajectories.own_gap`.
    """
    n = robot.chain.size
    balls = [_of_link(robot.body_and_brush, link) for link in range(n)]
    boxes = [_rounded_boxes(*of_link) for of_link in balls]
    p, R = _frames(robot.chain, _postures(robot))
    pairs = [
        _Pair(a, b, _gaps(balls[a], boxes[b], p[:, (a, b)], R[:, (a, b)]))
        for a in range(n)
        for b in range(a - _JOINED)
        if len(balls[a].radius) and len(boxes[b].radius)
    ]
    pairs = [pair._replace(gap=np.where(pair.gap[:1] > 0, pair.gap[1:], _FAR)) for pair in pairs]
    use_balls = [np.ones(len(x.radius), bool) for x in balls]
    use_boxes = [np.ones(len(x.radius), bool) for x in boxes]
    kept = _thinned(pairs, use_balls, use_boxes)
    pairs = [pair for pair, keep in zip(pairs, kept, strict=True) if keep]
    inside = [_rows(boxes[b], use_boxes[b] & any(x.inner == b for x in pairs)) for b in range(n)]
    outside = [_rows(balls[a], use_balls[a] & any(x.outer == a for x in pairs)) for a in range(n)]
    return BodyParts(
        outer=_link_spheres(outside),
        inner=_link_boxes(inside),
        ignored=tuple(
            jnp.asarray((pair.gap.min(0) >= _FAR)[use_balls[pair.outer]][:, use_boxes[pair.inner]])
            for pair in pairs
        ),
        skin=_link_spheres([_outline(_of_link(robot.spheres, link)) for link in range(n)]),
        pairs=tuple((pair.outer, pair.inner) for pair in pairs),
    )


def _of_link(spheres: Spheres, link: int) -> _Balls:
    rides = np.asarray(spheres.frame) == link
    return _Balls(np.asarray(spheres.center, float)[rides], np.asarray(spheres.radius, float)[rides])


def _rows(parts, keep: Bool[np.ndarray, "s"]):
    return type(parts)(*(x[keep] for x in parts))


def _joined(parts) -> jnp.ndarray:
    return jnp.asarray(np.concatenate(parts), float)


def _link_spheres(balls: list[_Balls]) -> LinkSpheres:
    center, radius = (_joined(parts) for parts in zip(*balls, strict=True))
    return LinkSpheres(center, radius, tuple(len(x.radius) for x in balls))


def _link_boxes(boxes: list[_Boxes]) -> LinkBoxes:
    middle, half, radius = (_joined(parts) for parts in zip(*boxes, strict=True))
    return LinkBoxes(middle, half, radius, tuple(len(x.radius) for x in boxes))


def _rounded_boxes(center: Float[np.ndarray, "s 3"], radius: Float[np.ndarray, "s"]) -> _Boxes:
    """Boxes that hold the spheres: one for all of a size where they fill it, else one for each."""
    middles, halves, radii = [], [], []
    for size in np.unique(radius.round(6)):
        same = center[np.isclose(radius, size, atol=2e-6)]
        low, high = same.min(0), same.max(0)
        inside = np.random.default_rng(_SEED).uniform(low, high, (300, 3))
        filled = np.linalg.norm(inside[:, None] - same, axis=-1).min(1).max() <= 1.01 * size
        corners = [(low, high)] if filled else [(one, one) for one in same]
        middles += [(a + b) / 2 for a, b in corners]
        halves += [(b - a) / 2 for a, b in corners]
        radii += [size] * len(corners)
    shape = (len(radii), 3)
    return _Boxes(np.reshape(middles, shape), np.reshape(halves, shape), np.array(radii, float))


def _postures(robot: Robot) -> Float[np.ndarray, "n joints"]:
    """Home, and random ones within the limits, the base at the origin."""
    low, high = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    drawn = np.random.default_rng(_SEED).uniform(low, high, (_POSTURES, len(low)))
    arm = np.concatenate([np.asarray(robot.home, float)[None], drawn])
    return np.concatenate([np.zeros((len(arm), robot.base_size)), arm], axis=1)


def _frames(chain: KinematicChain, q: Float[np.ndarray, "n joints"]) -> tuple[np.ndarray, np.ndarray]:
    """p [n, joints, 3] and R [n, joints, 3, 3] of all postures, as `jaxpaint.kinematics.frames`."""
    p, R = np.zeros((len(q), 3)), np.broadcast_to(np.eye(3), (len(q), 3, 3))
    places, turns = [], []
    for offset, turn, kind, along in zip(chain.p_offset, chain.R_offset, chain.kinds, q.T, strict=True):
        p, R = p + R @ np.asarray(offset, float), R @ np.asarray(turn, float)
        if kind == "hinge":
            c, s = np.cos(along)[:, None], np.sin(along)[:, None]
            x, y, z = R[..., 0], R[..., 1], R[..., 2]
            R = np.stack([c * x + s * y, c * y - s * x, z], axis=-1)
        else:
            p = p + R[..., 2] * along[:, None]
        places.append(p)
        turns.append(R)
    return np.stack(places, axis=1), np.stack(turns, axis=1)


def _gaps(balls: _Balls, boxes: _Boxes, p: np.ndarray, R: np.ndarray) -> Float[np.ndarray, "n s k"]:
    """Between the spheres of one link and the boxes of another; p, R: of the two."""
    center = p[:, :1] - p[:, 1:] + np.einsum("nij,sj->nsi", R[:, 0], balls.center)
    off = np.einsum("nji,nsj->nsi", R[:, 1], center)[:, :, None] - boxes.middle
    off = off - np.clip(off, -boxes.half, boxes.half)
    return np.linalg.norm(off, axis=-1) - balls.radius[:, None] - boxes.radius


def _thinned(pairs: list[_Pair], balls: list[np.ndarray], boxes: list[np.ndarray]) -> list[bool]:
    """Clears the flags of spheres and boxes that no posture needs; which pairs of links are needed.

    The smallest spheres go first: those of a row between its ends.
    """
    if not pairs:
        return []
    least = np.min([pair.gap.min((1, 2)) for pair in pairs], axis=0)
    near = (least < _NEAR) & (least > -_NEAR / 10)
    if not near.any():
        return [False] * len(pairs)
    wanted = [True] * len(pairs)
    seen = [pair._replace(gap=pair.gap[near]) for pair in pairs]

    def least_of(pair: _Pair):
        return np.where(balls[pair.outer][:, None] & boxes[pair.inner], pair.gap, _FAR).min((1, 2))

    rows = [least_of(pair) for pair in seen]

    def still_right(touched):
        now = [least_of(x) if touched(x) else row for x, row in zip(seen, rows, strict=True)]
        left = [row for row, keep in zip(now, wanted, strict=True) if keep]
        right = bool(left) and (np.min(left, axis=0) - least[near]).max() < _SLACK
        return right, now

    for flags, side in ((balls, "outer"), (boxes, "inner")):
        for link, of_link in enumerate(flags):
            for k in range(len(of_link)):
                of_link[k] = False
                right, now = still_right(lambda x, link=link, side=side: getattr(x, side) == link)
                of_link[k] = not right
                rows = now if right else rows
    for k in range(len(pairs)):
        wanted[k] = False
        wanted[k] = not still_right(lambda x: False)[0]
    return wanted


def _outline(balls: _Balls) -> _Balls:
    """The spheres that are seen from outside: without the others the link looks the same, to 4 mm."""
    direction = np.random.default_rng(_SEED).normal(size=(_DIRECTIONS, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    out = direction @ balls.center.T + balls.radius
    keep = np.ones(len(balls.radius), bool)
    for k in range(len(keep)):
        keep[k] = False
        seen = np.where(keep, out, -np.inf).max(1)
        keep[k] = (out.max(1) - seen).max() >= _SLACK
    return _rows(balls, keep)
