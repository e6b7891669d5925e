"""A control step of many robots: Jacobian, QP, 4WSK and odometry, for the same task as the peer's."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from experiments.benchmarks.compare import rate
from experiments.benchmarks.serial_loop_peer import circle_twist
from jaxpaint.compiling import batched, on_devices
from jaxpaint.kinematics import frames, tool_jacobian
from opt.qp import QPStatus, quadratic_program, solve_qp
from opt.wbc import RobotLimits
from opt.wbc.base_motion import body_twist
from sims.driver import Wheels, at_rest, drive
from sims.limits import robot_limits
from sims.odometry import moved
from sims.robots import load_robot
from sims.worlds import RIM_ACCELERATION

_WORLDS, _STEPS = 2048, 50
_DT = 0.02
# As the peer's: weight of all joint speeds, and their bound [rad/s, m/s].
_WEIGHT, _BOUND = 0.01, 1.0
# How many worlds a device takes at a time: what a step keeps of so many fits the second-level cache.
_CHUNK = 256
# Steps of the solver: enough for every program here to be solved, which is checked.
_ITERATIONS = 8


class ControlSteps:
    """Robots at different postures, each of which draws the peer's circle."""

    def __init__(self, worlds: int = _WORLDS, steps: int = _STEPS) -> None:
        robot = load_robot()
        self.count = worlds * steps
        rng = np.random.default_rng(0)
        arm = np.asarray(robot.home) + rng.uniform(-0.1, 0.1, (worlds, robot.home.size))
        base = rng.uniform(-1, 1, (worlds, 3))
        shared = robot_limits(robot, clearance=False)
        twists = jnp.asarray(np.stack([circle_twist(k) for k in range(steps)]), float)
        self._run = batched(run_steps, in_axes=(None, None, 0, 0), chunk=_CHUNK)
        own = on_devices((jnp.asarray(base, float), jnp.asarray(arm, float)))
        self._inputs = (shared, twists, *own)

    def rate(self) -> float:
        """Control steps a second. Raises RuntimeError where a program was not solved."""
        _, _, unsolved = self._run(*self._inputs)
        if np.asarray(unsolved).any():
            raise RuntimeError(f"{int(np.asarray(unsolved).sum())} of {self.count} programs were not solved")
        return rate(lambda: jax.block_until_ready(self._run(*self._inputs)), self.count)


def run_steps(
    robot: RobotLimits, twists: Float[Array, "t 6"], base: Float[Array, "3"], arm: Float[Array, " a"]
) -> tuple[Float[Array, "3"], Float[Array, " a"], Int[Array, ""]]:
    """One robot's base by odometry and its arm after these twists of the brush, and how many programs were
    not solved.
    """

    def step(state, twist):
        base, arm, wheels, unsolved = state
        base, arm, wheels, solved = control_step(robot, twist, base, arm, wheels)
        return (base, arm, wheels, unsolved + ~solved), None

    size = robot.drive.size
    wheels = at_rest(jnp.zeros((size,), base.dtype))
    state, _ = jax.lax.scan(step, (base, arm, wheels, jnp.zeros((), jnp.int32)), twists)
    return state[0], state[1], state[3]


def control_step(
    robot: RobotLimits,
    twist: Float[Array, "6"],
    base: Float[Array, "3"],
    arm: Float[Array, " a"],
    wheels: Wheels,
):
    """Least joint speeds that give the brush this twist (linear [m/s], angular [rad/s], map frame); then the
    wheels that give the base its part within their limits, and where odometry says that this leads.
    """
    links = frames(robot.chain, robot.joints(base, arm))
    _, jacobian = tool_jacobian(robot.chain, links)
    size = robot.chain.size
    bound = jnp.full((size,), _BOUND, base.dtype)
    program = quadratic_program(
        jnp.full_like(bound, _WEIGHT),
        jnp.zeros_like(bound),
        jacobian=jacobian,
        target=twist,
        lower=-bound,
        upper=bound,
    )
    solution = solve_qp(program, iterations=_ITERATIONS, fixed=True)
    told = body_twist(solution.value[:3], base[2])
    dt = jnp.asarray(_DT, base.dtype)
    wheels, motion = drive(robot.drive, wheels, told, told, RIM_ACCELERATION, dt)
    base = moved(base, robot.drive.odometry(motion).twist * dt)
    return base, arm + solution.value[3:] * dt, wheels, solution.status == QPStatus.SOLVED
