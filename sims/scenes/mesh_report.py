"""What was made of a mesh, guesses included, for the person who has to judge it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sims.scenes.mesh_baking import MeshSurface
from sims.scenes.mesh_checks import MeshChecks
from sims.scenes.mesh_files import TriangleMesh
from sims.scenes.orientation import Stance
from sims.scenes.placing import Place

# Above this the surface is no longer what the file holds [m].
ACCURACY = 0.001
_UNEVEN = 0.0001


@dataclass(frozen=True)
class MeshReport:
    """Lengths in m, angles in rad.

    checks: defects of the mesh. extent: its size along its own axes. up: the file's axis that points up,
    up_guessed where nobody said so. side: what told the robot's side. lean: by which the wall was off the
    vertical before it was levelled. plane_share: share of the area that makes up the wall's plane. height:
    of the lowest point above the floor. cell: pitch of the height map. residual_rms, residual_p95,
    residual_max: from the mesh to the surface, away from rims. roughness: rms height of the mesh over its
    mean within 2 cm. stretch: 95th percentile of what an area in the chart's coordinates differs from the
    true one by. free_area, canvas_size, clearance: of the canvas' place. T_map_mesh: from the file's axes,
    scaled, to the map.
    """

    name: str
    checks: MeshChecks
    scale: float
    extent: tuple[float, float, float]
    up: str
    up_guessed: bool
    side: str
    lean: float
    plane_share: float
    height: float
    height_guessed: bool
    cell: float
    residual_rms: float
    residual_p95: float
    residual_max: float
    roughness: float
    stretch: float
    wall_area: float
    free_area: float
    canvas_size: tuple[float, float]
    clearance: float
    T_map_mesh: Float[np.ndarray, "4 4"]

    @staticmethod
    def of(
        mesh: TriangleMesh,
        checks: MeshChecks,
        stance: Stance,
        surface: MeshSurface,
        place: Place,
        shift: Float[np.ndarray, "3"],
        height: float,
        height_guessed: bool,
    ) -> "MeshReport":
        """shift: depth, u and rise by which the wall was moved to the map [m]."""
        transform = np.eye(4)
        transform[:3, :3] = stance.R_wall_capture
        transform[:3, 3] = [-stance.offset - shift[0], shift[1], shift[2]]
        size = np.ptp(mesh.vertices, axis=0)
        return MeshReport(
            name=mesh.name,
            checks=checks,
            scale=mesh.scale,
            extent=(float(size[0]), float(size[1]), float(size[2])),
            up=stance.up,
            up_guessed=stance.guessed,
            side=stance.side,
            lean=stance.lean,
            plane_share=stance.share,
            height=height,
            height_guessed=height_guessed,
            cell=surface.lattice.cell,
            residual_rms=surface.residuals[0],
            residual_p95=surface.residuals[1],
            residual_max=surface.residuals[2],
            roughness=surface.roughness,
            stretch=_stretch(surface),
            wall_area=float(np.sqrt(1 + (surface.slopes**2).sum(axis=0))[surface.wall].sum())
            * surface.lattice.cell**2,
            free_area=place.free,
            canvas_size=place.size,
            clearance=place.clearance,
            T_map_mesh=transform,
        )

    def lines(self) -> list[str]:
        """The report as lines that a person reads, millimetres and degrees."""
        guess = {True: " (guessed)", False: ""}
        checks, holes = self.checks, self.checks.holes
        widest = ", ".join(f"{1e3 * width:.0f}" for width in holes[:3])
        found = f"{len(holes)} holes" + (f", the widest {widest} mm" if holes else "")
        true = (
            "" if self.residual_p95 <= ACCURACY else "; NOT within 1 mm, its detail is finer than the cells"
        )
        uneven = f"; uneven by {1e3 * self.roughness:.2f} mm within 2 cm" if self.roughness > _UNEVEN else ""
        return [
            f"{self.name}: {checks.faces} faces in {checks.bodies} bodies, {checks.rims} of them open, "
            f"{found}; {checks.crowded} non-manifold edges, {checks.flipped} between faces that look to "
            f"opposite sides, {checks.degenerate} faces without area",
            f"size {' x '.join(f'{side:.2f}' for side in self.extent)} m with scale {self.scale:g}; "
            f"up {self.up}{guess[self.up_guessed]}, seen from {self.side} side, "
            f"levelled by {np.rad2deg(abs(self.lean)):.1f} degrees, "
            f"lowest point {self.height:.2f} m above the floor{guess[self.height_guessed]}",
            f"wall: {self.wall_area:.2f} m2 seen, {self.free_area:.2f} m2 of it free; surface "
            f"{1e3 * self.residual_rms:.3f} mm rms, {1e3 * self.residual_p95:.3f} mm (95 %), "
            f"{1e3 * self.residual_max:.2f} mm at most from the mesh, cells of {1e3 * self.cell:.1f} mm"
            f"{true}{uneven}",
            f"canvas {self.canvas_size[0]:.2f} x {self.canvas_size[1]:.2f} m, {1e3 * self.clearance:.0f} mm "
            f"from where it cannot lie; areas in wall coordinates are true to {100 * self.stretch:.1f} %",
        ]


def _stretch(surface: MeshSurface) -> float:
    """How far the mean profiles' lengths are from the surface's own, as an area."""
    wall = surface.wall
    rates = [
        np.sqrt(1 + (np.where(wall, slope, 0.0).sum(axis=axis) / np.maximum(wall.sum(axis=axis), 1)) ** 2)
        for axis, slope in enumerate(surface.slopes)
    ]
    true = np.sqrt(1 + (surface.slopes**2).sum(axis=0))
    return float(np.percentile(np.abs(true / (rates[0][None, :] * rates[1][:, None]) - 1)[wall], 95))
