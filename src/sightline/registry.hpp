// The one table of algorithms. Tests, benchmarks, documentation and command line loop over it and nothing else.
#pragma once

#include <memory>
#include <span>

#include "sightline/core/algorithm.hpp"

namespace sightline {

std::span<const Algorithm> algorithms();

/// The row of that name. Throws InputError that lists the names of the family if there is none.
const Algorithm& find_algorithm(std::string_view name, Family family);

/// Makes the culler or renderer that `text` ("name[:key=value]...") asks for. Throws InputError.
std::unique_ptr<Culler> make_culler(std::string_view text, const IndexedScene& scene);
std::unique_ptr<Renderer> make_renderer(std::string_view text, const IndexedScene& scene);
std::unique_ptr<FaceCuller> make_face_culler(std::string_view text, const IndexedScene& scene);

}  // namespace sightline
