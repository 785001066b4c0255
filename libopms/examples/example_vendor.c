/* SPDX-License-Identifier: Apache-2.0 */
/* A detector maker's own software with libopms inside: example_vendor SESSION.txt
 *
 * Its camera and its USB are its own. SESSION.txt stands for both: what came, as it came, with the
 * host's monotonic time; out go poses with their true times.
 *     session BOOT_ID SESSION_ID           the box was told to arm
 *     report ARRIVED_NS SENT_NS HEX        bytes of a report; a pong's ping was sent at SENT_NS
 *     frame ARRIVED_NS FRAME_ID CAMERA_US PICTURE.pgm */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include <opms/opms.h>

#include "example_camera.h"
#include "example_pgm.h"

#define FRAMES_MAX 64

typedef struct vendor {
    opms_pairer_t *pairer;
    opms_locator_t *locator;
    opms_location_t found[FRAMES_MAX]; /* what each picture gave, until its trigger is known */
    unsigned frames, poses;
    opms_error_t err;
} vendor_t;

static int read_hex(const char *text, uint8_t bytes[OPMS_WIRE_SIZE])
{
    size_t i = 0;
    while (i < OPMS_WIRE_SIZE && sscanf(text + 2 * i, "%2" SCNx8, &bytes[i]) == 1) {
        ++i;
    }
    return i == OPMS_WIRE_SIZE ? 0 : -1;
}

/** Give the pairer what the box sent; bytes that were damaged on their way are left alone. */
static opms_status_t take_report(vendor_t *v, const uint8_t *bytes, int64_t at_ns, int64_t sent_ns)
{
    opms_trigger_report_t trigger;
    opms_event_report_t event;
    opms_pong_report_t pong;
    if (opms_wire_read_trigger(bytes, OPMS_WIRE_SIZE, &trigger) == OPMS_WIRE_OK) {
        return opms_pairer_push_trigger(v->pairer, &trigger, at_ns, &v->err);
    }
    if (opms_wire_read_pong(bytes, OPMS_WIRE_SIZE, &pong) == OPMS_WIRE_OK) {
        return opms_pairer_push_pong(v->pairer, sent_ns, &pong, at_ns, &v->err);
    }
    if (opms_wire_read_event(bytes, OPMS_WIRE_SIZE, &event) == OPMS_WIRE_OK) {
        return opms_pairer_push_event(v->pairer, &event, &v->err);
    }
    fprintf(stderr, "a damaged report is left out\n");
    return OPMS_OK;
}

/** Locate at once, tell the pairer: the picture itself is not needed any more. */
static opms_status_t take_frame(vendor_t *v, opms_frame_t *frame, const char *picture)
{
    opms_image_t image;
    frame->tag = v->frames++ % FRAMES_MAX;
    v->found[frame->tag] = (opms_location_t){.state = OPMS_BAR_ABSENT};
    if (example_pgm_read(picture, &image) == 0) {
        opms_locator_locate(v->locator, &image, NULL, NULL, &v->found[frame->tag], NULL);
        free((void *)image.pixels);
    }
    return opms_pairer_push_frame(v->pairer, frame, &v->err);
}

/** Poses whose trigger has become certain. */
static void print_poses(vendor_t *v)
{
    opms_pair_result_t pair;
    uint32_t count = 0;
    while (opms_pairer_poll(v->pairer, &pair, 1, &count, &v->err) == OPMS_OK && count == 1) {
        const opms_location_t *found = &v->found[pair.frame.tag];
        const double *t_m = found->ground_detector.transform.t_m;
        if (pair.frame_state == OPMS_FRAME_PAIRED && found->state == OPMS_BAR_LOCATED &&
            (pair.known & OPMS_PAIR_HAS_START_EDGE)) {
            printf("t = %.6f s, trigger %" PRIu64 ": detector at %.2f %.2f %.2f mm\n",
                   (double)(pair.mid_exposure_box_ns - pair.start_edge_box_ns) * 1e-9,
                   pair.trigger_number, 1e3 * t_m[0], 1e3 * t_m[1], 1e3 * t_m[2]);
            ++v->poses;
        }
    }
}

static opms_status_t take_line(vendor_t *v, const char *line)
{
    opms_settings_t settings;
    opms_frame_t frame = {0};
    uint8_t bytes[OPMS_WIRE_SIZE];
    char text[256];
    int64_t arrived_ns, sent_ns;
    uint32_t boot_id, session_id;
    if (sscanf(line, "session %" SCNu32 " %" SCNu32, &boot_id, &session_id) == 2) {
        opms_wire_default_settings(&settings); /* those that are in force in the box */
        return opms_pairer_open(v->pairer, boot_id, session_id, &settings, &v->err);
    }
    if (sscanf(line, "report %" SCNd64 " %" SCNd64 " %128s", &arrived_ns, &sent_ns, text) == 3 &&
        read_hex(text, bytes) == 0) {
        return take_report(v, bytes, arrived_ns, sent_ns);
    }
    if (sscanf(line, "frame %" SCNd64 " %" SCNu64 " %" SCNu64 " %255s", &frame.arrival_host_ns,
               &frame.frame_id, &frame.camera_time_ticks, text) == 4) {
        return take_frame(v, &frame, text);
    }
    fprintf(stderr, "a line is left out: %s", line);
    return OPMS_OK;
}

static opms_status_t create(vendor_t *v)
{
    const opms_camera_t camera = example_camera();
    opms_locator_options_t locator;
    opms_locator_options_init(&locator);
    locator.bar_tilt_rad = 0.33685; /* 19.3 degrees */
    opms_pair_options_t pair;
    opms_pair_options_init(&pair);
    pair.camera = (opms_camera_profile_t){
        .has_frame_id = 1, .frame_id_bits = 64, .has_camera_time = 1, .camera_time_bits = 64,
        .camera_tick_hz = 1000000, .has_start_delay = 1, .has_exposure = 1,
        .start_delay_ns = 20000, .exposure_ns = 4000000}; /* as its data sheet says */
    const opms_status_t status = opms_locator_create(&camera, &locator, &v->locator, &v->err);
    return status == OPMS_OK ? opms_pairer_create(&pair, &v->pairer, &v->err) : status;
}

int main(int argc, char **argv)
{
    static vendor_t v;
    char line[512];
    FILE *session = argc == 2 ? fopen(argv[1], "r") : NULL;
    if (!session) {
        fprintf(stderr, "usage: example_vendor SESSION.txt\n");
        return 2;
    }
    opms_status_t status = create(&v);
    while (status == OPMS_OK && fgets(line, sizeof line, session)) {
        status = take_line(&v, line);
        print_poses(&v);
    }
    fclose(session);
    if (status == OPMS_OK && (status = opms_pairer_close(v.pairer, &v.err)) == OPMS_OK) {
        print_poses(&v);
    }
    printf("%u poses. %s\n", v.poses, status == OPMS_OK ? "" : v.err.message);
    opms_pairer_destroy(v.pairer);
    opms_locator_destroy(v.locator);
    return status == OPMS_OK && v.poses > 0 ? 0 : 1;
}
