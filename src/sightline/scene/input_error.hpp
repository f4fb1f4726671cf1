// The one exception for bad input: a file, argument or value that a person can mend. Bugs are asserts instead.
#pragma once

#include <stdexcept>
#include <string>

namespace sightline {

/// what() is one line, "file: position: reason", parts that are unknown left out.
class InputError : public std::runtime_error {
 public:
  InputError(std::string file, std::string position, std::string reason)
      : std::runtime_error(line(file, position, reason)),
        file_(std::move(file)),
        position_(std::move(position)),
        reason_(std::move(reason)) {}
  explicit InputError(std::string reason) : InputError("", "", std::move(reason)) {}

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] const std::string& position() const { return position_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  static std::string line(const std::string& file, const std::string& position, const std::string& reason) {
    std::string text;
    if (!file.empty()) text += file + ": ";
    if (!position.empty()) text += position + ": ";
    return text + reason;
  }
  std::string file_, position_, reason_;
};

}  // namespace sightline
