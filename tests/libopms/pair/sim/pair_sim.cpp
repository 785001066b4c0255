/* SPDX-License-Identifier: Apache-2.0 */
/* opms_pair_sim: the pairer against a world in which everything goes wrong at once. */
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "sim_host.h"

namespace {

constexpr uint64_t TRIGGERS_PER_PAIRER = 50000;
constexpr double LEAST_SHARE = 0.999;
constexpr uint64_t NAIVE_WRONG_MIN = 1000;

struct Options {
    uint64_t triggers = 10000000; ///< for each profile
    uint64_t seed = 1;
    int profile = -1; ///< all
    bool naive = false;
};

/** Counters begin right before they wrap, in turns. */
uint32_t first_number(uint64_t run)
{
    constexpr uint32_t starts[] = {1, 65536 - 700, 0xffffffffU - 900, 1, 65536 - 4000};
    return starts[run % 5];
}

CameraState first_camera(uint64_t run, Random &random)
{
    CameraState camera;
    constexpr uint32_t bits[] = {16, 64, 32, 16};
    camera.bits = bits[run % 4];
    camera.skips_0 = camera.bits == 16 && run % 8 < 4;
    camera.next_id = random.chance(0.5) ? 1 : 65536 - 500;
    if (camera.bits > 16 && random.chance(0.5)) {
        camera.next_id = (int64_t(1) << 32) - 600;
    }
    camera.drift = random.uniform(-60e-6, 60e-6);
    return camera;
}

/** Sessions one after the other, on one pairer, until it saw its share of triggers. */
void run_pairer(Profile profile, uint64_t run, uint64_t triggers, bool naive, Faults &faults,
                Random &random, Figures &figures)
{
    CameraState camera = first_camera(run, random);
    const uint32_t first = first_number(run);
    BoxState box;
    box.boot_id = uint32_t(random.bits() | 1);
    box.drift = random.uniform(-50e-6, 50e-6);
    const auto subject = naive ? make_naive(first) : make_pairer(profile, camera, first);
    std::vector<bool> delivered;
    bool delays_learnt = false;
    const uint64_t enough = figures.triggers + triggers;
    int64_t armed_at = 10 * SECOND;
    for (uint32_t id = 1; figures.triggers < enough; ++id) {
        const BoxState before = box;
        Session session =
            make_session(profile, id, first, armed_at, box, camera, faults, random);
        session.box = before;
        run_session(profile, session, box, *subject, delivered, delays_learnt, faults, random,
                    figures);
        figures.broken_sums += !subject->sums_hold();
        armed_at = session.closed_at + 4 * SECOND;
    }
    figures.spent_ns += subject->spent_ns();
}

void print_faults(const Faults &faults, uint64_t triggers)
{
    std::printf("faults, for each 100 triggers:\n");
    for (int i = 0; i < FAULTS; ++i) {
        std::printf("  %-42s %7.3f\n", FAULT_TABLE[i].name,
                    100 * double(faults.count(Fault(i))) / double(triggers));
    }
}

void print_figures(Profile profile, const Figures &f)
{
    std::printf("%s\n", PROFILE_NAMES[profile]);
    std::printf("  triggers %llu: paired %llu, missing %llu, uncertain %llu\n",
                (unsigned long long)f.triggers,
                (unsigned long long)f.by_trigger_state[OPMS_TRIGGER_PAIRED],
                (unsigned long long)f.by_trigger_state[OPMS_TRIGGER_MISSING],
                (unsigned long long)f.by_trigger_state[OPMS_TRIGGER_UNCERTAIN]);
    std::printf("  frames %llu: paired %llu, orphan %llu, duplicate %llu, stale %llu, "
                "uncertain %llu\n",
                (unsigned long long)f.frames,
                (unsigned long long)f.by_frame_state[OPMS_FRAME_PAIRED],
                (unsigned long long)f.by_frame_state[OPMS_FRAME_ORPHAN],
                (unsigned long long)f.by_frame_state[OPMS_FRAME_DUPLICATE],
                (unsigned long long)f.by_frame_state[OPMS_FRAME_STALE],
                (unsigned long long)f.by_frame_state[OPMS_FRAME_UNCERTAIN]);
    std::printf("  wrong pairs %llu, broken sums %llu, wrong MISSING %llu, wrong ORPHAN %llu\n",
                (unsigned long long)f.wrong_pairs, (unsigned long long)f.broken_sums,
                (unsigned long long)f.wrong_missing, (unsigned long long)f.wrong_orphans);
    std::printf("  pairable %llu, of them paired %.4f %%\n", (unsigned long long)f.pairable,
                100 * double(f.pairable_paired) / double(f.pairable));
    std::printf("  lock lost %llu times; undisturbed frames to a new one: at most %llu "
                "(%llu times more than 10)\n",
                (unsigned long long)f.locks_lost, (unsigned long long)f.frames_to_lock,
                (unsigned long long)f.slow_locks);
    std::printf("  %.0f ns a trigger in the pairer, all its inputs included\n",
                double(f.spent_ns) / double(f.triggers));
}

bool is_good(const Figures &f)
{
    return f.wrong_pairs == 0 && f.broken_sums == 0 && f.wrong_missing == 0 &&
           f.wrong_orphans == 0 && f.slow_locks == 0 && f.pairable * 2 > f.frames &&
           double(f.pairable_paired) >= LEAST_SHARE * double(f.pairable);
}

bool run_profile(Profile profile, const Options &options)
{
    Random random(options.seed * 1000 + uint64_t(profile));
    Faults faults;
    Figures figures;
    for (uint64_t run = 0; figures.triggers < options.triggers; ++run) {
        const uint64_t left = options.triggers - figures.triggers;
        run_pairer(profile, run, std::min(left, TRIGGERS_PER_PAIRER), options.naive, faults,
                   random, figures);
    }
    if (options.naive) {
        std::printf("naive, %s: %llu pairs, %llu of them wrong\n", PROFILE_NAMES[profile],
                    (unsigned long long)figures.paired, (unsigned long long)figures.wrong_pairs);
        return figures.wrong_pairs >= NAIVE_WRONG_MIN;
    }
    print_figures(profile, figures);
    if (profile == STAMP_AND_STROBE) {
        print_faults(faults, figures.triggers);
    }
    std::fflush(stdout);
    return is_good(figures);
}

int usage()
{
    std::fprintf(stderr, "usage: opms_pair_sim [--triggers N] [--seed N] [--profile 0..3] "
                         "[--naive]\n");
    return 2;
}

} // namespace

int main(int argc, char **argv)
{
    Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string name = argv[i];
        if (name == "--naive") {
            options.naive = true;
            continue;
        }
        char *end = nullptr;
        const uint64_t value = i + 1 < argc ? std::strtoull(argv[i + 1], &end, 10) : 0;
        if (!end || *end != '\0' || end == argv[i + 1]) {
            return usage();
        }
        ++i;
        if (name == "--triggers" && value > 0) {
            options.triggers = value;
        } else if (name == "--seed") {
            options.seed = value;
        } else if (name == "--profile" && value < PROFILES) {
            options.profile = int(value);
        } else {
            return usage();
        }
    }
    bool good = true;
    for (int i = 0; i < PROFILES; ++i) {
        if (options.profile < 0 || options.profile == i) {
            good = run_profile(Profile(i), options) && good;
        }
    }
    std::printf("%s\n", good ? "all as promised" : "NOT as promised");
    return good ? 0 : 1;
}
