#include "report.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <ctime>

#include "base64.hpp"
#include "json.hpp"
#include "output.hpp"
#include "page_template.hpp"
#include "sightline/scene/input_error.hpp"
#include "walk_json.hpp"

namespace sightline::cli {
namespace {

constexpr std::string_view marker = "/*SIGHTLINE_DATA*/null";

/// Bounds of all objects as little-endian floats, lo and hi for each. Empty above a million objects: the page could not
/// draw them.
std::string bounds_base64(const Scene& scene) {
  static_assert(std::endian::native == std::endian::little);
  constexpr std::size_t most_objects = 1'000'000;
  std::string bytes;
  if (scene.objects().size() <= most_objects)
    for (const Object& object : scene.objects())
      for (const float value : {object.bounds.lo.x, object.bounds.lo.y, object.bounds.lo.z, object.bounds.hi.x,
                                object.bounds.hi.y, object.bounds.hi.z}) {
        char four[sizeof value];
        std::memcpy(four, &value, sizeof value);
        bytes.append(four, sizeof value);
      }
  return base64(bytes);
}

std::string state_base64(const WalkAnswer& answer) {
  return base64({reinterpret_cast<const char*>(answer.state.data()), answer.state.size()});
}

/// The camera of a frame and, where it was kept, what became of every object in one run.
Json frame_json(const WalkReport& report, const WalkRun& run, std::size_t i) {
  const View& view = report.views[i].view;
  const bool perspective = view.projection == Projection::perspective;
  Json json{{"frame", report.views[i].frame},
            {"method", run.method},
            {"direction", vector_json(view_direction(view))},
            {"up", vector_json(view.orientation * glm::dvec3(0.0, 1.0, 0.0))},
            {"right", vector_json(view.orientation * glm::dvec3(1.0, 0.0, 0.0))},
            {"fov_y", perspective ? Json(view.fov_y) : Json(nullptr)},
            {"span_y", perspective ? Json(nullptr) : Json(view.span_y)},
            {"aspect", static_cast<double>(view.width) / view.height},
            {"near", view.near},
            {"far", view.far}};
  if (!run.answers[i].state.empty()) json["state"] = state_base64(run.answers[i]);
  return json;
}

std::string additions(const WalkReport& report) {
  Json json{{"command", report.command},
            {"version", SIGHTLINE_VERSION},
            {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))},
            {"objects", {{"bounds", bounds_base64(*report.scene)}}},
            {"frames", Json::array()},
            {"pictures", Json::array()}};
  for (const WalkRun& run : report.runs)
    for (std::size_t i = 0; i < run.answers.size(); ++i) json["frames"].push_back(frame_json(report, run, i));
  for (const WalkPicture& picture : report.pictures)
    json["pictures"].push_back({{"frame", picture.frame}, {"kind", picture.kind}, {"png", base64(picture.png)}});
  if (!report.comparison.empty()) json["comparison"] = Json::parse(report.comparison);
  return ",\n\"report\":" + json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string script_safe(std::string_view json) {
  // "<" stands only inside of JSON strings, where this escape means the same.
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

void prepare_report(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder.string(), "", "cannot make the folder: " + error.message());
  OutputFile(folder / "index.html");
}

void write_report(const WalkReport& report, const std::filesystem::path& folder) {
  const std::string_view page = page_template();
  const std::size_t place = page.find(marker);
  if (place == std::string_view::npos) throw std::logic_error("the report page has no place for the data");
  OutputFile file(folder / "index.html");
  file.write(page.substr(0, place));
  write_walk_json(report, false, [&](std::string_view text) { file.write(script_safe(text)); }, additions(report));
  file.write(page.substr(place + marker.size()));
  file.commit();
}

}  // namespace sightline::cli
