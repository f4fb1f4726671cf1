// A glTF 2.0 file opened: its JSON, and the bytes of its buffers and buffer views, checked and fetched when first asked
// for.
#include "sightline/scene/load/gltf_document.hpp"

#include <algorithm>
#include <array>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/gltf_meshopt.hpp"

namespace sightline {

namespace {

// A file may decode to this much, plus so many times its own size: the most that an honest compressed file does.
constexpr std::uint64_t base_allowance = std::uint64_t{1} << 30;
constexpr std::uint64_t growth = 64;

constexpr std::array<std::string_view, 5> used_extensions = {
    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression",    "KHR_draco_mesh_compression",
    "KHR_mesh_quantization",   "KHR_materials_transmission",
};

/// Extensions that only change how surfaces look, which we do not draw.
bool is_appearance(std::string_view extension) {
  return extension.starts_with("KHR_materials_") || extension.starts_with("KHR_texture_") ||
         extension.starts_with("EXT_texture_") || extension == "MSFT_texture_dds";
}

}  // namespace

GltfDocument::GltfDocument(const std::filesystem::path& file, Bytes bytes)
    : file_(file.string()),
      bytes_(std::move(bytes)),
      chunks_(split_gltf(file_, bytes_)),
      json_(parse_json(file_, chunks_.json)),
      allowance_(base_allowance + growth * bytes_.size()) {
  check_version();
  check_extensions();
}

void GltfDocument::check_version() const {
  const std::optional<JsonObject> asset = root().object("asset");
  if (!asset) root().fail("asset", "is missing: this is no glTF 2.0 file");
  const std::string& version = asset->text("version");
  if (!version.starts_with("2.")) asset->fail("version", in_quotes(version) + " is not 2.x");
}

void GltfDocument::check_extensions() {
  const auto is_used = [](std::string_view name) {
    return std::ranges::find(used_extensions, name) != used_extensions.end();
  };
  for (const std::string& name : root().texts("extensionsRequired")) {
    if (!is_used(name) && !is_appearance(name)) {
      root().fail("extensionsRequired", "the file needs the extension " + one_line(name) + ", which cannot be read");
    }
  }
  for (const std::string& name : root().texts("extensionsUsed")) {
    if (!is_used(name)) warn("extension " + one_line(name) + " is not used");
  }
}

void GltfDocument::spend(std::uint64_t bytes, const JsonObject& what) {
  if (bytes > allowance_ - spent_) {
    what.fail("the file asks for more than " + std::to_string(allowance_ >> 20) + " MiB");
  }
  spent_ += bytes;
}

Bytes GltfDocument::read_buffer(const JsonObject& buffer, std::uint64_t length) const {
  const std::string& uri = buffer.text("uri");
  const std::string place = buffer.place() + ".uri";
  if (std::optional<Bytes> bytes = decode_data_uri(uri, file_, place)) return *std::move(bytes);
  const std::filesystem::path path = resolve_uri(uri, file_, place);
  try {
    return read_file(path, length);
  } catch (const InputError& error) {
    buffer.fail("uri", in_quotes(path.string()) + " " + error.reason());
  }
}

std::span<const std::byte> GltfDocument::buffer(std::size_t index) {
  const JsonObject buffer = item("buffers", index);
  const std::uint64_t length = buffer.required_integer("byteLength");
  std::span<const std::byte> bytes;
  if (index == 0 && !buffer.has("uri") && chunks_.binary) {
    bytes = *chunks_.binary;
  } else if (!buffer.has("uri")) {
    buffer.fail("has neither a uri nor a binary chunk");
  } else {
    auto entry = buffers_.find(index);
    if (entry == buffers_.end()) {
      entry = buffers_.emplace(index, read_buffer(buffer, length)).first;
      allowance_ += growth * entry->second.size();
    }
    bytes = entry->second;
  }
  if (length > bytes.size()) {
    buffer.fail("byteLength",
                std::to_string(length) + " bytes are claimed, " + std::to_string(bytes.size()) + " are there");
  }
  return bytes.first(static_cast<std::size_t>(length));
}

std::span<const std::byte> GltfDocument::range(const JsonObject& view) {
  const std::optional<std::size_t> index = view.reference("buffer", count("buffers"));
  if (!index) view.fail("buffer", "is missing");
  const std::span<const std::byte> bytes = buffer(*index);
  const std::uint64_t offset = view.integer("byteOffset").value_or(0);
  const std::uint64_t length = view.required_integer("byteLength");
  if (offset > bytes.size() || length > bytes.size() - offset) {
    view.fail("bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) + " lie outside buffers[" +
              std::to_string(*index) + "] of " + std::to_string(bytes.size()));
  }
  return bytes.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

std::span<const std::byte> GltfDocument::view(std::size_t index) {
  const JsonObject view = item("bufferViews", index);
  const std::optional<JsonObject> meshopt = gltf_extension(view, "EXT_meshopt_compression");
  if (!meshopt) return range(view);
  auto entry = decoded_.find(index);
  if (entry == decoded_.end()) {
    spend(meshopt_size(*meshopt), *meshopt);
    entry = decoded_.emplace(index, decode_meshopt(*meshopt, range(*meshopt))).first;
  }
  return entry->second;
}

void GltfDocument::warn(const std::string& what, const std::string& where) {
  ++warnings_.try_emplace(what, Warning{where, 0}).first->second.count;
}

std::vector<std::string> GltfDocument::warnings() const {
  std::vector<std::string> lines;
  for (const auto& [what, warning] : warnings_) {
    std::string line = warning.where;
    if (warning.count > 1 && !line.empty()) line += " and " + std::to_string(warning.count - 1) + " more";
    lines.push_back(line.empty() ? what : line + ": " + what);
  }
  return lines;
}

std::optional<JsonObject> gltf_extension(const JsonObject& object, std::string_view name) {
  const std::optional<JsonObject> extensions = object.object("extensions");
  return extensions ? extensions->object(name) : std::nullopt;
}

}  // namespace sightline
