// The interface of every occlusion culling method that works through OpenGL: it draws a frame and leaves out what it
// knows to be hidden. Promise of all but the approximate settings: colour, depth and ids are, bit by bit, those of
// drawing every object in the frustum.
#pragma once

#include <string>
#include <vector>

#include "gl/scene_drawing.hpp"
#include "sightline/core/visible_set.hpp"

namespace sightline::gl {

class Method {
 public:
  /// The drawing must outlive the method; several methods may share one.
  explicit Method(SceneDrawing& drawing) : drawing_(drawing) {}
  virtual ~Method() = default;
  Method(const Method&) = delete;
  Method& operator=(const Method&) = delete;

  /// Draws one frame of the candidates (null: every object) into `target`. Throws Unavailable if the context is gone.
  void frame(const View& view, Target& target, const VisibleSet* candidates = nullptr);
  /// What must be known before the frame and is not part of its cost: only the optimum has such a thing.
  virtual void prepare(const View& /*view*/, const VisibleSet* /*candidates*/) {}
  /// The objects drawn by the last frame, in order. May wait for the device.
  virtual void drawn(std::vector<ObjectId>& ids) { ids = drawn_; }
  /// True if its parameters let it leave out what is seen a little.
  [[nodiscard]] virtual bool approximate() const { return false; }
  /// Forgets all earlier frames.
  virtual void reset() {}
  /// Lines "frame query nodes -> answer", one for each query in the order of issue, are appended to `log`; null: none.
  void set_log(std::string* log) { log_ = log; }

 protected:
  virtual void render() = 0;
  [[nodiscard]] bool is_candidate(ObjectId id) const { return candidates_ == nullptr || candidates_->contains(id); }
  [[nodiscard]] const VisibleSet* candidates() const { return candidates_; }
  /// Draws and remembers.
  void draw(std::span<const ObjectId> ids);

  SceneDrawing& drawing_;
  std::vector<ObjectId> drawn_;
  std::string* log_ = nullptr;

 private:
  const VisibleSet* candidates_ = nullptr;
};

/// An object and the squared distance of the nearest point of its box.
struct Placed {
  float distance2;
  ObjectId id;
};

/// The candidates whose boxes are not outside of the frustum, found down the hierarchy; nearest first if `sorted`.
void objects_in_frustum(SceneDrawing& drawing, const VisibleSet* candidates, bool sorted, std::vector<Placed>& found);

}  // namespace sightline::gl
