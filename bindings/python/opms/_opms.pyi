"""Binding of libopms; use the package opms."""

from collections.abc import Sequence
import enum
from typing import Annotated, overload

import numpy
import numpy.dtypes
import numpy.typing
from numpy.typing import NDArray


class Status(enum.IntEnum):
    """Status of a call; failures are negative."""

    OK = 0

    ERR_ARG = -1
    """An argument is out of range or not finite."""

    ERR_MEMORY = -2
    """An allocation failed."""

    ERR_CAPACITY = -3
    """A buffer is too small."""

    ERR_DOMAIN = -4
    """No solution exists, e.g. no ray reaches a pixel."""

    ERR_CONVERGE = -5
    """An iteration did not converge."""

    ERR_INTERNAL = -6
    """A defect of the library; please report it."""

    ERR_DEVICE = -8
    """No such device, several, gone, or no permission."""

    ERR_TIMEOUT = -9
    """The device did not answer in time."""

    ERR_VERSION = -10
    """The device speaks another protocol version."""

    ERR_REFUSED = -11
    """The device refused; the message says why."""

def version() -> str:
    """Version of the library, as major.minor.patch."""

BAR_SQUARES: int = 33

BAR_PITCH_M: float = 0.03

BAR_SQUARE_M: float = 0.02

BAR_ORIGIN: int = 16

SQUARE_DTYPE: numpy.dtypes.VoidDType = ...

EDGE_DTYPE: numpy.dtypes.VoidDType = ...

NODE_DTYPE: numpy.dtypes.VoidDType = ...

GRID_PITCH_M: float = 0.025

GRID_LINE_M: float = 0.002

GRID_CENTRE: int = 50

GRID_NODES_X: int = 33

GRID_NODES_Y: int = 45

class Lens:
    """
    Pinhole with the four-parameter Seidel model.

    The distortion is OpenCV's first four coefficients. A value: it never changes, any thread may use
    it. Frames: `camera` has x right and y down in the picture, z along the optical axis; pixel (0, 0)
    is the centre of the top left pixel.
    """

    def __init__(self, *, width_px: int, height_px: int, fx_px: float, fy_px: float, cx_px: float, cy_px: float, k1: float = 0.0, k2: float = 0.0, p1: float = 0.0, p2: float = 0.0) -> None:
        """
        Picture size and intrinsic parameters; check() tells whether they can be used.
        """

    @property
    def width_px(self) -> int:
        """Width of the picture."""

    @property
    def height_px(self) -> int:
        """Height of the picture."""

    @property
    def fx_px(self) -> float:
        """Focal length along u."""

    @property
    def fy_px(self) -> float:
        """Focal length along v."""

    @property
    def cx_px(self) -> float:
        """Principal point, u."""

    @property
    def cy_px(self) -> float:
        """Principal point, v."""

    @property
    def k1(self) -> float:
        """Radial distortion of r^2."""

    @property
    def k2(self) -> float:
        """Radial distortion of r^4."""

    @property
    def p1(self) -> float:
        """First tangential distortion."""

    @property
    def p2(self) -> float:
        """Second tangential distortion."""

    def __repr__(self) -> str: ...

    def check(self) -> None:
        """
        Check that the lens can be used over its whole picture.

        Raises Error: ERR_ARG names the parameter, ERR_DOMAIN where the distortion folds in the picture.
        """

    def project(self, points_m: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 2))]:
        """
        Project points of the camera frame.

        points_m: (N, 3), X Y Z with Z > 0, any common unit. Returns (N, 2) pixels u v.
        Raises Error with the index of the first point that has no picture. Releases the GIL.
        """

    def project_gradients(self, points_m: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)]) -> tuple[Annotated[NDArray[numpy.float64], dict(shape=(None, 2))], Annotated[NDArray[numpy.float64], dict(shape=(None, 2, 3))], Annotated[NDArray[numpy.float64], dict(shape=(None, 2, 8))]]:
        """
        Project points of the camera frame, with gradients.

        points_m: (N, 3) as in project(). Returns pixels (N, 2), d(u, v)/d(X, Y, Z) as (N, 2, 3), and
        d(u, v)/d(fx fy cx cy k1 k2 p1 p2) as (N, 2, 8). Raises as project(). Releases the GIL.
        """

    def unproject(self, px: Annotated[NDArray[numpy.float64], dict(shape=(None, 2), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 2))]:
        """
        Rays of pixels.

        px: (N, 2) pixels u v. Returns (N, 2) normalised coordinates x y, so that project((x, y, 1)) = px.
        Raises Error with the index of the first pixel that no ray reaches. Releases the GIL.
        """

    def unproject_gradients(self, px: Annotated[NDArray[numpy.float64], dict(shape=(None, 2), order='C', device='cpu', writable=False)]) -> tuple[Annotated[NDArray[numpy.float64], dict(shape=(None, 2))], Annotated[NDArray[numpy.float64], dict(shape=(None, 2, 2))]]:
        """
        Rays of pixels, with gradients.

        px: (N, 2) as in unproject(). Returns rays (N, 2) and d(x, y)/d(u, v) as (N, 2, 2). Raises as
        unproject(). Releases the GIL.
        """

class Covariance(enum.Flag):
    """What a covariance holds."""

    IMAGE = 1

    INTRINSICS = 2

    DETECTOR_CAMERA = 4

class Transform:
    """
    A rigid transform that takes coordinates in b to those in a.

    A value: it never changes, any thread may use it.
    """

    def __init__(self, R: Annotated[NDArray[numpy.float64], dict(shape=(3, 3), order='C', device='cpu', writable=False)], t_m: Annotated[NDArray[numpy.float64], dict(shape=(3), order='C', device='cpu', writable=False)]) -> None:
        """R: (3, 3) rotation R_a_b; t_m: (3,) translation t_a_b in metres."""

    @property
    def R(self) -> Annotated[NDArray[numpy.float64], dict(shape=(3, 3), writable=False)]:
        """Rotation R_a_b, (3, 3), read only."""

    @property
    def t_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(3), writable=False)]:
        """Translation t_a_b in metres, (3,), read only."""

class Pose:
    """A pose with its uncertainty."""

    @property
    def transform(self) -> Transform:
        """The pose itself."""

    @property
    def covariance(self) -> Annotated[NDArray[numpy.float64], dict(shape=(6, 6), writable=False)]:
        """
        Covariance of (w, d), (6, 6), read only, in rad and m.

        R_true = R Exp(w), t_true = t + d.
        """

class Camera:
    """
    A camera as calibrated: its lens and its place on the detector.

    A value: it never changes, any thread may use it. opms.load_camera() reads one from a file.
    """

    def __init__(self, lens: Lens, *, R_detector_camera: Annotated[NDArray[numpy.float64], dict(shape=(3, 3), order='C', device='cpu', writable=False)] | None = None, t_detector_camera_m: Annotated[NDArray[numpy.float64], dict(shape=(3), order='C', device='cpu', writable=False)] | None = None, covariance_intrinsics: Annotated[NDArray[numpy.float64], dict(shape=(8, 8), order='C', device='cpu', writable=False)] | None = None, covariance_detector_camera: Annotated[NDArray[numpy.float64], dict(shape=(6, 6), order='C', device='cpu', writable=False)] | None = None, covariance_detector_camera_intrinsics: Annotated[NDArray[numpy.float64], dict(shape=(6, 8), order='C', device='cpu', writable=False)] | None = None) -> None:
        """
        R_detector_camera: (3, 3) and t_detector_camera_m: (3,) take the camera's frame
        to the detector's. covariance_intrinsics: (8, 8) in the order fx fy cx cy k1 k2 p1 p2;
        covariance_detector_camera: (6, 6) of (w, d) as in Pose.covariance;
        covariance_detector_camera_intrinsics: (6, 8), that of the latter with the former.
        """

    def check(self) -> None:
        """
        Check lens, rotation and covariances. Raises Error (ERR_ARG or ERR_DOMAIN).
        """

    @property
    def lens(self) -> Lens:
        """The lens."""

    @property
    def detector_camera(self) -> Transform | None:
        """Camera to detector, or None."""

    @property
    def covariance_intrinsics(self) -> Annotated[NDArray[numpy.float64], dict(shape=(8, 8), writable=False)] | None:
        """Covariance of fx fy cx cy k1 k2 p1 p2, (8, 8), or None."""

    @property
    def covariance_detector_camera(self) -> Annotated[NDArray[numpy.float64], dict(shape=(6, 6), writable=False)] | None:
        """Covariance of (w, d) of the camera on the detector, (6, 6), or None."""

    @property
    def covariance_detector_camera_intrinsics(self) -> Annotated[NDArray[numpy.float64], dict(shape=(6, 8), writable=False)] | None:
        """
        Covariance of (w, d) of the camera on the detector with the intrinsics, (6, 8), or None.
        """

class PoseState(enum.IntEnum):
    """Outcome of pose_solve()."""

    NONE = 0
    """Too few edges, or none that agree."""

    FOUND = 1

    AMBIGUOUS = 2
    """Both solutions of a plane fit alike."""

class PoseResult:
    """Result of pose_solve(); valid where state is FOUND."""

    @property
    def state(self) -> PoseState:
        """A PoseState."""

    @property
    def edges_used(self) -> int:
        """Edges with a robust weight above one half."""

    @property
    def bar_camera(self) -> Pose:
        """Camera to bar; the covariance is from the image noise alone."""

    @property
    def edge_shift_px(self) -> float:
        """Common outward shift of all edges of the black squares."""

    @property
    def residual_px(self) -> float:
        """Weighted RMS of the used edges' distances from the solution."""

    @property
    def chi2_dof(self) -> float:
        """Mean squared residual of the used edges in units of their sigmas."""

    @property
    def chi2_other(self) -> float:
        """Excess of chi2 of the other planar solution; large is good."""

    @property
    def intrinsics_jacobian(self) -> Annotated[NDArray[numpy.float64], dict(shape=(6, 8), writable=False)]:
        """d(w, d)/d(fx fy cx cy k1 k2 p1 p2), (6, 8), read only."""

def pose_solve(lens: Lens, edges: numpy.typing.NDArray[numpy.void]) -> tuple[PoseResult, numpy.typing.NDArray[numpy.float64] | None]:
    """
    Pose of the camera in the bar frame from measured edges.

    edges: (N,) of opms.EDGE_DTYPE, at least 8 on 2 squares for a pose. Returns the result and, where
    its state is FOUND, the signed distance of each edge from the solution in px, (N,).
    Raises Error (ERR_ARG, index of the edge). Pure, any thread; releases the GIL.
    """

def pose_detector(bar_camera: PoseResult, camera: Camera, bar_tilt_rad: float = 0.0) -> tuple[Pose, Covariance]:
    """
    Pose of the detector in the ground frame from that of the camera in the bar frame.

    bar_camera: a result whose state is FOUND. camera: with detector_camera. bar_tilt_rad: positive
    where the printed face is turned away from the operator. Returns the pose, detector to ground, and
    what its covariance holds. Raises Error (ERR_ARG). Pure, any thread.
    """

class BarState(enum.IntEnum):
    """What a picture shows."""

    ABSENT = 0
    """No bar is seen."""

    LOCATED = 1
    """Squares found, labels certain."""

    AMBIGUOUS = 2
    """Squares found, but the evidence does not decide."""

class BarSummary:
    """The picture of the bar as a whole."""

    @property
    def state(self) -> BarState:
        """A BarState."""

    @property
    def square_count(self) -> int:
        """Squares found."""

    @property
    def edge_count(self) -> int:
        """Edges measured."""

    @property
    def followed(self) -> bool:
        """The bar was found where the hint said."""

    @property
    def label_margin(self) -> float:
        """Log-likelihood ratio of the labels to the next best; 0 if none."""

    @property
    def blur_px(self) -> Annotated[NDArray[numpy.float64], dict(shape=(2), writable=False)]:
        """
        Gaussian edge blur of the sides along X and of those along Y, (2,); 0 unknown.
        """

    @property
    def noise(self) -> float:
        """Standard deviation of the grey levels about the edge model."""

    @property
    def contrast(self) -> float:
        """Median grey levels from black to white."""

    @property
    def white_fraction_saturated(self) -> float:
        """Part of the white beside the squares that is saturated."""

class BarDetection:
    """What BarDetector.detect() found."""

    @property
    def summary(self) -> BarSummary:
        """State and figures."""

    @property
    def squares(self) -> numpy.typing.NDArray[numpy.void]:
        """
        Squares by rising index, (N,) of opms.SQUARE_DTYPE.

        corners_px: (N, 4, 2), in the order (-X,-Y), (+X,-Y), (+X,+Y), (-X,+Y) of the bar frame.
        """

    @property
    def edges(self) -> numpy.typing.NDArray[numpy.void]:
        """
        Measured stretches of the squares' sides, (N,) of opms.EDGE_DTYPE.

        side 0: X = -10 mm, 1: Y = -10 mm, 2: X = +10 mm, 3: Y = +10 mm; bar_m: (X, Y) in the bar plane;
        normal: unit normal in the picture, out of the square; sigma_px: along the normal; shift_gain:
        pixels by which the edge moves when the common edge shift grows by one.
        """

class BarDetector:
    """
    Finds bars of kind hope33; holds all memory.

    Calls from several threads on one detector are taken one after the other; different detectors run
    in parallel.
    """

    def __init__(self, lens: Lens, *, min_square_px: int = 7) -> None:
        """
        For pictures of one lens, whose size is that of the pictures.

        min_square_px: shortest side of a square that the search must not miss, 6 to 64.
        Raises Error (ERR_ARG, ERR_DOMAIN, ERR_MEMORY).
        """

    def detect(self, image: numpy.typing.NDArray[numpy.uint8] | numpy.typing.NDArray[numpy.uint16], *, roi: tuple[int, int, int, int] | None = None, hint: Transform | None = None, white_level: int = 0) -> BarDetection:
        """
        Find the bar in a picture.

        image: (height, width), uint8 or uint16, rows at any distance, read in place without a copy; do not
        change it meanwhile. roi: (x_px, y_px, width_px, height_px) in which squares are sought. hint:
        where the bar is expected, camera to bar. white_level: grey level at saturation, 0 for 255 or 65535.
        Raises Error (ERR_ARG); "no bar" is no error but a state. Releases the GIL.
        """

class Location:
    """Everything one picture gives."""

    @property
    def state(self) -> BarState:
        """A BarState; LOCATED only when the pose is found, too."""

    @property
    def bar(self) -> BarSummary:
        """The picture of the bar as a whole."""

    @property
    def pose(self) -> PoseResult | None:
        """Pose of the camera in the bar frame; None where state is not LOCATED."""

    @property
    def ground_detector(self) -> Pose | None:
        """
        Pose of the detector in the ground frame.

        None where state is not LOCATED or the camera has no detector_camera.
        """

    @property
    def covariance_includes(self) -> Covariance:
        """What the covariance of ground_detector holds."""

    @property
    def followed(self) -> bool:
        """The hint was taken up."""

    @property
    def squares(self) -> numpy.typing.NDArray[numpy.void]:
        """
        Squares by rising index, (N,) of opms.SQUARE_DTYPE; see BarDetection.squares.
        """

    @property
    def edges(self) -> numpy.typing.NDArray[numpy.void]:
        """Measured edges, (N,) of opms.EDGE_DTYPE; see BarDetection.edges."""

    @property
    def residuals_px(self) -> numpy.typing.NDArray[numpy.float64] | None:
        """
        Signed distance of each edge from the solution, (N,); None where there is none.
        """

class Locator:
    """
    Finds the bar and solves for the pose.

    Calls from several threads on one locator are taken one after the other; different locators run in
    parallel.
    """

    def __init__(self, camera: Camera, *, bar_tilt_rad: float = 0.0, min_square_px: int = 7) -> None:
        """
        For pictures of one camera.

        bar_tilt_rad: positive where the printed face is turned away from the operator. min_square_px: as
        in BarDetector. Raises Error (ERR_ARG, ERR_DOMAIN, ERR_MEMORY).
        """

    def locate(self, image: numpy.typing.NDArray[numpy.uint8] | numpy.typing.NDArray[numpy.uint16], *, roi: tuple[int, int, int, int] | None = None, hint: Transform | None = None, white_level: int = 0) -> Location:
        """
        Locate the bar in one picture.

        image: (height, width), uint8 or uint16, rows at any distance, read in place without a copy; do not
        change it meanwhile. roi: (x_px, y_px, width_px, height_px) in which squares are sought. hint:
        the expected camera-to-bar pose, e.g. pose.bar_camera.transform of the last picture; a wrong one
        does no harm. white_level: grey level at saturation, 0 for 255 or 65535.
        Raises Error (ERR_ARG); "no bar" is no error but a state. Releases the GIL.
        """

    def solve(self, edges: numpy.typing.NDArray[numpy.void]) -> Location:
        """
        Solve for the pose from edges found elsewhere, e.g. another kind of bar.

        edges: (N,) of opms.EDGE_DTYPE. Raises Error (ERR_ARG, index of the edge). Releases the GIL.
        """

class BlurVerdict(enum.IntEnum):
    """What a person should do something about."""

    UNKNOWN = 0
    """Too few squares, or their white is saturated."""

    SHARP = 1

    FOCUS = 2
    """Blurred in all directions, nowhere sharp."""

    MOTION = 3
    """Blurred in one direction of the picture."""

    APERTURE = 4
    """Sharp in places alone."""

class Blur:
    """
    How sharp the bar is in a picture.

    Blur is the standard deviation of what a point becomes, px, as the picture shows it: a perfect lens
    leaves the pixel's own 0.29.
    """

    @property
    def verdict(self) -> BlurVerdict:
        """A BlurVerdict."""

    @property
    def squares(self) -> int:
        """Squares that were measured."""

    @property
    def blur_px(self) -> Annotated[NDArray[numpy.float64], dict(shape=(2), writable=False)]:
        """Medians across the sides along Y and across those along X, (2,)."""

    @property
    def still_px(self) -> float:
        """Median in the direction that is blurred least."""

    @property
    def motion_px(self) -> float:
        """Way of the picture that explains what is more in the other direction."""

    @property
    def motion_direction(self) -> Annotated[NDArray[numpy.float64], dict(shape=(2), writable=False)]:
        """(u, v) of that way, length 1; its sign means nothing."""

    @property
    def sharpest_px(self) -> float:
        """Blur where it is least on the bar."""

    @property
    def softest_px(self) -> float:
        """Blur where it is most on the bar."""

    @property
    def sharpest_square(self) -> int | None:
        """Index of the square where it is least; None where none was measured."""

    @property
    def softest_square(self) -> int | None:
        """Index of the square where it is most; None where none was measured."""

def blur_measure(image: numpy.typing.NDArray[numpy.uint8] | numpy.typing.NDArray[numpy.uint16], squares: numpy.typing.NDArray[numpy.void], *, white_level: int = 0, sharp_most_px: float = 1.0) -> Blur:
    """
    Measure the blur of the bar's squares.

    image: (height, width), uint8 or uint16, read in place; squares: (N,) of opms.SQUARE_DTYPE as a
    detection or a location has them. white_level: grey level at saturation, 0 for 255 or 65535.
    sharp_most_px: up to here it counts as sharp, 0.3 to 20.
    Raises Error (ERR_ARG). Pure, any thread; releases the GIL.
    """

class GridState(enum.IntEnum):
    """What a picture shows."""

    ABSENT = 0
    """No grid is seen."""

    LABELLED = 1
    """Nodes found, labels certain."""

    UNLABELLED = 2
    """
    Nodes found, but not the marker: labels begin anywhere, turned by any quarter.
    """

class GridSummary:
    """The picture of the grid as a whole."""

    @property
    def state(self) -> GridState:
        """A GridState."""

    @property
    def node_count(self) -> int:
        """Nodes found."""

    @property
    def noise(self) -> float:
        """Standard deviation of the grey levels about the line model."""

    @property
    def contrast(self) -> float:
        """Median grey levels from white to the depth of a line."""

    @property
    def blur_px(self) -> float:
        """Standard deviation of the blur."""

    @property
    def marker_margin(self) -> float:
        """Contrast of the marker over the next best place, 0 to 1; 0 if none."""

class GridDetection:
    """What opms.grid.Detector.detect() found."""

    @property
    def summary(self) -> GridSummary:
        """State and figures."""

    @property
    def nodes(self) -> numpy.typing.NDArray[numpy.void]:
        """
        Nodes by label, (N,) of opms.grid.NODE_DTYPE.

        label: (N, 2), (50 + i, 50 + j) for the node at (i, j) pitches of the grid frame; px: (N, 2),
        (u, v); sigma_px: standard deviation of each coordinate.
        """

class GridDetector:
    """
    Finds grids of kind a0-25; holds all memory.

    Calls from several threads on one detector are taken one after the other; different detectors run
    in parallel.
    """

    def __init__(self, width_px: int, height_px: int, *, min_pitch_px: float = 9.0) -> None:
        """
        For pictures of one size, 16 to 16384 px each way.

        min_pitch_px: shortest distance between lines that is sought, 8 to 100.
        Raises Error (ERR_ARG, ERR_MEMORY).
        """

    def detect(self, image: numpy.typing.NDArray[numpy.uint8] | numpy.typing.NDArray[numpy.uint16], *, white_level: int = 0) -> GridDetection:
        """
        Find the grid in a picture. No lens is needed.

        image: (height_px, width_px), uint8 or uint16, rows at any distance, read in place without a copy;
        do not change it meanwhile. white_level: grey level at saturation, 0 for 255 or 65535.
        Raises Error (ERR_ARG); "no grid" is no error but a state. Releases the GIL.
        """

def grid_relabel(known: numpy.typing.NDArray[numpy.void], nodes: numpy.typing.NDArray[numpy.void]) -> numpy.typing.NDArray[numpy.void] | None:
    """
    Label the nodes of a picture whose marker is hidden from a neighbouring picture.

    known: (M,) labelled nodes of a picture taken shortly before or after; nodes: (N,); both of
    opms.grid.NODE_DTYPE. Returns new nodes with their labels, or None where these are not certain: the
    camera must have moved by much less than half a pitch between both.
    Raises Error (ERR_ARG). Pure, any thread; releases the GIL.
    """

class CalibWarning(enum.Flag):
    """What the pictures do not fix well enough."""

    ALL_PARALLEL = 1
    """The target's normal has nearly one direction in all pictures."""

    FEW_PICTURES = 2
    """Fewer than 5."""

    POOR_COVERAGE = 4
    """Much of the picture's border never held a point."""

    FOCAL_OPEN = 8
    """Focal length no better than 1 %."""

    CENTRE_OPEN = 16
    """Principal point no better than 2 % of the width."""

    LARGE_RESIDUAL = 32
    """Residuals far beyond the stated sigmas."""

    MANY_OUTLIERS = 64
    """More than 5 % of the points do not agree."""

class CalibUse(enum.IntEnum):
    """What became of one picture."""

    USED = 0

    NOT_SOLVED = 1
    """No solution since it was added, or the last one failed."""

    NO_PLANE = 2
    """Its points are no view of a plane."""

    NO_FIT = 3
    """A plane, but not seen by this camera."""

    SWITCHED_OFF = 4
    """By Calibrator.use()."""

class Footprint:
    """Where the detector's head stood on the target in one picture."""

    def __init__(self, **kwargs) -> None:
        """Fields by keyword; those that are not given are 0."""

    @property
    def picture(self) -> int:
        """Index of the picture."""

    @picture.setter
    def picture(self, arg: int, /) -> None: ...

    @property
    def x_m(self) -> float:
        """Head centre in the target's frame, X."""

    @x_m.setter
    def x_m(self, arg: float, /) -> None: ...

    @property
    def y_m(self) -> float:
        """Head centre in the target's frame, Y."""

    @y_m.setter
    def y_m(self, arg: float, /) -> None: ...

    @property
    def yaw_rad(self) -> float:
        """Turn of the head about Z."""

    @yaw_rad.setter
    def yaw_rad(self, arg: float, /) -> None: ...

    @property
    def sigma_m(self) -> float:
        """Standard deviation of the placing along X and along Y, >= 0."""

    @sigma_m.setter
    def sigma_m(self, arg: float, /) -> None: ...

    @property
    def sigma_rad(self) -> float:
        """Standard deviation of the yaw, >= 0."""

    @sigma_rad.setter
    def sigma_rad(self, arg: float, /) -> None: ...

    def __eq__(self, arg: Footprint, /) -> bool:
        """Are all fields equal?"""

    def __repr__(self) -> str: ...

class CalibResult:
    """A calibration."""

    @property
    def lens(self) -> Lens:
        """The lens."""

    @property
    def covariance(self) -> Annotated[NDArray[numpy.float64], dict(shape=(8, 8), writable=False)]:
        """Covariance of fx fy cx cy k1 k2 p1 p2 in px and 1, (8, 8), read only."""

    @property
    def pictures_used(self) -> int:
        """Pictures that fit."""

    @property
    def points_used(self) -> int:
        """Points with a weight of one quarter or more."""

    @property
    def outliers(self) -> int:
        """The other points of the pictures used."""

    @property
    def warnings(self) -> CalibWarning:
        """What the pictures do not fix well enough, an opms.calib.Warning."""

    @property
    def iterations(self) -> int:
        """Steps of the solution."""

    @property
    def residual_rms_px(self) -> float:
        """RMS length of the residuals (u, v) of the points used."""

    @property
    def chi2_dof(self) -> float:
        """Mean square of the residuals over the stated sigmas."""

    @property
    def coverage(self) -> float:
        """Part of 8 x 8 cells of the picture that held points."""

    @property
    def cockle_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(12), writable=False)]:
        """
        Heights of the target, (12,), read only, in metres.

        Of the terms (X/s)^i (Y/s)^j with 2 <= i + j <= 4, where s is cockle_scale_m; 0 where none was
        estimated.
        """

    @property
    def cockle_scale_m(self) -> float:
        """Half the target's size, 0 where no cockle was estimated."""

    @property
    def cockle_peak_m(self) -> float:
        """Largest less smallest height over the target's points."""

class CalibPicture:
    """One picture of a calibration."""

    @property
    def use(self) -> CalibUse:
        """A CalibUse; unless it is USED what follows is 0."""

    @property
    def points(self) -> int:
        """Points it was given."""

    @property
    def outliers(self) -> int:
        """Those with a weight below one quarter."""

    @property
    def target_camera(self) -> Pose | None:
        """
        Camera to target, covariance with the lens's uncertainty; None unless USED.
        """

    @property
    def covariance_with_lens(self) -> Annotated[NDArray[numpy.float64], dict(shape=(6, 8), writable=False)]:
        """
        Covariance of the pose's (w, d) and the lens's eight parameters, (6, 8), read only.
        """

    @property
    def residual_rms_px(self) -> float:
        """RMS length of the residuals of its points used."""

    @property
    def tilt_rad(self) -> float:
        """Between the optical axis and the target's normal."""

    @property
    def gain(self) -> float:
        """
        Part of the lens's information that would be lost without this picture.

        Summed over its eight parameters; 1 is all of one parameter's.
        """

class CalibForesight:
    """What a further picture would do."""

    @property
    def points(self) -> int:
        """Points of the target in the picture."""

    @property
    def gain(self) -> float:
        """
        Part of the lens's variances that would be gone, over its parameters: 0 to 8.
        """

    @property
    def camera(self) -> Camera:
        """The camera with that picture: unmoved, its covariances smaller."""

class CalibLensCheck:
    """What new pictures say of a lens that was calibrated before."""

    @property
    def pictures_used(self) -> int:
        """Pictures that fit."""

    @property
    def points_used(self) -> int:
        """Points with a weight of one quarter or more."""

    @property
    def outliers(self) -> int:
        """The other points of the pictures used."""

    @property
    def residual_rms_px(self) -> float:
        """RMS length of the residuals, the lens as stated."""

    @property
    def residual_free_rms_px(self) -> float:
        """The same with the lens free: what the points are good for."""

    @property
    def noise_factor(self) -> float:
        """Standard deviation of the points over the stated one, never below 1."""

    @property
    def chi2(self) -> float:
        """Of 8: above opms.calib.CHI2_LENS the stated lens is wrong."""

    @property
    def change(self) -> Annotated[NDArray[numpy.float64], dict(shape=(8), writable=False)]:
        """
        Of fx fy cx cy k1 k2 p1 p2, (8,), read only: what would explain the points.
        """

    @property
    def shows_focal(self) -> float:
        """Smallest relative change of fx and fy that would show 19 times of 20."""

    @property
    def shows_centre_px(self) -> Annotated[NDArray[numpy.float64], dict(shape=(2), writable=False)]:
        """The same of cx and cy, (2,), read only."""

class CalibMountingCheck:
    """
    What a picture on a footprint says of a mounting that was found before.
    """

    @property
    def detector_camera(self) -> Transform:
        """Camera to detector as this picture has it, through the stated lens."""

    @property
    def change(self) -> Annotated[NDArray[numpy.float64], dict(shape=(6), writable=False)]:
        """
        (w, d) from the stated mounting to this one, (6,), read only, in rad and m.
        """

    @property
    def covariance(self) -> Annotated[NDArray[numpy.float64], dict(shape=(6, 6), writable=False)]:
        """
        Of the change where nothing moved, (6, 6), read only; the placing included.
        """

    @property
    def chi2(self) -> float:
        """Of 6: above opms.calib.CHI2_MOUNTING the camera has moved."""

    @property
    def shows_turn_rad(self) -> Annotated[NDArray[numpy.float64], dict(shape=(3), writable=False)]:
        """
        Smallest turns about the detector's axes that would show 19 times of 20, (3,).
        """

    @property
    def shows_shift_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(3), writable=False)]:
        """Smallest shifts along the detector's axes that would, (3,)."""

CALIB_CHI2_LENS: float = 26.12

CALIB_CHI2_MOUNTING: float = 22.46

class Calibrator:
    """
    Solves one camera; holds all memory.

    Calls from several threads on one calibrator are taken one after the other; different calibrators
    run in parallel.
    """

    def __init__(self, width_px: int, height_px: int, *, pictures_max: int = 64, points_max: int = 1485, cockle_sigma_m: float = 0.0) -> None:
        """
        For pictures of one size, 16 to 16384 px each way.

        pictures_max: 3 to 1024; points_max: in one picture, 4 to 8192; cockle_sigma_m: how far the target
        may be off a plane (standard deviation at half its size), which is then estimated; 0: it is a
        plane. Raises Error (ERR_ARG, ERR_MEMORY).
        """

    def add(self, target_m: Annotated[NDArray[numpy.float64], dict(shape=(None, 2), order='C', device='cpu', writable=False)], px: Annotated[NDArray[numpy.float64], dict(shape=(None, 2), order='C', device='cpu', writable=False)], sigma_px: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> int:
        """
        Add a picture; returns its index: 0, 1, ... in the order of the calls.

        target_m: (N, 2), the points' (X, Y) in the target's plane in metres; px: (N, 2), where they are
        seen, (u, v); sigma_px: (N,), standard deviation of each coordinate, > 0. N is at least 4.
        Raises Error: ERR_ARG (index of the point), ERR_CAPACITY, or ERR_DOMAIN where the points are no
        view of a plane; nothing was added then. Releases the GIL.
        """

    def use(self, picture: int, used: bool) -> None:
        """
        Switch a picture off or on again; it takes effect with the next solution.

        Raises Error (ERR_ARG).
        """

    def picture(self, picture: int) -> CalibPicture:
        """
        What became of one picture in the last solution. Raises Error (ERR_ARG).
        """

    def residuals(self, picture: int) -> tuple[Annotated[NDArray[numpy.float64], dict(shape=(None, 2))], Annotated[NDArray[numpy.float64], dict(shape=(None,))]]:
        """
        Residuals and weights of one picture's points in the last solution.

        Returns (N, 2) in px, measured less model, NaN where the picture is not used; and (N,) robust
        weights, 0 to 1, below one quarter for an outlier. Raises Error (ERR_ARG).
        """

    def solve(self) -> CalibResult:
        """
        Solve for the camera from all pictures that are switched on.

        The next solution starts from the last one. Raises Error: ERR_DOMAIN where fewer than 3 pictures
        can be used or nothing fits them, ERR_CONVERGE. Releases the GIL.
        """

    def choose(self, count: int) -> list[int]:
        """
        Indices of the pictures that together fix the lens best, best first.

        Fewer than count where fewer are used. Raises Error (ERR_DOMAIN before a solution).
        """

    def camera(self, footprints: Sequence[Footprint]) -> Camera:
        """
        The camera on its detector, from pictures on footprints, with its covariances.

        footprints: at least one, of pictures that the last solution used. Without any,
        opms.Camera(result.lens, covariance_intrinsics=result.covariance) is the camera by itself.
        Raises Error: ERR_ARG (index of the footprint), ERR_DOMAIN before a solution.
        """

    def foresee(self, target_camera: Transform, target_m: Annotated[NDArray[numpy.float64], dict(shape=(None, 2), order='C', device='cpu', writable=False)], *, sigma_px: float = 0.0, footprints: Sequence[Footprint] = []) -> CalibForesight:
        """
        Foresee what one more picture would do, before it is taken.

        target_camera: camera to target, from where it would be taken; target_m: (N, 2), the target's
        points, of which those in the picture count; sigma_px: of a point's coordinate, 0 for that of the
        pictures so far; footprints: as for camera(), where the place on the detector matters.
        Raises Error: ERR_ARG, ERR_DOMAIN before a solution. Releases the GIL.
        """

    def check(self, camera: Camera, footprints: Sequence[Footprint] = []) -> tuple[CalibLensCheck, list[CalibMountingCheck]]:
        """
        Does a camera that was calibrated before still hold?

        camera: as it was calibrated; with footprints it needs detector_camera. Returns what the pictures
        say of its lens, and for each footprint what that picture says of its mounting. A solution of this
        calibrator is lost. Raises Error: ERR_ARG (index of the footprint), ERR_DOMAIN where no picture is
        seen by such a lens at all. Releases the GIL.
        """

class Expectation:
    """
    What is to be expected of the detector's pose at one place.

    The covariances are those of the detector's (w, d) as in Pose.covariance; they are independent, and
    their sum is that of the pose.
    """

    @property
    def state(self) -> PoseState:
        """
        A PoseState; unless it is FOUND too little of the bar is in the picture.
        """

    @property
    def square_count(self) -> int:
        """Squares of the bar that are whole in the picture."""

    @property
    def covariance_image(self) -> Annotated[NDArray[numpy.float64], dict(shape=(6, 6), writable=False)]:
        """From the image noise alone, (6, 6), read only, in rad and m."""

    @property
    def covariance_calibration(self) -> Annotated[NDArray[numpy.float64], dict(shape=(6, 6), writable=False)]:
        """
        From the calibration alone, (6, 6), read only; 0 where the camera holds none.
        """

def expect_pose(camera: Camera, ground_detector: Transform, *, bar_tilt_rad: float = 0.0, contrast: float = 150.0, noise: float = 3.0, blur_px: float = 0.75, min_square_px: float = 7.0) -> Expectation:
    """
    Expected uncertainty of the detector's pose over a bar that lies in full view.

    camera: with detector_camera; ground_detector: detector to ground, where the head is.
    bar_tilt_rad: positive where the printed face is turned away from the operator. contrast: grey
    levels from black to white; noise: standard deviation of the grey levels; blur_px: standard
    deviation of the blur; min_square_px: squares with a shorter side do not count.
    Raises Error (ERR_ARG, ERR_DOMAIN where the lens folds). Pure, any thread; releases the GIL.
    """

class ReportId(enum.IntEnum):
    """Ids of reports."""

    TRIGGER = 1

    PONG = 2

    STATUS = 3

    EVENT = 4

    COMMAND = 16

    IDENTITY = 32

    SETTINGS = 33

    HISTORY = 34

    BOOTLOADER = 35

class WireResult(enum.IntEnum):
    """What is wrong with the bytes of a report."""

    OK = 0

    LENGTH = 1
    """Not 64 bytes."""

    ID = 2
    """Unknown, or not the id that was asked for."""

    VERSION = 3
    """Another protocol version."""

    CRC = 4

    VALUE = 5
    """A field out of range, or a reserved byte not 0."""

class BoxState(enum.IntEnum):
    """States of the box."""

    IDLE = 0

    ARMED = 1
    """Told to get ready."""

    PREAMBLE = 2
    """Sends the preamble's pulses."""

    WAITING = 3
    """For the hardware start."""

    RUNNING = 4
    """A pulse each period since the start edge."""

class ResetCause(enum.IntEnum):
    """Why the box started up."""

    UNKNOWN = 0

    POWER = 1

    PIN = 2

    WATCHDOG = 3
    """The program hung."""

    SOFTWARE = 4

class SyncMode(enum.IntEnum):
    """What SYNC sends while RUNNING."""

    OFF = 0

    ONE_HZ = 1
    """1 Hz from the start edge on, each 100 ms high."""

    RUN = 2
    """High from the start edge to the stop."""

class EventKind(enum.IntEnum):
    """Kinds of EVENT."""

    ARMED = 1

    WAITING = 2

    START = 3

    STOP = 4

    GLITCH = 5

    START_REFUSED = 6

    PREAMBLE_CUT = 7

    STROBE_MISSING = 8

    WAIT_TIMEOUT = 9

    REFUSED = 10

    SETTINGS_STORED = 11

    ENDPOINT_HEALED = 12

class Refusal(enum.IntEnum):
    """Why the box refused."""

    NONE = 0

    STATE = 1
    """Not in this state."""

    LENGTH = 2

    ID = 3

    VERSION = 4

    CRC = 5

    VALUE = 6

    MAGIC = 7
    """BOOTLOADER without its magic word."""

    FLASH = 8
    """The flash did not keep what was written."""

    BUSY = 9
    """The one before is still being carried out."""

class CommandOpcode(enum.IntEnum):
    """Opcodes of COMMAND."""

    PING = 1

    ARM = 2

    DISARM = 3

class BoxTime:
    """Time of the box since it started up."""

    def __init__(self, **kwargs) -> None:
        """Fields by keyword; those that are not given are 0."""

    @property
    def us(self) -> int:
        """Whole microseconds."""

    @us.setter
    def us(self, arg: int, /) -> None: ...

    @property
    def cycles(self) -> int:
        """0 to 124, of 8 ns, beyond us."""

    @cycles.setter
    def cycles(self, arg: int, /) -> None: ...

    def __eq__(self, arg: BoxTime, /) -> bool:
        """Are all fields equal?"""

    def __repr__(self) -> str: ...

class TriggerReport:
    """0x01 TRIGGER: one pulse, as it left the box."""

    def __init__(self, **kwargs) -> None:
        """Fields by keyword; those that are not given are 0."""

    @property
    def flags(self) -> int:
        """Bits of opms.wire.TriggerFlag."""

    @flags.setter
    def flags(self, arg: int, /) -> None: ...

    @property
    def boot_id(self) -> int:
        """Random, another one at each start-up; never 0."""

    @boot_id.setter
    def boot_id(self, arg: int, /) -> None: ...

    @property
    def session_id(self) -> int:
        """Set by the host when it armed."""

    @session_id.setter
    def session_id(self, arg: int, /) -> None: ...

    @property
    def report_number(self) -> int:
        """Of all input reports since start-up, from 1."""

    @report_number.setter
    def report_number(self, arg: int, /) -> None: ...

    @property
    def trigger_number(self) -> int:
        """Pulses since arming, the preamble included, from 1."""

    @trigger_number.setter
    def trigger_number(self, arg: int, /) -> None: ...

    @property
    def time(self) -> BoxTime:
        """Rising edge (of active TRIG)."""

    @time.setter
    def time(self, arg: BoxTime, /) -> None: ...

    @property
    def start_edge(self) -> BoxTime:
        """START's edge; zero before the run."""

    @start_edge.setter
    def start_edge(self, arg: BoxTime, /) -> None: ...

    @property
    def first_run_number(self) -> int:
        """Number of the run's first pulse; 0 before the run."""

    @first_run_number.setter
    def first_run_number(self, arg: int, /) -> None: ...

    @property
    def strobe_for_trigger(self) -> int:
        """The pulse that the last completed exposure followed; 0 if none."""

    @strobe_for_trigger.setter
    def strobe_for_trigger(self, arg: int, /) -> None: ...

    @property
    def strobe_delay_cycles(self) -> int:
        """From that pulse to the exposure's start, of 8 ns."""

    @strobe_delay_cycles.setter
    def strobe_delay_cycles(self, arg: int, /) -> None: ...

    @property
    def strobe_length_cycles(self) -> int:
        """Length of that exposure, of 8 ns."""

    @strobe_length_cycles.setter
    def strobe_length_cycles(self, arg: int, /) -> None: ...

    @property
    def gap_us(self) -> list[int]:
        """
        Whole us from the pulse before this one, and from the one before that to it.
        """

    @gap_us.setter
    def gap_us(self, arg: Sequence[int], /) -> None: ...

    @property
    def dropped(self) -> int:
        """Pulses whose number and time were lost; stays at 65535."""

    @dropped.setter
    def dropped(self, arg: int, /) -> None: ...

    def __eq__(self, arg: TriggerReport, /) -> bool:
        """Are all fields equal?"""

    def __repr__(self) -> str: ...

class PongReport:
    """0x02 PONG: the answer to a ping."""

    def __init__(self, **kwargs) -> None:
        """Fields by keyword; those that are not given are 0."""

    @property
    def boot_id(self) -> int:
        """Never 0."""

    @boot_id.setter
    def boot_id(self, arg: int, /) -> None: ...

    @property
    def report_number(self) -> int:
        """Of all input reports."""

    @report_number.setter
    def report_number(self, arg: int, /) -> None: ...

    @property
    def ping_id(self) -> int:
        """As the host sent it."""

    @ping_id.setter
    def ping_id(self, arg: int, /) -> None: ...

    @property
    def received(self) -> BoxTime:
        """When the ping came."""

    @received.setter
    def received(self, arg: BoxTime, /) -> None: ...

    @property
    def sent(self) -> BoxTime:
        """When the answer was handed to USB."""

    @sent.setter
    def sent(self, arg: BoxTime, /) -> None: ...

    def __eq__(self, arg: PongReport, /) -> bool:
        """Are all fields equal?"""

    def __repr__(self) -> str: ...

class StatusReport:
    """0x03 STATUS: all that the box counts."""

    def __init__(self, **kwargs) -> None:
        """Fields by keyword; those that are not given are 0."""

    @property
    def state(self) -> BoxState:
        """A BoxState."""

    @state.setter
    def state(self, arg: BoxState, /) -> None: ...

    @property
    def reset_cause(self) -> ResetCause:
        """A ResetCause."""

    @reset_cause.setter
    def reset_cause(self, arg: ResetCause, /) -> None: ...

    @property
    def boot_id(self) -> int:
        """Never 0."""

    @boot_id.setter
    def boot_id(self, arg: int, /) -> None: ...

    @property
    def session_id(self) -> int:
        """Armed last; 0 before the first."""

    @session_id.setter
    def session_id(self, arg: int, /) -> None: ...

    @property
    def report_number(self) -> int:
        """Of all input reports."""

    @report_number.setter
    def report_number(self, arg: int, /) -> None: ...

    @property
    def uptime_us(self) -> int:
        """Since start-up."""

    @uptime_us.setter
    def uptime_us(self, arg: int, /) -> None: ...

    @property
    def trigger_number(self) -> int:
        """Of the last pulse; 0 if none."""

    @trigger_number.setter
    def trigger_number(self, arg: int, /) -> None: ...

    @property
    def first_run_number(self) -> int:
        """0 before the run."""

    @first_run_number.setter
    def first_run_number(self, arg: int, /) -> None: ...

    @property
    def glitches(self) -> int:
        """START was high for less than the debounce."""

    @glitches.setter
    def glitches(self, arg: int, /) -> None: ...

    @property
    def starts_refused(self) -> int:
        """START edges in another state."""

    @starts_refused.setter
    def starts_refused(self, arg: int, /) -> None: ...

    @property
    def strobes_missing(self) -> int:
        """Exposures that did not come."""

    @strobes_missing.setter
    def strobes_missing(self, arg: int, /) -> None: ...

    @property
    def dropped(self) -> int:
        """Pulses whose number and time were lost."""

    @dropped.setter
    def dropped(self, arg: int, /) -> None: ...

    @property
    def commands_refused(self) -> int:
        """Requests not carried out."""

    @commands_refused.setter
    def commands_refused(self, arg: int, /) -> None: ...

    @property
    def reenumerations(self) -> int:
        """Wedged endpoints healed."""

    @reenumerations.setter
    def reenumerations(self, arg: int, /) -> None: ...

    @property
    def settings_crc(self) -> int:
        """CRC of the settings in force."""

    @settings_crc.setter
    def settings_crc(self, arg: int, /) -> None: ...

    def __eq__(self, arg: StatusReport, /) -> bool:
        """Are all fields equal?"""

    def __repr__(self) -> str: ...

class EventReport:
    """0x04 EVENT: something happened."""

    def __init__(self, **kwargs) -> None:
        """Fields by keyword; those that are not given are 0."""

    @property
    def kind(self) -> EventKind:
        """An EventKind."""

    @kind.setter
    def kind(self, arg: EventKind, /) -> None: ...

    @property
    def state(self) -> BoxState:
        """After the event."""

    @state.setter
    def state(self, arg: BoxState, /) -> None: ...

    @property
    def boot_id(self) -> int:
        """Never 0."""

    @boot_id.setter
    def boot_id(self, arg: int, /) -> None: ...

    @property
    def session_id(self) -> int:
        """Armed last; 0 before the first."""

    @session_id.setter
    def session_id(self, arg: int, /) -> None: ...

    @property
    def report_number(self) -> int:
        """Of all input reports."""

    @report_number.setter
    def report_number(self, arg: int, /) -> None: ...

    @property
    def event_number(self) -> int:
        """A gap is a lost event."""

    @event_number.setter
    def event_number(self, arg: int, /) -> None: ...

    @property
    def time(self) -> BoxTime:
        """Of the event."""

    @time.setter
    def time(self, arg: BoxTime, /) -> None: ...

    @property
    def argument(self) -> int:
        """By kind, see docs/wire.md."""

    @argument.setter
    def argument(self, arg: int, /) -> None: ...

    @property
    def detail(self) -> int:
        """By kind, else 0."""

    @detail.setter
    def detail(self, arg: int, /) -> None: ...

    def __eq__(self, arg: EventReport, /) -> bool:
        """Are all fields equal?"""

    def __repr__(self) -> str: ...

class CommandReport:
    """0x10 COMMAND."""

    def __init__(self, **kwargs) -> None:
        """Fields by keyword; those that are not given are 0."""

    @property
    def opcode(self) -> CommandOpcode:
        """A CommandOpcode."""

    @opcode.setter
    def opcode(self, arg: CommandOpcode, /) -> None: ...

    @property
    def argument(self) -> int:
        """Ping id or session id."""

    @argument.setter
    def argument(self, arg: int, /) -> None: ...

    def __eq__(self, arg: CommandReport, /) -> bool:
        """Are all fields equal?"""

    def __repr__(self) -> str: ...

class IdentityReport:
    """0x20 IDENTITY."""

    def __init__(self, **kwargs) -> None:
        """Fields by keyword; those that are not given are 0."""

    @property
    def hardware_version(self) -> int:
        """Of the board."""

    @hardware_version.setter
    def hardware_version(self, arg: int, /) -> None: ...

    @property
    def firmware_version(self) -> list[int]:
        """Major, minor, patch."""

    @firmware_version.setter
    def firmware_version(self, arg: Sequence[int], /) -> None: ...

    @property
    def firmware_modified(self) -> bool:
        """Built from a tree with uncommitted changes."""

    @firmware_modified.setter
    def firmware_modified(self, arg: bool, /) -> None: ...

    @property
    def capabilities(self) -> int:
        """Bits of opms.wire.Capability."""

    @capabilities.setter
    def capabilities(self, arg: int, /) -> None: ...

    @property
    def unique_id(self) -> list[int]:
        """Of the board, 8 numbers."""

    @unique_id.setter
    def unique_id(self, arg: Sequence[int], /) -> None: ...

    @property
    def git_hash(self) -> str:
        """First 20 hex digits."""

    @git_hash.setter
    def git_hash(self, arg: str, /) -> None: ...

    @property
    def boot_id(self) -> int:
        """Never 0."""

    @boot_id.setter
    def boot_id(self, arg: int, /) -> None: ...

    @property
    def clock_hz(self) -> int:
        """Of the cycles."""

    @clock_hz.setter
    def clock_hz(self, arg: int, /) -> None: ...

    @property
    def start_cycles(self) -> int:
        """Start edge to first pulse beyond the debounce."""

    @start_cycles.setter
    def start_cycles(self, arg: int, /) -> None: ...

    @property
    def ring_entries(self) -> int:
        """Remembered without the CPU."""

    @ring_entries.setter
    def ring_entries(self, arg: int, /) -> None: ...

    @property
    def history_entries(self) -> int:
        """That HISTORY can return."""

    @history_entries.setter
    def history_entries(self, arg: int, /) -> None: ...

    def __eq__(self, arg: IdentityReport, /) -> bool:
        """Are all fields equal?"""

    def __repr__(self) -> str: ...

class BoxSettings:
    """Settings of the box, kept in its flash."""

    def __init__(self, **kwargs) -> None:
        """Fields by keyword; those that are not given are 0."""

    @property
    def period_us(self) -> int:
        """10,000 to 10,000,000."""

    @period_us.setter
    def period_us(self, arg: int, /) -> None: ...

    @property
    def width_us(self) -> int:
        """10 to period - 1,000."""

    @width_us.setter
    def width_us(self, arg: int, /) -> None: ...

    @property
    def debounce_cycles(self) -> int:
        """0 to 1,250,000, of 8 ns."""

    @debounce_cycles.setter
    def debounce_cycles(self, arg: int, /) -> None: ...

    @property
    def trig_active_low(self) -> bool:
        """TRIG rests high."""

    @trig_active_low.setter
    def trig_active_low(self, arg: bool, /) -> None: ...

    @property
    def start_falling_edge(self) -> bool:
        """START is active low."""

    @start_falling_edge.setter
    def start_falling_edge(self, arg: bool, /) -> None: ...

    @property
    def strobe_enabled(self) -> bool:
        """The exposure output is wired."""

    @strobe_enabled.setter
    def strobe_enabled(self, arg: bool, /) -> None: ...

    @property
    def strobe_active_low(self) -> bool:
        """STROBE is active low."""

    @strobe_active_low.setter
    def strobe_active_low(self, arg: bool, /) -> None: ...

    @property
    def sync(self) -> SyncMode:
        """A SyncMode."""

    @sync.setter
    def sync(self, arg: SyncMode, /) -> None: ...

    @property
    def preamble_gap_ms(self) -> list[int]:
        """8 gaps of 10 to 10,000 ms; the first 0 ends the list."""

    @preamble_gap_ms.setter
    def preamble_gap_ms(self, arg: Sequence[int], /) -> None: ...

    @property
    def wait_timeout_s(self) -> int:
        """In WAITING; 0 waits for ever."""

    @wait_timeout_s.setter
    def wait_timeout_s(self, arg: int, /) -> None: ...

    def __eq__(self, arg: BoxSettings, /) -> bool:
        """Are all fields equal?"""

    def __repr__(self) -> str: ...

class SettingsReport:
    """0x21 SETTINGS, as it is read back."""

    def __init__(self, **kwargs) -> None:
        """Fields by keyword; those that are not given are 0."""

    @property
    def settings(self) -> BoxSettings:
        """Those in force."""

    @settings.setter
    def settings(self, arg: BoxSettings, /) -> None: ...

    @property
    def last_set(self) -> Refusal:
        """What became of the last SET."""

    @last_set.setter
    def last_set(self, arg: Refusal, /) -> None: ...

    @property
    def pending(self) -> bool:
        """A SET is being written; read again."""

    @pending.setter
    def pending(self, arg: bool, /) -> None: ...

    @property
    def stored(self) -> bool:
        """Read from flash, not the defaults."""

    @stored.setter
    def stored(self, arg: bool, /) -> None: ...

    @property
    def settings_crc(self) -> int:
        """Of the settings in force."""

    @settings_crc.setter
    def settings_crc(self, arg: int, /) -> None: ...

    def __eq__(self, arg: SettingsReport, /) -> bool:
        """Are all fields equal?"""

    def __repr__(self) -> str: ...

class HistoryRequest:
    """0x22 HISTORY, set: what to return next."""

    def __init__(self, **kwargs) -> None:
        """Fields by keyword; those that are not given are 0."""

    @property
    def token(self) -> int:
        """Not 0; comes back with each answer."""

    @token.setter
    def token(self, arg: int, /) -> None: ...

    @property
    def session_id(self) -> int:
        """Of the pulses."""

    @session_id.setter
    def session_id(self, arg: int, /) -> None: ...

    @property
    def first_number(self) -> int:
        """From 1."""

    @first_number.setter
    def first_number(self, arg: int, /) -> None: ...

    @property
    def count(self) -> int:
        """1 to 8192."""

    @count.setter
    def count(self, arg: int, /) -> None: ...

    def __eq__(self, arg: HistoryRequest, /) -> bool:
        """Are all fields equal?"""

    def __repr__(self) -> str: ...

class HistoryEntry:
    """One pulse out of the box's memory."""

    def __init__(self, **kwargs) -> None:
        """Fields by keyword; those that are not given are 0."""

    @property
    def number(self) -> int:
        """Of the pulse."""

    @number.setter
    def number(self, arg: int, /) -> None: ...

    @property
    def flags(self) -> int:
        """Bits of opms.wire.TriggerFlag."""

    @flags.setter
    def flags(self, arg: int, /) -> None: ...

    @property
    def time(self) -> BoxTime:
        """Of the pulse's edge."""

    @time.setter
    def time(self, arg: BoxTime, /) -> None: ...

    @property
    def strobe_delay_cycles(self) -> int:
        """From this pulse to its exposure, of 8 ns."""

    @strobe_delay_cycles.setter
    def strobe_delay_cycles(self, arg: int, /) -> None: ...

    @property
    def strobe_length_cycles(self) -> int:
        """Length of its exposure, of 8 ns."""

    @strobe_length_cycles.setter
    def strobe_length_cycles(self, arg: int, /) -> None: ...

    def __eq__(self, arg: HistoryEntry, /) -> bool:
        """Are all fields equal?"""

    def __repr__(self) -> str: ...

class HistoryReport:
    """0x22 HISTORY, get."""

    def __init__(self, **kwargs) -> None:
        """Fields by keyword; those that are not given are 0."""

    @property
    def token(self) -> int:
        """Of the selection; 0 if there was none."""

    @token.setter
    def token(self, arg: int, /) -> None: ...

    @property
    def boot_id(self) -> int:
        """Never 0."""

    @boot_id.setter
    def boot_id(self, arg: int, /) -> None: ...

    @property
    def session_id(self) -> int:
        """Of the entries; 0: not held."""

    @session_id.setter
    def session_id(self, arg: int, /) -> None: ...

    @property
    def remaining(self) -> int:
        """Entries that follow this report."""

    @remaining.setter
    def remaining(self, arg: int, /) -> None: ...

    @property
    def count(self) -> int:
        """Of entries that are filled in."""

    @count.setter
    def count(self, arg: int, /) -> None: ...

    @property
    def entries(self) -> list[HistoryEntry]:
        """2 entries, of which `count` hold."""

    @entries.setter
    def entries(self, arg: Sequence[HistoryEntry], /) -> None: ...

    def __eq__(self, arg: HistoryReport, /) -> bool:
        """Are all fields equal?"""

    def __repr__(self) -> str: ...

def wire_read(data: bytes) -> TriggerReport | PongReport | StatusReport | EventReport | CommandReport | IdentityReport | SettingsReport | HistoryReport | None:
    """
    The report in 64 bytes, by its id; None for BOOTLOADER, which has no fields.

    SETTINGS and HISTORY as the box answers a GET. Raises Error (ERR_ARG) that says what is wrong.
    """

def wire_read_settings_set(data: bytes) -> BoxSettings:
    """SETTINGS as the host sends it with a SET. Raises Error (ERR_ARG)."""

def wire_read_history_request(data: bytes) -> HistoryRequest:
    """HISTORY as the host sends it with a SET. Raises Error (ERR_ARG)."""

def wire_check(data: bytes) -> WireResult:
    """Are length, id, version and CRC of a report right?"""

def wire_crc16(data: bytes) -> int:
    """CRC-16/IBM-3740, which every report ends with."""

@overload
def wire_write(report: TriggerReport) -> bytes: ...

@overload
def wire_write(report: PongReport) -> bytes: ...

@overload
def wire_write(report: StatusReport) -> bytes: ...

@overload
def wire_write(report: EventReport) -> bytes: ...

@overload
def wire_write(report: CommandReport) -> bytes: ...

@overload
def wire_write(report: IdentityReport) -> bytes: ...

@overload
def wire_write(report: SettingsReport) -> bytes: ...

@overload
def wire_write(report: BoxSettings) -> bytes: ...

@overload
def wire_write(report: HistoryRequest) -> bytes: ...

@overload
def wire_write(report: HistoryReport) -> bytes:
    """
    The 64 bytes of a report. Raises Error (ERR_ARG) where a field is out of range.
    """

def wire_write_bootloader() -> bytes:
    """The 64 bytes of BOOTLOADER with its magic word."""

def wire_default_settings() -> BoxSettings:
    """The settings of a box whose flash holds none."""

def wire_check_settings(settings: BoxSettings) -> str | None:
    """
    None where all is in range, else a message that names the field and its range.
    """
