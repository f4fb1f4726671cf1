# For choosing SIMD targets.
target_link_libraries(test_geometry PRIVATE hwy::hwy)
