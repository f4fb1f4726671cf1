#include "sightline/core/parameters.hpp"

#include <charconv>

#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

template <class T>
T parse_number(const std::string& text, const std::string& where, T low, T high) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) throw InputError("", where, "'" + text + "' is not a number");
  if (!(value >= low && value <= high))
    throw InputError("", where, text + " is not between " + std::to_string(low) + " and " + std::to_string(high));
  return value;
}

}  // namespace

MethodSpec parse_method(std::string_view text) {
  MethodSpec spec;
  std::size_t at = text.find(':');
  spec.name = std::string(text.substr(0, at));
  if (spec.name.empty()) throw InputError("an empty method name");
  while (at != std::string_view::npos) {
    const std::size_t next = text.find(':', at + 1);
    const std::string_view part = text.substr(at + 1, next == std::string_view::npos ? next : next - at - 1);
    const std::size_t equals = part.find('=');
    if (equals == std::string_view::npos || equals == 0)
      throw InputError("", spec.name, "'" + std::string(part) + "' is not of the form key=value");
    if (!spec.parameters.emplace(part.substr(0, equals), part.substr(equals + 1)).second)
      throw InputError("", spec.name, "parameter '" + std::string(part.substr(0, equals)) + "' is given twice");
    at = next;
  }
  return spec;
}

bool ParameterReader::take(std::string_view key, std::string& text) {
  known_ += (known_.empty() ? "" : ", ") + std::string(key);
  const auto found = left_.find(key);
  if (found == left_.end()) return false;
  text = found->second;
  left_.erase(found);
  return true;
}

void ParameterReader::read(std::string_view key, double& value, double low, double high) {
  std::string text;
  if (take(key, text)) value = parse_number(text, spec_.name + ": " + std::string(key), low, high);
}

void ParameterReader::read(std::string_view key, int& value, int low, int high) {
  std::string text;
  if (take(key, text)) value = parse_number(text, spec_.name + ": " + std::string(key), low, high);
}

void ParameterReader::read(std::string_view key, bool& value) {
  std::string text;
  if (!take(key, text)) return;
  if (text != "on" && text != "off") throw InputError("", spec_.name + ": " + std::string(key), "must be on or off");
  value = text == "on";
}

void ParameterReader::read(std::string_view key, std::string& value) {
  std::string text;
  if (take(key, text)) value = text;
}

void ParameterReader::finish() const {
  if (left_.empty()) return;
  const std::string has = known_.empty() ? "it has none" : "it has " + known_;
  throw InputError("", spec_.name, "no parameter '" + left_.begin()->first + "'; " + has);
}

}  // namespace sightline
