# The rows of the parts that can be left out have pages as well.
if(TARGET sightline_gl)
  target_link_libraries(test_house PRIVATE sightline::gl)
  target_compile_definitions(test_house PRIVATE SIGHTLINE_HAS_GL)
endif()
