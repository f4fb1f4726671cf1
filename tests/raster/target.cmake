target_link_libraries(test_raster PRIVATE hwy::hwy)
# A C program for the C header.
enable_language(C)
target_sources(test_raster PRIVATE ${CMAKE_CURRENT_LIST_DIR}/occlusion_buffer_c.c)
