// The --json option of verbs whose answer is one small document.
#pragma once

#include <optional>

#include "json.hpp"
#include "options.hpp"
#include "output.hpp"

namespace sightline::cli {

/// Opens the file of --json at once, so that a bad place is told before the work; does nothing without --json.
class JsonOutput {
 public:
  explicit JsonOutput(const CommonOptions& common) {
    if (!common.json.empty()) file_.emplace(common.json);
  }
  /// Bytes that are no UTF-8 (names from files) are replaced. Throws InputError if it cannot be written.
  void write(const Json& json) {
    if (!file_) return;
    file_->write(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
    file_->commit();
  }

 private:
  std::optional<OutputFile> file_;
};

}  // namespace sightline::cli
