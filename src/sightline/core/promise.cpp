#include "sightline/core/promise.hpp"

namespace sightline {

std::string_view to_string(Promise promise) {
  switch (promise) {
    case Promise::exact:
      return "exact";
    case Promise::conservative:
      return "conservative";
    case Promise::conservative_continuous:
      return "conservative-continuous";
    case Promise::approximate:
      return "approximate";
  }
  return "unknown";
}

}  // namespace sightline
