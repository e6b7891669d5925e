"""What all tests share: two host devices, 64-bit and strict-rank modes, the data beside the repository."""

import gc
import os
import shutil
import signal
import tempfile
from collections.abc import Iterator
from pathlib import Path

import hypothesis
import jax
import pytest

from jaxpaint.compiling import Batched

ROOT = Path(__file__).resolve().parents[1]
MAPPINGS = Path("/proc/self/maps")

# Two host devices on any machine, so that splitting worlds over devices is exercised. It must come before the
# first array is made, so it stands here and not in a fixture.
jax.config.update("jax_num_cpu_devices", 2)

# Where a test run was put into the background Ctrl-C is ignored, here and in all that is started from here.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# Names the folder of compiled programs to all processes of a test run.
_PROGRAMS = "JAXPAINT_TEST_PROGRAMS"


def pytest_configure(config: pytest.Config) -> None:
    """What one process compiled is not compiled again: not by another, and not after it was forgotten."""
    if not hasattr(config, "workerinput"):
        folder = tempfile.mkdtemp(prefix="jaxpaint-tests-")
        os.environ[_PROGRAMS] = folder
        config.add_cleanup(lambda: shutil.rmtree(folder, ignore_errors=True))
    jax.config.update("jax_compilation_cache_dir", os.environ[_PROGRAMS])
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.3)


# Few examples, because each may compile; the same ones each time, because a failure must repeat elsewhere. No
# deadline: the first example compiles. Function-scoped fixtures are let through for `x64` and `strict_ranks`,
# which set a mode and hold no state.
hypothesis.settings.register_profile(
    "house",
    max_examples=20,
    deadline=None,
    derandomize=True,
    suppress_health_check=[hypothesis.HealthCheck.too_slow, hypothesis.HealthCheck.function_scoped_fixture],
)
hypothesis.settings.load_profile("house")


# A compiled program takes up to two thousand mappings of memory; Linux gives a process 65,530, and beyond
# them LLVM crashes.
_MOST_MAPPINGS = 25_000


@pytest.fixture(autouse=True, scope="module")
def room_for_programs() -> Iterator[None]:
    """Forgets all compiled programs after a module where there are too many."""
    yield
    if MAPPINGS.exists() and MAPPINGS.read_bytes().count(b"\n") > _MOST_MAPPINGS:
        for held in gc.get_objects():
            if isinstance(held, Batched):
                held.forget()
        jax.clear_caches()
        gc.collect()


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of real clouds, pictures, maps and meshes; they are not ours to ship."""
    return _beside_the_repository("data")


@pytest.fixture(scope="session")
def shared_peers() -> Path:
    """The folder of reference scripts that our own peers are held against."""
    return _beside_the_repository("peers")


def _beside_the_repository(name: str) -> Path:
    folder = ROOT.parent / "shared" / name
    if not folder.is_dir():
        pytest.skip(f"../shared/{name} is absent beside the repository")
    return folder


@pytest.fixture
def x64() -> Iterator[None]:
    """Doubles during one test: for finite differences, and to show that code keeps its inputs' dtype."""
    with jax.enable_x64(True):
        yield


@pytest.fixture
def strict_ranks() -> Iterator[None]:
    """Makes implicit broadcasting between ranks an error, for one-world code that should need none.

    Not on everywhere: MJX itself broadcasts (3, 3) with (3,), and for clouds `points - origin` reads best.
    Strict dtype promotion is not asked for at all: jaxlie, optax and MJX fail under it; `x64` shows as much.
    """
    with jax.numpy_rank_promotion("raise"):
        yield
