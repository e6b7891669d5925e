"""Whether MuJoCo can draw here, and by which OpenGL: tried in processes of their own."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping

VARIABLE = "MUJOCO_GL"
MISSING = (
    "film.png is not drawn: no OpenGL found; on Debian install libegl1 libegl-mesa0 libgl1-mesa-dri and set "
    f"{VARIABLE}=egl, or libosmesa6 and {VARIABLE}=osmesa"
)
# Without a screen; the first is the faster.
_KINDS = ("egl", "osmesa")
_PATIENCE = 120.0
_PROBE = """
import mujoco
model = mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
data, renderer = mujoco.MjData(model), mujoco.Renderer(model, 16, 16)
mujoco.mj_forward(model, data)
renderer.update_scene(data)
renderer.render()
renderer.close()
"""


def find_opengl(environment: Mapping[str, str] = os.environ) -> dict[str, str] | None:
    """The environment of a process in which MuJoCo draws: what the user chose, or else the first kind that
    works; None where none does.
    """
    for kind in kinds_to_try(environment, sys.platform):
        chosen = {**environment, **({} if kind is None else {VARIABLE: kind})}
        if _works(chosen):
            return chosen
    return None


def kinds_to_try(environment: Mapping[str, str], platform: str) -> tuple[str | None, ...]:
    """Values of MUJOCO_GL; None leaves it as it is: set, or not needed outside of Linux."""
    return (None,) if environment.get(VARIABLE) or platform != "linux" else _KINDS


def _works(environment: Mapping[str, str]) -> bool:
    """A broken driver may raise, hang, or end its process."""
    command = [sys.executable, "-P", "-c", _PROBE]
    with tempfile.TemporaryDirectory() as elsewhere:  # MuJoCo writes its log where it runs
        try:
            done = subprocess.run(
                command,
                env=environment,
                cwd=elsewhere,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                timeout=_PATIENCE,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return False
    return done.returncode == 0
