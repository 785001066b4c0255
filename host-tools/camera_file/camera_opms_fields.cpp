/* SPDX-License-Identifier: Apache-2.0 */
/* The mapping `opms`: where the camera sits, how well all is known, and how it was calibrated. */
#include <algorithm>
#include <cmath>

#include "camera_parts.hpp"
#include "yaml_text.hpp"

namespace opms_host {
namespace {

constexpr double ROTATION_TOLERANCE = 1e-6; /* that of opms_camera_check() */
constexpr const char *OPMS_KEYS[] = {
    "version", "R_detector_camera", "t_detector_camera_m", "covariance_intrinsics",
    "covariance_detector_camera", "covariance_detector_camera_intrinsics", "grid", "footprint",
    "residual_rms_px", "date"};

void check_rotation(const Field &field, const std::vector<double> &R)
{
    double worst = 0;
    for (std::size_t i = 0; i < 3; i++) {
        for (std::size_t j = 0; j < 3; j++) {
            const double dot = R[i] * R[j] + R[3 + i] * R[3 + j] + R[6 + i] * R[6 + j];
            worst = std::max(worst, std::fabs(dot - (i == j ? 1 : 0)));
        }
    }
    const double det = R[0] * (R[4] * R[8] - R[5] * R[7]) - R[1] * (R[3] * R[8] - R[5] * R[6]) +
                       R[2] * (R[3] * R[7] - R[4] * R[6]);
    if (!(worst <= ROTATION_TOLERANCE)) {
        field.fail("is not a rotation to 1e-6; write it with at least 8 digits");
    }
    if (det < 0) {
        field.fail("is a mirror image, not a rotation (determinant -1)");
    }
}

void read_mounting(const FieldMap &opms, CameraFile &file)
{
    const bool has_R = opms.has("R_detector_camera");
    const bool has_t = opms.has("t_detector_camera_m");
    if (has_R) {
        const Field field = opms.get("R_detector_camera");
        const std::vector<double> R = field.numbers(9);
        check_rotation(field, R);
        std::copy(R.begin(), R.end(), file.camera.detector_camera.R);
    }
    if (has_t) {
        const std::vector<double> t = opms.get("t_detector_camera_m").numbers(3);
        std::copy(t.begin(), t.end(), file.camera.detector_camera.t_m);
    }
    file.camera.has_detector_camera = has_R && has_t;
    if (has_R != has_t) {
        const Field half = opms.get(has_R ? "R_detector_camera" : "t_detector_camera_m");
        file.notes.push_back(half.where() + " stands without " +
                             (has_R ? "t_detector_camera_m" : "R_detector_camera") +
                             ": there will be no detector pose");
    }
}

/** @return Whether the key is there; a matrix that is no covariance fails. */
bool read_covariance(const FieldMap &opms, const char *key, std::size_t n, double *out)
{
    if (!opms.has(key)) {
        return false;
    }
    const Field field = opms.get(key);
    const std::vector<double> c = field.numbers(n * n);
    for (std::size_t i = 0; i < n; i++) {
        if (c[i * n + i] < 0) {
            field.fail("has a negative variance, number " + std::to_string(i * n + i));
        }
        for (std::size_t j = 0; j < i; j++) {
            const double scale = std::sqrt(c[i * n + i] * c[j * n + j]);
            if (std::fabs(c[i * n + j] - c[j * n + i]) > 1e-6 * scale) {
                field.fail("is not symmetric: row " + std::to_string(i) + ", column " +
                           std::to_string(j));
            }
        }
    }
    std::copy(c.begin(), c.end(), out);
    return true;
}

void read_history(const FieldMap &opms, CameraFile &file)
{
    if (opms.has("grid")) {
        file.grid = opms.get("grid").text();
    }
    if (opms.has("date")) {
        file.date = opms.get("date").text();
    }
    if (opms.has("residual_rms_px")) {
        file.residual_rms_px = opms.get("residual_rms_px").number();
    }
    if (opms.has("footprint")) {
        const FieldMap map = opms.map("footprint");
        file.footprint = Footprint{map.get("x_m").number(), map.get("y_m").number(),
                                   map.get("yaw_rad").number()};
    }
}

/** What mounting and lens share; of no use without the covariance of each. */
void read_shared_covariance(const FieldMap &opms, CameraFile &file)
{
    if (!opms.has("covariance_detector_camera_intrinsics")) {
        return;
    }
    opms_camera_t &camera = file.camera;
    const Field field = opms.get("covariance_detector_camera_intrinsics");
    const std::vector<double> shared = field.numbers(48);
    if (!camera.has_covariance_intrinsics || !camera.has_covariance_detector_camera) {
        file.notes.push_back(field.where() + " stands without " +
                             (camera.has_covariance_intrinsics ? "covariance_detector_camera"
                                                               : "covariance_intrinsics") +
                             ": it is left out");
        return;
    }
    std::copy(shared.begin(), shared.end(), camera.covariance_detector_camera_intrinsics);
    camera.has_covariance_detector_camera_intrinsics = 1;
}

void note_unknown_keys(const FieldMap &opms, CameraFile &file)
{
    for (const auto &entry : opms.entries()) {
        if (!camera_opms_key(entry.first)) {
            file.notes.push_back(camera_one_line(
                opms.get(entry.first).where().substr(0, 80) + " is unknown and ignored"));
        }
    }
}

YAML::Node number_node(double value)
{
    return YAML::Node(yaml_number(value));
}

YAML::Node numbers_node(const double *values, std::size_t count)
{
    YAML::Node node(YAML::NodeType::Sequence);
    for (std::size_t i = 0; i < count; i++) {
        node.push_back(number_node(values[i]));
    }
    return node;
}

void write_mounting(const opms_camera_t &camera, YAML::Node &opms)
{
    if (camera.has_detector_camera) {
        opms["R_detector_camera"] = numbers_node(camera.detector_camera.R, 9);
        opms["t_detector_camera_m"] = numbers_node(camera.detector_camera.t_m, 3);
    }
    if (camera.has_covariance_intrinsics) {
        opms["covariance_intrinsics"] = numbers_node(camera.covariance_intrinsics, 64);
    }
    if (camera.has_covariance_detector_camera) {
        opms["covariance_detector_camera"] = numbers_node(camera.covariance_detector_camera, 36);
    }
    if (camera.has_covariance_detector_camera_intrinsics) {
        opms["covariance_detector_camera_intrinsics"] =
            numbers_node(camera.covariance_detector_camera_intrinsics, 48);
    }
}

void write_history(const CameraFile &file, YAML::Node &opms)
{
    if (file.grid) {
        opms["grid"] = camera_text_node(*file.grid);
    }
    if (file.footprint) {
        YAML::Node footprint(YAML::NodeType::Map);
        footprint["x_m"] = number_node(file.footprint->x_m);
        footprint["y_m"] = number_node(file.footprint->y_m);
        footprint["yaw_rad"] = number_node(file.footprint->yaw_rad);
        opms["footprint"] = footprint;
    }
    if (file.residual_rms_px) {
        opms["residual_rms_px"] = number_node(*file.residual_rms_px);
    }
    if (file.date) {
        opms["date"] = camera_text_node(*file.date);
    }
}

}  // namespace

bool camera_opms_key(const std::string &name)
{
    return std::any_of(std::begin(OPMS_KEYS), std::end(OPMS_KEYS),
                       [&](const char *key) { return name == key; });
}

void camera_read_opms(const FieldMap &parent, CameraFile &file)
{
    if (!parent.has("opms") || parent.get("opms").node.IsNull()) {
        return;
    }
    const FieldMap opms = parent.map("opms");
    if (opms.has("version")) {
        const Field version = opms.get("version");
        if (version.number() != 1) {
            version.fail("is not 1: the file was written for another version of opms");
        }
    }
    read_mounting(opms, file);
    opms_camera_t &camera = file.camera;
    camera.has_covariance_intrinsics =
        read_covariance(opms, "covariance_intrinsics", 8, camera.covariance_intrinsics);
    camera.has_covariance_detector_camera =
        read_covariance(opms, "covariance_detector_camera", 6, camera.covariance_detector_camera);
    read_shared_covariance(opms, file);
    read_history(opms, file);
    note_unknown_keys(opms, file);
    camera_read_extras(parent.get("opms").node, camera_opms_key, file.opms_extras);
}

YAML::Node camera_opms_node(const CameraFile &file)
{
    YAML::Node opms(YAML::NodeType::Map);
    opms["version"] = YAML::Node("1");
    write_mounting(file.camera, opms);
    write_history(file, opms);
    for (const CameraExtra &extra : file.opms_extras) {
        opms.force_insert(YAML::Load(extra.key), YAML::Load(extra.value));
    }
    return opms;
}

YAML::Node camera_text_node(const std::string &text)
{
    YAML::Node node(text);
    node.SetTag("!"); /* as the parser marks what is quoted */
    return node;
}

}  // namespace opms_host
