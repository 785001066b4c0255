/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A box, a camera and a host for tests: everything on time unless the test says otherwise.
 *
 * The host's clock runs as the box's, HOST_LESS_BOX_NS ahead. Trigger n is exposed as frame id
 * n + 1000; the camera's clock is CAMERA_LESS_BOX_NS ahead of the box's. */
#ifndef PAIR_SCENE_H
#define PAIR_SCENE_H

#include <opms/pair.h>

#define MS 1000000LL
#define HOST_LESS_BOX_NS (900000 * MS)
#define CAMERA_LESS_BOX_NS (77777 * MS)
#define FRAME_DELAY_NS (30 * MS)
#define PREAMBLE 6
#define BOOT 0xB0070001U
#define SESSION 77U
#define ID_LESS_NUMBER 1000
#define RESULTS_MAX 8192

typedef enum pair_kind { STAMP_AND_STROBE, STAMP_ONLY, STROBE_ONLY, ARRIVAL_ONLY } pair_kind_t;

typedef struct pair_scene {
    opms_pairer_t *pairer;
    pair_kind_t kind;
    uint32_t first_number;
    int64_t start_ns;  /* box time of trigger 1 */
    opms_pair_result_t results[RESULTS_MAX];
    uint32_t count;
} pair_scene_t;

opms_pair_options_t scene_options(pair_kind_t kind);
opms_settings_t scene_settings(void);

/** Create a pairer, ping it, open a session. */
void scene_start(pair_scene_t *scene, pair_kind_t kind);
void scene_start_with(pair_scene_t *scene, pair_kind_t kind, const opms_pair_options_t *options);
void scene_ping(pair_scene_t *scene, uint32_t boot_id, int64_t from_box_ns, int count);
void scene_open(pair_scene_t *scene, uint32_t boot_id, uint32_t session_id);
void scene_end(pair_scene_t *scene);

/** Box time of trigger n, 1 the first of the preamble, 7 the first of the run. */
int64_t scene_trigger_ns(const pair_scene_t *scene, int n);

opms_trigger_report_t scene_report(const pair_scene_t *scene, int n);
opms_frame_t scene_frame(const pair_scene_t *scene, int n);

void scene_push_report(pair_scene_t *scene, const opms_trigger_report_t *report);
void scene_push_frame(pair_scene_t *scene, const opms_frame_t *frame);

/** Trigger n: its report alone, or its frame alone. */
void scene_report_only(pair_scene_t *scene, int n);
void scene_frame_only(pair_scene_t *scene, int n);

/** Trigger n: its report, then its frame. */
void scene_step(pair_scene_t *scene, int n);
void scene_steps(pair_scene_t *scene, int from, int to);

/** Let box time be this, in steps of 50 ms of time that passes in between. */
void scene_advance(pair_scene_t *scene, int64_t box_ns);

/** Close, and check the sums. */
void scene_close(pair_scene_t *scene);

/** The one result of trigger n, or NULL; and of the frame with this tag. */
const opms_pair_result_t *scene_of_trigger(const pair_scene_t *scene, int n);
const opms_pair_result_t *scene_of_frame(const pair_scene_t *scene, uint64_t tag);

opms_pair_summary_t scene_summary(const pair_scene_t *scene);

/** Trigger n is paired with the frame whose tag is n; for all of from to to. */
void scene_assert_paired(const pair_scene_t *scene, int from, int to);

/** No result pairs a frame with another trigger than its tag says. */
void scene_assert_no_wrong_pair(const pair_scene_t *scene);

#endif
