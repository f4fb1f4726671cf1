#include "sightline/cull/none.hpp"

namespace sightline {
namespace {

class None final : public Culler {
 public:
  void cull(const View&, const VisibleSet& candidates, VisibleSet& visible, Counters&) override {
    visible = candidates;
  }
  bool follow_scene() override { return true; }
};

}  // namespace

std::unique_ptr<Culler> make_none(const IndexedScene&, ParameterReader& parameters) {
  parameters.finish();
  return std::make_unique<None>();
}

}  // namespace sightline
