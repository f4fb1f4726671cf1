// JSON objects together with where they stand in their file, so that every wrong value is reported by its place.
// Promise: each access checks presence, kind and range, and throws InputError(file, "accessors[3].count", reason).
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sightline {

/// The JSON in `bytes`. Throws InputError(file, "JSON line 1, column 5", reason) if it is broken.
nlohmann::json parse_json(const std::string& file, std::span<const std::byte> bytes);

class JsonObject {
 public:
  /// `value`, `file` must outlive this. Throws InputError if `value` is no JSON object.
  JsonObject(const nlohmann::json& value, const std::string& file, std::string place);

  [[nodiscard]] const std::string& place() const { return place_; }
  [[nodiscard]] bool has(std::string_view field) const { return find(field) != nullptr; }

  /// A non-negative integer of at most `most`; nothing if the field is absent.
  [[nodiscard]] std::optional<std::uint64_t> integer(std::string_view field, std::uint64_t most = max_integer) const;
  /// The same for a field that must be there.
  [[nodiscard]] std::uint64_t required_integer(std::string_view field, std::uint64_t most = max_integer) const;
  /// An index into a list of `size` entries; nothing if the field is absent.
  [[nodiscard]] std::optional<std::size_t> reference(std::string_view field, std::size_t size) const;
  [[nodiscard]] std::optional<double> number(std::string_view field) const;
  [[nodiscard]] bool flag(std::string_view field) const;
  /// The text of a field; empty if it is absent.
  [[nodiscard]] const std::string& text(std::string_view field) const;
  /// Fills `values` from an array of exactly so many numbers; false if the field is absent.
  bool numbers(std::string_view field, std::span<double> values) const;
  /// Indices into a list of `size` entries; empty if the field is absent.
  [[nodiscard]] std::vector<std::size_t> references(std::string_view field, std::size_t size) const;
  /// Texts of an array; empty if the field is absent.
  [[nodiscard]] std::vector<std::string> texts(std::string_view field) const;
  /// The object in a field; nothing if the field is absent.
  [[nodiscard]] std::optional<JsonObject> object(std::string_view field) const;
  /// How many entries the array in a field has; 0 if the field is absent.
  [[nodiscard]] std::size_t count(std::string_view field) const;
  /// Entry `index` < count(field) of the array in a field.
  [[nodiscard]] JsonObject item(std::string_view field, std::size_t index) const;

  /// Throws InputError at this object, or at its field.
  [[noreturn]] void fail(std::string_view field, std::string reason) const;
  [[noreturn]] void fail(std::string reason) const { fail("", std::move(reason)); }

  /// JSON numbers are doubles: integers above this are not exact.
  static constexpr std::uint64_t max_integer = std::uint64_t{1} << 53;

 private:
  [[nodiscard]] const nlohmann::json* find(std::string_view field) const;
  [[nodiscard]] const nlohmann::json* find_array(std::string_view field) const;
  [[nodiscard]] std::string place_of(std::string_view field) const;

  const nlohmann::json* value_;
  const std::string* file_;
  std::string place_;
};

}  // namespace sightline
