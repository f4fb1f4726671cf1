# For choosing SIMD targets.
target_link_libraries(test_geometry PRIVATE hwy::hwy)
# The reference of the principal components; the library itself does without.
find_package(Eigen3 REQUIRED NO_MODULE)
target_link_libraries(test_geometry PRIVATE Eigen3::Eigen)
