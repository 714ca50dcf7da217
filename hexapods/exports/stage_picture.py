"""A picture of a moment of a run as a PNG, drawn without OpenGL: what is seen where no page plays.

It shows what the stage shows (`hexapods.drawing`): lanes, lines, robots in their agents' colours,
names and distances, from the side of `static/viewer/shots.js`. Triangles are painted from the
farthest to the nearest.
"""

import io
import math
import unicodedata
from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np
from PIL import Image, ImageDraw, ImageFilter, ImageFont

from hexapods.domain.text import metres
from hexapods.domain.types import FloatArray
from hexapods.drawing.colormap import Rgb, mix, rgb
from hexapods.drawing.lane_marks import BEFORE_M, BEYOND_M
from hexapods.drawing.robot_mesh import RobotMesh, antenna_m
from hexapods.drawing.robots import part_color
from hexapods.drawing.scene import lane_width_m
from hexapods.exports.export_format import StagePicture
from hexapods.runs.clocks import FINISH_LINE_M
from hexapods.shows.replay import Replay
from hexapods.shows.stage_frame import StageFrame

WIDTH, HEIGHT = 800, 450
"""Size of the picture [px]."""
_FINER = 2
"""Each pixel is the mean of so many by so many, for smooth edges."""
_AZIMUTH_DEG, _ELEVATION_DEG, _FOV_DEG = 30.0, 18.0, 22.0
_MARGINS_PX = (40, 58, 40, 36)
"""Left, top, right and bottom of what robots fill: labels are above them."""
_NEAR_M = 0.1
_SKY: tuple[Rgb, Rgb] = ((207, 220, 236), (233, 239, 246))
_GROUND: tuple[Rgb, Rgb] = ((243, 245, 248), (220, 226, 234))
"""Colours at the top and bottom of sky and ground, as in `static/viewer/patch.css`."""
_TINT, _ROW_M = 0.2, 0.05
"""Share of the agent's colour in its lane, and length of the rows in which this fades."""
_GAP_M, _FADE_M = 0.02, 0.4
_LINE_M, _SQUARE_M, _ROWS = 0.03, 0.031, 3
_GREEN, _WHITE, _BLACK = (0, 150, 64), (255, 255, 255), (16, 18, 22)
_TOWARDS_LIGHT: FloatArray = np.array([0.35, -0.45, 0.82])
_AMBIENT = 0.52
_SHADOW, _SHADOW_BLUR_PX = 70, 5
_TEXT = (20, 24, 31)
_DASHES = "−–—‐‑"
_COLORS = 192
"""Colours of the file; flat areas in few of them take a third of the bytes."""


def stage_picture(replay: Replay) -> StagePicture:
    """Return a picture of a run that has ended: of its time-out, or where it has none of its end.

    Args:
        replay: the run.
    """
    plan = replay.plan()
    time_outs_s = [mark.time_s for mark in plan.marks if mark.kind == "time-out"]
    end_s = plan.recorded_s[-1][1] if plan.recorded_s else 0.0
    frame = replay.frame_at(min([*time_outs_s, end_s]))
    buffer = io.BytesIO()
    image = _Painter(frame).painted().quantize(_COLORS, dither=Image.Dither.NONE)
    image.save(buffer, "PNG", optimize=True)
    return StagePicture(buffer.getvalue(), _description(frame))


def _description(frame: StageFrame) -> str:
    robots = zip(frame.spec.lane_specs, frame.lanes, strict=True)
    distances = [f"{spec.name} {metres(lane.distance_m)}" for spec, lane in robots]
    moment = "At the time-out" if frame.phase == "photo-finish" else "At the end"
    return f"{moment}: {'; '.join(distances)}"


class _Triangles(NamedTuple):
    """Triangles of the robots, in the world [m]."""

    corners: FloatArray
    """(n, 3, 3)."""
    colors: FloatArray
    """(n, 3), 0–255, without light."""


class _Camera:
    """The nearest camera of a direction that has all points within the margins."""

    def __init__(self, points: FloatArray) -> None:
        azimuth, elevation = math.radians(_AZIMUTH_DEG), math.radians(_ELEVATION_DEG)
        level = math.cos(elevation)
        back = np.array(
            [math.sin(azimuth) * level, -math.cos(azimuth) * level, math.sin(elevation)]
        )
        right = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
        self._axes = np.stack([right, np.cross(back, right), back])
        high = math.tan(math.radians(_FOV_DEG) / 2)
        self._scale = HEIGHT / 2 / high
        left, top, right_px, bottom = (
            (size / 2 - margin) / self._scale
            for margin, size in zip(_MARGINS_PX, (WIDTH, HEIGHT) * 2, strict=True)
        )
        x, y, z = (points @ self._axes.T).T
        # Each side of the view is a plane that no point may be beyond.
        a, b = (x + right_px * z).max(), (x - left * z).min()
        c, d = (y + top * z).max(), (y - bottom * z).min()
        depth = max((a - b) / (left + right_px), (c - d) / (top + bottom))
        self._place = np.array(
            [
                (a - right_px * depth + b + left * depth) / 2,
                (c - top * depth + d + bottom * depth) / 2,
                depth,
            ]
        )

    @property
    def horizon_px(self) -> float:
        """Distance of the horizon from the top of the picture."""
        return HEIGHT / 2 - self._scale * math.tan(math.radians(_ELEVATION_DEG))

    @property
    def eye_m(self) -> FloatArray:
        """Its place in the world, (3,)."""
        place: FloatArray = self._place @ self._axes
        return place

    def seen(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return where points (…, 3) are in the picture [px], (…, 2), and how deep [m], (…)."""
        offsets = points @ self._axes.T - self._place
        depths = -offsets[..., 2]
        safe = np.maximum(depths, _NEAR_M)[..., None]
        middle = np.array([WIDTH / 2, HEIGHT / 2])
        return middle + offsets[..., :2] / safe * np.array([1.0, -1.0]) * self._scale, depths


class _Painter:
    """Paints a frame."""

    def __init__(self, frame: StageFrame) -> None:
        self._frame, spec = frame, frame.spec
        self._width_m = lane_width_m(spec)
        count = len(spec.lane_specs)
        self._xs = [self._width_m * (lane - (count - 1) / 2) for lane in range(count)]
        self._robots = [_triangles(frame, lane, x) for lane, x in enumerate(self._xs)]
        corners = [robot.corners.reshape(-1, 3) for robot in self._robots if len(robot.corners)]
        tops = [self._top(lane) for lane in range(count)]
        self._camera = _Camera(np.concatenate([*corners, np.array(tops)]))
        self._image = Image.new("RGB", (WIDTH * _FINER, HEIGHT * _FINER), _GROUND[1])
        self._draw = ImageDraw.Draw(self._image)

    def painted(self) -> Image.Image:
        """Return the picture."""
        self._paint_background()
        self._paint_lanes()
        self._paint_shadows()
        self._paint_robots()
        self._image = self._image.resize((WIDTH, HEIGHT), Image.Resampling.BOX)
        self._draw = ImageDraw.Draw(self._image)
        self._paint_labels()
        return self._image

    def _top(self, lane: int) -> FloatArray:
        """Return where the label of a lane points to [m]."""
        pose = self._frame.lanes[lane].qpos
        top = antenna_m(self._frame.spec.robot)
        return np.array([self._xs[lane] + float(pose[0]), float(pose[1]), float(pose[2]) + top])

    def _paint_background(self) -> None:
        horizon = round(self._camera.horizon_px * _FINER)
        for first, last, colors in (
            (0, horizon, _SKY),
            (max(0, horizon), HEIGHT * _FINER, _GROUND),
        ):
            for row in range(first, last):
                share = (row - first) / max(1, last - first)
                color = mix(colors[0], colors[1], share)
                self._draw.line([(0, row), (WIDTH * _FINER, row)], fill=color)

    def _paint_lanes(self) -> None:
        half = (self._width_m - _GAP_M) / 2
        for x, lane in zip(self._xs, self._frame.spec.lane_specs, strict=True):
            color = mix(_WHITE, rgb(lane.color), _TINT)
            for row in range(round((BEYOND_M - BEFORE_M) / _ROW_M)):
                y = BEFORE_M + row * _ROW_M
                share = min(1.0, (y - BEFORE_M) / _FADE_M, (BEYOND_M - y) / (2 * _FADE_M))
                self._rectangle(x - half, x + half, y, y + _ROW_M, mix(_GROUND[0], color, share))
        left, right = self._xs[0] - self._width_m / 2, self._xs[-1] + self._width_m / 2
        self._rectangle(left, right, -_LINE_M / 2, _LINE_M / 2, _WHITE)
        self._rectangle(left, right, -_LINE_M / 5, _LINE_M / 5, _GREEN)
        count = round((right - left) / _SQUARE_M)
        side = (right - left) / count
        for row in range(_ROWS):
            y = FINISH_LINE_M + (row - _ROWS / 2) * _SQUARE_M
            for square in range(count):
                color = _BLACK if (row + square) % 2 else _WHITE
                x = left + square * side
                self._rectangle(x, x + side, y, y + _SQUARE_M, color)

    def _rectangle(self, left: float, right: float, near: float, far: float, color: Rgb) -> None:
        """Paint a rectangle on the ground [m], unless a part of it is behind the camera."""
        corners = [[left, near, 0.0], [right, near, 0.0], [right, far, 0.0], [left, far, 0.0]]
        places, depths = self._camera.seen(np.array(corners))
        if depths.min() > _NEAR_M:
            self._draw.polygon([tuple(place) for place in places * _FINER], fill=color)

    def _paint_shadows(self) -> None:
        """Darken the ground where robots are between it and the light."""
        mask = Image.new("L", self._image.size, 0)
        draw = ImageDraw.Draw(mask)
        for robot in self._robots:
            heights = robot.corners[..., 2:] / _TOWARDS_LIGHT[2]
            places, depths = self._camera.seen(robot.corners - heights * _TOWARDS_LIGHT)
            for triangle in (places * _FINER)[depths.min(axis=1) > _NEAR_M]:
                draw.polygon(triangle.ravel().tolist(), fill=_SHADOW)
        blurred = mask.filter(ImageFilter.GaussianBlur(_SHADOW_BLUR_PX))
        dark = Image.new("RGB", self._image.size, (40, 50, 70))
        self._image.paste(Image.composite(dark, self._image, blurred))

    def _paint_robots(self) -> None:
        triangles = np.concatenate([robot.corners for robot in self._robots])
        colors = np.concatenate([robot.colors for robot in self._robots])
        normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        places, depths = self._camera.seen(triangles)
        towards = self._camera.eye_m - triangles[:, 0]
        is_seen = ((normals * towards).sum(axis=1) > 0) & (depths.min(axis=1) > _NEAR_M)
        light = _AMBIENT + (1 - _AMBIENT) * np.maximum(normals @ _TOWARDS_LIGHT, 0.0)
        shaded = np.clip(colors * light[:, None] * 1.08, 0, 255).astype(int).tolist()
        order = np.argsort(-depths.mean(axis=1))
        flat = (places * _FINER).reshape(len(places), 6).tolist()
        for number in order[is_seen[order]].tolist():
            self._draw.polygon(flat[number], fill=tuple(shaded[number]))

    def _paint_labels(self) -> None:
        """Write the name and distance of each robot above it, farther up where it would cover."""
        boxes: list[tuple[float, float, float, float]] = []
        large, small = ImageFont.load_default(15), ImageFont.load_default(14)
        lanes = zip(self._frame.spec.lane_specs, self._frame.lanes, strict=True)
        for number, (lane_spec, lane) in enumerate(lanes):
            (x, y), _ = self._camera.seen(self._top(number))
            texts = ((in_ascii(lane_spec.name), large), (in_ascii(metres(lane.distance_m)), small))
            half = max(self._draw.textlength(text, font=font) for text, font in texts) / 2 + 8
            x_box = min(max(x, half + 4), WIDTH - half - 4)
            box = (x_box - half, y - 46, x_box + half, y - 4)
            while any(_overlap(box, other) for other in boxes) and box[1] > 4:
                box = (box[0], box[1] - 4, box[2], box[3] - 4)
            boxes.append(box)
            self._draw.line([(x, box[3]), (x, y)], fill=lane_spec.color, width=2)
            self._draw.rounded_rectangle(box, 6, fill=_WHITE)
            self._draw.rectangle((box[0] + 3, box[3] - 3, box[2] - 3, box[3]), fill=lane_spec.color)
            for row, (text, font) in enumerate(texts):
                at = (x_box, box[1] + 11 + 17 * row)
                self._draw.text(at, text, font=font, fill=_TEXT, anchor="mm")


def in_ascii(text: str) -> str:
    """Return a text with letters that Pillow's own font has, the only font that is everywhere.

    `é` becomes `e`, `α` `alpha`, what has no such form `?`.
    """
    letters = []
    for letter in unicodedata.normalize("NFKD", text):
        name = unicodedata.name(letter, "")
        if letter.isascii():
            letters.append(letter)
        elif letter in _DASHES:
            letters.append("-")
        elif name.startswith("GREEK SMALL LETTER "):
            letters.append(name.split()[-1].lower())
        elif not unicodedata.combining(letter):
            letters.append("?")
    return "".join(letters)


def _overlap(box: Sequence[float], other: Sequence[float]) -> bool:
    return (
        box[0] < other[2] and other[0] < box[2] and box[1] < other[3] + 2 and other[1] < box[3] + 2
    )


def _triangles(frame: StageFrame, lane: int, x_m: float) -> _Triangles:
    """Return the robot of a lane, whose centre line is at `x_m`; lost legs are left out."""
    mesh, view = RobotMesh(frame.spec.robot), frame.lanes[lane]
    color = rgb(frame.spec.lane_specs[lane].color)
    poses = mesh.body_poses(view.qpos).moved(x_m)
    corners, colors = [np.empty((0, 3, 3))], [np.empty((0, 3))]
    for part in mesh.parts:
        looks = mesh.link_colors(part, part_color(part, color), view.conditions)
        for link, look in zip(part.links.tolist(), looks, strict=True):
            if look is not None:
                shape = part.shape.moved(_matrix(poses.rotations[link]), poses.positions[link])
                corners.append(shape.vertices[shape.faces].astype(float))
                colors.append(np.tile(np.array(look, float), (len(shape.faces), 1)))
    return _Triangles(np.concatenate(corners), np.concatenate(colors))


def _matrix(wxyz: FloatArray) -> FloatArray:
    flat = np.empty(9)
    mujoco.mju_quat2Mat(flat, wxyz)
    return flat.reshape(3, 3)
