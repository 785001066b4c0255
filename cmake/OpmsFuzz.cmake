# SPDX-License-Identifier: Apache-2.0
# Fuzz targets: sources that define LLVMFuzzerTestOneInput(), and a corpus.
#
# opms_add_fuzzer(<name> <source>... LIBS <library>... CORPUS <folder>...)
#
# With OPMS_FUZZ (preset fuzz, clang) the program is a libFuzzer and its ctest entry runs it for
# OPMS_FUZZ_SECONDS from the corpus. Otherwise it replays the corpus as a plain test.
set(OPMS_FUZZ_SECONDS 20 CACHE STRING "Seconds for which ctest runs each fuzz target")

function(opms_add_fuzzer name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "LIBS;CORPUS")
    add_executable(${name} ${arg_UNPARSED_ARGUMENTS})
    opms_target_defaults(${name})
    target_link_libraries(${name} PRIVATE ${arg_LIBS})
    if(OPMS_FUZZ)
        target_link_options(${name} PRIVATE -fsanitize=fuzzer)
        # libFuzzer writes what it learns into the first folder; the tree's corpus stays as it is.
        set(found ${CMAKE_CURRENT_BINARY_DIR}/${name}_found)
        file(MAKE_DIRECTORY ${found})
        add_test(NAME fuzz.${name} COMMAND ${name} -max_total_time=${OPMS_FUZZ_SECONDS}
            -timeout=20 -rss_limit_mb=2048 ${found} ${arg_CORPUS})
    else()
        target_sources(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests/fuzz/fuzz_replay.c)
        set(files)
        foreach(folder IN LISTS arg_CORPUS)
            file(GLOB more CONFIGURE_DEPENDS ${folder}/*)
            list(APPEND files ${more})
        endforeach()
        add_test(NAME fuzz.${name} COMMAND ${name} ${files})
    endif()
    set_tests_properties(fuzz.${name} PROPERTIES LABELS fuzz TIMEOUT 600)
endfunction()
