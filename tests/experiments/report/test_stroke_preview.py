"""The preview shows the ink pale, the strokes over it, and the numbers that a person asks for."""

import cv2
import numpy as np
import shapely

from experiments.report.stroke_preview import stroke_preview
from jaxpaint.pictures import Drawing, plan_strokes
from jaxpaint.pictures.regions import areas_of


def test_a_preview():
    areas = (*areas_of(shapely.box(0, 0, 0.3, 0.3), 0), *areas_of(shapely.box(0.5, 0, 0.8, 0.3), 1))
    line = np.array([[0.0, 0.4], [0.8, 0.4]])
    drawing = Drawing((line,), (1,), areas, ((1.0, 0.0, 0.0), (0.0, 0.0, 0.0)), "two")
    strokes = plan_strokes(drawing, 0.005)
    png = stroke_preview(strokes, drawing, radius=0.010)
    picture = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None and picture.shape[1] >= 1500
    blue, green, red = (picture[..., k].astype(int) for k in range(3))
    pale = (red > 240) & (abs(green - blue) < 4) & (green > 150) & (green < 230)
    dark_first = (blue > red + 15) & (blue < 140) & (green < 80)  # the first colours of viridis
    bright_last = (red > 180) & (green > 200) & (blue < 90)
    assert pale.mean() > 0.05 and dark_first.mean() > 1e-4 and bright_last.mean() > 2e-5
    assert stroke_preview(strokes, drawing, radius=0.010) == png
