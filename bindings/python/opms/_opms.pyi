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
