#include "methods.hpp"

#include "sightline/registry.hpp"
#include "sightline/scene/input_error.hpp"
#ifdef SIGHTLINE_HAS_GL
#include "gl/registry.hpp"
#endif

namespace sightline::cli {

#ifdef SIGHTLINE_HAS_GL
namespace {

/// The program's one context, made when it is first asked for. Throws MethodUnavailable.
gl::Context& gl_context() {
  try {
    static gl::Context context;
    return context;
  } catch (const gl::Unavailable& error) {
    throw MethodUnavailable(error.what());
  }
}

/// The scene in the device's memory: shared by the methods of one comparison.
std::shared_ptr<gl::SceneDrawing> gl_drawing(const Scene& scene) {
  static std::weak_ptr<gl::SceneDrawing> last;
  if (auto drawing = last.lock(); drawing && &drawing->scene() == &scene) return drawing;
  auto drawing = std::make_shared<gl::SceneDrawing>(gl_context(), scene);
  last = drawing;
  return drawing;
}

template <class Action>
void as_unavailable(const Action& action) {
  try {
    action();
  } catch (const gl::Unavailable& error) {
    throw MethodUnavailable(error.what());
  }
}

/// A culler that ends with MethodUnavailable where the device goes away in mid-work.
class GlCuller final : public Culler {
 public:
  GlCuller(std::string_view text, const Scene& scene) : inner_(gl_drawing(scene), text) {}
  ~GlCuller() override { inner_.drawing().context().make_current(); }
  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    as_unavailable([&] { inner_.cull(view, candidates, visible, counters); });
  }
  [[nodiscard]] Promise promise(Promise of_row) const override { return inner_.promise(of_row); }
  void reset() override { inner_.reset(); }
  /// What OpenGL shows when every object is drawn.
  Truth truth(const View& view) {
    gl::SceneDrawing& drawing = inner_.drawing();
    drawing.context().make_current();
    const std::size_t objects = drawing.scene().objects().size();
    std::vector<std::uint32_t> ids;
    as_unavailable([&] {
      drawing.begin(view, whole_);
      drawing.draw(VisibleSet::all(objects).order());
      whole_.read_ids(ids);
      drawing.context().check("drawing everything");
    });
    Truth truth{VisibleSet(objects), std::vector<std::uint32_t>(objects), 1};
    for (const std::uint32_t id : ids) {
      if (id == no_object) continue;
      truth.seen.insert(id);
      ++truth.samples[id];
    }
    return truth;
  }
  void start_timeline() {
    timeline_ = std::make_unique<gl::Timeline>();
    inner_.set_timeline(timeline_.get());
  }
  gl::Timeline* timeline() { return timeline_.get(); }

 private:
  gl::MethodCuller inner_;
  gl::Target whole_;
  std::unique_ptr<gl::Timeline> timeline_;
};

}  // namespace
#endif

const std::vector<Algorithm>& all_algorithms() {
  static const std::vector<Algorithm> all = [] {
    std::vector<Algorithm> rows(algorithms().begin(), algorithms().end());
#ifdef SIGHTLINE_HAS_GL
    for (const gl::GlAlgorithm& algorithm : gl::algorithms()) rows.push_back(algorithm.row);
#endif
    return rows;
  }();
  return all;
}

const Algorithm& find_method(std::string_view name, Family family) {
  std::string names;
  for (const Algorithm& row : all_algorithms()) {
    if (row.family != family) continue;
    if (row.name == name) return row;
    names += (names.empty() ? "" : ", ") + std::string(row.name);
  }
  throw InputError("no " + std::string(to_string(family)) + " is called '" + std::string(name) + "'; there are " +
                   names);
}

std::unique_ptr<Culler> make_any_culler(std::string_view text, const IndexedScene& scene) {
#ifdef SIGHTLINE_HAS_GL
  if (gl::find_algorithm(parse_method(text).name) != nullptr) {
    try {
      return std::make_unique<GlCuller>(text, scene.scene);
    } catch (const gl::Unavailable& error) {
      throw MethodUnavailable(error.what());
    }
  }
#endif
  return make_culler(text, scene);
}

const Truth* own_truth([[maybe_unused]] Culler& culler, [[maybe_unused]] const View& view,
                       std::optional<Truth>& drawn) {
#ifdef SIGHTLINE_HAS_GL
  if (auto* gl_culler = dynamic_cast<GlCuller*>(&culler)) {
    if (!drawn) drawn = gl_culler->truth(view);
    return &*drawn;
  }
#endif
  (void)drawn;
  return nullptr;
}

bool start_trace([[maybe_unused]] Culler& culler) {
#ifdef SIGHTLINE_HAS_GL
  if (auto* gl_culler = dynamic_cast<GlCuller*>(&culler)) {
    gl_culler->start_timeline();
    return true;
  }
#endif
  return false;
}

std::string finish_trace([[maybe_unused]] Culler& culler, [[maybe_unused]] const std::string& name,
                         [[maybe_unused]] bool as_picture) {
#ifdef SIGHTLINE_HAS_GL
  if (auto* gl_culler = dynamic_cast<GlCuller*>(&culler); gl_culler != nullptr && gl_culler->timeline() != nullptr) {
    const std::vector<gl::Span>& spans = gl_culler->timeline()->spans();
    if (!as_picture) return gl::chrome_trace(spans, name);
    return gl::timeline_svg(spans, spans.empty() ? 0 : spans.back().frame, name);
  }
#endif
  return "";
}

}  // namespace sightline::cli
