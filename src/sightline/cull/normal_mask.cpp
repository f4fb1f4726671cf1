#include "sightline/cull/normal_mask.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "sightline/core/mesh_face_culler.hpp"
#include "sightline/geometry/face_planes.hpp"
#include "sightline/geometry/normal_mask.hpp"
#include "sightline/parallel/parallel.hpp"

namespace sightline {
namespace {

struct NormalMaskConfig {
  int n = 16;        // the direction cube has 6 n^2 classes, 1 to 18
  int sectors = 1;   // the image is cut into sectors^2 parts with one mask each, 1 to 16
  int chunk = 1024;  // triangles that are sent to one sector together, a multiple of 64
  bool scalar = false;
};

/// Triangles that lie together: a range of places, and their bounds in mesh space.
struct Chunk {
  std::uint32_t begin, end;
  Aabb bounds;
};

struct ClassifiedMesh {
  std::vector<std::uint8_t> byte_offset, bit_mask;  // by place, padded to a multiple of 64
  std::vector<std::uint32_t> order;                 // empty with one sector: the mesh's own order
  std::vector<Chunk> chunks;                        // one with one sector
  double height = 0.0;                              // no classified triangle has a lesser height
};

/// Splits triangles at the median of the longest side of their centres until a chunk holds at most `size`; all chunks
/// but the last begin and end at a multiple of 64.
void split(std::span<const glm::vec3> centres, std::vector<std::uint32_t>& order, std::uint32_t begin,
           std::uint32_t end, std::uint32_t size, std::vector<Chunk>& chunks) {
  if (end - begin <= size) {
    chunks.push_back({begin, end, {}});
    return;
  }
  Aabb box;
  for (std::uint32_t i = begin; i < end; ++i) box.extend(centres[order[i]]);
  const glm::vec3 e = box.extent();
  const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
  const std::uint32_t middle = begin + ((end - begin) / 2 + 63) / 64 * 64;
  std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     return centres[a][axis] != centres[b][axis] ? centres[a][axis] < centres[b][axis] : a < b;
                   });
  split(centres, order, begin, middle, size, chunks);
  split(centres, order, middle, end, size, chunks);
}

ClassifiedMesh classify_mesh(const Mesh& mesh, const DirectionCube& cube, const NormalMaskConfig& config) {
  ClassifiedMesh result;
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  result.chunks.push_back({0, count, {}});
  if (config.sectors > 1) {
    std::vector<glm::vec3> centres;
    for (const glm::uvec3& t : mesh.triangles)
      centres.push_back((mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0f);
    result.order.resize(count);
    std::iota(result.order.begin(), result.order.end(), 0u);
    result.chunks.clear();
    split(centres, result.order, 0, count, static_cast<std::uint32_t>(config.chunk), result.chunks);
  }
  std::vector<FacePlane> planes;
  std::vector<double> heights;
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::uvec3& t = mesh.triangles[result.order.empty() ? i : result.order[i]];
    planes.push_back(face_plane(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]));
    if (planes.back().height > 0.0) heights.push_back(planes.back().height);
  }
  // The thinnest twentieth, whose normals rounding moves most, is never culled, so that the others lose nothing by it.
  if (heights.empty()) return result;
  const auto thin = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 20);
  std::nth_element(heights.begin(), thin, heights.end());
  result.height = *thin;
  result.byte_offset.assign((planes.size() + 63) / 64 * 64, 0);
  result.bit_mask.assign(result.byte_offset.size(), 0);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!(planes[i].height >= result.height)) continue;
    const PolygonNormalMask bits = polygon_normal_mask(cube.class_of(planes[i].normal));
    result.byte_offset[i] = bits.byte_offset;
    result.bit_mask[i] = bits.bit_mask;
  }
  for (Chunk& chunk : result.chunks)
    for (std::uint32_t i = chunk.begin; i < chunk.end; ++i) {
      const glm::uvec3& t = mesh.triangles[result.order.empty() ? i : result.order[i]];
      for (int k = 0; k < 3; ++k) chunk.bounds.extend(mesh.positions[t[k]]);
    }
  return result;
}

class NormalMask final : public MeshFaceCuller {
 public:
  NormalMask(const Scene& scene, const NormalMaskConfig& config)
      : MeshFaceCuller(scene),
        config_(config),
        cube_(config.n),
        meshes_(scene.meshes().size()),
        masks_(static_cast<std::size_t>(config.sectors) * static_cast<std::size_t>(config.sectors)) {
    parallel_blocks(meshes_.size(), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (solidity(static_cast<MeshId>(i)) == Solidity::solid)
          meshes_[i] = classify_mesh(scene.meshes()[i], cube_, config_);
    });
  }

  [[nodiscard]] std::span<const std::uint32_t> order(MeshId mesh) const override { return meshes_[mesh].order; }

  [[nodiscard]] std::size_t bytes() const override {
    std::size_t total = 0;
    for (const ClassifiedMesh& mesh : meshes_)
      total +=
          2 * mesh.byte_offset.size() + sizeof(Chunk) * mesh.chunks.size() + sizeof(std::uint32_t) * mesh.order.size();
    return total;
  }

 private:
  void begin(const View& view) override {
    view_ = view;
    image_ = view_projection(view);
    directions_.clear();
    if (view.projection == Projection::orthographic) {
      directions_.push_back(view_direction(view));
      return;
    }
    for (int row = 0; row <= config_.sectors; ++row)
      for (int column = 0; column <= config_.sectors; ++column)
        directions_.push_back(pixel_ray(view, static_cast<double>(view.width) * column / config_.sectors,
                                        static_cast<double>(view.height) * row / config_.sectors)
                                  .direction);
  }

  std::size_t cull_mesh(const Object& object, const MeshEye& eye, std::span<std::uint64_t> kept,
                        Counters& counters) override {
    const ClassifiedMesh& mesh = meshes_[object.mesh];
    const std::size_t count = scene().meshes()[object.mesh].triangles.size();
    glm::dmat3 inverse;
    // An angle: what rounding of the corners does to a normal, and of the class borders.
    const double far = eye.eye.w > 0.0f ? glm::length(glm::dvec3(eye.eye)) : 1.0;
    const double margin = 4e-6 + (far > 0.0 && mesh.height > 0.0 ? angle_slack(object, mesh.height) : 2.0);
    if (mesh.bit_mask.empty() || margin >= 1.0 || !inverse_linear(object.transform, inverse)) {
      set_bits(kept, 0, count);
      return 0;
    }
    local_.clear();
    for (const glm::dvec3& direction : directions_) local_.emplace_back(glm::normalize(inverse * direction));
    margin_ = static_cast<float>(margin);
    made_.assign(masks_.size(), false);
    counters.faces_tested += count;
    std::size_t culled = 0;
    const glm::dmat4 to_image = image_ * to_matrix(object.transform);
    for (const Chunk& chunk : mesh.chunks) {
      BackMask mask;
      if (!mask_of(chunk, to_image, mask)) {
        set_bits(kept, chunk.begin, chunk.end);
        continue;
      }
      culled += (config_.scalar ? front_by_mask_scalar : front_by_mask)(
          mesh.byte_offset.data() + chunk.begin, mesh.bit_mask.data() + chunk.begin, chunk.end - chunk.begin, mask,
          kept.data() + chunk.begin / 64);
    }
    counters.clusters_tested += static_cast<std::uint64_t>(cube_.classes()) *
                                static_cast<std::uint64_t>(std::count(made_.begin(), made_.end(), true));
    return culled;
  }

  /// The mask of a sector, made when it is first asked for: most objects lie in few of them.
  const BackMask& mask_at(std::size_t x, std::size_t y) {
    const auto sectors = static_cast<std::size_t>(config_.sectors), at = y * sectors + x;
    if (!made_[at]) {
      made_[at] = true;
      const std::size_t corner = y * (sectors + 1) + x;
      const std::array<glm::vec3, 4> four{local_[corner], local_[corner + 1], local_[corner + sectors + 1],
                                          local_[corner + sectors + 2]};
      masks_[at] = back_mask(cube_, four, margin_);
    }
    return masks_[at];
  }

  /// How far a normal may turn when the corners of a triangle of this least height are rounded in world space.
  [[nodiscard]] double angle_slack(const Object& object, double height) const {
    View direction = view_;
    direction.projection = Projection::orthographic;  // there `sharpness` is an angle times a height
    return static_cast<double>(mesh_eye(direction, object, scene().meshes()[object.mesh]).sharpness) / height;
  }

  /// The mask for all sectors that a chunk may touch; false if it lies outside of the image, of which nothing is known.
  bool mask_of(const Chunk& chunk, const glm::dmat4& to_image, BackMask& mask) {
    if (local_.size() == 1) {
      if (!made_[0]) masks_[0] = back_mask(cube_, local_, margin_);
      made_[0] = true;
      mask = masks_[0];
      return true;
    }
    if (masks_.size() == 1) {
      mask = mask_at(0, 0);
      return true;
    }
    glm::dvec2 low(2.0), high(-2.0);
    const glm::dvec3 size = glm::dvec3(chunk.bounds.hi) - glm::dvec3(chunk.bounds.lo);
    const glm::dvec4 corner = to_image * glm::dvec4(glm::dvec3(chunk.bounds.lo), 1.0), along_x = to_image[0] * size.x,
                     along_y = to_image[1] * size.y, along_z = to_image[2] * size.z;
    for (int i = 0; i < 8; ++i) {
      const glm::dvec4 p = corner + static_cast<double>(i & 1) * along_x + static_cast<double>(i >> 1 & 1) * along_y +
                           static_cast<double>(i >> 2) * along_z;
      if (!(p.w > 1e-9 * (std::abs(p.x) + std::abs(p.y)))) {
        low = glm::dvec2(-1.0);
        high = glm::dvec2(1.0);
        break;
      }
      const glm::dvec2 at = glm::dvec2(p) * (1.0 / p.w);
      low = glm::min(low, at);
      high = glm::max(high, at);
    }
    constexpr double wide = 1e-4;  // a sector is shared by what lies at its border
    if (low.x > 1.0 || low.y > 1.0 || high.x < -1.0 || high.y < -1.0) return false;
    const int s = config_.sectors;
    const auto sector = [&](double ndc) {
      return std::clamp(static_cast<int>(std::floor(0.5 * (ndc + 1.0) * s)), 0, s - 1);
    };
    const int x0 = sector(low.x - wide), x1 = sector(high.x + wide);
    const int y0 = s - 1 - sector(high.y + wide), y1 = s - 1 - sector(low.y - wide);
    mask.fill(0xFF);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const BackMask& part = mask_at(static_cast<std::size_t>(x), static_cast<std::size_t>(y));
        for (std::size_t i = 0; i < mask.size(); ++i) mask[i] &= part[i];
      }
    return true;
  }

  NormalMaskConfig config_;
  DirectionCube cube_;
  std::vector<ClassifiedMesh> meshes_;
  View view_;
  glm::dmat4 image_{1.0};
  std::vector<glm::dvec3> directions_;  // world space, through the corners of the sectors
  std::vector<glm::vec3> local_;        // the same in the space of a mesh
  float margin_ = 0.0f;                 // of the mesh
  std::vector<BackMask> masks_;         // by sector
  std::vector<bool> made_;              // by sector, for the mesh
};

}  // namespace

std::unique_ptr<FaceCuller> make_normal_mask(const IndexedScene& scene, ParameterReader& parameters) {
  NormalMaskConfig config;
  parameters.read("n", config.n, 1, 18);
  parameters.read("sectors", config.sectors, 1, 16);
  parameters.read("chunk", config.chunk, 64, 1 << 20);
  parameters.read("scalar", config.scalar);
  parameters.finish();
  config.chunk = config.chunk / 64 * 64;
  return std::make_unique<NormalMask>(scene.scene, config);
}

}  // namespace sightline
