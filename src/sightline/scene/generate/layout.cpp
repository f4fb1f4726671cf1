#include "sightline/scene/generate/layout.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace sightline {

Part Layout::part(std::string_view name, Mesh mesh) {
  PartInfo info;
  info.name = name;
  for (const glm::vec3& p : mesh.positions) info.bounds.extend(p);
  info.natural = std::move(mesh);
  parts_.push_back(std::move(info));
  return static_cast<Part>(parts_.size() - 1);
}

Part Layout::part(std::string_view name, std::function<Mesh(double detail)> make) {
  const Part id = part(name, make(1.0));
  parts_[id].make = std::move(make);
  return id;
}

ObjectId Layout::place(Part part, const Affine& transform, bool opaque) {
  assert(part < parts_.size());
  places_.push_back({part, parts_[part].uses++, opaque, transform});
  return static_cast<ObjectId>(places_.size() - 1);
}

void Layout::keep_first(std::uint32_t count) {
  while (placed() > count) {
    --parts_[places_.back().part].uses;
    places_.pop_back();
  }
}

Aabb Layout::bounds(ObjectId id) const {
  const Place& place = places_[id];
  Aabb box;
  for (const glm::vec3& p : parts_[place.part].natural.positions) box.extend(transform_point(place.transform, p));
  return box;
}

// At least 1: all parts get so many times their natural triangles. Below 1: so far from their coarsest to their
// natural.
double Layout::triangle_factor() const {
  if (config_.triangles == 0) return 1.0;
  double natural = 0.0, coarsest = 0.0;
  for (const PartInfo& info : parts_) {
    const double uses = info.uses;
    natural += uses * static_cast<double>(info.natural.triangles.size());
    coarsest += uses * static_cast<double>((info.make ? info.make(0.0) : info.natural).triangles.size());
  }
  const auto target = static_cast<double>(config_.triangles);
  if (target >= natural) return target / natural;
  return target > coarsest ? (target - coarsest) / (natural - coarsest) : 0.0;
}

Mesh Layout::tessellate(const PartInfo& info, double factor) const {
  const auto natural = static_cast<double>(info.natural.triangles.size());
  if (factor >= 1.0) {
    const auto wanted = static_cast<std::size_t>(std::llround(natural * factor));
    if (!info.make || factor == 1.0) return refine(info.natural, wanted);
    double detail = std::sqrt(factor);
    Mesh mesh = info.make(detail);
    while (mesh.triangles.size() > wanted && detail > 1.0) {
      detail *= 0.98 * std::sqrt(static_cast<double>(wanted) / static_cast<double>(mesh.triangles.size()));
      mesh = info.make(detail);
    }
    return refine(mesh, wanted);
  }
  if (!info.make) return info.natural;
  const auto coarsest = static_cast<double>(info.make(0.0).triangles.size());
  const auto wanted = static_cast<std::size_t>(std::llround(coarsest + (natural - coarsest) * factor));
  return refine(info.make(factor), wanted);
}

Scene Layout::build() {
  const double factor = triangle_factor();
  SceneBuilder builder;
  std::vector<MeshId> mesh_of_part(parts_.size(), 0);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].uses == 0) continue;
    Mesh mesh = tessellate(parts_[i], factor);
    mesh.name = parts_[i].name;
    mesh_of_part[i] = builder.add_mesh(std::move(mesh));
  }
  std::string name;
  for (const Place& place : places_) {
    name = parts_[place.part].name + ' ' + std::to_string(place.number);
    builder.add_object(mesh_of_part[place.part], place.transform, name, {}, place.opaque);
  }
  for (Cell& cell : cells) builder.add_cell(std::move(cell));
  for (Portal& portal : portals) builder.add_portal(std::move(portal));
  return builder.build();
}

Affine place_at(const glm::dvec3& position, double turns, const glm::dvec3& scale) {
  const glm::dvec2 c = circle_point(turns);
  return {glm::vec3(c.x * scale.x, 0.0, -c.y * scale.x), glm::vec3(0.0, scale.y, 0.0),
          glm::vec3(c.y * scale.z, 0.0, c.x * scale.z), glm::vec3(position)};
}

int scaled(int base, double detail, int least) { return std::max(least, static_cast<int>(std::lround(base * detail))); }

}  // namespace sightline
