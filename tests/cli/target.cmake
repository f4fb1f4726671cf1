# The tests run the program itself and look into the library of its parts.
if(TARGET sightline_cli)
  add_dependencies(test_cli sightline_cli)
  target_link_libraries(test_cli PRIVATE sightline_verbs)
else()
  set_target_properties(test_cli PROPERTIES EXCLUDE_FROM_ALL ON)
endif()
target_link_libraries(test_cli PRIVATE util)
