// Camera paths from files: text with a view a line, or JSON. The formats are described at read_path.
#include "sightline/scene/camera_path.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <optional>
#include <string_view>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/json_object.hpp"
#include "sightline/scene/load/readers.hpp"

namespace sightline {

namespace {

constexpr std::string_view blanks = " \t\r\f\v";
constexpr std::int64_t most_frames = 10'000'000;
constexpr double golden_angle = 2.39996322972865332;

/// A view of the file; what it leaves open is the prototype's.
struct PathEntry {
  View view;
  bool has_direction = false;
};

/// The number that a whole word is; nothing if it is none ("item_health", "3x").
std::optional<double> as_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double number = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (end != word.data() + word.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

/// How many words at the start of a line are numbers, six at most; the numbers themselves go to `numbers`.
std::size_t leading_numbers(std::string_view line, std::array<double, 6>& numbers) {
  std::size_t count = 0;
  while (count < numbers.size()) {
    line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
    const std::size_t length = std::min(line.find_first_of(blanks), line.size());
    const std::optional<double> number = as_number(line.substr(0, length));
    if (!number) break;
    numbers[count++] = *number;
    line.remove_prefix(length);
  }
  return count;
}

/// Turns the view to `direction`. Throws InputError without a file.
void aim(View& view, const glm::dvec3& direction, const glm::dvec3& up) {
  // Scaled, so that the squares of very long or short directions stay in range.
  const double largest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
  view.orientation = look_along(view.eye, direction / largest, up).orientation;
}

/// The view of a line, nothing for a blank one. `before` is that of the line before it: a walker who turns on the spot
/// has a direction of length 0, and goes on looking as before. Throws InputError without a file.
std::optional<PathEntry> parse_line(std::string_view line, const PathEntry& before) {
  line = line.substr(0, line.find('#'));
  if (line.find_first_not_of(blanks) == std::string_view::npos) return std::nullopt;
  std::array<double, 6> numbers{};
  const std::size_t count = leading_numbers(line, numbers);
  if (count < 3) throw InputError("a line must begin with three numbers: the eye");
  const glm::dvec3 look{numbers[3], numbers[4], numbers[5]};
  PathEntry entry{before.view, count == numbers.size() && (before.has_direction || look != glm::dvec3(0.0))};
  entry.view.eye = {numbers[0], numbers[1], numbers[2]};
  if (entry.has_direction && look != glm::dvec3(0.0)) aim(entry.view, look, {0.0, 1.0, 0.0});
  check_view(entry.view);
  return entry;
}

std::vector<PathEntry> parse_text(const std::string& file, std::string_view text, const View& prototype) {
  std::vector<PathEntry> entries;
  const PathEntry nothing{prototype, false};
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    try {
      const PathEntry& before = entries.empty() ? nothing : entries.back();
      if (const auto entry = parse_line(text.substr(0, length), before)) entries.push_back(*entry);
    } catch (const InputError& error) {
      throw InputError(file, "line " + std::to_string(line), error.reason());
    }
    text.remove_prefix(std::min(length + 1, text.size()));
  }
  return entries;
}

std::optional<glm::dvec3> vector_field(const JsonObject& object, std::string_view field) {
  std::array<double, 3> numbers{};
  if (!object.numbers(field, numbers)) return std::nullopt;
  return glm::dvec3(numbers[0], numbers[1], numbers[2]);
}

PathEntry parse_view(const JsonObject& object, const View& prototype) {
  PathEntry entry{prototype, false};
  View& view = entry.view;
  const std::optional<glm::dvec3> eye = vector_field(object, "eye");
  if (!eye) object.fail("eye", "is missing");
  view.eye = *eye;
  if (const auto degrees = object.number("fov")) view.fov_y = glm::radians(*degrees);
  view.near = object.number("near").value_or(view.near);
  view.far = object.number("far").value_or(view.far);
  std::optional<glm::dvec3> look = vector_field(object, "look");
  const std::optional<glm::dvec3> target = vector_field(object, "target");
  if (look && target) object.fail("has a look and a target");
  if (target) look = *target - *eye;
  try {
    if (look) aim(view, *look, vector_field(object, "up").value_or(glm::dvec3(0.0, 1.0, 0.0)));
    check_view(view);
  } catch (const InputError& error) {
    object.fail(error.reason());
  }
  entry.has_direction = look.has_value();
  return entry;
}

std::vector<PathEntry> parse_views(const std::string& file, const Bytes& bytes, const View& prototype) {
  const nlohmann::json json = parse_json(file, bytes);
  const JsonObject root(json, file, "");
  std::vector<PathEntry> entries;
  for (std::size_t i = 0; i < root.count("views"); ++i) entries.push_back(parse_view(root.item("views", i), prototype));
  return entries;
}

/// Where in the circle the first eye looks first: 0 to 2 pi, well mixed over seeds.
double first_angle(std::uint64_t seed) {
  const std::uint64_t mixed = (seed * 0x9E3779B97F4A7C15u) >> 11;
  return glm::two_pi<double>() * std::ldexp(static_cast<double>(mixed), -53);
}

CameraPath sample(const std::vector<PathEntry>& entries, const PathConfig& config) {
  CameraPath path;
  const auto lines = static_cast<std::int64_t>(entries.size());
  const std::int64_t frames = config.frames;
  path.views.reserve(static_cast<std::size_t>(frames));
  for (std::int64_t frame = 0; frame < frames; ++frame) {
    const std::int64_t line = frame * lines / frames;
    const PathEntry& entry = entries[static_cast<std::size_t>(line)];
    View view = entry.view;
    if (!entry.has_direction) {
      // Line k is shown in the frames [ceil(k frames / lines), ceil((k + 1) frames / lines)).
      const std::int64_t begin = (line * frames + lines - 1) / lines;
      const std::int64_t end = ((line + 1) * frames + lines - 1) / lines;
      const double turn = static_cast<double>(frame - begin) / static_cast<double>(end - begin);
      const double angle =
          first_angle(config.seed) + golden_angle * static_cast<double>(line) + glm::two_pi<double>() * turn;
      aim(view, {std::sin(angle), 0.0, -std::cos(angle)}, {0.0, 1.0, 0.0});
    }
    path.views.push_back(view);
  }
  return path;
}

}  // namespace

CameraPath parse_path(const std::filesystem::path& file, const Bytes& bytes, const PathConfig& config) {
  if (config.frames < 1 || config.frames > most_frames) {
    throw InputError("frames must be from 1 to " + std::to_string(most_frames));
  }
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool is_json = first != std::string_view::npos && text[first] == '{';
  const std::vector<PathEntry> entries =
      is_json ? parse_views(file.string(), bytes, config.prototype) : parse_text(file.string(), text, config.prototype);
  if (entries.empty()) throw InputError(file.string(), "", "has no views");
  return sample(entries, config);
}

CameraPath read_path(const std::filesystem::path& file, const PathConfig& config) {
  return parse_path(file, read_file(file), config);
}

}  // namespace sightline
