// Walks: a grid of free space (path/free_space.hpp), the largest region that can be walked in, ways between far places
// of it, smoothed. Scenes that one cannot walk in are flown through, or circled if there is nothing but closed objects.
#include "sightline/scene/camera_path.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/path/smooth_way.hpp"
#include "sightline/scene/path/walk_graph.hpp"

namespace sightline {
namespace {

constexpr double eye_height = 1.7;     // metres above the floor, where the scene is large enough for people
constexpr double people_scale = 3.0;   // metres; scenes smaller than this are models
constexpr double walking_step = 0.14;  // metres from frame to frame: 1.4 m/s at ten frames a second

struct SceneScale {
  double size;    // largest extent
  double eye;     // eye height
  double median;  // diagonal of an ordinary object
  bool all_closed;
};

SceneScale measure(const Scene& scene) {
  const glm::dvec3 extent(scene.bounds().extent());
  SceneScale scale{};
  scale.size = std::max({extent.x, extent.y, extent.z});
  scale.eye = scale.size >= people_scale ? eye_height : 0.1 * scale.size;
  std::vector<double> diagonals;
  const std::span<const Object> objects = scene.objects();
  for (std::size_t i = 0; i < objects.size(); i += 1 + objects.size() / 4096)
    if (!objects[i].bounds.empty()) diagonals.push_back(glm::length(glm::dvec3(objects[i].bounds.extent())));
  std::nth_element(diagonals.begin(), diagonals.begin() + static_cast<std::ptrdiff_t>(diagonals.size() / 2),
                   diagonals.end());
  scale.median = diagonals[diagonals.size() / 2];
  scale.all_closed =
      std::all_of(objects.begin(), objects.end(), [&](const Object& o) { return scene.meshes()[o.mesh].closed; });
  return scale;
}

View view_at(const View& prototype, const glm::dvec3& eye, const glm::dvec3& direction) {
  View view = prototype;
  const View aimed = look_along(eye, direction);
  view.eye = aimed.eye;
  view.orientation = aimed.orientation;
  return view;
}

// Turns a direction by a yaw about the vertical axis and then raises it, both in turns.
glm::dvec3 sway(const glm::dvec3& direction, double yaw, double rise) {
  const glm::dvec2 c = circle_point(yaw);
  const glm::dvec3 turned(direction.x * c.x + direction.z * c.y, direction.y, direction.z * c.x - direction.x * c.y);
  const double flat = std::sqrt(turned.x * turned.x + turned.z * turned.z);
  return {turned.x, turned.y + flat * circle_point(rise).y, turned.z};
}

double sine(double turns) { return circle_point(turns).y; }

struct Region {
  FreeSpace space;
  WalkGraph graph;
};

// Whether most objects start near the lowest level of the scene, as houses on a plain that has no ground of its own do.
bool stands_on_base(const Scene& scene, const SceneScale& scale) {
  const double base = scene.bounds().lo.y + std::max(2.0 * scale.eye, 0.02 * scene.bounds().extent().y);
  std::size_t standing = 0;
  for (const Object& object : scene.objects()) standing += object.bounds.lo.y <= base ? 1 : 0;
  return 2 * standing > scene.objects().size();
}

std::optional<Region> find_region(const Scene& scene, const SceneScale& scale, std::uint64_t seed) {
  FreeSpaceConfig config;
  config.seed = seed;
  config.margin_side = std::max(0.02 * scale.size, std::min(2.0 * scale.eye, scale.size));
  config.margin_top = 2.0 * scale.eye;
  if (scale.size >= people_scale) {
    config.finest = std::min(0.25, scale.size / 24);
    config.coarsest = std::clamp(0.12 * scale.median, 0.25, 4.0);
  } else {
    config.finest = scale.size / 64;
  }
  Region region{FreeSpace(scene, config), WalkGraph()};
  const auto columns =
      static_cast<std::size_t>(region.space.size().x) * static_cast<std::size_t>(region.space.size().z);
  WalkGraph walk(scene, region.space, Gait::walk, scale.eye);
  // A room or a long walk, not the top of one box in the air.
  const bool roomy = walk.columns() >= 40 && walk.extent() >= 1.5 * scale.eye &&
                     (walk.columns() >= columns / 25 || walk.extent() >= 6 * scale.eye);
  if (stands_on_base(scene, scale) && scene.objects().size() > 4 && walk.columns() < columns / 10) {
    WalkGraph ground(scene, region.space, Gait::ground, scale.eye);
    if (ground.columns() > 4 * walk.columns()) {
      region.graph = std::move(ground);
      return region;
    }
  }
  if (roomy) {
    region.graph = std::move(walk);
    return region;
  }
  config.cells = 200'000;
  config.finest = 0.0;
  config.margin_side = config.margin_top = 0.1 * scale.size;
  region.space = FreeSpace(scene, config);
  region.graph = WalkGraph(scene, region.space, Gait::fly, scale.eye);
  if (region.graph.size() < 200) return std::nullopt;
  return region;
}

// Ways from far place to far place until they are long enough together.
std::vector<glm::dvec3> wander(const WalkGraph& graph, double wanted, Random& random) {
  const std::vector<std::uint32_t> goals = graph.goals();
  const auto any = [&] { return goals[random.below(static_cast<std::uint32_t>(goals.size()))]; };
  std::uint32_t here = any();
  std::vector<glm::dvec3> points;
  double length = 0.0;
  const int most_legs = static_cast<int>(std::clamp(8'000'000.0 / static_cast<double>(graph.size()), 4.0, 200.0));
  for (int leg = 0; leg < most_legs && length < wanted; ++leg) {
    std::uint32_t there = here;
    double farthest = -1.0;
    for (int k = 0; k < 6; ++k) {
      const std::uint32_t place = any();
      const double distance = glm::length(graph.position(place) - graph.position(here));
      if (distance > farthest) farthest = distance, there = place;
    }
    const std::vector<glm::dvec3> way = graph.way(here, there);
    for (std::size_t i = points.empty() ? 0 : 1; i < way.size(); ++i) {
      if (!points.empty()) length += glm::length(way[i] - points.back());
      points.push_back(way[i]);
    }
    here = there;
  }
  return points;
}

CameraPath walk(const Region& region, const SceneScale& scale, const PathConfig& config) {
  Random random(config.seed, 5);
  const double extent = std::max(region.graph.extent(), region.space.cell());
  const double frames = std::max(config.frames - 1, 1);
  // Few frames should still see different places, many should not race.
  double step = std::max(scale.size >= people_scale ? walking_step : 0.0, extent / 250);
  step = std::max(step, 0.3 * extent / frames);
  const Trail trail(smooth_way(region.space, wander(region.graph, step * frames, random), 60));
  step = std::min(step, trail.length() / frames);
  const double ahead = std::max({5 * region.space.cell(), 1.2 * scale.eye, 2 * step});
  const double phases[4] = {random.uniform(), random.uniform(), random.uniform(), random.uniform()};
  CameraPath path;
  glm::dvec3 direction(0, 0, -1);
  for (int i = 0; i < config.frames; ++i) {
    const double s = i * step;
    const glm::dvec3 eye = trail.at(s);
    // The mean of two points ahead turns sooner and more softly than one.
    glm::dvec3 towards = 0.5 * (trail.at(s + ahead) + trail.at(s + 0.4 * ahead)) - eye;
    towards.y *= 0.6;
    if (glm::length(glm::dvec3(towards.x, 0, towards.z)) > 0.02 * ahead) direction = towards;
    const double t = s / (12 * ahead);
    const double yaw = 0.06 * sine(t + phases[0]) + 0.03 * sine(2.7 * t + phases[1]);
    const double rise = 0.012 * sine(1.6 * t + phases[2]) + 0.008 * sine(4.1 * t + phases[3]) - 0.008;
    path.views.push_back(view_at(config.prototype, eye, sway(direction, yaw, rise)));
  }
  return path;
}

// Around the scene, nearer and farther, higher and lower, looking at its middle.
CameraPath circle(const Scene& scene, const PathConfig& config) {
  Random random(config.seed, 6);
  const glm::dvec3 centre(scene.bounds().centre());
  const double radius = std::max(0.5 * glm::length(glm::dvec3(scene.bounds().extent())), 1e-6);
  const double nearest = std::max(1.1 * radius, radius + 2 * config.prototype.near);
  const double phases[3] = {random.uniform(), random.uniform(), random.uniform()};
  CameraPath path;
  for (int i = 0; i < config.frames; ++i) {
    const double t = static_cast<double>(i) / std::max(config.frames, 120) * 1.25;
    const glm::dvec2 around = circle_point(t + phases[0]);
    const glm::dvec2 above = circle_point(0.02 + 0.11 * sine(1.7 * t + phases[1]));
    const double distance = nearest * (1.45 + 0.45 * sine(2.3 * t + phases[2]));
    const glm::dvec3 eye = centre + distance * glm::dvec3(around.x * above.x, above.y, around.y * above.x);
    path.views.push_back(view_at(config.prototype, eye, sway(centre - eye, 0.01 * sine(3.1 * t + phases[1]), 0.0)));
  }
  return path;
}

}  // namespace

CameraPath generate_path(const Scene& scene, const PathConfig& config) {
  if (config.frames < 1) throw InputError("a camera path needs at least one frame");
  check_view(config.prototype);
  if (scene.triangle_count() == 0) throw InputError("there is no way through a scene without triangles");
  const SceneScale scale = measure(scene);
  if (scale.all_closed && scene.objects().size() <= 4) return circle(scene, config);
  const std::optional<Region> region = find_region(scene, scale, config.seed);
  return region ? walk(*region, scale, config) : circle(scene, config);
}

}  // namespace sightline
