# Without a viewer its tests do not exist.
if(TARGET sightline_viewer)
  target_link_libraries(test_viewer PRIVATE sightline_viewer)
endif()
