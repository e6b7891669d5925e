"""A painting run to look at: its robot and wall as one MuJoCo model, its motion, and pictures of both."""

from experiments.viewing.drawing import draw_film
from experiments.viewing.files import write_view
from experiments.viewing.opengl import find_opengl
from experiments.viewing.recorded import Motion, Recorded, read_recorded

__all__ = ["Motion", "Recorded", "draw_film", "find_opengl", "read_recorded", "write_view"]
