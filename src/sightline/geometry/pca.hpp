// Principal component analysis: mean, orthogonal axes and variances of a point set (Pearson 1901, Hotelling 1933; also
// called KLT, EOF or POD; checklist 15.17-15.25 with E32-E34). Promise: variances descend, axes are orthonormal to
// rounding, and the same input gives the same bits.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace sightline {

/// The axes of a cloud of points. The extent along axis i grows with the root of variances[i], which is a square (E33).
struct PrincipalAxes {
  glm::dvec3 mean{0.0};
  /// Unit columns in the order of descending variance, right-handed; the identity where the points define none. Of the
  /// two directions of the first two axes, the one whose largest coordinate is positive.
  glm::dmat3 axes{1.0};
  /// Of the points along the axes, divided by n - 1; all 0 for fewer than two points.
  glm::dvec3 variances{0.0};
};

/// Points must be finite. O(n).
PrincipalAxes principal_axes(std::span<const glm::vec3> points);
PrincipalAxes principal_axes(std::span<const glm::dvec3> points);

/// The analysis of n samples of m features each (checklist 15.20).
struct PrincipalComponents {
  std::size_t features = 0;
  std::vector<double> mean;        // m
  std::vector<double> components;  // m x m, component i at [i * m, (i + 1) * m), unit length
  std::vector<double> variances;   // m, descending (E34), none negative

  [[nodiscard]] std::span<const double> component(std::size_t i) const {
    return std::span(components).subspan(i * features, features);
  }
  /// The share of all variance that the first `count` components hold, 0 to 1; 1 if there is no variance (15.23).
  [[nodiscard]] double explained(std::size_t count) const;
  /// Coordinates of one sample along the first `count` components, relative to the mean.
  [[nodiscard]] std::vector<double> project(std::span<const double> sample, std::size_t count) const;
};

/// `rows` holds the samples one after another, rows.size() == n * features; finite numbers, any n >= 0. Work is
/// O(n m^2 + m^3). The result depends on the scale of the features and on outliers (15.24): scale them before if they
/// have different units.
PrincipalComponents principal_components(std::span<const double> rows, std::size_t features);

/// Eigenvalues (descending) and unit eigenvectors (column i as vectors[i * m ..]) of a symmetric m x m matrix, by
/// cyclic Jacobi rotations (Jacobi 1846; Golub and Van Loan, 8.5). Only the upper triangle is read.
struct SymmetricEigen {
  std::vector<double> values, vectors;
};
SymmetricEigen symmetric_eigen(std::span<const double> matrix, std::size_t m);

}  // namespace sightline
