# SPDX-License-Identifier: Apache-2.0
# Write OUTPUT, a header with a sum over all sources of libopms in SOURCE_DIR: it tells whether two
# programs compute alike, with or without a version control system. Left alone where it is the same.
file(GLOB_RECURSE files RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/src/* ${SOURCE_DIR}/include/*
    ${SOURCE_DIR}/apriltag/*)
list(SORT files)
set(sums)
foreach(file IN LISTS files)
    file(SHA256 ${SOURCE_DIR}/${file} sum)
    string(APPEND sums "${file} ${sum}\n")
endforeach()
string(SHA256 whole "${sums}")
string(SUBSTRING ${whole} 0 16 whole)
set(content "#define OPMS_CODE_SUM \"${whole}\"\n")
set(old)
if(EXISTS ${OUTPUT})
    file(READ ${OUTPUT} old)
endif()
if(NOT content STREQUAL old)
    file(WRITE ${OUTPUT} "${content}")
endif()
