// bench_raster: the exact rasterisers beside OpenGL on llvmpipe (skipped loudly where there is no EGL), one core, then
// two; more than 400 lines because the four tasks share their contenders. Every picture is compared with its reference
// before anything is timed; exits 1 if one is wrong. Tasks: a million small triangles, layers that fill the image, 553
// million instanced triangles, decoding of compressed depth tiles. Contenders are interleaved; figures are medians.
// bench_raster triangles|layers|compression|instances runs one task.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "raster_gl/gl_target.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/depth_precision.hpp"
#include "sightline/raster/tile_codec.hpp"
#include "sightline/raster/tile_rasteriser.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/generate/raster_scenes.hpp"

namespace {

using namespace sightline;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Contender {
  std::string name;
  std::function<void()> draw;
  double pixels_or_triangles;
  std::vector<double> seconds{};
};

void time_all(std::vector<Contender>& contenders, int rounds, int threads, const char* unit, double reference_factor) {
  const ThreadLimit limit(threads);
  for (Contender& c : contenders) c.draw();
  for (int round = 0; round < rounds; ++round)
    for (Contender& c : contenders) {
      const double start = now();
      c.draw();
      c.seconds.push_back(now() - start);
    }
  const double reference = median(contenders.front().seconds);
  std::printf("%d thread(s)\n", threads);
  for (const Contender& c : contenders)
    std::printf("  %-34s %9.2f ms %10.1f M%s/s %8.2f x %s\n", c.name.c_str(), 1e3 * median(c.seconds),
                1e-6 * c.pixels_or_triangles / median(c.seconds), unit,
                reference_factor * reference / median(c.seconds), contenders.front().name.c_str());
}

std::vector<ObjectId> all_objects(const Scene& scene) {
  std::vector<ObjectId> ids(scene.objects().size());
  for (ObjectId i = 0; i < ids.size(); ++i) ids[i] = i;
  return ids;
}

/// Pixels where two images show different objects or depths that differ by more than a share of 1e-5.
std::size_t different(const Frame& a, const Frame& b, bool ids) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    const bool depth = std::abs(a.depth[i] - b.depth[i]) > 1e-5f * std::min(a.depth[i], b.depth[i]);
    count += depth || (ids && a.object[i] != b.object[i]) ? 1 : 0;
  }
  return count;
}

#ifdef SIGHTLINE_HAS_EPOXY
/// The scene in one vertex and index buffer, drawn depth only or with RGBA8 beside it.
class GlScene {
 public:
  GlScene(const Scene& scene, const View& view, bool colour = false) : view_(view) {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
    for (const Object& object : scene.objects()) {
      const Mesh& mesh = scene.meshes()[object.mesh];
      const auto base = static_cast<std::uint32_t>(positions.size());
      for (const glm::vec3& p : mesh.positions) positions.push_back(transform_point(object.transform, p));
      for (const glm::uvec3& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) indices.push_back(base + t[k]);
    }
    count_ = static_cast<GLsizei>(indices.size());
    const GLuint program = glCreateProgram();
    const auto attach = [&](GLenum kind, const char* text) {
      const GLuint id = glCreateShader(kind);
      glShaderSource(id, 1, &text, nullptr);
      glCompileShader(id);
      glAttachShader(program, id);
    };
    attach(GL_VERTEX_SHADER,
           "#version 330\nlayout(location=0) in vec3 p; uniform mat4 m; void main() { gl_Position = m * vec4(p, 1); }");
    attach(GL_FRAGMENT_SHADER, colour ? "#version 330\nout vec4 c; void main() { c = vec4(gl_FragCoord.z); }"
                                      : "#version 330\nvoid main() {}");
    glLinkProgram(program);
    glUseProgram(program);
    const glm::mat4 matrix(view_projection(view));
    glUniformMatrix4fv(glGetUniformLocation(program, "m"), 1, GL_FALSE, &matrix[0][0]);
    GLuint ids[4];
    glGenVertexArrays(1, ids);
    glBindVertexArray(ids[0]);
    glGenBuffers(2, ids + 1);
    glBindBuffer(GL_ARRAY_BUFFER, ids[1]);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(positions.size() * sizeof(glm::vec3)), positions.data(),
                 GL_STATIC_DRAW);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, ids[2]);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * 4), indices.data(), GL_STATIC_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
    GLuint buffer = 0, depth = 0;
    glGenFramebuffers(1, &buffer);
    glBindFramebuffer(GL_FRAMEBUFFER, buffer);
    glGenRenderbuffers(1, &depth);
    glBindRenderbuffer(GL_RENDERBUFFER, depth);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, view.width, view.height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
    if (colour) {
      GLuint image = 0;
      glGenRenderbuffers(1, &image);
      glBindRenderbuffer(GL_RENDERBUFFER, image);
      glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, view.width, view.height);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, image);
    }
    glDrawBuffer(colour ? GL_COLOR_ATTACHMENT0 : GL_NONE);
    glReadBuffer(GL_NONE);
    buffer_ = buffer;
    array_ = ids[0];
    program_ = program;
    glViewport(0, 0, view.width, view.height);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
  }
  void draw(bool cull) const {
    glBindFramebuffer(GL_FRAMEBUFFER, buffer_);
    glBindVertexArray(array_);
    glUseProgram(program_);
    cull ? glEnable(GL_CULL_FACE) : glDisable(GL_CULL_FACE);
    glClear(GL_DEPTH_BUFFER_BIT);
    glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
    glFinish();
  }
  /// Distances, rows from the top.
  [[nodiscard]] Frame read() const {
    Frame frame;
    frame.clear(view_.width, view_.height);
    std::vector<float> z(frame.depth.size());
    glReadPixels(0, 0, view_.width, view_.height, GL_DEPTH_COMPONENT, GL_FLOAT, z.data());
    for (int y = 0; y < view_.height; ++y)
      for (int x = 0; x < view_.width; ++x) {
        const double d = z[frame.index(x, view_.height - 1 - y)];
        if (d < 1.0)
          frame.depth[frame.index(x, y)] =
              static_cast<float>(view_.near * view_.far / (view_.far - d * (view_.far - view_.near)));
      }
    return frame;
  }

 private:
  View view_;
  GLsizei count_ = 0;
  GLuint buffer_ = 0, array_ = 0, program_ = 0;
};
#endif

int failures = 0;

void check(bool ok, const std::string& what) {
  std::printf("%s %s\n", ok ? "checked:" : "WRONG:", what.c_str());
  failures += ok ? 0 : 1;
}

void small_triangles(bool gl) {
  const SceneAndView task = spheres_and_floor();
  const raster::TileRasteriser rasteriser(task.scene);
  const std::vector<ObjectId> ids = all_objects(task.scene);
  const double triangles = static_cast<double>(task.scene.triangle_count());
  Frame reference, tiled, scratch;
  Counters counters;
  const IndexedScene indexed = index_scene(task.scene);
  make_renderer("zbuffer", indexed)->draw(task.view, VisibleSet::all(ids.size()), reference, counters);
  raster::TileStats stats;
  rasteriser.draw(task.view, ids, {}, tiled, stats);
  std::printf("\n== small triangles: %.0f triangles, depth complexity %.2f\n", triangles,
              static_cast<double>(stats.work.tested) / static_cast<double>(reference.depth.size()));
  check(different(reference, tiled, true) * 10000 <= reference.depth.size(),
        "zbuffer_tiled against zbuffer: " + std::to_string(different(reference, tiled, true)) + " pixels differ");
  const auto ours = [&](raster::TileSettings settings) {
    return [&, settings] {
      raster::TileStats unused;
      rasteriser.draw(task.view, ids, settings, scratch, unused);
    };
  };
  raster::TileSettings depth, culled, scalar, hierarchical;
  depth.ids = culled.ids = scalar.ids = hierarchical.ids = false;
  culled.cull_back = scalar.scalar = hierarchical.hierarchical = true;
  for (const auto& settings : {depth, scalar, hierarchical}) {
    ours(settings)();
    check(different(tiled, scratch, false) == 0, "depth only equals the image with ids");
  }
  std::vector<Contender> contenders;
#ifdef SIGHTLINE_HAS_EPOXY
  std::unique_ptr<GlScene> theirs;
  if (gl) {
    theirs = std::make_unique<GlScene>(task.scene, task.view);
    theirs->draw(false);
    const Frame image = theirs->read();
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < image.depth.size(); ++i)
      wrong +=
          std::isinf(image.depth[i]) != std::isinf(tiled.depth[i]) || std::abs(image.depth[i] - tiled.depth[i]) > 0.02f
              ? 1
              : 0;
    check(wrong * 200 <= image.depth.size(), "llvmpipe draws the same: " + std::to_string(wrong) +
                                                 " pixels differ by more than 2 cm (it snaps vertices to 1/256 pixel)");
    contenders.push_back({"llvmpipe", [&] { theirs->draw(false); }, triangles});
    contenders.push_back({"llvmpipe, back faces culled", [&] { theirs->draw(true); }, triangles});
  }
#endif
  contenders.push_back({"zbuffer_tiled", ours(depth), triangles});
  contenders.push_back({"zbuffer_tiled, back faces culled", ours(culled), triangles});
  contenders.push_back({"zbuffer_tiled, scalar loops", ours(scalar), triangles});
  contenders.push_back({"zbuffer_tiled, with ids", ours({}), triangles});
  contenders.push_back({"hzb", ours(hierarchical), triangles});
  time_all(contenders, 9, 1, "triangles", 1.0);
  std::vector<Contender> scaling{{"zbuffer_tiled", ours(depth), triangles},
                                 {"zbuffer_tiled, back faces culled", ours(culled), triangles}};
  const double one = median((contenders.end() - 5)->seconds);
  time_all(scaling, 9, 2, "triangles", 1.0);
  std::printf("  two threads against one: %.2f x\n", one / median(scaling[0].seconds));
}

Scene stack_of_layers(int count, bool near_first) {
  SceneBuilder builder;
  Mesh stack{"stack", {}, {}, false, {}};
  for (int i = 0; i < count; ++i) {
    const auto base = static_cast<std::uint32_t>(stack.positions.size());
    const float z = -10.0f - 0.05f * static_cast<float>(near_first ? i : count - 1 - i);
    for (const glm::vec2 corner : {glm::vec2(-40, -40), glm::vec2(40, -40), glm::vec2(40, 40), glm::vec2(-40, 40)})
      stack.positions.emplace_back(corner.x, corner.y, z);
    stack.triangles.push_back({base, base + 1, base + 2});
    stack.triangles.push_back({base, base + 2, base + 3});
  }
  const MeshId mesh = builder.add_mesh(stack);
  builder.add_object(mesh, identity_affine());
  return builder.build();
}

void layers(bool gl) {
  constexpr int count = 200;
  const SceneAndView task = full_screen_layers(count);
  const raster::TileRasteriser rasteriser(task.scene);
  std::vector<ObjectId> back_to_front = all_objects(task.scene);
  const double pixels = static_cast<double>(count) * task.view.width * task.view.height;
  Frame reference, scratch;
  Counters counters;
  const IndexedScene indexed = index_scene(task.scene);
  make_renderer("zbuffer", indexed)->draw(task.view, VisibleSet::all(back_to_front.size()), reference, counters);
  std::printf("\n== %d layers that fill the image\n", count);
  raster::TileSettings plain, hierarchical;
  plain.ids = hierarchical.ids = false;
  hierarchical.hierarchical = true;
  const auto ours = [&](raster::TileSettings settings) {
    return [&, settings] {
      raster::TileStats unused;
      rasteriser.draw(task.view, back_to_front, settings, scratch, unused);
    };
  };
  for (const auto& settings : {plain, hierarchical}) {
    ours(settings)();
    check(different(reference, scratch, false) == 0, "layers against zbuffer");
  }
  // Tile by tile, not object by object: as many layers as one cluster takes, near ones first or far ones first.
  constexpr int stacked = raster::cluster_vertices / 4;
  const Scene near_first = stack_of_layers(stacked, true), far_first = stack_of_layers(stacked, false);
  const raster::TileRasteriser near_rasteriser(near_first), far_rasteriser(far_first);
  const std::vector<ObjectId> only{0};
  Frame stack_reference;
  raster::TileStats stats, all_written;
  near_rasteriser.draw(task.view, only, plain, stack_reference, stats);
  stats = {};
  near_rasteriser.draw(task.view, only, hierarchical, scratch, stats);
  check(different(stack_reference, scratch, false) == 0, "layers in one cluster, near ones first");
  far_rasteriser.draw(task.view, only, hierarchical, scratch, all_written);
  check(different(stack_reference, scratch, false) == 0, "layers in one cluster, far ones first");
  check(all_written.work.tiles_rejected == 0, "far ones first: nothing is rejected");
  std::printf("in one cluster: near ones first %llu tiles filled, %llu rejected; far ones first %llu and %llu\n",
              static_cast<unsigned long long>(stats.work.tiles_filled),
              static_cast<unsigned long long>(stats.work.tiles_rejected),
              static_cast<unsigned long long>(all_written.work.tiles_filled),
              static_cast<unsigned long long>(all_written.work.tiles_rejected));
  const double stack_pixels = static_cast<double>(stacked) * task.view.width * task.view.height;
  std::vector<Contender> contenders;
#ifdef SIGHTLINE_HAS_EPOXY
  std::unique_ptr<GlScene> theirs, with_colour;
  if (gl) {
    theirs = std::make_unique<GlScene>(task.scene, task.view);
    with_colour = std::make_unique<GlScene>(task.scene, task.view, true);
    contenders.push_back({"llvmpipe, all written", [&] { theirs->draw(false); }, pixels});
    contenders.push_back({"llvmpipe, z and RGBA8 written", [&] { with_colour->draw(false); }, pixels});
  }
#endif
  contenders.push_back({"zbuffer_tiled, all written", ours(plain), pixels});
  contenders.push_back({"zbuffer_tiled, z and ids written", ours({}), pixels});
  contenders.push_back({"hzb, sorted by itself", ours(hierarchical), pixels});
  const auto drawn_by = [&](const raster::TileRasteriser& stack) {
    return [&] {
      raster::TileStats unused;
      stack.draw(task.view, only, hierarchical, scratch, unused);
    };
  };
  contenders.push_back({"hzb, rejected tile by tile", drawn_by(near_rasteriser), stack_pixels});
  contenders.push_back({"hzb, all written", drawn_by(far_rasteriser), stack_pixels});
  time_all(contenders, 7, 1, "pixels", 1.0);
}

void instanced() {
  const SceneAndView task = instanced_spheres(36);
  const raster::TileRasteriser rasteriser(task.scene);
  const std::vector<ObjectId> ids = all_objects(task.scene);
  Frame image, again;
  raster::TileSettings settings;
  settings.hierarchical = true;
  raster::TileStats stats;
  rasteriser.draw(task.view, ids, settings, image, stats);
  std::size_t covered = 0;
  for (const ObjectId id : image.object) covered += id != no_object ? 1 : 0;
  std::printf("\n== instances: %.1f M triangles, %zu objects; %zu pixels covered\n",
              1e-6 * static_cast<double>(task.scene.triangle_count()), ids.size(), covered);
  std::printf("drawn %.2f M triangles; %.3f depth writes per covered pixel\n",
              1e-6 * static_cast<double>(stats.triangles_in),
              static_cast<double>(stats.work.written) / static_cast<double>(covered));
  {
    const ThreadLimit limit(2);
    raster::TileStats plain;
    const double start = now();
    rasteriser.draw(task.view, ids, {}, again, plain);
    std::printf("plain z-buffer: %.2f s on two threads, %.3f depth writes per covered pixel\n", now() - start,
                static_cast<double>(plain.work.written) / static_cast<double>(covered));
    check(different(image, again, true) == 0, "hzb against the plain z-buffer");
  }
  for (const int threads : {1, 2}) {
    std::vector<Contender> contenders{{"hzb",
                                       [&] {
                                         raster::TileStats unused;
                                         rasteriser.draw(task.view, ids, settings, again, unused);
                                       },
                                       static_cast<double>(task.scene.triangle_count())}};
    time_all(contenders, 3, threads, "triangles", 1.0);
  }
}

/// The depth tiles of an image that are not cleared, as codes of 24 bits.
std::vector<raster::DepthTile> depth_tiles(const SceneAndView& task, std::size_t& cleared) {
  const raster::TileRasteriser rasteriser(task.scene);
  Frame frame;
  raster::TileStats stats;
  rasteriser.draw(task.view, all_objects(task.scene), {}, frame, stats);
  std::vector<raster::DepthTile> tiles;
  for (int y = 0; y + 8 <= frame.height; y += 8)
    for (int x = 0; x + 8 <= frame.width; x += 8) {
      raster::DepthTile tile;
      bool empty = true;
      for (int i = 0; i < 64; ++i) {
        const double d = frame.depth[frame.index(x + i % 8, y + i / 8)];
        empty = empty && std::isinf(d);
        const double z = std::isinf(d) ? 1.0 : raster::window_depth(d, task.view.near, task.view.far);
        tile[static_cast<std::size_t>(i)] = raster::depth_code(raster::DepthFormat::unorm24, z);
      }
      cleared += empty ? 1 : 0;
      if (!empty) tiles.push_back(tile);
    }
  return tiles;
}

void compression(const char* name, const SceneAndView& task) {
  std::size_t bytes = 0, modes[raster::tile_modes] = {}, first = 0, second = 0, cleared = 0;
  const std::vector<raster::DepthTile> tiles = depth_tiles(task, cleared);
  std::vector<raster::PackedTile> packed;
  for (const raster::DepthTile& tile : tiles) {
    packed.push_back(raster::encode_tile(tile));
    bytes += packed.back().size;
    ++modes[static_cast<std::size_t>(packed.back().mode)];
    first += raster::dpcm_first_order_bytes(tile);
    second += raster::dpcm_second_order_bytes(tile);
  }
  std::vector<raster::DepthTile> decoded(tiles.size());
  raster::decode_tiles(packed.data(), packed.size(), decoded.data());
  bool lossless = decoded == tiles;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    raster::DepthTile one, scalar;
    raster::decode_tile(packed[i], one);
    raster::decode_tile_scalar(packed[i], scalar);
    lossless = lossless && one == tiles[i] && scalar == tiles[i];
  }
  const double raw = static_cast<double>(tiles.size() * raster::raw_tile_bytes);
  std::printf("\n== compression of %s: %zu tiles that are not cleared (%zu are), 24 bits\n", name, tiles.size(),
              cleared);
  check(lossless, "decoded tiles equal the originals");
  std::printf(
      "ratio %.2f:1 (first-order DPCM %.2f, second-order DPCM %.2f); plane %zu, two planes %zu, second order %zu and "
      "turned %zu, mixed %zu, raw %zu\n",
      raw / static_cast<double>(bytes), raw / static_cast<double>(first), raw / static_cast<double>(second), modes[0],
      modes[1], modes[2], modes[3], modes[4], modes[5]);
  std::uint32_t sum = 0;
  const auto one_by_one = [&](auto decode) {
    return [&, decode] {
      raster::DepthTile tile;
      for (const raster::PackedTile& p : packed) {
        decode(p, tile);
        sum += tile[63];
      }
    };
  };
  constexpr std::size_t together = 64;  // tiles: what they decode to fits the first-level cache
  const auto in_blocks = [&] {
    raster::DepthTile block[together];
    for (std::size_t i = 0; i < packed.size(); i += together) {
      const std::size_t count = std::min(together, packed.size() - i);
      raster::decode_tiles(packed.data() + i, count, block);
      for (std::size_t k = 0; k < count; ++k) sum += block[k][63];
    }
  };
  const double pixels = 64.0 * static_cast<double>(packed.size());
  std::vector<Contender> contenders{{"scalar decoder", one_by_one(raster::decode_tile_scalar), pixels},
                                    {"SIMD decoder, tile by tile", one_by_one(raster::decode_tile), pixels},
                                    {"SIMD decoder, 64 tiles at once", in_blocks, pixels}};
  time_all(contenders, 51, 1, "pixels", 1.0);
  std::printf("  (checksum %u)\n", sum);
}

void compression() {
  compression("spheres of small triangles", spheres_and_floor());
  SceneAndView city{generate_scene("city", {.objects = 4000, .triangles = 0, .seed = 1}),
                    look_along({20, 40, 20}, {1, -0.35, 0.8})};
  city.view.far = 1000;
  compression("a city", city);
}

}  // namespace

int main(int count, char** arguments) {
  const std::string only = count > 1 && arguments[1][0] != '-' ? arguments[1] : "";
  std::printf("SIMD target %s\n", raster::TileRasteriser::target());
  bool gl = false;
#ifdef SIGHTLINE_HAS_EPOXY
  std::string reason;
  const auto context = raster::GlContext::make(reason);
  gl = context != nullptr;
  std::printf("%s\n", gl ? raster::GlContext::renderer().c_str() : ("OPENGL SKIPPED: " + reason).c_str());
#else
  std::printf("OPENGL SKIPPED: built without libepoxy\n");
#endif
  if (only.empty() || only == "triangles") small_triangles(gl);
  if (only.empty() || only == "layers") layers(gl);
  if (only.empty() || only == "compression") compression();
  if (only.empty() || only == "instances") instanced();
  return failures > 0 ? 1 : 0;
}
