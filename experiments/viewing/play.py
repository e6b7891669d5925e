"""Plays a painting run, trajectory.npz, with its robot and wall, model.xml: both beside this script.

python play.py            in MuJoCo's viewer, in real time (--speed 4: four times as fast)
python play.py --check    through all frames without a screen
python play.py --film F   a picture F.png of the robot at several times; needs OpenGL: MUJOCO_GL=egl or osmesa

It needs the packages mujoco and numpy, for --film pillow too.
"""

import argparse
import time
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

HERE = Path(__file__).parent
# Along each piece of paint the brush goes at least so far, in its radii, and this share of its whole way.
STEP, SHARE = 0.5, 1 / 4000


def load(folder: Path) -> tuple[mujoco.MjModel, dict[str, np.ndarray]]:
    """The model and the run's arrays: time [s], qpos, and what the brush drew."""
    with np.load(folder / "trajectory.npz") as held:
        run = dict(held)
    return mujoco.MjModel.from_xml_path(str(folder / "model.xml")), run


def lines(run: dict[str, np.ndarray]) -> list[tuple[float, np.ndarray, np.ndarray, np.ndarray]]:
    """Pieces of the drawn strokes in order: when each is done [s], from, to [m], colour."""
    stroke, brush, found = run["stroke"], run["brush"], []
    way = np.linalg.norm(np.diff(brush, axis=0), axis=1)[stroke[1:] >= 0].sum()
    length = max(STEP * float(run["brush_radius"]), SHARE * way)
    for number in range(int(stroke.max(initial=-1)) + 1):
        row = np.flatnonzero(stroke == number)
        start = row[0]
        for k in row[1:]:
            if np.linalg.norm(brush[k] - brush[start]) >= length or k == row[-1]:
                found.append(
                    (float(run["time"][k]), brush[start], brush[k], run["palette"][run["colour"][k]])
                )
                start = k
    return found


def paint(scene: Any, pieces, radius: float) -> None:
    """Adds a capsule for each piece to a scene, as far as it has room."""
    for _, begin, end, colour in pieces:
        if scene.ngeom >= scene.maxgeom:
            return
        geom = scene.geoms[scene.ngeom]
        none, rgba = np.zeros(3), np.array([*colour, 1.0], np.float32)
        mujoco.mjv_initGeom(geom, mujoco.mjtGeom.mjGEOM_CAPSULE, none, none, np.eye(3).ravel(), rgba)
        mujoco.mjv_connector(geom, mujoco.mjtGeom.mjGEOM_CAPSULE, radius, begin, end)
        geom.specular = 0.1
        scene.ngeom += 1


def check(model: mujoco.MjModel, run: dict[str, np.ndarray]) -> str:
    """Goes through all frames; says how many there are, and how far the model's brush is from the run's."""
    data, away = mujoco.MjData(model), []
    for qpos, brush in zip(run["qpos"], run["brush"], strict=True):
        data.qpos[:] = qpos
        mujoco.mj_forward(model, data)
        away.append(np.linalg.norm(data.site("brush").xpos - brush))
    last = run["time"][-1]
    return f"{len(away)} frames, {last:.1f} s; brush within {1e3 * max(away):.3f} mm of the run's"


def pictures(model: mujoco.MjModel, run: dict[str, np.ndarray], times: np.ndarray, size: tuple[int, int]):
    """Images [height, width, 3] of the model at those times, seen as a viewer first shows it."""
    data, camera, pieces = mujoco.MjData(model), mujoco.MjvCamera(), lines(run)
    mujoco.mjv_defaultFreeCamera(model, camera)
    width, height = size
    # Without these, room for pictures of 640 x 480 only.
    model.vis.global_.offwidth, model.vis.global_.offheight = width, height
    renderer = mujoco.Renderer(model, height, width, max_geom=model.ngeom + len(pieces) + 100)
    try:
        for now in times:
            data.qpos[:] = run["qpos"][np.abs(run["time"] - now).argmin()]
            mujoco.mj_forward(model, data)
            renderer.update_scene(data, camera)
            paint(renderer.scene, [piece for piece in pieces if piece[0] <= now], float(run["brush_radius"]))
            yield renderer.render().copy()
    finally:
        renderer.close()


def film(model: mujoco.MjModel, run: dict[str, np.ndarray], path: Path, count: int, size: tuple[int, int]):
    """Writes a strip of that many pictures, evenly spaced over the run, each with its time."""
    from PIL import Image, ImageDraw, ImageFont

    times = np.linspace(run["time"][0], run["time"][-1], count) if count > 1 else run["time"][-1:]
    columns = int(np.ceil(np.sqrt(count)))
    width, height = size
    strip = Image.new("RGB", (columns * width, -(-count // columns) * height), "white")
    font, pad = ImageFont.load_default(max(10, height // 20)), max(2, height // 80)
    for k, (now, pixels) in enumerate(zip(times, pictures(model, run, times, size), strict=True)):
        picture = Image.fromarray(pixels)
        draw, label = ImageDraw.Draw(picture), f"{now:.1f} s"
        box = draw.textbbox((3 * pad, 3 * pad), label, font)
        draw.rectangle((box[0] - pad, box[1] - pad, box[2] + pad, box[3] + pad), "white")
        draw.text((3 * pad, 3 * pad), label, "black", font)
        strip.paste(picture, (k % columns * width, k // columns * height))
    strip.save(path)


def play(model: mujoco.MjModel, run: dict[str, np.ndarray], speed: float) -> None:
    """Plays the run once in MuJoCo's viewer, which stays open at the end."""
    import mujoco.viewer

    data, pieces = mujoco.MjData(model), lines(run)
    with mujoco.viewer.launch_passive(model, data) as viewer:
        begin, drawn = time.monotonic(), 0
        while viewer.is_running():
            now = run["time"][0] + (time.monotonic() - begin) * speed
            row = min(int(np.searchsorted(run["time"], now)), len(run["time"]) - 1)
            with viewer.lock():
                data.qpos[:], data.time = run["qpos"][row], run["time"][row]
                mujoco.mj_forward(model, data)
                done = sum(piece[0] <= now for piece in pieces)
                paint(viewer.user_scn, pieces[drawn:done], float(run["brush_radius"]))
                drawn = done
            viewer.sync()
            time.sleep(0.02)


def main() -> None:
    """Does what the words ask for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0], allow_abbrev=False)
    parser.add_argument("--check", action="store_true", help="go through all frames without a screen")
    parser.add_argument("--film", type=Path, metavar="F.png", help="draw the robot at several times")
    parser.add_argument("--frames", type=int, default=6, help="how many, for --film (6)")
    parser.add_argument("--size", type=int, nargs=2, default=(720, 540), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--speed", type=float, default=1.0, help="factor on real time in the viewer (1)")
    given = parser.parse_args()
    model, run = load(HERE)
    if given.check:
        print(check(model, run))
    elif given.film:
        film(model, run, given.film, given.frames, tuple(given.size))
    else:
        play(model, run, given.speed)


if __name__ == "__main__":
    main()
