# The rows of the parts that can be left out have pages as well.
if(TARGET sightline_gl)
  target_link_libraries(test_house PRIVATE sightline::gl)
  target_compile_definitions(test_house PRIVATE SIGHTLINE_HAS_GL)
endif()

# All headers of the core in one source: a program may include any of them beside any other.
file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/src/sightline/*.hpp)
list(FILTER headers EXCLUDE REGEX "[.]inl[.]hpp$")
list(TRANSFORM headers REPLACE "(.+)" "#include \"\\1\"\n")
string(CONCAT headers ${headers})
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/all_headers.cpp CONTENT "${headers}" @ONLY)
target_sources(test_house PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/all_headers.cpp)
