"""Everything that one painting job is given, before any world is simulated."""

import equinox as eqx
import jax
from jaxtyping import Array, Float, Int, PRNGKeyArray, UInt32

from jaxpaint.decisions.thresholds import Thresholds
from jaxpaint.mapping.canvas import Canvas
from jaxpaint.mapping.moves import CHANGE_TIME
from jaxpaint.mapping.raycast import MappingSettings
from opt.wbc import ControllerSettings, RobotLimits
from sims.noise import NoisePreset
from sims.paint import Brush
from sims.robots import Robot
from sims.scenes.scene import Scene
from sims.sensors import Camera
from sims.sight import Sight
from sims.truth import Calibration
from sims.worlds import Fidelity, Kinematic

# One control step [s].
CONTROL_PERIOD = 0.02


class Job(eqx.Module):
    """What all worlds share; every leaf is traced.

    picture: canvas points of the strokes in order [m], stroke: which stroke each belongs to. camera_place,
    camera_rotation, camera_base, camera_joints: the viewpoints, see `jaxpaint.planning.Viewpoints`. echoes:
    what the lidar saw of the wall before the scan (x, y) [m], NaN for nothing. sight: what the robot looks
    with as it moves. seed: key data of the job's random numbers. speed: of the brush [m/s]. fidelity: how
    truly worlds move. calibration: what the robot's picture of itself is wrong by. colour: of each stroke;
    None: all are one. colours: how many the picture has, with and without strokes. tool_change: time that a
    change of colour takes [s].
    """

    robot: Robot
    limits: RobotLimits
    scene: Scene
    canvas: Canvas
    camera: Camera
    noise: NoisePreset
    brush: Brush
    thresholds: Thresholds
    settings: ControllerSettings
    mapping: MappingSettings
    picture: Float[Array, "points 2"]
    stroke: Int[Array, " points"]
    camera_place: Float[Array, "views 3"]
    camera_rotation: Float[Array, "views 3 3"]
    camera_base: Float[Array, "views 3"]
    camera_joints: Float[Array, "views arm"]
    echoes: Float[Array, "beams 2"]
    sight: Sight
    speed: Float[Array, ""]
    dt: Float[Array, ""]
    seed: UInt32[Array, "2"]
    fidelity: Fidelity = Kinematic()
    calibration: Calibration = eqx.field(default_factory=Calibration)
    colour: Int[Array, " strokes"] | None = None
    colours: int = eqx.field(static=True, default=1)
    tool_change: Float[Array, ""] | float = CHANGE_TIME

    def key(self, world: Int[Array, ""], purpose: int | Int[Array, ""]) -> PRNGKeyArray:
        """A world's random numbers for one purpose: they depend on its index, not on who runs beside it."""
        key = jax.random.fold_in(jax.random.wrap_key_data(self.seed), world)
        return jax.random.fold_in(key, purpose)


# Purposes of random numbers.
START, SLIP, DEPTH, SCAN, APPROACH, PAINT, SURVEY, RANDOMISED = range(8)
