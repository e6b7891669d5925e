"""Memory: how many worlds run at once, from a budget."""

import dataclasses

import jax
import pytest

from experiments import memory_plan
from experiments.commands.paint_options import PaintOptions
from experiments.memory_plan import GB, available, budget_of, largest_group, resident
from experiments.paint_job import paint_task
from experiments.process import PROCESSES_HERE
from jaxpaint.compiling import CHUNK
from jaxpaint.errors import InputError
from sims.painting.memory_need import MemoryNeed

PICTURE = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 60" fill="none" stroke="black">
<path d="M5 10 H40"/></svg>"""


@pytest.fixture(scope="module")
def options(tmp_path_factory):
    picture = tmp_path_factory.mktemp("picture") / "line.svg"
    picture.write_text(PICTURE)
    return PaintOptions(image=picture, canvas_size=(0.5, 0.5), worlds=300)


@pytest.fixture(scope="module")
def task(options):
    return paint_task(options)


@pytest.mark.parametrize(
    ("fits", "worlds", "most", "group"),
    [
        (10_000, 300, 64, 64),  # more do no good
        (10_000, 300, 10_000, 300),  # the last ones need no whole step
        (10_000, 40, 64, 40),
        (200, 300, 10_000, 192),
        (64, 300, 10_000, 64),
        (63, 300, 10_000, None),
        (40, 40, 64, 40),
    ],
)
def test_the_largest_group_that_fits_and_does_any_good(fits, worlds, most, group):
    assert largest_group(lambda size: size <= fits, worlds, step=64, most=most) == group


def test_films_beyond_what_is_held_are_laid_again():
    need = MemoryNeed(once=5, each=10, film=10**8, kept=1, device_once=7, device_each=2)
    assert need.host(1, 3) == 5 + 10 + 10**8 + 3
    assert need.host(1000, 3) == 5 + 10_000 + 800 * 10**6 + 3
    assert need.device(2) == 7 + 4 + 2 * 10**8


def test_on_cpus_a_group_is_one_chunk_for_each_core(task, options):
    plan = memory_plan.memory_plan(task, options)
    assert plan.group == CHUNK * jax.local_device_count()
    assert 0 < plan.planned <= plan.budget
    assert plan.summary() == {
        "budget_gb": plan.budget / GB, "planned_gb": plan.planned / GB, "group": plan.group,
    }  # fmt: skip


def test_what_does_not_fit_is_refused_in_one_line(task, options):
    tight = dataclasses.replace(options, memory_gb=0.5)
    with pytest.raises(
        InputError, match=r"^--memory-gb: found '0.5', allowed: at least \d\.\d for this run$"
    ):
        memory_plan.memory_plan(task, tight)


def test_what_is_refused_unasked_says_so_too(task, options, monkeypatch):
    monkeypatch.setattr(memory_plan, "available", lambda: 1e8)
    with pytest.raises(InputError, match=r"^memory: found .* GB to take, allowed: at least \d"):
        memory_plan.memory_plan(task, options)


def test_a_device_with_its_own_memory_is_a_limit_beside_the_host(task, options, monkeypatch):
    monkeypatch.setattr(jax, "default_backend", lambda: "gpu")
    monkeypatch.setattr(memory_plan, "available", lambda: 1e12)
    monkeypatch.setattr(memory_plan, "device_limit", lambda: 80e9)
    assert memory_plan.memory_plan(task, options).group == 300
    monkeypatch.setattr(memory_plan, "device_limit", lambda: 0.3e9)
    group = memory_plan.memory_plan(task, options).group
    assert group < 300 and group % (CHUNK * jax.local_device_count()) == 0
    monkeypatch.setattr(memory_plan, "device_limit", lambda: 80e9)
    monkeypatch.setattr(memory_plan, "available", lambda: 2.4e9)
    assert memory_plan.memory_plan(task, options).group < 300


def test_local_processes_share_the_budget(options, monkeypatch):
    asked = dataclasses.replace(options, memory_gb=6.0)
    assert budget_of(asked) == 6e9
    monkeypatch.setenv(PROCESSES_HERE, "3")
    assert budget_of(asked) == 2e9


def test_the_limit_of_a_container_counts(tmp_path, monkeypatch):
    group = (f"{tmp_path}/", "memory.max", "memory.current", "inactive_file ")
    monkeypatch.setattr(memory_plan, "_GROUPS", (group,))
    machine = available()
    (tmp_path / "memory.max").write_text("max\n")
    assert available() == pytest.approx(machine, rel=0.2)
    (tmp_path / "memory.max").write_text("50000000\n")
    (tmp_path / "memory.current").write_text("40000000\n")
    (tmp_path / "memory.stat").write_text("anon 9000000\ninactive_file 25000000\n")
    assert available() == 35e6
    assert resident() > 1e7
