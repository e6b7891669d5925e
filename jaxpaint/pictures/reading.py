"""How well line art was read as lines."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Reading:
    """Pixels of ink, and those under the lines that were read; length of these lines [pixels], and on ink."""

    ink: int
    under: int
    length: float
    on_ink: float

    def __add__(self, other: "Reading") -> "Reading":
        return Reading(
            self.ink + other.ink,
            self.under + other.under,
            self.length + other.length,
            self.on_ink + other.on_ink,
        )

    @property
    def ink_read(self) -> float:
        """Share of the ink that lies under a line; 1 without ink."""
        return self.under / self.ink if self.ink else 1.0

    @property
    def lines_on_ink(self) -> float:
        """Share of the lines' length that lies on ink; 1 without length."""
        return self.on_ink / self.length if self.length else 1.0
