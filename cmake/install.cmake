# What is installed: headers, one static or shared library per component with its CMake targets, a pkg-config file, the
# tool, and the .deb packages made of them. Included after all targets exist.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(SIGHTLINE_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/sightline)
set(components sightline)
set(header_exclusions PATTERN oracle EXCLUDE PATTERN load EXCLUDE PATTERN save EXCLUDE)
install(DIRECTORY src/sightline DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
  FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h" ${header_exclusions})
if(SIGHTLINE_IO)
  list(APPEND components io)
  foreach(folder IN ITEMS load save)
    if(EXISTS ${PROJECT_SOURCE_DIR}/src/sightline/scene/${folder})
      install(DIRECTORY src/sightline/scene/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sightline/scene
        COMPONENT development FILES_MATCHING PATTERN "*.hpp")
    endif()
  endforeach()
endif()
if(SIGHTLINE_ORACLE)
  list(APPEND components oracle)
  install(DIRECTORY src/sightline/oracle DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sightline
    COMPONENT development FILES_MATCHING PATTERN "*.hpp")
endif()
if(SIGHTLINE_GL)
  list(APPEND components gl)
  install(DIRECTORY src/gl DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development FILES_MATCHING PATTERN "*.hpp")
endif()

# Each component has an export set of its own, so that a consumer of the core needs nothing of the others.
foreach(component IN LISTS components)
  set(target sightline)
  if(NOT component STREQUAL sightline)
    set(target sightline_${component})
  endif()
  install(TARGETS ${target} EXPORT sightline_${component}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT sightline_${component} FILE sightline-${component}-targets.cmake NAMESPACE sightline::
    DESTINATION ${SIGHTLINE_CMAKE_DIR} COMPONENT development)
endforeach()

configure_package_config_file(cmake/sightlineConfig.cmake.in sightlineConfig.cmake
  INSTALL_DESTINATION ${SIGHTLINE_CMAKE_DIR} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(sightlineConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sightlineConfig.cmake ${PROJECT_BINARY_DIR}/sightlineConfigVersion.cmake
  DESTINATION ${SIGHTLINE_CMAKE_DIR} COMPONENT development)

# A static library hands its own dependencies to whoever links it.
if(BUILD_SHARED_LIBS)
  set(SIGHTLINE_PC_REQUIRES "Requires: glm\nRequires.private: tbb libhwy")
else()
  set(SIGHTLINE_PC_REQUIRES "Requires: glm tbb libhwy")
endif()
file(RELATIVE_PATH SIGHTLINE_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(cmake/sightline.pc.in sightline.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/sightline.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

if(TARGET sightline_cli)
  install(TARGETS sightline_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tool)
  if(TARGET sightline_documents)
    set(documents ${PROJECT_BINARY_DIR}/apps/cli/documents)
    install(FILES ${documents}/sightline.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tool OPTIONAL)
    install(FILES ${documents}/sightline.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
      RENAME sightline COMPONENT tool OPTIONAL)
    install(FILES ${documents}/_sightline DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT tool OPTIONAL)
    install(FILES ${documents}/sightline.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
      COMPONENT tool OPTIONAL)
  endif()
endif()
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT tool)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libsightline-dev RENAME copyright
  COMPONENT development)

if(PROJECT_IS_TOP_LEVEL)
  set(CPACK_GENERATOR DEB)
  set(CPACK_PACKAGE_VENDOR sightline)
  set(CPACK_PACKAGE_CONTACT "sightline maintainers <sightline@localhost>")
  set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
  set(CPACK_DEB_COMPONENT_INSTALL ON)
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_STRIP_FILES ON)
  set(CPACK_COMPONENTS_ALL tool development)
  set(CPACK_DEBIAN_TOOL_PACKAGE_NAME sightline)
  set(CPACK_DEBIAN_TOOL_PACKAGE_SECTION graphics)
  set(CPACK_DEBIAN_TOOL_PACKAGE_SHLIBDEPS ON)
  set(CPACK_COMPONENT_TOOL_DESCRIPTION "What can be seen from here? The command line tool.")
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libsightline-dev)
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libglm-dev, libhwy-dev, libtbb-dev")
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS
    "libembree-dev, nlohmann-json3-dev, libtinyobjloader-dev, libdraco-dev, libmeshoptimizer-dev, libassimp-dev, libepoxy-dev, libegl-dev")
  set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "What can be seen from here? The library: headers and static libraries.")
  include(CPack)
endif()
