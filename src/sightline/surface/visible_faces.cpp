#include "sightline/surface/visible_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/surface/image_triangle.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t no_face = 0xFFFFFFFFu;
/// Relative difference of depth below which faces are at equal depth; a quarter of the oracle's error.
constexpr float depth_tie = 1e-6f;

/// All faces in world space, with shared vertices.
struct World {
  std::vector<glm::vec3> points;
  std::vector<glm::uvec3> faces;
  std::vector<std::uint8_t> opaque;  // by face
  bool any_glass = false;
};

World gather(const Scene& scene) {
  if (scene.triangle_count() >= no_face) throw InputError("the scene has too many faces to number them");
  World world;
  world.faces.reserve(scene.triangle_count());
  world.opaque.reserve(scene.triangle_count());
  for (const Object& object : scene.objects()) {
    const Mesh& mesh = scene.meshes()[object.mesh];
    if (world.points.size() + mesh.positions.size() >= no_face)
      throw InputError("the scene has too many vertices to number them");
    const auto base = static_cast<std::uint32_t>(world.points.size());
    for (const glm::vec3& p : mesh.positions) world.points.push_back(transform_point(object.transform, p));
    for (const glm::uvec3& t : mesh.triangles) world.faces.push_back(t + base);
    world.opaque.insert(world.opaque.end(), mesh.triangles.size(), object.opaque ? 1 : 0);
    world.any_glass |= !object.opaque && !mesh.triangles.empty();
  }
  return world;
}

struct Sample {
  float w;
  std::uint32_t face;
};

/// A point of a face in the image that asks whether anything lies before it.
struct Query {
  double x, y, w;
  std::uint32_t face;
  std::uint32_t next;  // of the same pixel
};

/// The work on one camera; memory is kept from camera to camera.
class CameraWork {
 public:
  CameraWork(const World& world, const VisibleFacesConfig& config) : world_(world), config_(config) {}

  CameraFaces look(const CalibratedCamera& camera) {
    camera_ = &camera;
    perspective_ = camera.projection == Projection::perspective;
    w_near_ = perspective_ ? 1.0 / camera.near : -camera.near;
    w_far_ = perspective_ ? 1.0 / camera.far : -camera.far;
    project();
    buffer_.assign(pixel_count(), {-std::numeric_limits<float>::max(), no_face});
    samples_.assign(world_.faces.size(), 0);
    seen_.assign(world_.faces.size(), 0);
    for (std::uint32_t face = 0; face < world_.faces.size(); ++face)
      if (world_.opaque[face] != 0)
        for_triangles(
            face, [&](const ImageBox& box, double nearest) { return may_be_drawn(box, nearest); },
            [&](const ImageTriangle& t) { draw(t, face); });
    for (const Sample& sample : buffer_)
      if (sample.face != no_face) ++samples_[sample.face];
    if (world_.any_glass)
      for (std::uint32_t face = 0; face < world_.faces.size(); ++face)
        if (world_.opaque[face] == 0) for_triangles(face, any_box, [&](const ImageTriangle& t) { count(t, face); });
    for (std::size_t face = 0; face < samples_.size(); ++face) seen_[face] = samples_[face] > 0 ? 1 : 0;
    if (config_.extra_points >= 1) ask(true);
    if (config_.extra_points >= 2) ask(false);
    return {samples_, seen_};
  }

 private:
  [[nodiscard]] std::size_t pixel_count() const {
    return static_cast<std::size_t>(camera_->width) * static_cast<std::size_t>(camera_->height);
  }

  [[nodiscard]] Corner corner(const glm::dvec3& p) const {
    if (!perspective_) return {camera_->cx + camera_->fx * p.x, camera_->cy + camera_->fy * p.y, -p.z};
    const double w = 1.0 / p.z;
    return {camera_->cx + camera_->fx * p.x * w, camera_->cy + camera_->fy * p.y * w, w};
  }

  void project() {
    points_.resize(world_.points.size());
    corners_.resize(world_.points.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      points_[i] = camera_->to_camera(glm::dvec3(world_.points[i]));
      corners_[i] = corner(points_[i]);
    }
  }

  static bool any_box(const ImageBox&, double) { return true; }

  /// Calls f with the image of the face, or of the parts of it beyond the near plane. Before the work of setting up
  /// triangles, wanted(their box, their nearest w) is asked where nothing is clipped: most faces end there.
  template <class Wanted, class F>
  void for_triangles(std::uint32_t face, Wanted&& wanted, F&& f) {
    const glm::uvec3& v = world_.faces[face];
    const std::array<std::uint32_t, 3> ids{v.x, v.y, v.z};
    int behind = 0;
    for (const std::uint32_t id : ids) behind += points_[id].z < camera_->near ? 1 : 0;
    if (behind == 3) return;
    ImageTriangle triangle;
    if (behind == 0) {
      const Corner &a = corners_[v.x], &b = corners_[v.y], &c = corners_[v.z];
      const ImageBox box = box_of(a, b, c);
      if (box.max_x < 0.0 || box.min_x > camera_->width || box.max_y < 0.0 || box.min_y > camera_->height) return;
      if (wanted(box, std::max({a.w, b.w, c.w})) && triangle.set(a, b, c)) f(triangle);
      return;
    }
    std::array<Corner, 4> kept{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3 &a = points_[ids[i]], &b = points_[ids[(i + 1) % 3]];
      const bool a_in = a.z >= camera_->near, b_in = b.z >= camera_->near;
      if (a_in) kept[n++] = corner(a);
      if (a_in == b_in) continue;
      const glm::dvec3 &in = a_in ? a : b, &out = a_in ? b : a;  // from the kept end on, as neighbours do
      glm::dvec3 p = in + (in.z - camera_->near) / (in.z - out.z) * (out - in);
      p.z = camera_->near;
      kept[n++] = corner(p);
    }
    for (std::size_t i = 2; i < n; ++i)
      if (triangle.set(kept[0], kept[i - 1], kept[i])) f(triangle);
  }

  /// Pixels whose centres lie in the box, and perhaps one more on a side.
  [[nodiscard]] PixelBox centres_in(const ImageBox& box) const {
    const auto first = [](double min, double size) {
      const double v = std::clamp(min - 0.5, 0.0, size);
      const int i = static_cast<int>(v);
      return i + (static_cast<double>(i) < v ? 1 : 0);
    };
    const auto last = [](double max, double size) {
      return static_cast<int>(std::clamp(max - 0.5, -1.0, size - 1.0) + 1.0) - 1;
    };
    return {first(box.min_x, camera_->width), last(box.max_x, camera_->width), first(box.min_y, camera_->height),
            last(box.max_y, camera_->height)};
  }
  /// Pixels that touch the box.
  [[nodiscard]] PixelBox pixels_of(const ImageBox& box) const {
    const auto pixel = [](double at, double size) { return static_cast<int>(std::clamp(at, 0.0, size - 1.0)); };
    return {pixel(box.min_x, camera_->width), pixel(box.max_x, camera_->width), pixel(box.min_y, camera_->height),
            pixel(box.max_y, camera_->height)};
  }
  /// Calls f(first, past the last) with the places of the pixels of each row until it returns true; whether it did.
  template <class F>
  bool any_row(const PixelBox& box, F&& f) const {
    for (int y = box.y0; y <= box.y1; ++y) {
      const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_->width);
      if (f(row + static_cast<std::size_t>(box.x0), row + static_cast<std::size_t>(box.x1) + 1)) return true;
    }
    return false;
  }

  static bool is_nearer(float w, const Sample& sample) { return w > sample.w + depth_tie * std::abs(sample.w); }

  /// False for triangles without a pixel centre and small ones behind all that is drawn where they are.
  [[nodiscard]] bool may_be_drawn(const ImageBox& box, double nearest) const {
    const PixelBox pixels = centres_in(box);
    if (pixels.empty()) return false;
    if (pixels.count() > small) return true;
    const auto w = static_cast<float>(nearest);
    return any_row(pixels, [&](std::size_t at, std::size_t end) {
      for (; at < end; ++at)
        if (is_nearer(w, buffer_[at])) return true;
      return false;
    });
  }

  /// Calls put(pixel, w) for the pixel centres in the triangle, between near and far.
  template <class Put>
  void scan(const ImageTriangle& t, Put&& put) const {
    const auto [x0, x1, y0, y1] = centres_in(box_of(t.c[0], t.c[1], t.c[2]));
    for (int y = y0; y <= y1; ++y) {
      const double py = y + 0.5;
      int left = x0, right = x1;
      if (x1 - x0 > 8) span_of(t, py, left, right);
      const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_->width);
      for (int x = left; x <= right; ++x) {
        const double px = x + 0.5;
        if (!t.covers(px, py)) continue;
        const double w = t.w_at(px, py);
        if (w <= w_near_ && w >= w_far_) put(row + static_cast<std::size_t>(x), w);
      }
    }
  }

  /// Narrows [left, right] to where the row can be covered; covers() decides at its ends.
  static void span_of(const ImageTriangle& t, double py, int& left, int& right) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double x = -(t.ey[i] * py + t.e0[i]) / t.ex[i] - 0.5;
      if (!(std::abs(x) < 1e8)) continue;
      if (t.ex[i] > 0.0)
        left = std::max(left, static_cast<int>(std::floor(x)));
      else
        right = std::min(right, static_cast<int>(std::ceil(x)));
    }
  }

  void draw(const ImageTriangle& t, std::uint32_t face) {
    scan(t, [&](std::size_t at, double w) {
      const auto near = static_cast<float>(w);
      Sample& sample = buffer_[at];
      // Nearer by more than rounding: of coplanar faces the lower one was first and stays.
      if (is_nearer(near, sample)) sample = {near, face};
    });
  }

  void count(const ImageTriangle& t, std::uint32_t face) {
    scan(t, [&](std::size_t at, double w) {
      if (static_cast<float>(w) > buffer_[at].w) ++samples_[face];
    });
  }

  /// The corners of the triangle clipped to the viewport.
  void clip_to_viewport(const ImageTriangle& t) {
    polygon_.assign(t.c.begin(), t.c.end());
    const ImageBox box = box_of(t.c[0], t.c[1], t.c[2]);
    if (box.min_x >= 0.0 && box.max_x <= camera_->width && box.min_y >= 0.0 && box.max_y <= camera_->height) return;
    const double limits[4] = {0.0, static_cast<double>(camera_->width), 0.0, static_cast<double>(camera_->height)};
    for (int side = 0; side < 4 && !polygon_.empty(); ++side) {
      const auto inside = [&](const Corner& c) {
        const double v = side < 2 ? c.x : c.y;
        return side % 2 == 0 ? v - limits[side] : limits[side] - v;
      };
      clipped_.clear();
      for (std::size_t i = 0; i < polygon_.size(); ++i) {
        const Corner &a = polygon_[i], &b = polygon_[(i + 1) % polygon_.size()];
        const double fa = inside(a), fb = inside(b);
        if (fa >= 0.0) clipped_.push_back(a);
        if ((fa >= 0.0) == (fb >= 0.0)) continue;
        const double s = fa / (fa - fb);
        clipped_.push_back({a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), 0.0});
      }
      polygon_.swap(clipped_);
    }
  }

  /// Asks for a point of a face, unless it is outside or one of the faces drawn around it hides it: with these, most
  /// points of hidden faces are done.
  void add_query(const ImageTriangle& t, double x, double y, std::uint32_t face) {
    if (!(x >= 0.0 && y >= 0.0 && x < camera_->width && y < camera_->height)) return;
    const Query query{x, y, t.w_at(x, y), face, no_face};
    if (!(query.w <= w_near_ && query.w >= w_far_) || hidden_by_neighbours(query)) return;
    const std::size_t at =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_->width) + static_cast<std::size_t>(x);
    queries_.push_back(query);
    queries_.back().next = heads_[at];
    heads_[at] = static_cast<std::uint32_t>(queries_.size() - 1);
  }

  [[nodiscard]] bool hidden_by_neighbours(const Query& query) const {
    const PixelBox around = pixels_of({query.x - 1.0, query.x + 1.0, query.y - 1.0, query.y + 1.0});
    const std::size_t own = static_cast<std::size_t>(query.y) * static_cast<std::size_t>(camera_->width) +
                            static_cast<std::size_t>(query.x);
    std::uint32_t tried = query.face;
    const auto hidden_by = [&](std::size_t at) {
      const std::uint32_t face = buffer_[at].face;
      if (face == no_face || face == tried) return false;
      tried = face;
      const glm::uvec3& v = world_.faces[face];
      if (points_[v.x].z < camera_->near || points_[v.y].z < camera_->near || points_[v.z].z < camera_->near)
        return false;
      ImageTriangle t;
      if (!t.set_edges(corners_[v.x], corners_[v.y], corners_[v.z]) || !t.covers(query.x, query.y)) return false;
      t.set_depth();
      return hides(t, face, query);
    };
    if (hidden_by(own)) return true;
    return any_row(around, [&](std::size_t at, std::size_t end) {
      for (; at < end; ++at)
        if (at != own && hidden_by(at)) return true;
      return false;
    });
  }

  /// Puts further points on the faces that nobody has seen yet, and lets every opaque face take away those behind it.
  void ask(bool middle) {
    heads_.assign(pixel_count(), no_face);
    queries_.clear();
    for (std::uint32_t face = 0; face < world_.faces.size(); ++face) {
      if (seen_[face] != 0) continue;
      for_triangles(face, any_box, [&](const ImageTriangle& t) {
        clip_to_viewport(t);
        if (polygon_.size() < 3) return;
        double x = 0.0, y = 0.0;
        for (const Corner& c : polygon_) {
          x += c.x;
          y += c.y;
        }
        x /= static_cast<double>(polygon_.size());
        y /= static_cast<double>(polygon_.size());
        if (middle) {
          add_query(t, x, y, face);
          return;
        }
        for (std::size_t i = 0; i < 3; ++i) {
          const Corner& c = polygon_[i * polygon_.size() / 3];
          add_query(t, x + 0.85 * (c.x - x), y + 0.85 * (c.y - y), face);
        }
      });
    }
    const auto meets_queries = [&](const ImageBox& box, double) {
      const PixelBox pixels = pixels_of(box);
      return pixels.count() > small || any_row(pixels, [&](std::size_t at, std::size_t end) {
               for (; at < end; ++at)
                 if (heads_[at] != no_face) return true;
               return false;
             });
    };
    for (std::uint32_t face = 0; face < world_.faces.size(); ++face)
      if (world_.opaque[face] != 0) for_triangles(face, meets_queries, [&](const ImageTriangle& t) { hide(t, face); });
    for (const std::uint32_t head : heads_)
      for (std::uint32_t q = head; q != no_face; q = queries_[q].next) seen_[queries_[q].face] = 1;
  }

  /// Takes the points that the triangle hides out of the lists of its pixels.
  void hide(const ImageTriangle& t, std::uint32_t face) {
    const ImageBox box = box_of(t.c[0], t.c[1], t.c[2]);
    if (box.max_x < 0.0 || box.max_y < 0.0 || box.min_x > camera_->width || box.min_y > camera_->height) return;
    (void)any_row(pixels_of(box), [&](std::size_t at, std::size_t end) {
      for (; at < end; ++at) {
        std::uint32_t* link = &heads_[at];
        while (*link != no_face) {
          Query& query = queries_[*link];
          if (hides(t, face, query))
            *link = query.next;
          else
            link = &query.next;
        }
      }
      return false;
    });
  }

  [[nodiscard]] bool hides(const ImageTriangle& t, std::uint32_t face, const Query& query) const {
    if (face == query.face || !t.covers(query.x, query.y)) return false;
    const double w = t.w_at(query.x, query.y);
    if (!(w <= w_near_ && w >= w_far_)) return false;
    const double tie = 1e-10 * (std::abs(w) + std::abs(query.w));
    return w > query.w + tie || (w >= query.w - tie && face < query.face && world_.opaque[query.face] != 0);
  }

  static constexpr int small = 16;  // pixels that are looked at before a triangle is set up

  const World& world_;
  const VisibleFacesConfig config_;
  const CalibratedCamera* camera_ = nullptr;
  bool perspective_ = true;
  double w_near_ = 0.0, w_far_ = 0.0;
  std::vector<glm::dvec3> points_;
  std::vector<Corner> corners_, polygon_, clipped_;
  std::vector<Sample> buffer_;
  std::vector<std::uint32_t> samples_, heads_;
  std::vector<std::uint8_t> seen_;
  std::vector<Query> queries_;
};

}  // namespace

void visible_faces(const Scene& scene, std::span<const CalibratedCamera> cameras, const VisibleFacesConfig& config,
                   const std::function<void(std::size_t, const CameraFaces&)>& done) {
  for (const CalibratedCamera& camera : cameras) check_camera(camera);
  const World world = gather(scene);
  // A few blocks for each thread: memory of a camera's work is kept within a block.
  const std::size_t block = std::max<std::size_t>(1, cameras.size() / (4 * static_cast<std::size_t>(thread_count())));
  parallel_blocks(cameras.size(), block, [&](std::size_t begin, std::size_t end) {
    CameraWork work(world, config);
    for (std::size_t i = begin; i < end; ++i) done(i, work.look(cameras[i]));
  });
}

std::vector<std::uint64_t> first_faces(const Scene& scene) {
  std::vector<std::uint64_t> first{0};
  for (const Object& object : scene.objects())
    first.push_back(first.back() + scene.meshes()[object.mesh].triangles.size());
  return first;
}

}  // namespace sightline
