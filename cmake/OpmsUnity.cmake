# SPDX-License-Identifier: Apache-2.0
# Unity, the C test framework, and tests written with it.
#
# UNITY_DIR (variable or environment) may name a folder with src/unity.c; otherwise the sources
# are fetched by fetch_unity.sh, once, into the build folder.
set(UNITY_DIR "$ENV{UNITY_DIR}" CACHE PATH "Folder with Unity's src/unity.c")
if(NOT UNITY_DIR)
    set(UNITY_DIR ${PROJECT_BINARY_DIR}/unity)
    execute_process(COMMAND ${CMAKE_CURRENT_LIST_DIR}/fetch_unity.sh ${UNITY_DIR}
        RESULT_VARIABLE opms_unity_failed)
    if(opms_unity_failed)
        message(FATAL_ERROR "Unity is missing; set UNITY_DIR")
    endif()
endif()

add_library(opms_unity STATIC ${UNITY_DIR}/src/unity.c)
target_include_directories(opms_unity SYSTEM PUBLIC ${UNITY_DIR}/src)
# A test that fails leaves its objects behind, and their threads: what it said must be out by then.
target_compile_definitions(opms_unity PUBLIC UNITY_INCLUDE_DOUBLE UNITY_USE_FLUSH_STDOUT)

# opms_add_unity_test(<name> <source>... [LIBS <library>...])
#
# A test program of Unity, linked with the library's internals, and its ctest entry "unit.<name>".
# It runs in its own binary folder; the environment names the tree's test data (OPMS_TEST_DATA).
function(opms_add_unity_test name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "LIBS")
    add_executable(${name} ${arg_UNPARSED_ARGUMENTS})
    opms_target_defaults(${name})
    target_link_libraries(${name} PRIVATE opms_internal opms_unity ${arg_LIBS})
    add_test(NAME unit.${name} COMMAND ${name})
    set_tests_properties(unit.${name} PROPERTIES LABELS unit TIMEOUT 900
        ENVIRONMENT OPMS_TEST_DATA=${PROJECT_SOURCE_DIR}/tests/data)
endfunction()
