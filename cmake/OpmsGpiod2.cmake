# SPDX-License-Identifier: Apache-2.0
# opms_gpiod2: libgpiod 2, built from its sources for tests on systems that have version 1.
#
# LIBGPIOD2_DIR (variable or environment) may name a folder as fetch_libgpiod2.sh makes it;
# otherwise it is made in the build folder, once. Without it there is no such target.
set(LIBGPIOD2_DIR "$ENV{LIBGPIOD2_DIR}" CACHE PATH "Folder with libgpiod 2: lib, include, version")
set(opms_gpiod2_dir ${LIBGPIOD2_DIR})
if(NOT opms_gpiod2_dir)
    set(opms_gpiod2_dir ${PROJECT_BINARY_DIR}/libgpiod2)
    execute_process(COMMAND ${CMAKE_CURRENT_LIST_DIR}/fetch_libgpiod2.sh ${opms_gpiod2_dir}
        RESULT_VARIABLE opms_gpiod2_failed)
    if(opms_gpiod2_failed)
        message(WARNING "libgpiod 2 is missing: that side of opms siggen is not tested")
        return()
    endif()
endif()

file(READ ${opms_gpiod2_dir}/version opms_gpiod2_version)
string(STRIP "${opms_gpiod2_version}" opms_gpiod2_version)
add_library(opms_gpiod2 STATIC EXCLUDE_FROM_ALL
    ${opms_gpiod2_dir}/lib/chip-info.c
    ${opms_gpiod2_dir}/lib/chip.c
    ${opms_gpiod2_dir}/lib/edge-event.c
    ${opms_gpiod2_dir}/lib/info-event.c
    ${opms_gpiod2_dir}/lib/internal.c
    ${opms_gpiod2_dir}/lib/line-config.c
    ${opms_gpiod2_dir}/lib/line-info.c
    ${opms_gpiod2_dir}/lib/line-request.c
    ${opms_gpiod2_dir}/lib/line-settings.c
    ${opms_gpiod2_dir}/lib/misc.c
    ${opms_gpiod2_dir}/lib/request-config.c)
target_compile_definitions(opms_gpiod2 PRIVATE
    _GNU_SOURCE GPIOD_VERSION_STR="${opms_gpiod2_version}")
target_include_directories(opms_gpiod2 SYSTEM PUBLIC ${opms_gpiod2_dir}/include)
