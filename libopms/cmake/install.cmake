# SPDX-License-Identifier: Apache-2.0
# What an installed libopms consists of: libraries, headers, CMake package, pkg-config file. What
# programs need to run is the component `runtime`, with the program and its modules.
include(CMakePackageConfigHelpers)

set(opms_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/opms)

install(TARGETS opms opms_static EXPORT opmsTargets
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        COMPONENT runtime NAMELINK_COMPONENT Unspecified
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/opms DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
    FILES_MATCHING PATTERN "*.h")
install(EXPORT opmsTargets NAMESPACE opms:: DESTINATION ${opms_package_dir})

# A library of its own that needs libapriltag: an export set of its own.
if(TARGET opms_apriltag)
    set_target_properties(opms_apriltag PROPERTIES EXPORT_NAME apriltag)
    install(TARGETS opms_apriltag EXPORT opmsApriltagTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(DIRECTORY apriltag/include/opms DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.h")
    install(EXPORT opmsApriltagTargets NAMESPACE opms:: DESTINATION ${opms_package_dir})
endif()

# The same of opms::hid, which needs hidapi, and the rule that lets people open the box.
if(TARGET opms_hid)
    set(OPMS_UDEV_RULES_DIR lib/udev/rules.d CACHE STRING "Where udev rules are installed")
    set_target_properties(opms_hid PROPERTIES EXPORT_NAME hid)
    install(TARGETS opms_hid EXPORT opmsHidTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(DIRECTORY hid/include/opms DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.h")
    install(EXPORT opmsHidTargets NAMESPACE opms:: DESTINATION ${opms_package_dir})
    install(FILES hid/udev/70-opms-box.rules DESTINATION ${OPMS_UDEV_RULES_DIR} COMPONENT runtime)
endif()

configure_package_config_file(cmake/opmsConfig.cmake.in
    ${CMAKE_CURRENT_BINARY_DIR}/opmsConfig.cmake
    INSTALL_DESTINATION ${opms_package_dir})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/opmsConfigVersion.cmake
    COMPATIBILITY SameMajorVersion)
install(FILES
    ${CMAKE_CURRENT_BINARY_DIR}/opmsConfig.cmake
    ${CMAKE_CURRENT_BINARY_DIR}/opmsConfigVersion.cmake
    DESTINATION ${opms_package_dir})

# An absolute CMAKE_INSTALL_LIBDIR (as some distributions set it) must not get the prefix again.
foreach(dir LIBDIR INCLUDEDIR)
    set(opms_pc_${dir} "${CMAKE_INSTALL_${dir}}")
    cmake_path(IS_ABSOLUTE opms_pc_${dir} opms_pc_absolute)
    if(NOT opms_pc_absolute)
        set(opms_pc_${dir} "\${prefix}/${CMAKE_INSTALL_${dir}}")
    endif()
endforeach()
# The prefix is found from where the file lies, so that `cmake --install --prefix` is right, too.
file(RELATIVE_PATH opms_pc_up
    ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
configure_file(cmake/opms.pc.in ${CMAKE_CURRENT_BINARY_DIR}/opms.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/opms.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
