/* SPDX-License-Identifier: Apache-2.0 */
#include "sim_judge.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

bool is_on_time(const Session &session, const Delivery &delivery)
{
    const TrueFrame &frame = delivery.frame;
    return frame.session == session.id && frame.trigger >= 0 &&
           delivery.at >= session.clock_known &&
           delivery.at - session.triggers[size_t(frame.trigger)].at <= FRAME_DELAY + ON_TIME;
}

/** Frame and word of its trigger both reached the host within the wait. */
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

static void complain(const char *what, const Session &session, const opms_pair_result_t &result,
                     const Delivery *delivery)
{
    if (!std::getenv("OPMS_SIM_VERBOSE")) {
        return;
    }
    const long long truth = delivery ? delivery->frame.trigger : -2;
    std::printf("  %s: session %u trigger %lld (of %zu) frame %lld of trigger %lld id %llu "
                "witnesses %x against %x delay %.3f ms\n",
                what, unsigned(session.id),
                (long long)(result.trigger_number - session.first_number),
                session.triggers.size(), (long long)(result.frame.tag & 0xffffffff), truth,
                (unsigned long long)result.frame.frame_id, unsigned(result.witnesses),
                unsigned(result.against), double(result.arrival_delay_ns) / 1e6);
}

static void judge_triggers(Session &session, const opms_pair_result_t &result, Figures &figures)
{
    figures.by_trigger_state[result.trigger_state] += result.trigger_count;
    for (uint32_t i = 0; i < result.trigger_count; ++i) {
        const uint64_t index = result.trigger_number - session.first_number + i;
        if (index >= session.triggers.size()) {
            ++figures.broken_sums;
            complain("no such trigger", session, result, nullptr);
            continue;
        }
        ++session.triggers[index].results;
        if (result.trigger_state != OPMS_TRIGGER_MISSING) {
            continue;
        }
        for (const Delivery &delivery : session.frames) {
            if (delivery.frame.trigger == int(index) && is_in_time(session, delivery)) {
                ++figures.wrong_missing;
                complain("wrong MISSING", session, result, &delivery);
            }
        }
    }
}

void judge_result(Session &session, const opms_pair_result_t &result, Figures &figures)
{
    if (result.session_id != session.id) {
        ++figures.broken_sums;
        return;
    }
    if (result.trigger_state != OPMS_TRIGGER_NONE) {
        judge_triggers(session, result, figures);
    }
    if (result.frame_state == OPMS_FRAME_NONE) {
        return;
    }
    ++figures.by_frame_state[result.frame_state];
    const uint64_t index = result.frame.tag & 0xffffffff;
    if (result.frame.tag >> 32 != session.id || index >= session.frames.size()) {
        ++figures.broken_sums;
        return;
    }
    Delivery &delivery = session.frames[index];
    ++delivery.results;
    delivery.result = result;
    const bool of_session = delivery.frame.session == session.id && delivery.frame.trigger >= 0;
    if (result.frame_state == OPMS_FRAME_PAIRED) {
        delivery.paired = true;
        ++figures.paired;
        const uint64_t truth = session.first_number + uint64_t(delivery.frame.trigger);
        if (!of_session || truth != result.trigger_number) {
            ++figures.wrong_pairs;
            complain("wrong pair", session, result, &delivery);
        }
    } else if (result.frame_state == OPMS_FRAME_ORPHAN && of_session) {
        ++figures.wrong_orphans;
        complain("wrong ORPHAN", session, result, &delivery);
    }
}

namespace {

constexpr int LOCK_FRAMES = 8;   // in a row show an offset or a clock that is new
constexpr int LOCK_ON_TIME = 5;  // of them, and the last one
constexpr int PREAMBLE = 6, PREAMBLE_FRAMES = 4;
constexpr int CONSTANT = 3;      // frames show that a difference is constant

int64_t offset_of(const Delivery &delivery)
{
    return delivery.frame.id - delivery.frame.trigger;
}

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

class Pairable {
public:
    Pairable(Profile profile, Session &session, bool &delays_learnt)
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

void judge_session(Profile profile, Session &session, bool &delays_learnt, Figures &figures)
{
    Pairable(profile, session, delays_learnt).mark();
    figures.triggers += session.triggers.size();
    figures.frames += session.frames.size();
    for (const TrueTrigger &trigger : session.triggers) {
        const auto index = size_t(&trigger - session.triggers.data());
        const int due = index < session.heard ? 1 : 0; // the last ones may be lost with the boot
        figures.broken_sums += trigger.results != due;
        if (trigger.results != due && std::getenv("OPMS_SIM_VERBOSE")) {
            std::printf("  trigger %zu has %d results\n", index, trigger.results);
        }
    }
    for (const Delivery &delivery : session.frames) {
        figures.broken_sums += delivery.results != 1;
        figures.pairable += delivery.pairable;
        figures.pairable_paired += delivery.pairable && delivery.paired;
        if (delivery.pairable && !delivery.paired && std::getenv("OPMS_SIM_VERBOSE")) {
            const TrueTrigger &trigger = session.triggers[size_t(delivery.frame.trigger)];
            std::printf("  not paired: session %u frame %zu of trigger %d at %.3f s, %.3f ms late, "
                        "id %llu; trigger known after %.3f ms; %s, witnesses %x against %x\n",
                        unsigned(session.id), size_t(&delivery - session.frames.data()),
                        delivery.frame.trigger, double(delivery.at - session.armed_at) / 1e9,
                        double(delivery.at - trigger.at - FRAME_DELAY) / 1e6,
                        (unsigned long long)delivery.frame.raw_id,
                        double(trigger.known - trigger.at) / 1e6,
                        opms_frame_state_name(delivery.result.frame_state),
                        unsigned(delivery.result.witnesses), unsigned(delivery.result.against));
        }
    }
}

void LockWatch::see(const Session &session, const Delivery &delivery, bool locked,
                    Figures &figures)
{
    if (was_locked_ && !locked) {
        ++figures.locks_lost;
        row_ = 0;
    }
    if (was_locked_ != locked && std::getenv("OPMS_SIM_VERBOSE")) {
        std::printf("  %s at %.3f s, frame %zu of trigger %d\n", locked ? "locked" : "lock lost",
                    double(delivery.at - session.armed_at) / 1e9,
                    size_t(&delivery - session.frames.data()), delivery.frame.trigger);
    }
    was_locked_ = locked;
    if (delivery.copy) {
        return;
    }
    const bool known = is_on_time(session, delivery) &&
                       session.triggers[size_t(delivery.frame.trigger)].known <= delivery.at;
    if (!known || offset_of(delivery) != offset_ || delivery.frame.epoch != epoch_) {
        row_ = 0;
    }
    if (known) {
        ++row_;
        offset_ = offset_of(delivery);
        epoch_ = delivery.frame.epoch;
    }
    counted_ = counted_ && !locked && row_ > 1;
    if (!locked) {
        figures.frames_to_lock = std::max(figures.frames_to_lock, row_);
        if (row_ > 10 && !counted_) {
            ++figures.slow_locks;
            if (std::getenv("OPMS_SIM_VERBOSE")) {
                std::printf("  slow lock: session %u trigger %d at %.3f s\n", unsigned(session.id),
                            delivery.frame.trigger,
                            double(delivery.at - session.armed_at) / 1e9);
            }
            counted_ = true;
        }
    }
}
