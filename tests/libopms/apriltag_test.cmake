# SPDX-License-Identifier: Apache-2.0
# The test of opms::apriltag. Its pictures are drawn with libapriltag's table of codes.
if(NOT TARGET opms::apriltag)
    return()
endif()
opms_add_unity_test(test_apriltag
    ${CMAKE_CURRENT_LIST_DIR}/apriltag_scene.c
    ${CMAKE_CURRENT_LIST_DIR}/print_render.c
    ${CMAKE_CURRENT_LIST_DIR}/test_apriltag.c
    LIBS opms::apriltag opms_internal)
# The library's own sort of libapriltag (package file or pkg-config), with its headers.
get_target_property(opms_apriltag_libraries opms_apriltag LINK_LIBRARIES)
list(FILTER opms_apriltag_libraries INCLUDE REGEX apriltag)
target_link_libraries(test_apriltag PRIVATE ${opms_apriltag_libraries})
