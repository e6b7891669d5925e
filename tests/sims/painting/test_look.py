"""Looks correct what a robot believes, and only by what it sees."""

import dataclasses

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from jaxpaint.kinematics.pose import Pose
from jaxpaint.localisation import Belief
from opt.controller import Surface
from sims.odometry import no_slip
from sims.painting.approach import first_posture
from sims.painting.look import look
from sims.painting.marks import in_view, no_marks, with_mark
from sims.worlds import standing

WORLDS = 16


def sights(job, **weights):
    """The job with some of its sights off."""
    names = ("lidar", "depth", "strokes")
    values = tuple(jnp.asarray(float(weights.get(name, 0))) for name in names)
    return eqx.tree_at(lambda j: tuple(getattr(j.sight, name) for name in names), job, values)


@pytest.fixture(scope="module")
def before_the_wall(task):
    """A world whose brush is on the wall, and the surface there."""
    job = task.job
    place = jnp.asarray([0.0, 0.1, 1.1])
    towards = jnp.asarray([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
    row = jnp.concatenate([place, towards.reshape(-1), jnp.zeros(7)])
    base = jnp.asarray([-job.limits.home[0], 0.1 - job.limits.home[1], 0.0])
    world = standing(base, job.robot.home, no_slip(4), 4)
    way, found = jax.jit(first_posture)(job, world, row, base)
    assert found
    surface = Surface(place, -towards[:, 2], jnp.ones(()))
    return standing(way[1, :3], way[1, 3:], no_slip(4), 4), surface


def doubted(world, off):
    """The world of a robot that takes itself to be `off` aside, and knows that it may be."""
    spread = jnp.diag(jnp.asarray([0.02, 0.02, 0.02]) ** 2)
    belief = Belief(world.base + off, spread.astype(world.base.dtype))
    return dataclasses.replace(world, belief=belief)


def errors(job, world, surface, offs, looks=3, marks=None):
    """Of the believed pose after some looks. [worlds, 3]"""
    marks = no_marks(world.base.dtype) if marks is None else marks

    def one(job, marks, off, number):
        now = doubted(world, off)
        for k in range(looks):
            key = jax.random.fold_in(jax.random.key(number), k)
            now, _ = look(job, now, marks, surface, jnp.asarray(100.0), key=key)
        return now.believed - now.base

    run = batched(one, in_axes=(None, None, 0, 0), chunk=WORLDS)
    return np.asarray(run(job, marks, offs, jnp.arange(len(offs))))


@pytest.fixture(scope="module")
def offs():
    return jnp.asarray(np.random.default_rng(0).normal(size=(WORLDS, 3)) * [0.015, 0.015, 0.01], jnp.float32)


def test_what_is_not_looked_at_corrects_nothing(task, before_the_wall, offs):
    world, surface = before_the_wall
    found = errors(sights(task.job), world, surface, offs)
    np.testing.assert_allclose(found, offs, atol=1e-6)


def test_before_one_flat_wall_a_scan_shows_distance_and_heading_alone(task, before_the_wall, offs):
    world, surface = before_the_wall
    found = errors(sights(task.job, lidar=1), world, surface, offs)
    assert np.sqrt((found[:, 0] ** 2).mean()) < 0.003
    assert np.sqrt((found[:, 2] ** 2).mean()) < 0.003
    # Along the wall nothing is known: only what a turn moves the base by is taken back.
    along = found[:, 1] - np.asarray(offs[:, 1])
    assert np.abs(along).max() < 0.003


def test_depth_of_a_blank_wall_shows_distance_and_not_what_is_along_it(task, before_the_wall, offs):
    world, surface = before_the_wall
    found = errors(sights(task.job, depth=1), world, surface, offs)
    # The wall is seen before the brush: what is corrected is the distance there.
    ahead = surface.point[1] - world.base[1]
    assert np.abs(found[:, 0] - found[:, 2] * float(ahead)).max() < 0.003
    assert np.abs(found[:, 1] - np.asarray(offs[:, 1])).max() < 0.003


def test_depth_counts_only_where_the_plan_knows_the_surface(task, before_the_wall, offs):
    world, surface = before_the_wall
    nowhere = surface._replace(known=jnp.zeros(()))
    np.testing.assert_allclose(errors(sights(task.job, depth=1), world, nowhere, offs), offs, atol=1e-6)


def upright_strokes(world, surface):
    """Marks of a stroke above the brush, laid where they were believed to be."""
    marks = no_marks(world.base.dtype)
    for k in range(6):
        place = surface.point + jnp.asarray([0.0, 0.01, 0.04 + 0.03 * k])
        marks = with_mark(marks, place, place, surface, jnp.asarray(1e-8), jnp.asarray(float(k)))
    return marks


def test_an_upright_stroke_shows_what_is_along_the_wall(task, before_the_wall, offs):
    world, surface = before_the_wall
    marks = upright_strokes(world, surface)
    found = errors(sights(task.job, lidar=1, strokes=1), world, surface, offs, marks=marks)
    without = errors(sights(task.job, lidar=1), world, surface, offs, marks=marks)
    rms = [float(np.sqrt((e[:, 1] ** 2).mean())) for e in (found, without)]
    assert rms[0] < 0.004 < 0.4 * rms[1]


def test_marks_are_apart_and_of_the_pen(before_the_wall):
    _, surface = before_the_wall
    marks, still = no_marks(jnp.float32), jnp.asarray(1e-6)
    up = surface._replace(known=jnp.zeros(()))
    assert not np.isfinite(with_mark(marks, surface.point, surface.point, up, still, still).time).any()
    for k in range(40):
        place = surface.point + jnp.asarray([0.0, 0.01 * k, 0.0])
        marks = with_mark(marks, place, place, surface, still, jnp.asarray(0.4 * k))
    real = np.isfinite(marks.time)
    assert real.sum() == 14  # every 30 mm, the first multiple of 10 mm beyond 25 mm
    np.testing.assert_allclose(np.abs(marks.along[:13, 1]), 1, atol=1e-4)
    assert (np.diff(marks.time[:14]) < 0).all()


def test_marks_come_into_view_once_they_are_old_and_inside_the_picture(before_the_wall):
    _, surface = before_the_wall
    marks = no_marks(jnp.float32)
    for k, offset in enumerate(([0.0, 0.0, 0.0], [0.0, 0.05, 0.03], [0.0, 0.5, 0.0])):
        place = surface.point + jnp.asarray(offset)
        marks = with_mark(marks, place, place, surface, jnp.asarray(0.0), jnp.asarray(float(k)))
    camera = Pose(
        surface.point - jnp.asarray([0.2, 0, 0]), jnp.asarray([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
    )
    local, seen = in_view(marks, camera, jnp.asarray(20.0))
    np.testing.assert_array_equal(np.asarray(seen)[:3], [False, True, True])
    np.testing.assert_allclose(local[1], [-0.05, -0.03, 0.2], atol=1e-6)
    assert not in_view(marks, camera, jnp.asarray(4.0))[1].any()
