/* SPDX-License-Identifier: Apache-2.0 */
/* Each value's layout stands once, in fields(), and serves both directions. */
#include "little_endian_blob.hpp"

#include <cstring>

namespace opms_host {

namespace {

class Put {
public:
    explicit Put(Blob &blob) : blob_(blob) {}
    void number(std::uint64_t bits, std::size_t bytes)
    {
        for (std::size_t i = 0; i < bytes; i++) {
            blob_.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
        }
    }
    void operator()(const std::uint32_t &value) { number(value, 4); }
    void operator()(const std::int32_t &value) { number(static_cast<std::uint32_t>(value), 4); }
    void operator()(const double &value)
    {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        number(bits, 8);
    }
    template <typename Enum> void state(const Enum &value, Enum)
    {
        number(static_cast<std::uint32_t>(value), 4);
    }

private:
    Blob &blob_;
};

class Take {
public:
    explicit Take(BlobView blob) : blob_(blob) {}
    bool ok() const { return ok_; }
    std::uint64_t number(std::size_t bytes)
    {
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < bytes; i++) {
            bits |= static_cast<std::uint64_t>(blob_[at_ + i]) << (8 * i);
        }
        at_ += bytes;
        return bits;
    }
    void operator()(std::uint32_t &value) { value = static_cast<std::uint32_t>(number(4)); }
    void operator()(std::int32_t &value) { value = static_cast<std::int32_t>(number(4)); }
    void operator()(double &value)
    {
        const std::uint64_t bits = number(8);
        std::memcpy(&value, &bits, sizeof value);
    }
    /** A number beyond the last state is no state. */
    template <typename Enum> void state(Enum &value, Enum last)
    {
        const std::uint64_t bits = number(4);
        ok_ = ok_ && bits <= static_cast<std::uint64_t>(last);
        value = ok_ ? static_cast<Enum>(bits) : Enum{};
    }

private:
    BlobView blob_;
    std::size_t at_ = 0;
    bool ok_ = true;
};

template <typename Visit, typename Array> void all(Visit &visit, Array &array)
{
    for (auto &value : array) {
        visit(value);
    }
}

template <typename Visit, typename Transform> void transform_fields(Visit &visit, Transform &t)
{
    all(visit, t.R);
    all(visit, t.t_m);
}

template <typename Visit, typename Bar> void bar_fields(Visit &visit, Bar &bar)
{
    visit.state(bar.state, OPMS_BAR_AMBIGUOUS);
    visit(bar.square_count);
    visit(bar.edge_count);
    visit(bar.followed);
    visit(bar.label_margin);
    all(visit, bar.blur_px);
    visit(bar.noise);
    visit(bar.contrast);
    visit(bar.white_fraction_saturated);
}

template <typename Visit, typename Pose> void pose_fields(Visit &visit, Pose &pose)
{
    visit.state(pose.state, OPMS_POSE_AMBIGUOUS);
    visit(pose.edges_used);
    transform_fields(visit, pose.bar_camera.transform);
    all(visit, pose.bar_camera.covariance);
    visit(pose.edge_shift_px);
    visit(pose.residual_px);
    visit(pose.chi2_dof);
    visit(pose.chi2_other);
    all(visit, pose.intrinsics_jacobian);
}

template <typename Visit, typename Location> void location_fields(Visit &visit, Location &location)
{
    visit.state(location.state, OPMS_BAR_AMBIGUOUS);
    visit(location.has_ground_detector);
    visit(location.covariance_includes);
    visit(location.followed);
    bar_fields(visit, location.bar);
    pose_fields(visit, location.pose);
    transform_fields(visit, location.ground_detector.transform);
    all(visit, location.ground_detector.covariance);
}

template <typename Visit, typename Square> void square_fields(Visit &visit, Square &square)
{
    visit(square.index);
    visit(square.edges);
    for (auto &corner : square.corners_px) {
        all(visit, corner);
    }
}

template <typename Visit, typename Edge> void edge_fields(Visit &visit, Edge &edge)
{
    visit(edge.square);
    visit(edge.side);
    all(visit, edge.bar_m);
    all(visit, edge.px);
    all(visit, edge.normal);
    visit(edge.sigma_px);
    visit(edge.shift_gain);
}

constexpr std::size_t TRANSFORM_BYTES = 12 * 8;
constexpr std::size_t LOCATION_BYTES =
    10 * 4 + (6 + 12 + 36 + 4 + 48 + 12 + 36) * 8; /* as location_fields() has them */
constexpr std::size_t SQUARE_BYTES = 2 * 4 + 8 * 8;
constexpr std::size_t EDGE_BYTES = 2 * 4 + 8 * 8;

template <typename Row, typename Fields>
void write_rows(const std::vector<Row> &rows, std::size_t row_bytes, Blob &blob, Fields fields)
{
    blob.clear();
    blob.reserve(rows.size() * row_bytes);
    Put put(blob);
    for (const Row &row : rows) {
        fields(put, row);
    }
}

template <typename Row, typename Fields>
bool read_rows(BlobView blob, std::size_t row_bytes, std::vector<Row> &rows, Fields fields)
{
    if (blob.size() % row_bytes != 0) {
        return false;
    }
    rows.assign(blob.size() / row_bytes, Row{});
    Take take(blob);
    for (Row &row : rows) {
        fields(take, row);
    }
    return true;
}

}  // namespace

void blob_write(const opms_location_t &location, Blob &blob)
{
    blob.clear();
    blob.reserve(LOCATION_BYTES);
    Put put(blob);
    location_fields(put, location);
}

bool blob_read(BlobView blob, opms_location_t &location)
{
    if (blob.size() != LOCATION_BYTES) {
        return false;
    }
    Take take(blob);
    location_fields(take, location);
    return take.ok();
}

void blob_write(const std::vector<opms_square_t> &squares, Blob &blob)
{
    write_rows(squares, SQUARE_BYTES, blob, [](Put &put, auto &row) { square_fields(put, row); });
}

bool blob_read(BlobView blob, std::vector<opms_square_t> &squares)
{
    return read_rows(blob, SQUARE_BYTES, squares,
                     [](Take &take, auto &row) { square_fields(take, row); });
}

void blob_write(const std::vector<opms_edge_t> &edges, Blob &blob)
{
    write_rows(edges, EDGE_BYTES, blob, [](Put &put, auto &row) { edge_fields(put, row); });
}

bool blob_read(BlobView blob, std::vector<opms_edge_t> &edges)
{
    return read_rows(blob, EDGE_BYTES, edges,
                     [](Take &take, auto &row) { edge_fields(take, row); });
}

void blob_write(const opms_transform_t &transform, Blob &blob)
{
    blob.clear();
    Put put(blob);
    transform_fields(put, transform);
}

bool blob_read(BlobView blob, opms_transform_t &transform)
{
    if (blob.size() != TRANSFORM_BYTES) {
        return false;
    }
    Take take(blob);
    transform_fields(take, transform);
    return true;
}

void blob_write(const std::vector<double> &numbers, Blob &blob)
{
    write_rows(numbers, 8, blob, [](Put &put, auto &row) { put(row); });
}

bool blob_read(BlobView blob, std::vector<double> &numbers)
{
    return read_rows(blob, 8, numbers, [](Take &take, auto &row) { take(row); });
}

}  // namespace opms_host
