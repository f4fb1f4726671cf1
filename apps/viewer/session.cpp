#include "viewer/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <sstream>

#include "gl/registry.hpp"
#include "sightline/registry.hpp"

namespace sightline::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t longest_history = 240;
constexpr double views_per_second = 30.0;
constexpr std::uint32_t chosen_colour = 0xff00d7ffu, frustum_colour = 0xff000000u, unasked_colour = 0xffa0a0a0u;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

bool is_gl(const std::string& method) { return gl::find_algorithm(parse_method(method).name) != nullptr; }

bool library_has(std::string_view name) {
  return std::any_of(algorithms().begin(), algorithms().end(),
                     [&](const Algorithm& row) { return row.family == Family::culler && row.name == name; });
}

std::uint32_t hue(std::size_t i) {
  const auto x = static_cast<std::uint32_t>(i) * 2654435761u;
  return 0xff000000u | (64u + (x >> 25)) | (64u + ((x >> 17) & 127u)) << 8 | (64u + ((x >> 9) & 127u)) << 16;
}

}  // namespace

Session::Session(SessionConfig config, const IndexedScene& scene, gl::Context& context)
    : config_(std::move(config)),
      scene_(scene),
      drawing_(context, scene.scene),
      line_drawing_(context),
      navigation_(config_.start, scene.scene.bounds()),
      all_(VisibleSet::all(scene.scene.objects().size())),
      visible_(all_),
      frustum_culler_(make_culler("frustum_linear", scene)) {
  if (library_has("detail")) detail_culler_ = make_culler("detail", scene);
  figures_.scene_triangles = scene.scene.triangle_count();
  make_method();
}

Session::~Session() = default;

std::vector<std::pair<std::string, std::string>> Session::keys() {
  return {{"W A S D", "fly; E and X up and down, Shift faster"},
          {"drag", "orbit (left button), look around (right button); wheel: nearer, farther"},
          {"F", "frame: make the whole scene, or the chosen object, visible"},
          {"O", "overview: the whole scene from above"},
          {"C", "freeze culling and fly out; again to go on"},
          {"V", "colours by verdict: seen, outside the frustum, occluded, too small"},
          {"B", "bounds of the objects"},
          {"Z", "depth"},
          {"Q", "colours by the occlusion query that asked last (gl_chc, gl_chcpp)"},
          {"M", "next method"},
          {"N P", "next, previous view of the path; space plays it"},
          {"click", "why is this object seen?"},
          {"?", "this list"},
          {"Esc", "quit"}};
}

bool Session::press(char key) {
  switch (key) {
    case 'F':
      navigation_.frame(chosen_ != no_object ? drawing_.bounds()[chosen_] : scene_.scene.bounds(),
                        static_cast<double>(view_.width) / view_.height);
      return true;
    case 'O':
      navigation_.overview(scene_.scene.bounds(), static_cast<double>(view_.width) / view_.height);
      return true;
    case 'C':
      frozen_view_ = frozen_view_ ? std::nullopt : std::optional<View>(view_);
      return true;
    case 'V':
      by_standing_ = !by_standing_;
      return true;
    case 'B':
      bounds_ = !bounds_;
      return true;
    case 'Z':
      depth_ = !depth_;
      return true;
    case 'Q':
      by_query_ = !by_query_;
      return true;
    case 'M':
      set_method((method_index_ + 1) % config_.methods.size());
      return true;
    case 'N':
      step_path(1);
      return true;
    case 'P':
      step_path(-1);
      return true;
    case ' ':
      playing_ = !playing_ && !config_.path.empty();
      return true;
    case '?':
      help_ = !help_;
      return true;
    case '\x1b':
      quit_ = true;
      return true;
    default:
      return false;
  }
}

void Session::set_method(std::size_t index) {
  if (index == method_index_) return;
  method_index_ = index;
  make_method();
  if (frozen_view_) cull(*frozen_view_);
}

void Session::make_method() {
  culler_.reset();
  gl_method_.reset();
  query_log_.clear();
  if (is_gl(method()))
    gl_method_ = gl::make_method(method(), drawing_);
  else
    culler_ = make_culler(method(), scene_);
}

void Session::step_path(int by) {
  if (config_.path.empty()) return;
  const auto count = static_cast<std::ptrdiff_t>(config_.path.size());
  config_.path_frame = static_cast<std::size_t>((static_cast<std::ptrdiff_t>(config_.path_frame) + by + count) % count);
  navigation_.go_to(config_.path[config_.path_frame]);
}

void Session::draw(int width, int height, double seconds_since_last) {
  const auto start = Clock::now();
  if (playing_) {
    played_ += seconds_since_last * views_per_second;
    const double whole = std::floor(played_);
    if (whole > 0) step_path(static_cast<int>(std::min(whole, 1e6)));
    played_ -= whole;
  }
  view_ = navigation_.view(width, height);
  colour();
  if (!frozen_view_) cull(view_);
  // Through OpenGL culling is drawing; what is coloured by verdict or frozen is drawn anew.
  if (frozen_view_ || by_standing_ || gl_method_ == nullptr) {
    const auto drawing = Clock::now();
    drawing_.begin(view_, target_);
    drawing_.draw(by_standing_ ? all_.order() : visible_.order());
    figures_.draw_ms = milliseconds_since(drawing);
  }
  draw_lines();
  history_.push_back(static_cast<float>(milliseconds_since(start)));
  if (history_.size() > longest_history) history_.erase(history_.begin());
}

void Session::cull(const View& view) {
  figures_ = {.scene_triangles = figures_.scene_triangles};
  if (gl_method_ != nullptr)
    cull_through_gl(view);
  else
    cull_on_processor(view);
  judge(view);
}

void Session::cull_on_processor(const View& view) {
  Counters counters;
  const auto start = Clock::now();
  culler_->cull(view, all_, visible_, counters);
  figures_.cull_ms = milliseconds_since(start);
  figures_.queries = counters.queries;
}

void Session::cull_through_gl(const View& view) {
  gl::Work work;
  std::vector<ObjectId> drawn;
  query_log_.clear();
  gl_method_->set_log(by_query_ ? &query_log_ : nullptr);
  gl_method_->prepare(view, nullptr);
  drawing_.set_work(&work);
  const auto start = Clock::now();
  gl_method_->frame(view, target_);
  gl_method_->drawn(drawn);
  figures_.draw_ms = milliseconds_since(start);
  drawing_.set_work(nullptr);
  read_queries();
  visible_.reset(all_.universe());
  for (const ObjectId id : drawn) visible_.insert(id);
  figures_.queries = work.queries;
  figures_.state_changes = work.state_changes;
  figures_.waits = work.blocking_waits;
  figures_.draw_calls = work.draw_calls;
}

void Session::judge(const View& view) {
  Counters unused;
  frustum_culler_->cull(view, all_, frustum_, unused);
  if (detail_culler_ != nullptr) detail_culler_->cull(view, frustum_, large_, unused);
  standings_ = standings(frustum_, detail_culler_ != nullptr ? &large_ : nullptr, visible_);
  figures_.objects = count(standings_);
  for (const ObjectId id : visible_.order()) figures_.triangles += drawing_.triangles_of(id);
}

void Session::colour() {
  if (by_standing_ && !standings_.empty()) {
    drawing_.set_colours(colours_of(standings_));
  } else if (by_query_) {
    std::vector<std::uint32_t> colours(all_.universe(), unasked_colour);
    for (std::size_t query = 0; query < queries_.size(); ++query)
      for (const std::uint32_t node : queries_[query]) {
        const ItemRange below = items_below(drawing_.bvh(), node);
        for (std::uint32_t i = below.begin; i < below.end; ++i) colours[drawing_.bvh().items[i]] = hue(query);
      }
    drawing_.set_colours(colours);
  } else if (recoloured_) {
    drawing_.set_colours({});
  }
  recoloured_ = by_standing_ || by_query_;
}

void Session::draw_lines() {
  std::vector<gl::Line> lines;
  if (frozen_view_) {
    const double across = scene_.scene.bounds().empty() ? 1.0 : glm::length(scene_.scene.bounds().extent());
    gl::add_frustum(lines, *frozen_view_, std::min(frozen_view_->far, 0.5 * across), frustum_colour);
  }
  if (bounds_)
    for (std::size_t i = 0; i < standings_.size(); ++i)
      gl::add_box(lines, drawing_.bounds()[i], looks[static_cast<std::size_t>(standings_[i])].colour);
  if (by_query_)
    for (std::size_t query = 0; query < queries_.size(); ++query)
      for (const std::uint32_t node : queries_[query])
        gl::add_box(lines, drawing_.bvh().nodes[node].bounds, hue(query));
  if (chosen_ != no_object) gl::add_box(lines, drawing_.bounds()[chosen_], chosen_colour);
  line_drawing_.draw(view_, lines, target_);
}

/// Lines of the log are "FRAME node A [B ...] -> answer" or "FRAME node A answer": numbers after "node" name nodes.
void Session::read_queries() {
  queries_.clear();
  std::istringstream log(query_log_);
  std::string text;
  while (std::getline(log, text)) {
    std::vector<std::uint32_t> nodes;
    std::istringstream words(text);
    std::string word;
    while (words >> word && !word.starts_with("node")) {
    }
    while (words >> word) {
      char* end = nullptr;
      const unsigned long node = std::strtoul(word.c_str(), &end, 10);
      if (end == word.c_str() || node >= drawing_.bvh().nodes.size()) break;
      nodes.push_back(static_cast<std::uint32_t>(node));
    }
    if (!nodes.empty()) queries_.push_back(std::move(nodes));
  }
}

void Session::choose(int x, int y) {
  chosen_ = no_object;
  explanation_.clear();
  if (x < 0 || y < 0 || x >= target_.width() || y >= target_.height()) return;
  std::vector<std::uint32_t> ids;
  target_.read_ids(ids);
  const std::size_t row = static_cast<std::size_t>(target_.height() - 1 - y);
  chosen_ = ids[row * static_cast<std::size_t>(target_.width()) + static_cast<std::size_t>(x)];
  if (chosen_ == no_object) return;
  navigation_.set_pivot(glm::dvec3(drawing_.bounds()[chosen_].centre()));
  const std::string_view word = standings_.empty() ? "" : looks[static_cast<std::size_t>(standings_[chosen_])].word;
  explanation_ = fmt::format("object {} {}\n{} triangles, {}\n", chosen_, scene_.scene.name(chosen_),
                             drawing_.triangles_of(chosen_), word);
  if (config_.explain)
    explanation_ +=
        config_.explain(frozen_view_ ? *frozen_view_ : view_, chosen_, method(), visible_.contains(chosen_));
}

std::string Session::command_line() const {
  return fmt::format("sightline view {} --method {} {}", config_.scene_argument, method(), describe(view_));
}

}  // namespace sightline::viewer
