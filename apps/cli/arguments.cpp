#include "arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace sightline::cli {
namespace {

[[noreturn]] void refuse(std::string_view option, std::string_view text, std::string_view expected) {
  throw UsageError(fmt::format("{}: '{}' is not {}", option, text, expected));
}

/// False unless all of the text is one value.
template <class T>
bool read_all(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

}  // namespace

std::uint64_t parse_whole(std::string_view option, std::string_view text, std::uint64_t low, std::uint64_t high) {
  std::uint64_t value = 0;
  if (!read_all(text, value) || value < low || value > high)
    refuse(option, text, fmt::format("a whole number from {} to {}", low, high));
  return value;
}

double parse_finite(std::string_view option, std::string_view text) {
  double value = 0.0;
  if (!read_all(text, value) || !std::isfinite(value)) refuse(option, text, "a finite number");
  return value;
}

double parse_positive(std::string_view option, std::string_view text, bool may_be_infinite) {
  double value = 0.0;
  const bool good = read_all(text, value) && value > 0.0 && (may_be_infinite || std::isfinite(value));
  if (!good) refuse(option, text, may_be_infinite ? "a number above 0, or inf" : "a finite number above 0");
  return value;
}

double parse_share(std::string_view option, std::string_view text) {
  double value = 0.0;
  if (!read_all(text, value) || !(value >= 0.0 && value <= 1.0)) refuse(option, text, "a share from 0 to 1");
  return value;
}

glm::dvec3 parse_vector(std::string_view option, std::string_view text) {
  const auto parts = split(text, ',');
  glm::dvec3 value{0.0};
  bool good = parts.size() == 3;
  for (int axis = 0; good && axis < 3; ++axis)
    good = read_all(parts[static_cast<std::size_t>(axis)], value[axis]) && std::isfinite(value[axis]);
  if (!good) refuse(option, text, "three finite numbers x,y,z");
  return value;
}

std::pair<int, int> parse_size(std::string_view option, std::string_view text) {
  const auto parts = split(text, 'x');
  int width = 0, height = 0;
  const auto in_range = [](int pixels) { return pixels >= 1 && pixels <= 16384; };
  if (parts.size() != 2 || !read_all(parts[0], width) || !read_all(parts[1], height) || !in_range(width) ||
      !in_range(height))
    refuse(option, text, "a size WIDTHxHEIGHT of 1 to 16384 each");
  return {width, height};
}

std::pair<int, int> parse_pixel(std::string_view option, std::string_view text) {
  const auto parts = split(text, ',');
  int x = 0, y = 0;
  if (parts.size() != 2 || !read_all(parts[0], x) || !read_all(parts[1], y) || x < 0 || y < 0)
    refuse(option, text, "a pixel X,Y, whole numbers from 0");
  return {x, y};
}

std::vector<std::string> parse_names(std::string_view option, std::string_view text) {
  std::vector<std::string> names;
  for (const std::string_view part : split(text, ',')) {
    if (part.empty()) refuse(option, text, "a list of names with commas between");
    if (std::find(names.begin(), names.end(), part) != names.end())
      throw UsageError(fmt::format("{}: '{}' is given twice", option, part));
    names.emplace_back(part);
  }
  return names;
}

ProgressKind parse_progress(std::string_view option, std::string_view text) {
  if (text == "auto") return ProgressKind::automatic;
  if (text == "json") return ProgressKind::json;
  if (text == "none") return ProgressKind::none;
  refuse(option, text, "auto, json or none");
}

}  // namespace sightline::cli
