/* SPDX-License-Identifier: Apache-2.0 */
/* Files of older and newer versions, and files that are no scans. */
#include <fstream>
#include <iterator>

#include <sqlite3.h>
#include <unity.h>

#include "made_scan.hpp"
#include "temporary_folder.hpp"

using namespace opms_host;
namespace fs = std::filesystem;

void setUp(void) {}
void tearDown(void) {}

namespace {

std::string bytes_of(const std::string &path)
{
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void run_sql(const std::string &path, const std::string &sql)
{
    sqlite3 *book = nullptr;
    TEST_ASSERT_EQUAL(SQLITE_OK, sqlite3_open(path.c_str(), &book));
    char *error = nullptr;
    sqlite3_exec(book, sql.c_str(), nullptr, nullptr, &error);
    TEST_ASSERT_NULL_MESSAGE(error, error);
    sqlite3_close(book);
}

/** A scan of version 0 with its picture. @return Its database. */
std::string make_version_0(const std::string &folder)
{
    fs::create_directories(folder + "/pictures/000");
    std::ofstream(folder + "/pictures/000/000007.png") << "eleven byte";
    run_sql(folder + "/scan.sqlite", bytes_of(RECORDING_TEST_FOLDER "/schema_0.sql"));
    return folder + "/scan.sqlite";
}

AllRows rows_of(const std::string &folder, std::uint32_t version)
{
    std::string error;
    AllRows rows;
    const auto reader = ScanReader::open(folder, error);
    TEST_ASSERT_TRUE_MESSAGE(reader != nullptr, error.c_str());
    TEST_ASSERT_EQUAL_UINT32(version, reader->summary().schema_version);
    TEST_ASSERT_EQUAL_STRING("old", reader->summary().header.name.c_str());
    TEST_ASSERT_EQUAL_UINT32(100000, reader->summary().header.box_settings.period_us);
    TEST_ASSERT_TRUE_MESSAGE(read_all(*reader, rows, error), error.c_str());
    return rows;
}

void assert_rows_of_version_0(const AllRows &rows)
{
    TEST_ASSERT_EQUAL(1, rows.frames.size());
    TEST_ASSERT_EQUAL_UINT64(UINT64_MAX - 1, rows.frames[0].frame_id);
    TEST_ASSERT_EQUAL_UINT16(0, rows.frames[0].white_level);
    TEST_ASSERT_TRUE(rows.frames[0].exposure_us == 900.5);
    TEST_ASSERT_TRUE(rows.frames[0].gain_db != rows.frames[0].gain_db); /* not known */
    TEST_ASSERT_EQUAL(1, rows.triggers.size());
    TEST_ASSERT_EQUAL_UINT8(124, rows.triggers[0].report.time.cycles);
    TEST_ASSERT_EQUAL(1, rows.pairs.size());
    TEST_ASSERT_EQUAL_INT64(-3, rows.pairs[0].result.camera_residual_ns);
    TEST_ASSERT_EQUAL(1, rows.poses.size());
    TEST_ASSERT_FALSE(rows.poses[0].has_hint);
    TEST_ASSERT_EQUAL_INT64(699901009, rows.poses[0].t_scan_ns);
    TEST_ASSERT_EQUAL(1, rows.events.size());
    TEST_ASSERT_EQUAL(1, rows.clock.size());
    TEST_ASSERT_EQUAL(1, rows.box_reports.size());
    TEST_ASSERT_EQUAL(1, rows.sensors.size());
    TEST_ASSERT_TRUE(rows.sensors[0].values[0] == 1.5);
    TEST_ASSERT_EQUAL(1, rows.pictures.size());
    TEST_ASSERT_EQUAL_INT64(-1, rows.pictures[0].crc32);
}

void assert_refused(const std::string &folder, const char *why)
{
    std::string error;
    TEST_ASSERT_TRUE(ScanReader::open(folder, error) == nullptr);
    TEST_ASSERT_TRUE_MESSAGE(error.find(why) != std::string::npos, error.c_str());
    ScanRecovery recovery;
    TEST_ASSERT_FALSE(recover_scan(folder, recovery, error));
    TEST_ASSERT_TRUE_MESSAGE(error.find(why) != std::string::npos, error.c_str());
}

}  // namespace

static void test_version_0_is_read_and_left_as_it_is(void)
{
    const TemporaryFolder folder;
    const std::string database = make_version_0(folder / "old");
    const std::string before = bytes_of(database);
    assert_rows_of_version_0(rows_of(folder / "old", 0));
    TEST_ASSERT_TRUE(before == bytes_of(database));
}

static void test_mending_brings_version_0_up_to_date(void)
{
    const TemporaryFolder folder;
    make_version_0(folder / "old");
    ScanRecovery recovery;
    std::string error;
    TEST_ASSERT_TRUE_MESSAGE(recover_scan(folder / "old", recovery, error), error.c_str());
    TEST_ASSERT_TRUE(recovery.needed);
    TEST_ASSERT_EQUAL_UINT64(0, recovery.pictures_lost);
    assert_rows_of_version_0(rows_of(folder / "old", 1));
}

static void test_todays_tables_are_those_that_migration_makes(void)
{
    const TemporaryFolder folder;
    make_version_0(folder / "old");
    ScanRecovery recovery;
    std::string error;
    TEST_ASSERT_TRUE(recover_scan(folder / "old", recovery, error));
    record_scan(folder.path(), "new", 1);
    const auto columns_of = [&](const char *scan) {
        sqlite3 *book = nullptr;
        std::string all;
        sqlite3_open((folder / scan + "/scan.sqlite").c_str(), &book);
        sqlite3_exec(book, "SELECT t.name || '.' || c.name || ' ' || c.type || c.\"notnull\" "
                           "FROM sqlite_schema t, pragma_table_xinfo(t.name) c "
                           "WHERE t.type = 'table' ORDER BY 1",
                     [](void *text, int, char **values, char **) {
                         *static_cast<std::string *>(text) += std::string(values[0]) + "\n";
                         return 0;
                     }, &all, nullptr);
        sqlite3_close(book);
        return all;
    };
    const std::string made = columns_of("new");
    TEST_ASSERT_TRUE(made.find("frames.white_level INTEGER1") != std::string::npos);
    TEST_ASSERT_EQUAL_STRING(made.c_str(), columns_of("old").c_str());
}

static void test_a_newer_version_is_refused_by_its_number(void)
{
    const TemporaryFolder folder;
    record_scan(folder.path(), "one", 1);
    run_sql(folder / "one/scan.sqlite", "PRAGMA user_version = 7");
    assert_refused(folder / "one", "made by a newer opms: its tables have version 7");
}

static void test_a_database_of_something_else_is_refused(void)
{
    const TemporaryFolder folder;
    fs::create_directory(folder / "other");
    run_sql(folder / "other/scan.sqlite", "CREATE TABLE frames (number)");
    assert_refused(folder / "other", "but not of a scan");
}

static void test_what_is_no_database_is_refused(void)
{
    const TemporaryFolder folder;
    fs::create_directory(folder / "text");
    std::ofstream(folder / "text/scan.sqlite") << std::string(5000, 'x');
    assert_refused(folder / "text", "not a database");
    fs::create_directory(folder / "empty");
    std::ofstream(folder / "empty/scan.sqlite").close();
    assert_refused(folder / "empty", "not of a scan");
    fs::create_directory(folder / "nothing");
    assert_refused(folder / "nothing", "there is no scan.sqlite");
    assert_refused(folder / "nowhere", "there is no scan.sqlite");
}

static void test_scans_that_cannot_be_read_are_listed_with_the_reason(void)
{
    const TemporaryFolder folder;
    record_scan(folder.path(), "good", 1);
    fs::create_directory(folder / "bad");
    std::ofstream(folder / "bad/scan.sqlite") << std::string(5000, 'x');
    fs::create_directory(folder / "no scan");
    std::vector<std::string> failed;
    const auto scans = list_scans(folder.path(), failed);
    TEST_ASSERT_EQUAL(1, scans.size());
    TEST_ASSERT_EQUAL_STRING("good", scans[0].name.c_str());
    TEST_ASSERT_EQUAL(1, failed.size());
    TEST_ASSERT_TRUE(failed[0].find("bad") != std::string::npos);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_version_0_is_read_and_left_as_it_is);
    RUN_TEST(test_mending_brings_version_0_up_to_date);
    RUN_TEST(test_todays_tables_are_those_that_migration_makes);
    RUN_TEST(test_a_newer_version_is_refused_by_its_number);
    RUN_TEST(test_a_database_of_something_else_is_refused);
    RUN_TEST(test_what_is_no_database_is_refused);
    RUN_TEST(test_scans_that_cannot_be_read_are_listed_with_the_reason);
    return UNITY_END();
}
