# SPDX-License-Identifier: Apache-2.0
import json
import pathlib
import threading

import numpy as np
import pytest
from PIL import Image

import opms
from opms import grid

DATA = pathlib.Path(__file__).resolve().parent.parent / "data" / "grid"
PICTURES = sorted(DATA.glob("*.png"))


def read(path):
    return np.asarray(Image.open(path).convert("L"))


def true_px(path, labels):
    """Where the truth beside the picture has the nodes."""
    truth = json.loads(path.with_suffix(".json").read_text())
    at_m = (labels - grid.CENTRE) * grid.PITCH_M
    points = np.column_stack([at_m, np.zeros(len(at_m))]) - truth["t_bar_camera_m"]
    points = points @ np.array(truth["R_bar_camera"])
    return opms.load_camera(DATA / "camera.yaml").lens.project(points)


@pytest.fixture
def detector():
    return grid.Detector(1024, 768)


@pytest.mark.parametrize("path", PICTURES, ids=lambda path: path.stem)
def test_the_nodes_of_a_picture_lie_where_the_truth_has_them(detector, path):
    found = detector.detect(read(path))
    assert found.summary.state is grid.State.LABELLED
    assert found.summary.node_count == len(found.nodes) > 300
    assert found.nodes.dtype == grid.NODE_DTYPE
    off_px = found.nodes["px"] - true_px(path, found.nodes["label"])
    assert np.sqrt(np.mean(off_px**2)) < 0.04
    assert np.abs(off_px).max() < 0.5
    assert np.all(found.nodes["sigma_px"] > 0)


def test_a_picture_without_a_grid_is_a_state(detector, grey):
    found = detector.detect(grey)
    assert found.summary.state is grid.State.ABSENT
    assert len(found.nodes) == 0


def test_depth_and_stride_do_not_change_the_nodes(detector):
    picture = read(PICTURES[0])
    wide = np.zeros((picture.shape[0], picture.shape[1] + 37), np.uint16)
    wide[:, 11:-26] = picture
    first = detector.detect(picture).nodes
    deep = detector.detect(wide[:, 11:-26], white_level=255).nodes
    assert np.array_equal(first["label"], deep["label"])
    assert np.allclose(first["px"], deep["px"], atol=1e-6)


def test_what_is_no_picture_of_the_size_is_refused(detector, grey):
    with pytest.raises(opms.Error):
        detector.detect(grey[:-1])
    with pytest.raises(TypeError):
        detector.detect(grey.astype(np.float32))
    with pytest.raises(opms.Error):
        grid.Detector(8, 8)
    with pytest.raises(opms.Error):
        grid.Detector(1024, 768, min_pitch_px=1000.0)


def test_nodes_whose_labels_were_lost_get_them_from_a_neighbour(detector):
    known = detector.detect(read(PICTURES[1])).nodes
    lost = known.copy()
    lost["px"] += 0.6
    turned = lost["label"] - grid.CENTRE  # by a quarter, and moved
    lost["label"] = np.column_stack([-turned[:, 1], turned[:, 0]]) + [7, 9]
    labelled = grid.relabel(known, lost)
    assert np.array_equal(labelled["label"], known["label"])
    assert np.array_equal(labelled["px"], lost["px"])
    assert not np.array_equal(lost["label"], known["label"])  # what was given is unchanged


def test_labels_that_are_not_certain_are_none(detector):
    known = detector.detect(read(PICTURES[1])).nodes
    lost = known.copy()
    lost["px"] += 0.5 * np.median(np.abs(np.diff(known["px"][:, 0])))
    assert grid.relabel(known, lost) is None
    with pytest.raises(TypeError, match="NODE_DTYPE"):
        grid.relabel(known, known["px"])


def test_one_detector_in_many_threads_takes_turns(detector):
    pictures = [read(path) for path in PICTURES[:2]]
    expected = [detector.detect(picture).nodes for picture in pictures]
    wrong = []

    def work():
        for picture, nodes in zip(pictures, expected):
            if not np.array_equal(detector.detect(picture).nodes, nodes):
                wrong.append(1)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong
