# SPDX-License-Identifier: Apache-2.0
"""Each lint must be able to fail: small trees with one fault each."""
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import check_compiles  # noqa: E402
import check_files  # noqa: E402
import check_includes  # noqa: E402

SPDX_C = "/* SPDX-License-Identifier: Apache-2.0 */\n"
GOOD_TREE = {
    "libopms/include/opms/types.h": SPDX_C + "#include <stdint.h>\n",
    "libopms/include/opms/pose.h": SPDX_C + "#include <opms/types.h>\n",
    "libopms/src/base/fail.h": SPDX_C + "#include <opms/types.h>\n",
    "libopms/src/bar/search.h": SPDX_C,
    "libopms/src/bar/search.c": SPDX_C + '#include "bar/search.h"\n#include "base/fail.h"\n',
    "libopms/src/pose/solve.cpp": SPDX_C + "#include <Eigen/Dense>\n#include <opms/pose.h>\n",
    "host-tools/cli/main.cpp": SPDX_C + "#include <opms/pose.h>\n#include <vector>\n",
    "host-tools/simulate/scene.cpp": SPDX_C + "#include <opencv2/core.hpp>\n",
    "tests/synth/synth.h": SPDX_C,
}


class Tree(unittest.TestCase):
    def problems(self, lint, changes):
        """What a lint says of the good tree with some files added or replaced."""
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name, text in {**GOOD_TREE, **changes}.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text, encoding="utf-8")
            return list(lint(root))

    def assert_found(self, lint, changes, words):
        found = self.problems(lint, changes)
        self.assertEqual(len(found), 1, found)
        self.assertIn(words, found[0])


class Includes(Tree):
    def assert_refused(self, name, line, words):
        self.assert_found(check_includes.violations, {name: SPDX_C + line + "\n"}, words)

    def test_a_good_tree_passes(self):
        self.assertEqual(self.problems(check_includes.violations, {}), [])

    def test_a_stage_must_not_include_another(self):
        self.assert_refused("libopms/src/pose/x.cpp", '#include "bar/search.h"', "inside of bar")

    def test_a_stage_must_not_know_what_comes_after(self):
        self.assert_refused("libopms/src/bar/x.c", "#include <opms/pose.h>", "comes before")

    def test_hidapi_is_for_hid_alone(self):
        self.assert_refused("host-tools/cli/x.cpp", "#include <hidapi/hidapi.h>", "only opms::hid")

    def test_hid_sees_public_headers_only(self):
        self.assert_refused("libopms/hid/src/x.cpp", '#include "base/fail.h"', "public headers")
        self.assert_refused("libopms/hid/src/x.cpp", "#include <libusb.h>", "depends on hidapi")

    def test_the_logic_of_the_firmware_must_not_know_the_chip(self):
        self.assert_refused("firmware/core/x.c", '#include "hardware/pio.h"', "plain C")
        self.assert_refused("firmware/core/x.c", '#include <opms/pose.h>', "opms/wire.h only")

    def test_a_kit_must_not_include_another(self):
        self.assert_refused("libopms/src/lens/x.c", '#include "bar/search.h"', "inside of bar")

    def test_wire_must_stand_without_a_library(self):
        for line in ("#include <string.h>", "#include <opms/pose.h>", '#include "base/fail.h"'):
            self.assert_refused("libopms/src/wire/x.c", line, "freestanding")

    def test_the_library_must_not_use_another_library(self):
        self.assert_refused("libopms/src/bar/x.c", "#include <opencv2/core.hpp>", "nothing but")

    def test_the_c_files_must_not_use_eigen(self):
        self.assert_refused("libopms/src/bar/x.c", "#include <Eigen/Dense>", "C++ files")

    def test_a_public_header_must_not_use_a_private_one(self):
        self.assert_refused("libopms/include/opms/x.h", '#include "base/fail.h"', "public header")

    def test_only_the_apriltag_library_uses_apriltag(self):
        self.assert_refused("host-tools/cli/x.cpp", "#include <apriltag/apriltag.h>",
                            "only opms::apriltag")

    def test_nothing_includes_tests(self):
        self.assert_refused("host-tools/cli/x.cpp", '#include "../../tests/synth/synth.h"',
                            "includes tests")

    def test_the_programs_see_public_headers_only(self):
        self.assert_refused("host-tools/cli/x.cpp", '#include "../../libopms/src/base/fail.h"',
                            "only public headers")

    def test_the_renderer_must_not_include_the_library(self):
        self.assert_refused("host-tools/simulate/x.cpp", "#include <opms/lens.h>",
                            "share nothing")

    def test_the_renderer_must_not_link_the_library(self):
        self.assert_found(check_includes.violations, {
            "host-tools/simulate/CMakeLists.txt": "target_link_libraries(s PRIVATE opms::opms)\n",
        }, "must not link")

    def test_a_new_folder_needs_a_rule(self):
        self.assert_refused("libopms/src/map/x.c", "#include <math.h>", "table")


class Files(Tree):
    def assert_refused(self, name, text, words):
        self.assert_found(check_files.violations, {name: text}, words)

    def test_a_good_tree_passes(self):
        self.assertEqual(self.problems(check_files.violations, {}), [])

    def test_a_name_must_be_unique(self):
        self.assert_refused("libopms/src/pose/search.c", SPDX_C, "name is taken")

    def test_the_licence_must_be_stated(self):
        self.assert_refused("libopms/src/pose/x.c", "int x;\n", "SPDX")

    def test_nothing_may_be_left_to_do(self):
        for word in check_files.LEFTOVERS:
            self.assert_refused("libopms/src/pose/x.c", SPDX_C + f"/* {word} */\n", "left over")

    def test_a_file_must_not_be_long(self):
        self.assert_refused("libopms/src/pose/x.c", SPDX_C + "int x;\n" * 500, "one idea")

    def test_a_line_must_not_be_long(self):
        self.assert_refused("libopms/src/pose/x.c", SPDX_C + "/" * 101 + "\n", "columns")

    def test_a_line_must_not_end_in_blanks(self):
        self.assert_refused("libopms/src/pose/x.c", SPDX_C + "int x; \n", "blanks")

    def test_a_line_must_not_hold_a_tab(self):
        self.assert_refused("libopms/src/pose/x.c", SPDX_C + "\tint x;\n", "tab")

    def test_a_file_must_end_in_a_newline(self):
        self.assert_refused("libopms/src/pose/x.c", SPDX_C + "int x;", "newline")


class Compiles(Tree):
    def headers(self, text):
        return self.problems(lambda root: check_compiles.header_problems(root, "cc", "c++"),
                             {"libopms/include/opms/x.h": text})

    def documents(self, text):
        return self.problems(lambda root: check_compiles.document_problems(root, "cc", "c++"),
                             {"README.md": text})

    def test_a_good_tree_passes(self):
        self.assertEqual(self.headers("int opms_x(void);\n"), [])
        self.assertEqual(self.documents("```c\n#include <opms/types.h>\nint32_t x;\n```\n"), [])

    def test_a_header_must_include_what_it_needs(self):
        self.assertEqual(len(self.headers("int32_t opms_x(void);\n")), 2)

    def test_a_header_must_be_c(self):
        found = self.headers("int opms_x(int &y);\n")
        self.assertEqual(len(found), 1)
        self.assertIn("c11", found[0])

    def test_a_header_must_be_cpp(self):
        found = self.headers("int opms_x(int class);\n")
        self.assertEqual(len(found), 1)
        self.assertIn("c++17", found[0])

    def test_code_in_a_document_must_compile(self):
        for language in ("c", "cpp", "python"):
            found = self.documents(f"text\n\n```{language}\nint x = ;\n```\n")
            self.assertEqual(len(found), 1)
            self.assertIn("README.md:4", found[0])


if __name__ == "__main__":
    unittest.main()
