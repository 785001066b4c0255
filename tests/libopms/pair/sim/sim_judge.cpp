/* SPDX-License-Identifier: Apache-2.0 */
#include "sim_judge.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "sim_pairable.h"

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

void judge_session(Profile profile, Session &session, bool &delays_learnt, Figures &figures)
{
    mark_pairable(profile, session, delays_learnt);
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
    const bool known = !delivery.copy && is_on_time(session, delivery) &&
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
