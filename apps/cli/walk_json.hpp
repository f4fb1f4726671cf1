// The JSON of a walk, schema "sightline.walk/1".
#pragma once

#include <functional>
#include <string_view>

#include "walk_report.hpp"

namespace sightline::cli {

using TextSink = std::function<void(std::string_view)>;

/// Writes the document piece by piece, one frame a line: with ids it may be far larger than memory wants twice.
/// One run: {"schema", "size", "method", "scene", "frames", "summary"}; several: {"schema", "size", "scene", "runs":
/// [one such document each]}. With `ids` "objects" stands once at the top. `extra` is put before the closing brace as
/// it is.
void write_walk_json(const WalkReport& report, bool ids, const TextSink& sink, std::string_view extra = {});

}  // namespace sightline::cli
