# SPDX-License-Identifier: Apache-2.0
"""opms export --to mcap: PyPI's mcap reads what was written, and checks all its sums."""
import base64
import json
import math
import struct
import unittest

from mcap.reader import NonSeekingReader, make_reader
from mcap.stream_reader import StreamReader

from scan_kit import BAR, EXPOSURE_MIDDLE_NS, FRAMES, PREAMBLE, ScanTest, pictures_of

BEGUN_WALL_NS = 1795356187 * 10**9  # 2026-11-22T14:03:07Z
BEGUN_BOX_NS = 8_900_000_000
START_NS = 11_000_000_000 - 1032


class McapFile(ScanTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.scans / "scan.mcap"
        [cls.row] = cls().run_json("export", cls.scan, "--to", "mcap", "--out", cls.out)
        with open(cls.out, "rb") as file:
            reader = make_reader(file, validate_crcs=True)
            cls.summary = reader.get_summary()
            cls.messages = {}
            cls.order = []
            for schema, channel, message in reader.iter_messages(log_time_order=False):
                cls.messages.setdefault(channel.topic, []).append(
                    (schema, message, json.loads(message.data)))
                cls.order.append(message.log_time)

    def runTest(self):
        """Only so that an instance can be made."""

    def topic(self, name):
        return self.messages[name]

    def test_every_record_reads_from_front_to_back_with_its_sums(self):
        with open(self.out, "rb") as file:
            records = [type(record).__name__
                       for record in StreamReader(file, emit_chunks=True, validate_crcs=True,
                                                  ).records]
        self.assertEqual(records[0], "Header")
        self.assertEqual(records[-1], "Footer")
        for needed in ("Chunk", "MessageIndex", "ChunkIndex", "Statistics", "Attachment",
                       "AttachmentIndex", "Metadata", "MetadataIndex", "SummaryOffset", "DataEnd"):
            self.assertIn(needed, records)

    def test_a_reader_that_cannot_seek_finds_the_same_messages(self):
        with open(self.out, "rb") as file:
            count = sum(1 for _ in NonSeekingReader(file, validate_crcs=True).iter_messages())
        self.assertEqual(count, len(self.order))

    def test_a_changed_byte_is_noticed_by_the_sums(self):
        broken = bytearray(self.out.read_bytes())
        broken[len(broken) // 2] ^= 1
        path = self.folder / "broken.mcap"
        path.write_bytes(broken)
        with self.assertRaises(Exception), open(path, "rb") as file:
            for _ in make_reader(file, validate_crcs=True).iter_messages():
                pass

    def test_statistics_count_what_is_there(self):
        statistics = self.summary.statistics
        self.assertEqual(statistics.message_count, len(self.order))
        self.assertEqual(statistics.channel_count, len(self.summary.channels))
        self.assertEqual(statistics.schema_count, len(self.summary.schemas))
        self.assertEqual(statistics.chunk_count, len(self.summary.chunk_indexes))
        self.assertGreater(statistics.chunk_count, 1)
        self.assertEqual((statistics.attachment_count, statistics.metadata_count), (1, 1))
        self.assertEqual((statistics.message_start_time, statistics.message_end_time),
                         (min(self.order), max(self.order)))
        by_topic = {self.summary.channels[channel].topic: count
                    for channel, count in statistics.channel_message_counts.items()}
        self.assertEqual(by_topic, {topic: len(found) for topic, found in self.messages.items()})

    def test_the_index_finds_one_topic_and_a_stretch_of_time(self):
        middle = sorted(message.log_time for _, message, _ in self.topic("/opms/pose"))[7]
        with open(self.out, "rb") as file:
            found = list(make_reader(file).iter_messages(
                topics=["/opms/pose"], starting_at=middle, ending_before=middle + 150_000_000))
        self.assertEqual(len(found), 2)

    def test_every_channel_is_json_with_a_schema_that_names_its_fields(self):
        for topic, found in self.messages.items():
            schema, _, content = found[0]
            self.assertEqual(schema.encoding, "jsonschema")
            stated = json.loads(schema.data)
            self.assertEqual((stated["type"], stated["title"]), ("object", schema.name), topic)
            if schema.name.startswith("foxglove."):
                self.assertEqual(set(content), set(stated["properties"]), topic)

    def test_poses_of_the_detector_are_those_of_the_scan_at_their_wall_times(self):
        found = self.topic("/opms/detector")
        self.assertEqual(found[0][0].name, "foxglove.PoseInFrame")
        self.assertEqual(len(found), FRAMES)
        for (_, message, content), true in zip(found, self.truth["poses"]):
            position = content["pose"]["position"]
            self.assertEqual([position[axis] for axis in "xyz"], true["t_ground_detector_m"])
            self.assertEqual(content["frame_id"], "ground")
            wall_ns = content["timestamp"]["sec"] * 10**9 + content["timestamp"]["nsec"]
            self.assertEqual(wall_ns, message.log_time)
            self.assertEqual(wall_ns, BEGUN_WALL_NS + true["t_scan_ns"] + START_NS - BEGUN_BOX_NS)
            q = content["pose"]["orientation"]
            self.assertAlmostEqual(math.hypot(*q.values()), 1, places=12)

    def test_frames_form_one_tree_from_the_ground_to_the_camera(self):
        found = [content for _, _, content in self.topic("/tf")]
        self.assertEqual({(c["parent_frame_id"], c["child_frame_id"]) for c in found},
                         {("detector", "camera"), ("ground", "detector")})

    def test_pictures_are_the_stored_files(self):
        found = self.topic("/camera/image")
        self.assertEqual([base64.b64decode(content["data"]) for _, _, content in found],
                         [path.read_bytes() for path in pictures_of(self.scan)])
        self.assertTrue(all(content["format"] == "png" for _, _, content in found))

    def test_the_lens_is_that_of_the_camera_file(self):
        [(_, _, content)] = self.topic("/camera/calibration")
        self.assertEqual((content["width"], content["height"]), (1024, 768))
        self.assertEqual(content["K"], [585.0, 0, 517.3, 0, 585.0, 379.6, 0, 0, 1])
        self.assertEqual(content["D"], [-0.118, 0.031, 0.0011, -0.0007, 0])
        with open(self.out, "rb") as file:
            [attachment] = list(make_reader(file).iter_attachments())
        self.assertEqual(attachment.data, (BAR / "camera.yaml").read_bytes())

    def test_events_become_a_log_with_levels(self):
        found = [content for _, _, content in self.topic("/opms/events")]
        levels = {content["name"]: content["level"] for content in found}
        self.assertEqual((levels["scan.begun"], levels["box.lost"]), (2, 3))
        [lost] = [content for content in found if content["name"] == "box.lost"]
        self.assertEqual(lost["message"], 'the trigger box, "unplugged",\nis sought')

    def test_samples_keep_their_values_and_what_is_no_number_is_null(self):
        found = [content for _, _, content in self.topic("/sensors/metal")]
        self.assertEqual([content["values"] for content in found],
                         [[0.25, None], [0.5, None], [0.75, None], [1.0, None]])
        [(_, _, late)] = self.topic("/sensors/radar")
        self.assertEqual((late["t_scan_s"], late["data"]), (None, {"note": 'a "quote", a comma'}))

    def test_poses_in_full_carry_the_scans_own_time(self):
        for _, _, content in self.topic("/opms/pose")[PREAMBLE:]:
            ns = (content["trigger"] - PREAMBLE - 1) * 100_000_000 + EXPOSURE_MIDDLE_NS
            self.assertAlmostEqual(content["t_scan_s"], ns * 1e-9, places=12)

    def test_messages_stand_in_the_order_of_their_times(self):
        self.assertEqual(self.order, sorted(self.order))

    def test_without_pictures_the_file_is_small(self):
        out = self.folder / "small.mcap"
        [row] = self.run_json("export", self.scan, "--to", "mcap", "--out", out, "--no-pictures")
        self.assertEqual(row["pictures"], 0)
        self.assertLess(out.stat().st_size, 200_000)
        self.assertEqual(struct.unpack("<8s", out.read_bytes()[-8:])[0], b"\x89MCAP0\r\n")


if __name__ == "__main__":
    unittest.main()
