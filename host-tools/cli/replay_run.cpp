/* SPDX-License-Identifier: Apache-2.0 */
#include "replay_run.hpp"

#include <map>

#include "replay_locator.hpp"

using namespace opms_host;

namespace {

/** What is known of the pictures, beside their poses. */
struct PictureFacts {
    std::map<std::uint64_t, FrameRecord> frames;
    std::map<std::uint64_t, std::string> paths;
};

bool read_facts(ScanReader &scan, PictureFacts &facts, std::string &error)
{
    return scan.each_frame(
               [&facts](const FrameRecord &frame) {
                   facts.frames[frame.number] = frame;
                   return true;
               },
               error) &&
           scan.each_picture(
               [&facts](const PictureRow &picture) {
                   facts.paths[picture.number] = picture.path;
                   return true;
               },
               error);
}

class PosesAgain {
public:
    PosesAgain(const ReplayRequest &request, ReplayLocator &locator, const PictureFacts &facts,
               ReplayOutcome &outcome)
        : request_(request), locator_(locator), facts_(facts), outcome_(outcome)
    {
    }

    /** @return What `take` returned. */
    bool replay(const PoseRecord &recorded, const ReplayTake &take)
    {
        if (!can_be_replayed(recorded)) {
            outcome_.left_out++;
            return true;
        }
        if (seen_++ % request_.every != 0) {
            return true;
        }
        PoseRecord again = recorded;
        again.location = {};
        std::string error;
        if (!make(recorded, again, error)) {
            outcome_.problems.push_back(error);
            return true;
        }
        const PoseChange change = compare_poses(recorded, again, request_.from);
        sums_.add(change);
        return take(change, again);
    }

    ReplayFigures figures() const { return sums_.figures(); }

private:
    bool can_be_replayed(const PoseRecord &recorded) const
    {
        if (request_.from == ReplayFrom::points) {
            return recorded.location.bar.state == OPMS_BAR_LOCATED && !recorded.edges.empty();
        }
        const auto frame = facts_.frames.find(recorded.number);
        /* A damaged picture was not located, and is not now. */
        return frame != facts_.frames.end() && facts_.paths.count(recorded.number) > 0 &&
               (frame->second.flags & OPMS_FRAME_DAMAGED) == 0;
    }

    bool make(const PoseRecord &recorded, PoseRecord &again, std::string &error)
    {
        return request_.from == ReplayFrom::points
                   ? locator_.from_points(recorded, again, error)
                   : locator_.from_picture(facts_.paths.at(recorded.number),
                                           facts_.frames.at(recorded.number), recorded, again,
                                           error);
    }

    const ReplayRequest &request_;
    ReplayLocator &locator_;
    const PictureFacts &facts_;
    ReplayOutcome &outcome_;
    ReplaySums sums_;
    std::uint64_t seen_ = 0;
};

}  // namespace

bool replay_poses(ScanReader &scan, const ReplayRequest &request, const ReplayTake &take,
                  ReplayOutcome &outcome, std::string &error)
{
    const auto locator = ReplayLocator::create(request.camera, scan.summary().header, error);
    PictureFacts facts;
    if (!locator || !read_facts(scan, facts, error)) {
        return false;
    }
    PosesAgain poses(request, *locator, facts, outcome);
    const bool read = scan.each_pose(
        [&](const PoseRecord &recorded) { return poses.replay(recorded, take); }, error);
    outcome.figures = poses.figures();
    return read;
}
