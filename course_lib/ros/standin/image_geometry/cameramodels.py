# ruff: noqa: N802, N803, N815 - the names are ROS's
"""Camera models created from a CameraInfo, which map 3D points to pixels and pixels to rays."""

import copy
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from sensor_msgs.msg import CameraInfo

from course_lib.arrays import Matrix
from course_lib.errors import CourseError

# The possible numbers of distortion coefficients in OpenCV.
_COUNTS = (4, 5, 8, 12, 14)
# The number of iterations in OpenCV's undistortion.
_STEPS = 5


def undistorted(x: float, y: float, coefficients: Sequence[float]) -> tuple[float, float]:
    """Return the undistorted position of a point in normalized image coordinates (focal length 1).

    Raises:
        ValueError: The model does not have this number of coefficients.
    """
    if len(coefficients) not in _COUNTS:
        raise ValueError(
            f"The camera's d has {len(coefficients)} coefficients; the model has {_COUNTS} or "
            "none. Look at the publisher of the CameraInfo."
        )
    *lens, tau_x, tau_y = (*coefficients, *[0.0] * (14 - len(coefficients)))
    straight_x, straight_y = x, y
    if tau_x or tau_y:
        straight_x, straight_y, scale = np.linalg.solve(_tilt(tau_x, tau_y), [x, y, 1.0]).tolist()
        straight_x, straight_y = straight_x / scale, straight_y / scale
    return _without_lens(straight_x, straight_y, lens) or (x, y)


def _without_lens(x: float, y: float, lens: Sequence[float]) -> tuple[float, float] | None:
    """Invert the lens distortion of a point. Return None where the model is not invertible."""
    k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4 = lens
    x0, y0 = x, y
    for _ in range(_STEPS):
        r2 = x * x + y * y
        scale = (1 + ((k6 * r2 + k5) * r2 + k4) * r2) / (1 + ((k3 * r2 + k2) * r2 + k1) * r2)
        if scale < 0:
            return None
        shift_x = 2 * p1 * x * y + p2 * (r2 + 2 * x * x) + s1 * r2 + s2 * r2 * r2
        shift_y = p1 * (r2 + 2 * y * y) + 2 * p2 * x * y + s3 * r2 + s4 * r2 * r2
        x, y = (x0 - shift_x) * scale, (y0 - shift_y) * scale
    return x, y


def _tilt(tau_x: float, tau_y: float) -> Matrix:
    """Return the projection onto a sensor that is tilted by two angles, [rad]."""
    sin_x, cos_x, sin_y, cos_y = math.sin(tau_x), math.cos(tau_x), math.sin(tau_y), math.cos(tau_y)
    about_x = np.array([[1, 0, 0], [0, cos_x, sin_x], [0, -sin_x, cos_x]])
    about_y = np.array([[cos_y, 0, -sin_y], [0, 1, 0], [sin_y, 0, cos_y]])
    rotation = about_y @ about_x
    onto = np.array([[rotation[2, 2], 0, -rotation[0, 2]], [0, rotation[2, 2], -rotation[1, 2]], [0, 0, 1]])
    projection: Matrix = onto @ rotation
    return projection


def _matrix(rows: int, columns: int, numbers: Any) -> Any:
    """Return a numpy.matrix, in which * is the matrix product, as in ROS."""
    return np.matrix(np.reshape(np.array(numbers, np.float64), (rows, columns)))


def _field(name: str, description: str) -> Callable[["PinholeCameraModel"], Any]:
    """Return a method that returns an attribute of a camera."""

    def read(self: "PinholeCameraModel") -> Any:
        return getattr(self, name)

    read.__doc__ = description
    return read


def _entry(row: int, column: int, description: str) -> Callable[["PinholeCameraModel"], float]:
    """Return a method that returns an entry of a camera's projection matrix."""

    def read(self: "PinholeCameraModel") -> float:
        return float(self.P[row, column])

    read.__doc__ = description
    return read


class PinholeCameraModel:
    """A pinhole camera with lens distortion, for raw and rectified images.

    K and P refer to the binning and region of interest, full_K and full_P to the whole sensor.
    """

    K: Any = None
    D: Any = None
    R: Any = None
    P: Any = None
    full_K: Any = None
    full_P: Any = None
    width: Any = None
    height: Any = None
    binning_x: Any = None
    binning_y: Any = None
    resolution: Any = None
    raw_roi: Any = None
    tf_frame: Any = None
    stamp: Any = None

    def fromCameraInfo(self, msg: CameraInfo) -> None:
        """Set the parameters from a message."""
        self.full_K, self.full_P = _matrix(3, 3, msg.k), _matrix(3, 4, msg.p)
        self.D = _matrix(len(msg.d), 1, msg.d) if len(msg.d) else None
        self.R = _matrix(3, 3, msg.r)
        self.width, self.height = self.resolution = (msg.width, msg.height)
        self.binning_x, self.binning_y = max(1, msg.binning_x), max(1, msg.binning_y)
        self.raw_roi = copy.copy(msg.roi)
        # A region of zeros means the full image.
        if not (msg.roi.x_offset or msg.roi.y_offset or msg.roi.width or msg.roi.height):
            self.raw_roi.width, self.raw_roi.height = self.resolution
        self.tf_frame, self.stamp = msg.header.frame_id, msg.header.stamp
        self.K, self.P = self._crop_matrix(self.full_K), self._crop_matrix(self.full_P)

    def _crop_matrix(self, full: Any) -> Any:
        """Return a camera matrix adapted to the message's binning and region of interest."""
        reduced = full.copy()
        rows = ((0, self.raw_roi.x_offset, self.binning_x), (1, self.raw_roi.y_offset, self.binning_y))
        for row, offset, binning in rows:
            reduced[row, row] /= binning
            reduced[row, 2] = (reduced[row, 2] - offset) / binning
        return reduced

    def rectifyImage(self, raw: Any, rectified: Any) -> None:
        """Rectify `raw` and write the result into `rectified`.

        Raises:
            CourseError: OpenCV is not installed.
        """
        try:
            import cv2
        except ImportError:
            raise CourseError(
                "rectifyImage needs OpenCV, which is not here. Install it: pip install opencv-python-headless"
            ) from None
        self.mapx, self.mapy = cv2.initUndistortRectifyMap(
            self.K, self.D, self.R, self.P, self.resolution, cv2.CV_32FC1
        )
        cv2.remap(raw, self.mapx, self.mapy, cv2.INTER_CUBIC, rectified)

    def rectifyPoint(self, uv_raw: Sequence[float]) -> Any:
        """Return the rectified coordinates of a pixel, shape (2,)."""
        x = (uv_raw[0] - self.K[0, 2]) / self.K[0, 0]
        y = (uv_raw[1] - self.K[1, 2]) / self.K[1, 1]
        if self.D is not None:
            x, y = undistorted(x, y, self.D.A1.tolist())
        u, v, w = (self.P[:, :3] * self.R * np.array([[x], [y], [1.0]])).A1
        return np.array([u / w, v / w])

    def project3dToPixel(self, point: Sequence[float]) -> tuple[float, float]:
        """Return the pixel (u, v) of a point (x, y, z) in the camera frame; NaN if it has none."""
        u, v, w = (self.P * np.array([[point[0]], [point[1]], [point[2]], [1.0]])).A1
        return (u / w, v / w) if w != 0 else (math.nan, math.nan)

    def projectPixelTo3dRay(self, uv: Sequence[float]) -> tuple[float, float, float]:
        """Return the unit vector of the ray through a pixel of the rectified image."""
        x, y = (uv[0] - self.cx()) / self.fx(), (uv[1] - self.cy()) / self.fy()
        norm = math.sqrt(x * x + y * y + 1)
        return x / norm, y / norm, 1.0 / norm

    def getDeltaU(self, deltaX: float, Z: float) -> float:
        """Return the width in pixels of an object of width `deltaX` [m] at depth `Z` [m]."""
        return float(self.fx() * deltaX / Z) if Z else math.inf

    def getDeltaV(self, deltaY: float, Z: float) -> float:
        """Return the height in pixels of an object of height `deltaY` [m] at depth `Z` [m]."""
        return float(self.fy() * deltaY / Z) if Z else math.inf

    def getDeltaX(self, deltaU: float, Z: float) -> float:
        """Return the width [m] that `deltaU` pixels cover at depth `Z` [m]."""
        return float(Z * deltaU / self.fx())

    def getDeltaY(self, deltaV: float, Z: float) -> float:
        """Return the height [m] that `deltaV` pixels cover at depth `Z` [m]."""
        return float(Z * deltaV / self.fy())

    def fullResolution(self) -> tuple[int, int]:
        """Return the width and the height of the whole sensor, in pixels."""
        resolution: tuple[int, int] = self.resolution
        return resolution

    intrinsicMatrix = _field("K", "Return the camera matrix K.")
    distortionCoeffs = _field("D", "Return the distortion coefficients D as a column, or None.")
    rotationMatrix = _field("R", "Return the rectification matrix R.")
    projectionMatrix = _field("P", "Return the projection matrix P.")
    fullIntrinsicMatrix = _field("full_K", "Return K of the whole sensor, without binning.")
    fullProjectionMatrix = _field("full_P", "Return P of the whole sensor, without binning.")
    cx = _entry(0, 2, "Return the column of the principal point.")
    cy = _entry(1, 2, "Return the row of the principal point.")
    fx = _entry(0, 0, "Return the horizontal focal length in pixels.")
    fy = _entry(1, 1, "Return the vertical focal length in pixels.")
    Tx = _entry(0, 3, "Return P[0, 3]: -fx times the distance to the left camera, in pixels times [m].")
    Ty = _entry(1, 3, "Return P[1, 3].")

    def fovX(self) -> float:
        """Return the horizontal field of view, [rad]."""
        return 2 * math.atan(self.width / (2 * self.fx()))

    def fovY(self) -> float:
        """Return the vertical field of view, [rad]."""
        return 2 * math.atan(self.height / (2 * self.fy()))

    def tfFrame(self) -> str:
        """Return the frame of the camera."""
        return str(self.tf_frame)


class StereoCameraModel:
    """A stereo camera with rectified images."""

    def __init__(self) -> None:
        self.left = PinholeCameraModel()
        self.right = PinholeCameraModel()

    def fromCameraInfo(self, left_msg: CameraInfo, right_msg: CameraInfo) -> None:
        """Set the parameters of both cameras. The baseline is in P of the right camera."""
        self.left.fromCameraInfo(left_msg)
        self.right.fromCameraInfo(right_msg)
        right = self.right
        # Maps (u, v, disparity, 1) to homogeneous coordinates (x, y, z, w).
        self.Q = np.zeros((4, 4))
        self.Q[0, 0] = self.Q[1, 1] = 1.0
        self.Q[:3, 3] = -right.cx(), -right.cy(), right.fx()
        self.Q[3, 2] = 1 / (-right.Tx() / right.fx())

    def tfFrame(self) -> str:
        """Return the frame of 3D points: the frame of the left camera."""
        return self.left.tfFrame()

    def project3dToPixel(
        self,
        point: Sequence[float],
    ) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the pixels of a point (x, y, z) in the left and in the right image."""
        return self.left.project3dToPixel(point), self.right.project3dToPixel(point)

    def projectPixelTo3d(
        self,
        left_uv: Sequence[float],
        disparity: float,
    ) -> tuple[float, float, float]:
        """Return the 3D point of a pixel in the left image; (0, 0, 0) if the disparity is 0."""
        x, y, z, w = self.Q @ [left_uv[0], left_uv[1], disparity, 1.0]
        return (x / w, y / w, z / w) if w != 0 else (0.0, 0.0, 0.0)

    def getZ(self, disparity: float) -> float:
        """Return the depth [m] for a disparity."""
        return float(-self.right.Tx() / disparity) if disparity else math.inf

    def getDisparity(self, Z: float) -> float:
        """Return the disparity, in pixels, for a depth [m]."""
        return float(-self.right.Tx() / Z) if Z else math.inf
