// sightline visible-faces: which faces each camera sees, as NumPy array, CSV or JSON.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>

#include "json_output.hpp"
#include "query_options.hpp"
#include "scene_argument.hpp"
#include "sightline/surface/visible_faces.hpp"

namespace sightline::cli {
namespace {

/// Everything, by camera, then face.
struct Table {
  std::size_t cameras = 0, faces = 0;
  std::vector<std::uint8_t> seen;
  std::vector<std::uint32_t> samples;  // only if wanted
};

/// The head of a NumPy file, version 1.0: magic, length, a Python dictionary, padded to 64 bytes.
std::string npy_header(const char* type, std::size_t rows, std::size_t columns) {
  std::string dictionary =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}), }}", type, rows, columns);
  dictionary.append(63 - (10 + dictionary.size()) % 64, ' ');
  dictionary += '\n';
  std::string head("\x93NUMPY\x01\x00", 8);
  head += static_cast<char>(dictionary.size() & 255);
  head += static_cast<char>(dictionary.size() >> 8);
  return head + dictionary;
}

void write_npy(OutputFile& file, const Table& table) {
  const bool counts = !table.samples.empty() || table.seen.empty();
  file.write(npy_header(table.samples.empty() ? "|b1" : "<u4", table.cameras, table.faces));
  if (counts)
    file.write({reinterpret_cast<const char*>(table.samples.data()), table.samples.size() * sizeof(std::uint32_t)});
  else
    file.write({reinterpret_cast<const char*>(table.seen.data()), table.seen.size()});
}

void write_csv(OutputFile& file, const Table& table, std::span<const CalibratedCamera> cameras,
               std::span<const std::uint64_t> first) {
  std::string text = table.samples.empty() ? "camera,face,object,triangle\n" : "camera,face,object,triangle,samples\n";
  for (std::size_t camera = 0; camera < table.cameras; ++camera) {
    std::string name = cameras[camera].name;
    if (name.find_first_of(",\"\n\r") != std::string::npos) {
      for (std::size_t i = 0; (i = name.find('"', i)) != std::string::npos; i += 2) name.insert(i, 1, '"');
      name = '"' + name + '"';
    }
    std::size_t object = 0;
    for (std::size_t face = 0; face < table.faces; ++face) {
      const std::size_t at = camera * table.faces + face;
      if (table.seen[at] == 0) continue;
      while (first[object + 1] <= face) ++object;
      text += fmt::format("{},{},{},{}", name, face, object, face - first[object]);
      if (!table.samples.empty()) text += fmt::format(",{}", table.samples[at]);
      text += '\n';
    }
    file.write(text);
    text.clear();
  }
}

void write_json(OutputFile& file, const Table& table, std::span<const CalibratedCamera> cameras) {
  file.write(fmt::format("{{\"schema\": \"sightline.visible-faces/1\", \"faces\": {}, \"cameras\": [", table.faces));
  for (std::size_t camera = 0; camera < table.cameras; ++camera) {
    Json row{{"name", cameras[camera].name}, {"seen", Json::array()}};
    if (!table.samples.empty()) row["samples"] = Json::array();
    for (std::size_t face = 0; face < table.faces; ++face) {
      const std::size_t at = camera * table.faces + face;
      if (table.seen[at] == 0) continue;
      row["seen"].push_back(face);
      if (!table.samples.empty()) row["samples"].push_back(table.samples[at]);
    }
    file.write((camera > 0 ? ",\n" : "\n") + row.dump(-1, ' ', false, Json::error_handler_t::replace));
  }
  file.write("\n]}\n");
}

void check_output(const std::string& output) {
  for (const char* ending : {".npy", ".csv", ".json"})
    if (output.ends_with(ending)) return;
  throw UsageError(output + ": faces are written as .npy, .csv or .json");
}

Table look(const VisibleFacesOptions& options, const Scene& scene, std::span<const CalibratedCamera> cameras) {
  constexpr std::uint64_t most = 4'000'000'000;
  Table table{cameras.size(), scene.triangle_count(), {}, {}};
  if (table.faces > most / table.cameras)
    throw InputError(fmt::format("{} cameras times {} faces are too many for one table", table.cameras, table.faces));
  table.seen.resize(table.cameras * table.faces);
  if (options.samples) table.samples.resize(table.seen.size());
  Progress progress("cameras", cameras.size(), options.common.quiet);
  std::mutex mutex;
  std::size_t done = 0;
  visible_faces(scene, cameras, {options.extra_points}, [&](std::size_t camera, const CameraFaces& faces) {
    const auto row = static_cast<std::ptrdiff_t>(camera * table.faces);
    std::copy(faces.seen.begin(), faces.seen.end(), table.seen.begin() + row);
    if (options.samples) std::copy(faces.samples.begin(), faces.samples.end(), table.samples.begin() + row);
    const std::lock_guard lock(mutex);
    progress.show(++done);
  });
  return table;
}

}  // namespace

int run_visible_faces(const VisibleFacesOptions& options) {
  check_output(options.output);
  OutputFile file(options.output);
  JsonOutput output(options.common);
  const std::vector<CalibratedCamera> cameras = read_cameras(options.cameras);
  const LoadedScene loaded = open_scene(options.scene, options.common);
  const auto start = std::chrono::steady_clock::now();
  const Table table = look(options, loaded.scene, cameras);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.output.ends_with(".npy"))
    write_npy(file, table);
  else if (options.output.ends_with(".csv"))
    write_csv(file, table, cameras, first_faces(loaded.scene));
  else
    write_json(file, table, cameras);
  file.commit();

  Json json{{"schema", "sightline.visible-faces.summary/1"},
            {"scene", options.scene},
            {"output", options.output},
            {"faces", table.faces},
            {"seconds", seconds},
            {"cameras", Json::array()}};
  std::vector<std::uint8_t> any(table.faces, 0);
  for (std::size_t camera = 0; camera < table.cameras; ++camera) {
    const auto row = table.seen.begin() + static_cast<std::ptrdiff_t>(camera * table.faces);
    std::size_t seen = 0;
    for (std::size_t face = 0; face < table.faces; ++face) {
      if (row[static_cast<std::ptrdiff_t>(face)] == 0) continue;
      ++seen;
      any[face] = 1;
    }
    json["cameras"].push_back({{"name", cameras[camera].name}, {"faces_seen", seen}});
  }
  json["faces_seen_by_any"] = std::count(any.begin(), any.end(), std::uint8_t{1});
  if (options.common.prints())
    fmt::print("{}: {} cameras, {} faces, {} of them seen by at least one; {:.2f} s, {:.1f} ms per camera\n",
               options.output, table.cameras, table.faces, json["faces_seen_by_any"].get<std::size_t>(), seconds,
               1e3 * seconds / static_cast<double>(table.cameras));
  output.write(json);
  return exit_ok;
}

}  // namespace sightline::cli
