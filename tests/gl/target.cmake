# Only where the library is built.
if(TARGET sightline_gl)
  find_package(nlohmann_json REQUIRED)
  target_link_libraries(test_gl PRIVATE sightline::gl nlohmann_json::nlohmann_json)
else()
  set_target_properties(test_gl PROPERTIES EXCLUDE_FROM_ALL ON)
endif()
