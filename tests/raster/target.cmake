target_link_libraries(test_raster PRIVATE hwy::hwy)
