// How an answer relates to the truth.
#pragma once

#include <string_view>

namespace sightline {

enum class Promise {
  exact,                    // equal to the truth
  conservative,             // contains every object of which at least one pixel centre is seen
  conservative_continuous,  // contains also what is seen only between pixel centres
  approximate               // with an error measure stated on its page
};

std::string_view to_string(Promise promise);

}  // namespace sightline
