// The table of methods that work through OpenGL, beside the library's own; programs join the two.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "gl/method.hpp"
#include "sightline/core/algorithm.hpp"

namespace sightline::gl {

/// `row` says what every row of the registry says; its makers are empty, as a context is needed to make one.
struct GlAlgorithm {
  Algorithm row;
  std::unique_ptr<Method> (*make)(SceneDrawing&, ParameterReader&);
};

std::span<const GlAlgorithm> algorithms();

/// The row of that name, or null.
const GlAlgorithm* find_algorithm(std::string_view name);

/// Makes what `text` ("name[:key=value]...") asks for. Throws InputError.
std::unique_ptr<Method> make_method(std::string_view text, SceneDrawing& drawing);

/// A method as a culler: cull() draws a frame into a target of its own and answers with what was drawn.
class MethodCuller final : public Culler {
 public:
  /// The drawing lives as long as the culler.
  MethodCuller(std::shared_ptr<SceneDrawing> drawing, std::string_view text);
  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override;
  [[nodiscard]] Promise promise(Promise of_row) const override {
    return method_->approximate() ? Promise::approximate : of_row;
  }
  void reset() override { method_->reset(); }
  [[nodiscard]] Method& method() { return *method_; }
  [[nodiscard]] SceneDrawing& drawing() { return *drawing_; }
  [[nodiscard]] const Target& target() const { return target_; }
  /// Sums over all frames.
  [[nodiscard]] const Work& work() const { return work_; }
  /// From now on spans are collected here; null for none.
  void set_timeline(Timeline* timeline) { timeline_ = timeline; }

 private:
  std::shared_ptr<SceneDrawing> drawing_;
  std::unique_ptr<Method> method_;
  Target target_;
  Work work_;
  Timeline* timeline_ = nullptr;
  std::vector<ObjectId> drawn_;
};

}  // namespace sightline::gl
