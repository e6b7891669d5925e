"""A scene: bodies that sensors see, and the chart of the wall that is painted."""

from functools import reduce

import equinox as eqx
from jaxtyping import Array, Float

from sims.scenes.charts import AbstractChart
from sims.scenes.hits import Hit, nearer
from sims.scenes.primitives import AbstractPrimitive


class Scene(eqx.Module):
    """The one description of a place, for sensors, scores and MuJoCo alike.

    primitives: everything a ray can meet, the wall and the floor included. chart: coordinates on the wall.
    name: for people, as in reports.
    """

    primitives: tuple[AbstractPrimitive, ...]
    chart: AbstractChart
    name: str = eqx.field(static=True)

    def raycast(self, origin: Float[Array, "3"], direction: Float[Array, "3"]) -> Hit:
        """The nearest hit of one ray from `origin` [m] along the unit `direction`, both in the map frame."""
        return reduce(nearer, (primitive.intersect(origin, direction) for primitive in self.primitives))
