// Principal components: against Eigen, against clouds whose axes are known, and on degenerate clouds.
#include "sightline/geometry/pca.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "properties.hpp"
#include "sightline/scene/generate/random.hpp"

namespace sightline {
namespace {

/// A box-shaped cloud with half extents `size`, turned by `rotation`, around `centre`.
std::vector<glm::vec3> cloud(const glm::dvec3& size, const glm::dquat& rotation, const glm::dvec3& centre, int n,
                             std::uint64_t seed) {
  Random random(seed);
  std::vector<glm::vec3> points;
  for (int i = 0; i < n; ++i)
    points.emplace_back(centre +
                        rotation * (size * glm::dvec3(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1))));
  return points;
}

Eigen::MatrixXd covariance(std::span<const double> rows, Eigen::Index m) {
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> x(
      rows.data(), static_cast<Eigen::Index>(rows.size()) / m, m);
  const Eigen::MatrixXd y = x.rowwise() - x.colwise().mean();
  return y.transpose() * y / static_cast<double>(x.rows() - 1);
}

void expect_right_handed(const PrincipalAxes& axes) {
  const glm::dmat3 product = glm::transpose(axes.axes) * axes.axes;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(product[i][j], i == j ? 1.0 : 0.0, 1e-12);
  EXPECT_NEAR(glm::determinant(axes.axes), 1.0, 1e-12);
  EXPECT_GE(axes.variances.x, axes.variances.y);  // descending, E34
  EXPECT_GE(axes.variances.y, axes.variances.z);
  EXPECT_GE(axes.variances.z, 0.0);
}

TEST(Pca, AxesOfATurnedBoxAreFound) {
  const glm::dquat rotation = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, 3)));
  const PrincipalAxes axes = principal_axes(cloud({5, 2, 0.5}, rotation, {100, -20, 3}, 200000, 1));
  expect_right_handed(axes);
  EXPECT_LT(glm::length(axes.mean - glm::dvec3(100, -20, 3)), 0.03);
  for (int i = 0; i < 3; ++i) {
    glm::dvec3 unit(0.0);
    unit[i] = 1.0;
    EXPECT_GT(std::abs(glm::dot(axes.axes[i], rotation * unit)), 0.9999);
  }
  // A uniform cloud of half extent e has variance e^2 / 3: the extent goes with the root of the variance (E33), not
  // with the variance as the slide has it.
  const glm::dvec3 extent = glm::sqrt(3.0 * axes.variances);
  EXPECT_NEAR(extent.x, 5, 0.03);
  EXPECT_NEAR(extent.y, 2, 0.02);
  EXPECT_NEAR(extent.z, 0.5, 0.01);
  EXPECT_NEAR(axes.variances.x / axes.variances.z, 100.0, 2.0);
}

TEST(Pca, DegenerateCloudsHaveDefinedAxes) {
  const PrincipalAxes none = principal_axes(std::span<const glm::vec3>());
  EXPECT_EQ(none.axes, glm::dmat3(1.0));
  EXPECT_EQ(none.variances, glm::dvec3(0.0));
  const std::vector<glm::vec3> same(7, glm::vec3(1e6f, -3, 0.1f));
  for (const std::size_t n : {std::size_t{1}, std::size_t{7}}) {
    const PrincipalAxes axes = principal_axes(std::span(same).first(n));
    EXPECT_EQ(axes.mean, glm::dvec3(same[0]));
    EXPECT_EQ(axes.variances, glm::dvec3(0.0));
    expect_right_handed(axes);
  }
  std::vector<glm::vec3> line, plane;
  for (int i = 0; i < 50; ++i) {
    line.emplace_back(1 + 2 * i, 3 - i, 2 * i);
    plane.emplace_back(i % 7, i % 5, 0);
  }
  const PrincipalAxes along = principal_axes(line), flat = principal_axes(plane);
  EXPECT_NEAR(std::abs(glm::dot(along.axes[0], glm::normalize(glm::dvec3(2, -1, 2)))), 1.0, 1e-12);
  EXPECT_NEAR(along.variances.y, 0.0, 1e-9);
  EXPECT_NEAR(std::abs(flat.axes[2].z), 1.0, 1e-12);
  EXPECT_EQ(flat.variances.z, 0.0);  // a component of no variance shows what the points have in common (15.23)
  expect_right_handed(along);
  expect_right_handed(flat);
}

TEST(Pca, FarFromTheOriginDigitsRemain) {
  const glm::dquat rotation = glm::angleAxis(0.3, glm::dvec3(0, 1, 0));
  const PrincipalAxes axes = principal_axes(cloud({8, 4, 2}, rotation, {1e6, 1e6, -1e6}, 20000, 3));
  EXPECT_GT(std::abs(glm::dot(axes.axes[0], rotation * glm::dvec3(1, 0, 0))), 0.999);
  expect_right_handed(axes);
}

RC_GTEST_PROP(PcaProperty, AgreesWithEigen, ()) {
  const auto m = static_cast<std::size_t>(*rc::gen::inRange(1, 9));
  const auto n = static_cast<std::size_t>(*rc::gen::inRange(2, 40));
  std::vector<double> rows;
  for (std::size_t i = 0; i < n * m; ++i) rows.push_back(properties::number(-10, 10) * (i % m == 0 ? 1e3 : 1.0));
  const PrincipalComponents ours = principal_components(rows, m);
  const Eigen::MatrixXd c = covariance(rows, static_cast<Eigen::Index>(m));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(c);
  const double scale = c.norm() + 1e-30;
  for (std::size_t i = 0; i < m; ++i) {
    const auto index = static_cast<Eigen::Index>(m - 1 - i);  // Eigen's values ascend
    RC_ASSERT(std::abs(ours.variances[i] - std::max(0.0, solver.eigenvalues()[index])) <= 1e-11 * scale);
    if (i > 0) RC_ASSERT(ours.variances[i] <= ours.variances[i - 1]);  // RC_ASSERT evaluates both sides of an ||
    // C e = lambda e holds for every component, also where equal values leave the choice of vectors open.
    const Eigen::Map<const Eigen::VectorXd> e(ours.component(i).data(), static_cast<Eigen::Index>(m));
    RC_ASSERT((c * e - ours.variances[i] * e).norm() <= 1e-10 * scale);
    for (std::size_t j = 0; j <= i; ++j) {
      const Eigen::Map<const Eigen::VectorXd> f(ours.component(j).data(), static_cast<Eigen::Index>(m));
      RC_ASSERT(std::abs(e.dot(f) - (i == j ? 1.0 : 0.0)) <= 1e-11);  // U^T U = I
    }
  }
}

RC_GTEST_PROP(PcaProperty, ThreeFeaturesAreTheAxes, ()) {
  const auto points =
      cloud({properties::number(0, 9), properties::number(0, 9), properties::number(0, 9)}, properties::rotation(),
            properties::point(100), *rc::gen::inRange(2, 60), *rc::gen::arbitrary<std::uint64_t>());
  std::vector<double> rows;
  for (const glm::vec3& p : points) rows.insert(rows.end(), {p.x, p.y, p.z});
  const PrincipalAxes axes = principal_axes(points);
  const PrincipalComponents general = principal_components(rows, 3);
  for (std::size_t i = 0; i < 3; ++i)
    RC_ASSERT(std::abs(general.variances[i] - axes.variances[static_cast<int>(i)]) <=
              1e-10 * (1e-6 + general.variances[0]));
  RC_ASSERT(std::abs(glm::determinant(axes.axes) - 1.0) < 1e-11);
}

TEST(Pca, FirstComponentsHoldMostAndTheProjectionDropsTheRest) {
  // Two hidden causes seen by six instruments, with a little noise (15.22, 15.23).
  Random random(5);
  std::vector<double> rows;
  for (int i = 0; i < 500; ++i) {
    const double u = random.range(-5, 5), v = random.range(-3, 3);
    for (int j = 0; j < 6; ++j) rows.push_back((j + 1) * u + (j % 2 == 0 ? 4 : -4) * v + random.range(-0.05, 0.05));
  }
  const PrincipalComponents pca = principal_components(rows, 6);
  EXPECT_GT(pca.explained(2), 0.9999);
  EXPECT_LT(pca.explained(1), 0.99);
  EXPECT_EQ(pca.explained(6), 1.0);
  const std::vector<double> two = pca.project(std::span<const double>(rows).first(6), 2);
  for (std::size_t j = 0; j < 6; ++j)
    EXPECT_NEAR(pca.mean[j] + two[0] * pca.component(0)[j] + two[1] * pca.component(1)[j], rows[j], 0.15);
}

TEST(Pca, DependsOnScaleAndOutliers) {  // the limits of 15.24
  std::vector<glm::vec3> points = cloud({2, 1, 0.1}, {1, 0, 0, 0}, {0, 0, 0}, 1000, 9);
  EXPECT_GT(std::abs(principal_axes(points).axes[0].x), 0.99);
  std::vector<glm::vec3> scaled = points;
  for (glm::vec3& p : scaled) p.z *= 1000;
  EXPECT_GT(std::abs(principal_axes(scaled).axes[0].z), 0.99);
  points.emplace_back(0, 1000, 0);
  EXPECT_GT(std::abs(principal_axes(points).axes[0].y), 0.99);
}

TEST(Pca, NoFeaturesAndNoSamples) {
  EXPECT_EQ(principal_components({}, 0).variances.size(), 0u);
  const PrincipalComponents empty = principal_components({}, 3);
  EXPECT_EQ(empty.variances, std::vector<double>(3, 0.0));
  EXPECT_EQ(empty.explained(1), 1.0);
}

}  // namespace
}  // namespace sightline
