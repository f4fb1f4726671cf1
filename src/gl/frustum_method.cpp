#include "gl/frustum_method.hpp"

#include <algorithm>
#include <string>

#include "sightline/scene/input_error.hpp"

namespace sightline::gl {
namespace {

enum class Order { found, near_first, far_first, shuffled };

class Frustum final : public Method {
 public:
  Frustum(SceneDrawing& drawing, Order order) : Method(drawing), order_(order) {}

 private:
  void render() override {
    objects_in_frustum(drawing_, candidates(), order_ != Order::found, found_);
    ids_.clear();
    for (const Placed& placed : found_) ids_.push_back(placed.id);
    if (order_ == Order::far_first) std::reverse(ids_.begin(), ids_.end());
    if (order_ == Order::shuffled)  // the same in every frame
      std::sort(ids_.begin(), ids_.end(), [](ObjectId a, ObjectId b) { return a * 2654435761u < b * 2654435761u; });
    draw(ids_);
  }
  Order order_;
  std::vector<Placed> found_;
  std::vector<ObjectId> ids_;
};

class Optimal final : public Method {
 public:
  using Method::Method;

  void prepare(const View& view, const VisibleSet* candidates) override {
    Work unused;
    Work& counted = drawing_.work();
    drawing_.set_work(&unused);
    Frustum all(drawing_, Order::near_first);
    all.frame(view, scratch_, candidates);
    std::vector<ObjectId> drawn;
    all.drawn(drawn);
    drawing_.resolve_ties(drawn);
    std::vector<std::uint32_t> ids;
    scratch_.read_ids(ids);
    VisibleSet seen(drawing_.scene().objects().size());
    for (const std::uint32_t id : ids)
      if (id != no_object) seen.insert(id);
    ids_.clear();
    for (const ObjectId id : drawn)
      if (seen.contains(id)) ids_.push_back(id);
    drawing_.set_work(&counted);
  }

 private:
  void render() override { draw(ids_); }
  Target scratch_;
  std::vector<ObjectId> ids_;
};

}  // namespace

std::unique_ptr<Method> make_frustum(SceneDrawing& drawing, ParameterReader& parameters) {
  std::string order = "near";
  parameters.read("order", order);
  parameters.finish();
  constexpr std::pair<const char*, Order> orders[] = {
      {"found", Order::found}, {"near", Order::near_first}, {"far", Order::far_first}, {"random", Order::shuffled}};
  for (const auto& [name, value] : orders)
    if (order == name) return std::make_unique<Frustum>(drawing, value);
  throw InputError("", "gl_frustum: order", "must be near, far, random or found");
}

std::unique_ptr<Method> make_optimal(SceneDrawing& drawing, ParameterReader& parameters) {
  parameters.finish();
  return std::make_unique<Optimal>(drawing);
}

}  // namespace sightline::gl
