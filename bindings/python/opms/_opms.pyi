"""Binding of libopms; use the package opms."""

import enum
from typing import Annotated

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

def version() -> str:
    """Version of the library, as major.minor.patch."""

BAR_SQUARES: int = 33

BAR_PITCH_M: float = 0.03

BAR_SQUARE_M: float = 0.02

BAR_ORIGIN: int = 16

SQUARE_DTYPE: numpy.dtypes.VoidDType = ...

EDGE_DTYPE: numpy.dtypes.VoidDType = ...

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

    def __init__(self, lens: Lens, *, R_detector_camera: Annotated[NDArray[numpy.float64], dict(shape=(3, 3), order='C', device='cpu', writable=False)] | None = None, t_detector_camera_m: Annotated[NDArray[numpy.float64], dict(shape=(3), order='C', device='cpu', writable=False)] | None = None, covariance_intrinsics: Annotated[NDArray[numpy.float64], dict(shape=(8, 8), order='C', device='cpu', writable=False)] | None = None, covariance_detector_camera: Annotated[NDArray[numpy.float64], dict(shape=(6, 6), order='C', device='cpu', writable=False)] | None = None) -> None:
        """
        R_detector_camera: (3, 3) and t_detector_camera_m: (3,) take the camera's frame
        to the detector's. covariance_intrinsics: (8, 8) in the order fx fy cx cy k1 k2 p1 p2;
        covariance_detector_camera: (6, 6) of (w, d) as in Pose.covariance.
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
