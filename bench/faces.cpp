// The back-face family on scan meshes, one core: normal masks against the dot product (scalar and SIMD), hierarchical
// clusters against the SIMD test and libmeshoptimizer's cones of the same clusters, and boxes in clip space against
// frustum_linear's loop. What is timed is checked first: no triangle that faces the eye is lost.
#include <meshoptimizer.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "sightline/geometry/clip_boxes.hpp"
#include "sightline/geometry/cluster_tree.hpp"
#include "sightline/geometry/face_planes.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/load/load.hpp"
#include "sightline/scene/mesh_eye.hpp"

using namespace sightline;

namespace {

constexpr std::size_t checked_views = 2;  // of each scene; the timed ones are more

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

struct Contender {
  std::string name;
  std::function<void(std::size_t)> run;  // one view
  double found = 0.0;                    // share of the back faces
  std::vector<double> seconds{};
};

/// Times all contenders interleaved, view by view; medians over rounds of the sum over views.
void time_all(std::vector<Contender>& contenders, std::size_t views, int rounds) {
  for (int round = 0; round < rounds; ++round)
    for (Contender& c : contenders) {
      const double start = cpu_seconds();
      for (std::size_t v = 0; v < views; ++v) c.run(v);
      c.seconds.push_back((cpu_seconds() - start) / static_cast<double>(views));
    }
}

/// The three scans, or bumpy balls where they are missing.
std::vector<Mesh> curvy_meshes() {
  std::vector<Mesh> meshes;
  const std::filesystem::path folder =
      std::filesystem::path(SIGHTLINE_SOURCE_DIR) / ".." / "shared" / "scenes" / "scan-meshes";
  if (std::filesystem::is_directory(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.path().extension() == ".glb") {
        const LoadedScene loaded = load_scene(entry.path());
        for (const Mesh& mesh : loaded.scene.meshes()) meshes.push_back(mesh);
      }
  if (!meshes.empty()) return meshes;
  std::fprintf(stderr, "bench_faces: no scan-meshes beside the checkout, bumpy balls instead\n");
  for (int i = 0; i < 3; ++i) {
    Mesh ball = make_ball(320, 156);
    for (glm::vec3& p : ball.positions)
      p *= 1.0f + 0.15f * std::sin(5.0f * p.x + static_cast<float>(i)) * std::sin(6.0f * p.y) * std::sin(7.0f * p.z);
    meshes.push_back(ball);
  }
  return meshes;
}

/// `copies` of each mesh, unit sized, in a row; each a mesh of its own, so that no two share memory.
Scene row_of(const std::vector<Mesh>& meshes, int copies) {
  SceneBuilder builder;
  float x = 0.0f;
  for (const Mesh& source : meshes) {
    Mesh mesh = source;
    Aabb box;
    for (const glm::vec3& p : mesh.positions) box.extend(p);
    const float scale = 1.0f / glm::length(box.extent());
    for (glm::vec3& p : mesh.positions) p = (p - box.centre()) * scale;
    for (int i = 0; i < copies; ++i) {
      builder.add_object(builder.add_mesh(mesh), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {x, 0, 0}});
      x += 1.0f;
    }
  }
  return builder.build();
}

/// Views from all around, everything in the image.
std::vector<View> views_of(const Scene& scene, std::size_t count) {
  Random random(7);
  std::vector<View> views;
  const double size = glm::length(glm::dvec3(scene.bounds().extent()));
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 direction = random.direction();
    View view = look_along(glm::dvec3(scene.bounds().centre()) - 1.15 * size * direction, direction);
    view.far = 4.0 * size;
    view.width = view.height = 720;
    views.push_back(view);
  }
  return views;
}

/// Which triangles of an object face the eye and which turn their backs, in doubles: the truth.
struct Sides {
  std::vector<char> front;
  std::size_t back = 0;
};
Sides sides_of(const Scene& scene, ObjectId id, const View& view) {
  const Mesh& mesh = scene.mesh_of(id);
  Sides sides;
  for (const glm::uvec3& t : mesh.triangles) {
    glm::dvec3 p[3];
    for (int k = 0; k < 3; ++k) p[k] = glm::dvec3(transform_point(scene.objects()[id].transform, mesh.positions[t[k]]));
    const double side = glm::dot(glm::cross(p[1] - p[0], p[2] - p[0]), view.eye - p[0]);
    sides.front.push_back(side > 0.0 ? 1 : 0);
    sides.back += side < 0.0 ? 1 : 0;
  }
  return sides;
}

/// Share of the back faces that a culler finds; exits if it loses a front face.
double check(FaceCuller& culler, const std::string& name, const Scene& scene, const std::vector<View>& views) {
  std::size_t back = 0, culled = 0;
  for (const View& view : std::span(views).first(checked_views)) {
    FaceSet kept;
    Counters counters;
    culler.cull(view, VisibleSet::all(scene.objects().size()), kept, counters);
    for (const FaceSet::Part& part : kept.parts()) {
      const Sides sides = sides_of(scene, part.object, view);
      const auto order = culler.order(scene.objects()[part.object].mesh);
      back += sides.back;
      for (std::size_t place = 0; place < part.triangles; ++place) {
        if (kept.contains(part, place)) continue;
        ++culled;
        if (sides.front[order.empty() ? place : order[place]] == 0) continue;
        std::fprintf(stderr, "bench_faces: %s culls a front face\n", name.c_str());
        std::exit(1);
      }
    }
  }
  return static_cast<double>(culled) / static_cast<double>(std::max<std::size_t>(back, 1));
}

void masks_against_dot_products(const std::vector<Mesh>& meshes) {
  const Scene scene = row_of(meshes, 1);
  const IndexedScene indexed = index_scene(scene);
  const std::vector<View> views = views_of(scene, 12);
  const VisibleSet all = VisibleSet::all(scene.objects().size());
  std::vector<std::unique_ptr<FaceCuller>> cullers;
  std::vector<Contender> contenders;
  std::vector<FaceSet> kept(16);
  Counters counters;
  for (const char* method : {"backface:scalar=on", "backface", "normal_mask:scalar=on", "normal_mask",
                             "normal_mask:sectors=4", "cluster_backface"}) {
    cullers.push_back(make_face_culler(method, indexed));
    FaceCuller* culler = cullers.back().get();
    FaceSet* set = &kept[contenders.size()];
    contenders.push_back({method, [&, culler, set](std::size_t v) { culler->cull(views[v], all, *set, counters); }});
    contenders.back().found = check(*culler, method, scene, views);
  }
  time_all(contenders, views.size(), 15);
  const double scalar = median(contenders[0].seconds), simd = median(contenders[1].seconds);
  std::printf("%llu triangles in %zu meshes, %zu views, decided one by one, one thread\n",
              static_cast<unsigned long long>(scene.triangle_count()), scene.meshes().size(), views.size());
  std::printf("%-24s %9s %12s %14s %12s %9s\n", "", "ms", "ns/triangle", "x scalar dot", "x SIMD dot", "found %");
  for (const Contender& c : contenders) {
    const double t = median(c.seconds);
    std::printf("%-24s %9.4f %12.3f %14.2f %12.2f %9.1f\n", c.name.c_str(), 1e3 * t,
                1e9 * t / static_cast<double>(scene.triangle_count()), scalar / t, simd / t, 100.0 * c.found);
  }
  std::printf(
      "(wanted: normal_mask at least 3 x scalar, 1.3 x SIMD; the slides' 1.5 x of 1997 was a frame rate against "
      "OpenGL's back-face culling)\n\n");
}

/// libmeshoptimizer's cone of each leaf cluster, as arrays: what its documentation tests.
struct Cones {
  std::vector<float> x, y, z, ax, ay, az, cutoff;
  std::vector<std::uint32_t> begin, end;
};

Cones cones_of(const Mesh& mesh, const ClusterTree& tree) {
  Cones cones;
  for (const ClusterRange& range : leaf_clusters(tree)) {
    for (std::uint32_t first = range.begin; first < range.end; first += 512) {  // it takes no more at once
      const std::uint32_t last = std::min(range.end, first + 512);
      std::vector<unsigned int> indices;
      for (std::uint32_t i = first; i < last; ++i)
        for (int k = 0; k < 3; ++k) indices.push_back(mesh.triangles[tree.order[i]][k]);
      const meshopt_Bounds b = meshopt_computeClusterBounds(indices.data(), indices.size(), &mesh.positions[0].x,
                                                            mesh.positions.size(), sizeof(glm::vec3));
      cones.x.push_back(b.cone_apex[0]);
      cones.y.push_back(b.cone_apex[1]);
      cones.z.push_back(b.cone_apex[2]);
      cones.ax.push_back(b.cone_axis[0]);
      cones.ay.push_back(b.cone_axis[1]);
      cones.az.push_back(b.cone_axis[2]);
      cones.cutoff.push_back(b.cone_cutoff);
      cones.begin.push_back(first);
      cones.end.push_back(last);
    }
  }
  return cones;
}

/// dot(normalize(apex - eye), axis) >= cutoff: culled. Branch-free first, so that the compiler makes it SIMD.
std::size_t cull_cones(const Cones& cones, const glm::vec3& eye, std::vector<char>& culled,
                       std::span<std::uint64_t> kept) {
  const std::size_t count = cones.x.size();
  culled.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = cones.x[i] - eye.x, dy = cones.y[i] - eye.y, dz = cones.z[i] - eye.z;
    culled[i] = dx * cones.ax[i] + dy * cones.ay[i] + dz * cones.az[i] >=
                        cones.cutoff[i] * std::sqrt(dx * dx + dy * dy + dz * dz)
                    ? 1
                    : 0;
  }
  std::size_t triangles = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t keep = std::uint64_t{culled[i] != 0} - 1;
    for (std::size_t w = cones.begin[i] / 64; w < (cones.end[i] + 63) / 64; ++w) kept[w] = keep;
    triangles += culled[i] != 0 ? cones.end[i] - cones.begin[i] : 0;
  }
  if (cones.end.back() % 64 != 0) kept[cones.end.back() / 64] &= (std::uint64_t{1} << (cones.end.back() % 64)) - 1;
  return triangles;
}

void clusters_against_all(const std::vector<Mesh>& meshes) {
  const Scene scene = row_of(meshes, 4);
  const IndexedScene indexed = index_scene(scene);
  const std::vector<View> views = views_of(scene, 12);
  const VisibleSet all = VisibleSet::all(scene.objects().size());
  Counters counters;
  std::vector<FaceSet> kept(16);
  std::vector<Contender> contenders;
  std::vector<std::unique_ptr<FaceCuller>> cullers;
  std::vector<std::vector<Cones>> cones;  // of each leaf size, of each mesh
  std::vector<char> scratch;
  double back = 0.0;
  for (const View& view : std::span(views).first(checked_views))
    for (ObjectId id = 0; id < scene.objects().size(); ++id)
      back += static_cast<double>(sides_of(scene, id, view).back);
  const auto add = [&](const std::string& method) {
    cullers.push_back(make_face_culler(method, indexed));
    FaceCuller* culler = cullers.back().get();
    FaceSet* set = &kept[contenders.size()];
    contenders.push_back({method, [&, culler, set](std::size_t v) { culler->cull(views[v], all, *set, counters); }});
    contenders.back().found = check(*culler, method, scene, views);
  };
  add("backface");
  const std::vector<int> leaves{64, 128, 256, 512};
  cones.reserve(leaves.size());
  for (const int leaf : leaves) {
    ClusterTreeConfig config;
    config.leaf = leaf;
    config.cost_test = 1.0;
    add("cluster_backface:cost=1:leaf=" + std::to_string(leaf));
    std::vector<Cones>& of_mesh = cones.emplace_back();
    for (const Mesh& mesh : scene.meshes())
      of_mesh.push_back(
          cones_of(mesh, build_cluster_tree(mesh.positions, mesh.triangles, mesh.bounds.centre(), config)));
    FaceSet* set = &kept[contenders.size()];
    const auto run = [&, set, list = &of_mesh](std::size_t v) {
      set->clear();
      std::size_t culled = 0;
      for (ObjectId id = 0; id < scene.objects().size(); ++id) {
        const Object& object = scene.objects()[id];
        const MeshEye eye = mesh_eye(views[v], object, scene.mesh_of(id));  // relative to the centre of the bounds
        culled += cull_cones((*list)[object.mesh], glm::vec3(eye.eye) + scene.mesh_of(id).bounds.centre(), scratch,
                             set->add(id, scene.mesh_of(id).triangles.size(), false));
      }
      return culled;
    };
    double found = 0.0;
    for (std::size_t v = 0; v < checked_views; ++v) found += static_cast<double>(run(v));
    contenders.push_back({"  the same clusters, cones", [run](std::size_t v) { run(v); }, found / back});
  }
  time_all(contenders, views.size(), 15);
  const double simd = median(contenders[0].seconds);
  std::printf("%llu triangles, %zu objects, %zu views, one thread\n%-36s %9s %12s %9s\n",
              static_cast<unsigned long long>(scene.triangle_count()), scene.objects().size(), views.size(), "", "ms",
              "x SIMD dot", "found %");
  for (const Contender& c : contenders)
    std::printf("%-36s %9.4f %12.2f %9.1f\n", c.name.c_str(), 1e3 * median(c.seconds), simd / median(c.seconds),
                100.0 * c.found);
  std::printf("(wanted: at least 20 x with 60 %% found; no more time and no fewer found than the cones)\n\n");
}

void boxes_in_clip_space_against_planes() {
  Random random(1);
  std::vector<Aabb> list;
  for (int i = 0; i < 1000000; ++i) {
    const glm::vec3 at(random.range(-1000, 1000), random.range(-1000, 1000), random.range(-1000, 1000));
    list.push_back({at - 1.0f, at + 1.0f});
  }
  const BoxArrays boxes(list);
  View view = look_along({0, 0, 0}, {1, 0.1, 0.2});
  view.far = 2000;
  const Frustum frustum = view_frustum(view, 1001);
  const glm::dmat4 to_clip = view_projection(view);
  std::vector<std::uint32_t> planes(list.size() + 64), clip(list.size() + 64);
  const auto by_corners = [&] {
    return static_cast<std::size_t>(std::count_if(list.begin(), list.end(), [&](const Aabb& box) {
      return classify_in_clip_space(box, to_clip) != Containment::outside;
    }));
  };
  std::size_t both = by_corners();
  std::vector<Contender> contenders{
      {"planes, one by one", [&](std::size_t) { boxes_in_frustum_scalar(boxes, frustum, planes.data()); }},
      {"planes, SIMD (frustum_linear)", [&](std::size_t) { boxes_in_frustum(boxes, frustum, planes.data()); }},
      {"clip space, by eight corners", [&](std::size_t) { both = by_corners(); }},
      {"clip space, SIMD", [&](std::size_t) { boxes_in_clip_space(boxes, to_clip, 1001, clip.data()); }}};
  const std::size_t by_planes = boxes_in_frustum(boxes, frustum, planes.data()),
                    by_clip = boxes_in_clip_space(boxes, to_clip, 1001, clip.data());
  if (by_planes < both || by_clip < both || by_clip > both + both / 100) {
    std::fprintf(stderr, "bench_faces: the box tests disagree: %zu, %zu, %zu\n", by_planes, by_clip, both);
    std::exit(1);
  }
  time_all(contenders, 1, 25);
  const double reference = median(contenders[1].seconds);
  std::printf("1 M boxes, %zu in view by planes, %zu in clip space, %zu by their corners, one thread\n", by_planes,
              by_clip, both);
  for (const Contender& c : contenders)
    std::printf("%-32s %9.3f ms %8.2f x frustum_linear's loop\n", c.name.c_str(), 1e3 * median(c.seconds),
                median(c.seconds) / reference);
  std::printf("(wanted: at most 1.2 x)\n");
}

}  // namespace

int main() {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const ThreadLimit one(1);
  const std::vector<Mesh> meshes = curvy_meshes();
  masks_against_dot_products(meshes);
  clusters_against_all(meshes);
  boxes_in_clip_space_against_planes();
  return 0;
}
