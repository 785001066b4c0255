# SPDX-License-Identifier: Apache-2.0
# Write the header that says from which commit this is built. Run at every build, so that it is
# right after a commit; the file changes only when what it says does.
#
#   cmake -DSOURCE_DIR=... -DOUTPUT=... -P build_version.cmake
find_program(GIT git)
string(REPEAT 0 20 hash)
set(modified true) # what cannot be told is not a commit
if(GIT)
    execute_process(COMMAND ${GIT} -C ${SOURCE_DIR} rev-parse HEAD
        OUTPUT_VARIABLE head OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE result)
    if(result EQUAL 0)
        string(SUBSTRING "${head}" 0 20 hash)
        # The firmware is made of these folders alone.
        execute_process(
            COMMAND ${GIT} -C ${SOURCE_DIR} status --porcelain --
                firmware libopms/src/wire libopms/include
            OUTPUT_VARIABLE changes ERROR_QUIET RESULT_VARIABLE result)
        if(result EQUAL 0 AND changes STREQUAL "")
            set(modified false)
        endif()
    endif()
endif()

set(text "/* SPDX-License-Identifier: Apache-2.0 */
/* Written by the build. */
#ifndef BUILD_VERSION_H
#define BUILD_VERSION_H

#define BUILD_GIT_HASH \"${hash}\"
#define BUILD_MODIFIED ${modified}

#endif
")
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "${text}" @ONLY)
