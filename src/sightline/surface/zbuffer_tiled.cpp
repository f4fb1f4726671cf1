#include "sightline/surface/zbuffer_tiled.hpp"

#include "sightline/raster/tile_rasteriser.hpp"

namespace sightline {
namespace {

class TiledZBuffer final : public Renderer {
 public:
  TiledZBuffer(const Scene& scene, const raster::TileSettings& settings) : rasteriser_(scene), settings_(settings) {}

  void draw(const View& view, const VisibleSet& visible, Frame& frame, Counters& counters) override {
    raster::TileStats stats;
    stats.writes.swap(frame.writes);
    rasteriser_.draw(view, visible.order(), settings_, frame, stats);
    frame.writes.clear();
    if (settings_.count_writes) frame.writes.swap(stats.writes);
    counters.triangles_in += stats.triangles_in;
    counters.triangles_filled += stats.work.triangles;
    counters.pixels_tested += stats.work.tested;
    counters.pixels_written += stats.work.written;
    counters.queries += settings_.hierarchical ? stats.objects + stats.clusters : 0;
  }

 private:
  raster::TileRasteriser rasteriser_;
  raster::TileSettings settings_;
};

std::unique_ptr<Renderer> make(const IndexedScene& scene, ParameterReader& parameters, bool hierarchical) {
  raster::TileSettings settings;
  settings.hierarchical = hierarchical;
  parameters.read("overdraw", settings.count_writes);
  parameters.read("scalar", settings.scalar);
  parameters.finish();
  return std::make_unique<TiledZBuffer>(scene.scene, settings);
}

}  // namespace

std::unique_ptr<Renderer> make_zbuffer_tiled(const IndexedScene& scene, ParameterReader& parameters) {
  return make(scene, parameters, false);
}

std::unique_ptr<Renderer> make_hzb(const IndexedScene& scene, ParameterReader& parameters) {
  return make(scene, parameters, true);
}

}  // namespace sightline
