#include "sightline/geometry/pca.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace sightline {
namespace {

/// Cosine and sine of the rotation that makes entry (p, q) zero; the smaller of the two angles.
glm::dvec2 jacobi_rotation(double pp, double qq, double pq) {
  const double theta = (qq - pp) / (2.0 * pq);
  const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
  const double c = 1.0 / std::sqrt(t * t + 1.0);
  return {c, t * c};
}

/// a <- J^T a J for the rotation in the plane (p, q); a is full and symmetric. vectors hold eigenvectors as rows.
void rotate(std::vector<double>& a, std::vector<double>& vectors, std::size_t m, std::size_t p, std::size_t q) {
  const glm::dvec2 cs = jacobi_rotation(a[p * m + p], a[q * m + q], a[p * m + q]);
  for (std::size_t k = 0; k < m; ++k) {
    const double kp = a[k * m + p], kq = a[k * m + q];
    a[k * m + p] = cs.x * kp - cs.y * kq;
    a[k * m + q] = cs.y * kp + cs.x * kq;
  }
  for (std::size_t k = 0; k < m; ++k) {
    const double pk = a[p * m + k], qk = a[q * m + k];
    a[p * m + k] = cs.x * pk - cs.y * qk;
    a[q * m + k] = cs.y * pk + cs.x * qk;
    const double vp = vectors[p * m + k], vq = vectors[q * m + k];
    vectors[p * m + k] = cs.x * vp - cs.y * vq;
    vectors[q * m + k] = cs.y * vp + cs.x * vq;
  }
  a[p * m + q] = a[q * m + p] = 0.0;
}

/// Of the two directions of an eigenvector the one whose largest entry (the first of equal ones) is positive.
void fix_sign(std::span<double> v) {
  const auto larger = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto largest = std::max_element(v.begin(), v.end(), larger);
  if (largest != v.end() && *largest < 0.0)
    for (double& x : v) x = -x;
}

template <class Points>
PrincipalAxes axes_of(const Points& points) {
  PrincipalAxes result;
  if (points.empty()) return result;
  const double n = static_cast<double>(points.size());
  // Relative to the first point: the digits of a cloud far from the origin are not spent on its place.
  const glm::dvec3 anchor(points[0]);
  glm::dvec3 sum(0.0);
  for (const auto& p : points) sum += glm::dvec3(p) - anchor;
  const glm::dvec3 centre = sum / n;
  result.mean = anchor + centre;
  if (points.size() < 2) return result;
  double c[9] = {};
  for (const auto& p : points) {
    const glm::dvec3 d = glm::dvec3(p) - anchor - centre;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) c[3 * i + j] += d[i] * d[j];
  }
  for (double& entry : c) entry /= n - 1.0;
  const SymmetricEigen eigen = symmetric_eigen(c, 3);
  for (int i = 0; i < 3; ++i) {
    const std::size_t at = static_cast<std::size_t>(i);
    result.variances[i] = std::max(0.0, eigen.values[at]);
    result.axes[i] = {eigen.vectors[3 * at], eigen.vectors[3 * at + 1], eigen.vectors[3 * at + 2]};
  }
  result.axes[2] = glm::cross(result.axes[0], result.axes[1]);
  return result;
}

}  // namespace

SymmetricEigen symmetric_eigen(std::span<const double> matrix, std::size_t m) {
  assert(matrix.size() == m * m);
  std::vector<double> a(matrix.begin(), matrix.end()), vectors(m * m, 0.0);
  for (std::size_t i = 0; i < m; ++i) {
    vectors[i * m + i] = 1.0;
    for (std::size_t j = 0; j < i; ++j) a[i * m + j] = a[j * m + i];
  }
  // Convergence is quadratic: a handful of sweeps; the bound only guards against numbers that are not finite.
  for (int sweep = 0; sweep < 60; ++sweep) {
    bool changed = false;
    for (std::size_t p = 0; p < m; ++p)
      for (std::size_t q = p + 1; q < m; ++q) {
        const double off = std::abs(a[p * m + q]);
        if (!(off > 1e-17 * std::sqrt(std::abs(a[p * m + p])) * std::sqrt(std::abs(a[q * m + q])))) continue;
        const double diagonal = std::max(std::abs(a[p * m + p]), std::abs(a[q * m + q]));
        if (diagonal + 1e-3 * off == diagonal && sweep > 8) continue;
        rotate(a, vectors, m, p, q);
        changed = true;
      }
    if (!changed) break;
  }
  std::vector<std::size_t> order(m);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return a[i * m + i] > a[j * m + j]; });
  SymmetricEigen result;
  for (const std::size_t i : order) {
    result.values.push_back(a[i * m + i]);
    std::span<double> vector = std::span(vectors).subspan(i * m, m);
    fix_sign(vector);
    result.vectors.insert(result.vectors.end(), vector.begin(), vector.end());
  }
  return result;
}

PrincipalAxes principal_axes(std::span<const glm::vec3> points) { return axes_of(points); }
PrincipalAxes principal_axes(std::span<const glm::dvec3> points) { return axes_of(points); }

PrincipalComponents principal_components(std::span<const double> rows, std::size_t features) {
  assert(features == 0 ? rows.empty() : rows.size() % features == 0);
  const std::size_t m = features, n = m == 0 ? 0 : rows.size() / m;
  PrincipalComponents result;
  result.features = m;
  result.mean.assign(m, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < m; ++j) result.mean[j] += rows[i * m + j] - rows[j];
  for (std::size_t j = 0; j < m && n > 0; ++j) result.mean[j] = rows[j] + result.mean[j] / static_cast<double>(n);
  std::vector<double> covariance(m * m, 0.0), centred(m);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < m; ++j) centred[j] = rows[i * m + j] - result.mean[j];
    for (std::size_t j = 0; j < m; ++j)
      for (std::size_t k = j; k < m; ++k) covariance[j * m + k] += centred[j] * centred[k];
  }
  for (double& entry : covariance) entry /= n > 1 ? static_cast<double>(n - 1) : 1.0;
  SymmetricEigen eigen = symmetric_eigen(covariance, m);
  result.components = std::move(eigen.vectors);
  result.variances = std::move(eigen.values);
  for (double& variance : result.variances) variance = std::max(0.0, variance);
  return result;
}

double PrincipalComponents::explained(std::size_t count) const {
  const double all = std::accumulate(variances.begin(), variances.end(), 0.0);
  const auto end = variances.begin() + static_cast<std::ptrdiff_t>(std::min(count, features));
  return all > 0.0 ? std::accumulate(variances.begin(), end, 0.0) / all : 1.0;
}

std::vector<double> PrincipalComponents::project(std::span<const double> sample, std::size_t count) const {
  assert(sample.size() == features);
  std::vector<double> result;
  for (std::size_t i = 0; i < std::min(count, features); ++i) {
    const std::span<const double> axis = component(i);
    double dot = 0.0;
    for (std::size_t j = 0; j < features; ++j) dot += (sample[j] - mean[j]) * axis[j];
    result.push_back(dot);
  }
  return result;
}

}  // namespace sightline
