/* SPDX-License-Identifier: Apache-2.0 */
/* Which frames have two witnesses: by the truth, and by nothing that the pairer says. */
#include "sim_pairable.h"

#include <algorithm>

bool is_on_time(const Session &session, const Delivery &delivery)
{
    const TrueFrame &frame = delivery.frame;
    return frame.session == session.id && frame.trigger >= 0 &&
           delivery.at >= session.clock_known &&
           delivery.at - session.triggers[size_t(frame.trigger)].at <= FRAME_DELAY + ON_TIME;
}

bool is_in_time(const Session &session, const Delivery &delivery)
{
    const TrueFrame &frame = delivery.frame;
    if (frame.session != session.id || frame.trigger < 0 || delivery.copy) {
        return false;
    }
    const TrueTrigger &trigger = session.triggers[size_t(frame.trigger)];
    return delivery.at - trigger.at <= WAIT && trigger.known != NEVER &&
           trigger.known - trigger.at <= WAIT;
}

int64_t offset_of(const Delivery &delivery)
{
    return delivery.frame.id - delivery.frame.trigger;
}

namespace {

constexpr int LOCK_FRAMES = 8;   // in a row show an offset or a clock that is new
constexpr int LOCK_ON_TIME = 5;  // of them, and the last one
constexpr int PREAMBLE = 6, PREAMBLE_FRAMES = 4;
constexpr int CONSTANT = 3;      // frames show that a difference is constant

/** Frames in a row, by arrival, that count alike; with their indices. */
struct Row {
    std::vector<size_t> members;
    std::vector<bool> on_time;
    int preamble = 0; ///< of them: the preamble's frames that came on time, known by its gaps
    bool established = false;

    size_t first_on_time() const
    {
        return size_t(std::find(on_time.begin(), on_time.end(), true) - on_time.begin());
    }
    bool shows_itself(bool delays_learnt) const
    {
        const size_t n = members.size();
        if (preamble >= PREAMBLE_FRAMES) {
            return true;
        }
        return delays_learnt && n >= LOCK_FRAMES && on_time.back() &&
               std::count(on_time.end() - LOCK_FRAMES, on_time.end(), true) >= LOCK_ON_TIME;
    }
};

class Marker {
public:
    Marker(Profile profile, Session &session, bool &delays_learnt)
        : profile_(profile), session_(session), delays_learnt_(delays_learnt)
    {
    }

    void mark()
    {
        find_rows();
        if (has_stamp(profile_)) {
            mark_by_stamp();
        }
        for (Delivery &delivery : session_.frames) {
            delivery.pairable = delivery.pairable && is_in_time(session_, delivery);
        }
    }

private:
    /** Cut the frames, by arrival, into rows of one count; mark what arrival alone can show. */
    void find_rows()
    {
        int64_t newest = 0;
        Row row;
        for (size_t i = 0; i < session_.frames.size(); ++i) {
            const Delivery &delivery = session_.frames[i];
            if (delivery.copy || delivery.frame.session != session_.id ||
                delivery.frame.exposed_at < newest) {
                continue; // old news end no row
            }
            newest = delivery.frame.exposed_at;
            const Delivery *last = row.members.empty() ? nullptr
                                                       : &session_.frames[row.members.back()];
            if (delivery.frame.trigger < 0 ||
                (last && (offset_of(*last) != offset_of(delivery) ||
                          last->frame.epoch != delivery.frame.epoch))) {
                row = Row();
            }
            if (delivery.frame.trigger >= 0) {
                add(row, i);
            }
        }
    }

    void add(Row &row, size_t i)
    {
        const Delivery &delivery = session_.frames[i];
        row.members.push_back(i);
        row.on_time.push_back(is_on_time(session_, delivery));
        row.preamble += delivery.frame.trigger < PREAMBLE && row.on_time.back();
        if (!row.established && row.shows_itself(delays_learnt_)) {
            const bool by_preamble = row.preamble >= PREAMBLE_FRAMES;
            delays_learnt_ = true;
            row.established = true;
            note_clock(delivery.frame.epoch, session_.frames[row.members.front()]);
            // What came before the lock counts where a strobe or the preamble helps.
            const bool before = by_preamble || profile_ == STROBE_ONLY;
            const size_t shown = by_preamble ? 0 : row.first_on_time() + 1;
            for (size_t k = shown; before && k < row.members.size(); ++k) {
                mark_on_time(row.members[k]);
            }
        } else if (row.established) {
            mark_on_time(i);
        }
    }

    void mark_on_time(size_t i)
    {
        Delivery &delivery = session_.frames[i];
        delivery.pairable = !has_stamp(profile_) && is_on_time(session_, delivery);
    }

    void note_clock(uint32_t epoch, const Delivery &first)
    {
        for (const auto &[known, since] : clocks_) {
            if (known == epoch) {
                return;
            }
        }
        clocks_.push_back({epoch, first.frame.exposed_at});
    }

    bool has_clock(const TrueFrame &frame) const
    {
        return std::any_of(clocks_.begin(), clocks_.end(), [&](const auto &clock) {
            return clock.first == frame.epoch && frame.exposed_at >= clock.second;
        });
    }

    /** With time stamps: the camera's clock is known since it was shown, and a second witness is
     * an id that counts like its neighbours', or arrival. */
    void mark_by_stamp()
    {
        std::vector<size_t> order;
        for (size_t i = 0; i < session_.frames.size(); ++i) {
            if (is_in_time(session_, session_.frames[i])) {
                order.push_back(i);
            }
        }
        std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
            return session_.frames[a].frame.exposed_at < session_.frames[b].frame.exposed_at;
        });
        for (size_t from = 0, to = 0; from < order.size(); from = to) {
            const Delivery &first = session_.frames[order[from]];
            while (to < order.size() &&
                   offset_of(session_.frames[order[to]]) == offset_of(first) &&
                   session_.frames[order[to]].frame.epoch == first.frame.epoch) {
                ++to;
            }
            for (size_t i = from; i < to; ++i) {
                Delivery &delivery = session_.frames[order[i]];
                delivery.pairable = has_clock(delivery.frame) &&
                                    (to - from >= CONSTANT || is_on_time(session_, delivery));
            }
        }
    }

    Profile profile_;
    Session &session_;
    bool &delays_learnt_;
    std::vector<std::pair<uint32_t, int64_t>> clocks_; ///< of the camera: start, known since
};

} // namespace

void mark_pairable(Profile profile, Session &session, bool &delays_learnt)
{
    Marker(profile, session, delays_learnt).mark();
}
