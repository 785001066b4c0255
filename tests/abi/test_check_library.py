# SPDX-License-Identifier: Apache-2.0
"""check_library.py must be able to fail: small libraries with one fault each."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import check_library  # noqa: E402

HEADER = "#define OPMS_API\nOPMS_API int opms_one(void);\n"
SOURCE = "int opms_one(void) { return 1; }\n"


class Library(unittest.TestCase):
    def problems(self, source=SOURCE, header=HEADER, listed=("opms_one",), link=(), max_kib=400):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "x.h").write_text(header, encoding="utf-8")
            (Path(folder) / "x.c").write_text(source, encoding="utf-8")
            library = f"{folder}/libx.so"
            subprocess.run(["cc", "-shared", "-fPIC", "-Wl,--no-as-needed", "-o", library,
                            f"{folder}/x.c", *link], check=True)
            return list(check_library.violations(library, folder, set(listed), max_kib))

    def test_a_good_library_passes(self):
        self.assertEqual(self.problems(), [])

    def test_a_symbol_that_nobody_declared_is_found(self):
        found = self.problems(source=SOURCE + "int helper(void) { return 2; }\n")
        self.assertEqual(found, ["helper: exported, but not in the list",
                                 "helper: exported, but in no public header"])

    def test_a_symbol_that_went_away_is_found(self):
        found = self.problems(listed=("opms_one", "opms_two"))
        self.assertEqual(found, ["opms_two: in the list, but not exported"])

    def test_a_declaration_without_a_function_is_found(self):
        found = self.problems(header=HEADER + "OPMS_API const char *\n  opms_two(int x);\n")
        self.assertEqual(found, ["opms_two: declared, but not exported"])

    def test_a_foreign_library_is_found(self):
        found = self.problems(link=["-lresolv"])
        self.assertEqual(len(found), 1)
        self.assertIn("libresolv.so", found[0])

    def test_a_large_library_is_found(self):
        found = self.problems(max_kib=1)
        self.assertEqual(len(found), 1)
        self.assertIn("KiB stripped", found[0])


if __name__ == "__main__":
    unittest.main()
