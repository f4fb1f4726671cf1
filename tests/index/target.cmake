# For choosing SIMD targets.
target_link_libraries(test_index PRIVATE hwy::hwy)
