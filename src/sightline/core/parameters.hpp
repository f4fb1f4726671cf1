// Named parameters of an algorithm as a person types them, "occlusion_masked:width=640:depth_margin=1e-4".
// Unknown names and malformed values are input errors, never ignored.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace sightline {

/// A method name and its parameters.
struct MethodSpec {
  std::string name;
  std::map<std::string, std::string, std::less<>> parameters;
};

/// Parses "name[:key=value]...". Throws InputError.
MethodSpec parse_method(std::string_view text);

/// Reads parameters by type and remembers which were asked for.
class ParameterReader {
 public:
  explicit ParameterReader(const MethodSpec& spec) : spec_(spec), left_(spec.parameters) {}

  /// Overwrites `value` if the parameter is given. Throws InputError if it is no number or not in [low, high].
  void read(std::string_view key, double& value, double low, double high);
  void read(std::string_view key, int& value, int low, int high);
  void read(std::string_view key, bool& value);
  void read(std::string_view key, std::string& value);
  /// Throws InputError if a parameter was given that nobody read; names those that exist.
  void finish() const;

 private:
  bool take(std::string_view key, std::string& text);
  const MethodSpec& spec_;
  std::map<std::string, std::string, std::less<>> left_;
  std::string known_;
};

}  // namespace sightline
