"""How ink is found in pixels and read from it."""

from dataclasses import dataclass
from typing import Literal, get_args

from jaxpaint.errors import InputError

Reading = Literal["auto", "skeleton", "area"]
Threshold = Literal["auto", "global", "local"]
Side = Literal["auto", "dark", "light"]


@dataclass(frozen=True)
class RasterSettings:
    """How a PNG or JPEG becomes a drawing.

    style: ink as centre-lines (skeleton), as areas, or as centre-lines where it is line art (auto).
    threshold: one for the whole picture (global, by Otsu), one by neighbourhood (local, for uneven light), or
    as the picture asks for; the first two find one ink and no further colours. ink: the side of the threshold
    on which it lies; auto: not that of most of the border. colours: inks at most, each a pass (0: as the
    picture asks for). speck: islands and holes of fewer pixels are left out (negative: one in 150 of the
    longer side, squared).
    """

    style: Reading = "auto"
    threshold: Threshold = "auto"
    ink: Side = "auto"
    colours: int = 0
    speck: int = -1

    def check(self) -> None:
        """Raises InputError for a setting that is not allowed."""
        for name, allowed in (("style", Reading), ("threshold", Threshold), ("ink", Side)):
            if getattr(self, name) not in get_args(allowed):
                found = f"picture {name}: found '{getattr(self, name)}'"
                raise InputError(f"{found}; allowed are {', '.join(get_args(allowed))}")
        if not 0 <= self.colours <= 8:
            raise InputError(f"picture colours: found {self.colours}; allowed are 0 (automatic) to 8")
        if self.threshold != "auto" and self.colours > 1:
            found = f"picture threshold {self.threshold} with picture colours {self.colours}: found both"
            raise InputError(f"{found}; allowed is a threshold for one ink, or several colours without one")

    def least_speck(self, side: int) -> float:
        """Pixels of the smallest island or hole that is kept; side: pixels of the picture's longer side."""
        return self.speck if self.speck >= 0 else max(2.0, (side / 150) ** 2)
