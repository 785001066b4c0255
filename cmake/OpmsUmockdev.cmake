# SPDX-License-Identifier: Apache-2.0
# Tests whose program runs a device library unmodified against devices that umockdev mocks.
#
# opms_add_mocked_test(<name> <source>... [LIBS <library>...])
#
# A Unity test with the ctest entry "unit.<name>"; its own process has the mocked /dev and /sys.
# Without umockdev the function says so and adds nothing.
find_package(PkgConfig)
if(PkgConfig_FOUND)
    pkg_check_modules(OPMS_UMOCKDEV IMPORTED_TARGET umockdev-1.0)
endif()
if(NOT OPMS_UMOCKDEV_FOUND)
    message(STATUS "umockdev (Debian: libumockdev-dev) not found: no tests of mocked devices")
endif()

function(opms_add_mocked_test name)
    if(NOT OPMS_UMOCKDEV_FOUND)
        return()
    endif()
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "LIBS")
    opms_add_unity_test(${name} ${arg_UNPARSED_ARGUMENTS}
        LIBS PkgConfig::OPMS_UMOCKDEV ${arg_LIBS})
    # What umockdev-wrapper does. It must come before a sanitizer's run time, which would rather be
    # first; and what GLib keeps to the end of the process is no leak of ours.
    set_tests_properties(unit.${name} PROPERTIES ENVIRONMENT
        "LD_PRELOAD=libumockdev-preload.so.0;ASAN_OPTIONS=verify_asan_link_order=0;\
LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan_umockdev.supp:print_suppressions=0")
endfunction()
