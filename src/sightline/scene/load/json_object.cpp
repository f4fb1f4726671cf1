// JSON objects together with where they stand in their file, so that every wrong value is reported by its place.
#include "sightline/scene/load/json_object.hpp"

#include <cmath>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/file_bytes.hpp"

namespace sightline {

using nlohmann::json;

namespace {

/// The value as an integer in [0, 2^53], also when it is written as 5.0; nothing otherwise.
std::optional<std::uint64_t> as_integer(const json& value) {
  if (value.is_number_unsigned()) {
    const std::uint64_t integer = value.get<std::uint64_t>();
    if (integer <= JsonObject::max_integer) return integer;
  } else if (value.is_number_float()) {
    const double number = value.get<double>();
    if (number >= 0.0 && number <= static_cast<double>(JsonObject::max_integer) && std::floor(number) == number) {
      return static_cast<std::uint64_t>(number);
    }
  }
  return std::nullopt;
}

/// nlohmann's "[json.exception.parse_error.101] parse error at line 1, column 5: reason" as position and reason.
[[noreturn]] void throw_parse_error(const std::string& file, std::string_view what) {
  if (const std::size_t bracket = what.find("] "); bracket != std::string_view::npos) what.remove_prefix(bracket + 2);
  std::string position = "JSON";
  constexpr std::string_view prefix = "parse error at ";
  if (const std::size_t colon = what.find(": "); what.starts_with(prefix) && colon != std::string_view::npos) {
    position += " " + std::string(what.substr(prefix.size(), colon - prefix.size()));
    what.remove_prefix(colon + 2);
  }
  throw InputError(file, position, one_line(what));
}

}  // namespace

json parse_json(const std::string& file, std::span<const std::byte> bytes) {
  const char* text = reinterpret_cast<const char*>(bytes.data());
  try {
    return json::parse(text, text + bytes.size());
  } catch (const json::exception& error) {
    throw_parse_error(file, error.what());
  }
}

JsonObject::JsonObject(const json& value, const std::string& file, std::string place)
    : value_(&value), file_(&file), place_(std::move(place)) {
  if (!value.is_object()) fail("must be a JSON object");
}

std::string JsonObject::place_of(std::string_view field) const {
  std::string text = place_;
  if (!text.empty() && !field.empty()) text += '.';
  return text.append(field);
}

void JsonObject::fail(std::string_view field, std::string reason) const {
  throw InputError(*file_, one_line(place_of(field)), std::move(reason));
}

const json* JsonObject::find(std::string_view field) const {
  const auto entry = value_->find(field);
  return entry == value_->end() ? nullptr : &*entry;
}

const json* JsonObject::find_array(std::string_view field) const {
  const json* value = find(field);
  if (value != nullptr && !value->is_array()) fail(field, "must be an array");
  return value;
}

std::optional<std::uint64_t> JsonObject::integer(std::string_view field, std::uint64_t most) const {
  const json* value = find(field);
  if (value == nullptr) return std::nullopt;
  const std::optional<std::uint64_t> number = as_integer(*value);
  if (!number) fail(field, "must be an integer from 0 to 2^53");
  if (*number > most) fail(field, std::to_string(*number) + " is more than " + std::to_string(most));
  return number;
}

std::uint64_t JsonObject::required_integer(std::string_view field, std::uint64_t most) const {
  const std::optional<std::uint64_t> number = integer(field, most);
  if (!number) fail(field, "is missing");
  return *number;
}

std::optional<std::size_t> JsonObject::reference(std::string_view field, std::size_t size) const {
  const std::optional<std::uint64_t> index = integer(field);
  if (!index) return std::nullopt;
  if (*index >= size) fail(field, "there is no entry " + std::to_string(*index) + ", only " + std::to_string(size));
  return static_cast<std::size_t>(*index);
}

std::optional<double> JsonObject::number(std::string_view field) const {
  const json* value = find(field);
  if (value == nullptr) return std::nullopt;
  if (!value->is_number()) fail(field, "must be a number");
  return value->get<double>();
}

bool JsonObject::flag(std::string_view field) const {
  const json* value = find(field);
  if (value == nullptr) return false;
  if (!value->is_boolean()) fail(field, "must be true or false");
  return value->get<bool>();
}

const std::string& JsonObject::text(std::string_view field) const {
  static const std::string none;
  const json* value = find(field);
  if (value == nullptr) return none;
  if (!value->is_string()) fail(field, "must be a string");
  return value->get_ref<const std::string&>();
}

bool JsonObject::numbers(std::string_view field, std::span<double> values) const {
  const json* array = find_array(field);
  if (array == nullptr) return false;
  if (array->size() != values.size()) fail(field, "must have " + std::to_string(values.size()) + " numbers");
  for (std::size_t i = 0; i < values.size(); ++i) {
    const json& value = (*array)[i];
    if (!value.is_number()) fail(field, "must have numbers only");
    values[i] = value.get<double>();
  }
  return true;
}

std::vector<std::size_t> JsonObject::references(std::string_view field, std::size_t size) const {
  std::vector<std::size_t> indices;
  const json* array = find_array(field);
  if (array == nullptr) return indices;
  indices.reserve(array->size());
  for (const json& value : *array) {
    const std::optional<std::uint64_t> index = as_integer(value);
    if (!index) fail(field, "must have indices only");
    if (*index >= size) fail(field, "there is no entry " + std::to_string(*index) + ", only " + std::to_string(size));
    indices.push_back(static_cast<std::size_t>(*index));
  }
  return indices;
}

std::vector<std::string> JsonObject::texts(std::string_view field) const {
  std::vector<std::string> result;
  const json* array = find_array(field);
  if (array == nullptr) return result;
  for (const json& value : *array) {
    if (!value.is_string()) fail(field, "must have strings only");
    result.push_back(value.get<std::string>());
  }
  return result;
}

std::optional<JsonObject> JsonObject::object(std::string_view field) const {
  const json* value = find(field);
  if (value == nullptr) return std::nullopt;
  return JsonObject(*value, *file_, place_of(field));
}

std::size_t JsonObject::count(std::string_view field) const {
  const json* array = find_array(field);
  return array == nullptr ? 0 : array->size();
}

JsonObject JsonObject::item(std::string_view field, std::size_t index) const {
  const json* array = find_array(field);
  if (array == nullptr || index >= array->size()) fail(field, "there is no entry " + std::to_string(index));
  return {(*array)[index], *file_, place_of(field) + "[" + std::to_string(index) + "]"};
}

}  // namespace sightline
