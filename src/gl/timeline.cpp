#include "gl/timeline.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <cstdio>

namespace sightline::gl {

Timeline::Timeline() : start_(std::chrono::steady_clock::now()) {
  GLint64 device = 0;
  glGetInteger64v(GL_TIMESTAMP, &device);
  device_start_ = device;
}

Timeline::~Timeline() {
  for (const Pending& pending : pending_) glDeleteQueries(2, pending.stamps);
  if (!free_.empty()) glDeleteQueries(static_cast<GLsizei>(free_.size()), free_.data());
}

double Timeline::now() const {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start_).count();
}

unsigned Timeline::stamp() {
  GLuint name = 0;
  if (free_.empty()) {
    glGenQueries(1, &name);
  } else {
    name = free_.back();
    free_.pop_back();
  }
  glQueryCounter(name, GL_TIMESTAMP);
  return name;
}

void Timeline::collect() {
  for (Pending& pending : pending_) {
    GLuint64 times[2] = {0, 0};
    for (int i = 0; i < 2; ++i) glGetQueryObjectui64v(pending.stamps[i], GL_QUERY_RESULT, &times[i]);
    free_.insert(free_.end(), pending.stamps, pending.stamps + 2);
    pending.span.lane = Lane::device;
    pending.span.begin = 1e-3 * static_cast<double>(static_cast<std::int64_t>(times[0]) - device_start_);
    pending.span.end = 1e-3 * static_cast<double>(static_cast<std::int64_t>(times[1]) - device_start_);
    spans_.push_back(pending.span);
  }
  pending_.clear();
}

void Timeline::frame() {
  collect();
  if (any_frame_) ++frame_;
  any_frame_ = true;
}

const std::vector<Span>& Timeline::spans() {
  collect();
  return spans_;
}

Timeline::Guard::Guard(Timeline* timeline, char kind, std::uint32_t count) : timeline_(timeline) {
  if (timeline_ == nullptr) return;
  span_.kind = kind;
  span_.count = count;
  span_.frame = timeline_->frame_;
  if (kind == 'D' || kind == 'Q') stamps_[0] = timeline_->stamp();
  span_.begin = timeline_->now();
}

Timeline::Guard::~Guard() {
  if (timeline_ == nullptr) return;
  span_.end = timeline_->now();
  timeline_->spans_.push_back(span_);
  if (stamps_[0] == 0) return;
  stamps_[1] = timeline_->stamp();
  timeline_->pending_.push_back({span_, {stamps_[0], stamps_[1]}});
}

std::string chrome_trace(const std::vector<Span>& spans, const std::string& name) {
  std::string text = "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n";
  text += "{\"ph\":\"M\",\"pid\":1,\"name\":\"process_name\",\"args\":{\"name\":\"" + name + "\"}},\n";
  text += "{\"ph\":\"M\",\"pid\":1,\"tid\":1,\"name\":\"thread_name\",\"args\":{\"name\":\"processor\"}},\n";
  text += "{\"ph\":\"M\",\"pid\":1,\"tid\":2,\"name\":\"thread_name\",\"args\":{\"name\":\"device\"}}";
  for (const Span& span : spans) {
    const char* words = span.kind == 'D' ? "draw" : span.kind == 'Q' ? "query" : span.kind == 'R' ? "result" : "wait";
    char line[256];
    std::snprintf(line, sizeof line,
                  ",\n{\"ph\":\"X\",\"pid\":1,\"tid\":%d,\"name\":\"%s\",\"cat\":\"%c\",\"ts\":%.3f,\"dur\":%.3f,"
                  "\"args\":{\"frame\":%u,\"count\":%u}}",
                  span.lane == Lane::processor ? 1 : 2, words, span.kind, span.begin,
                  std::max(0.0, span.end - span.begin), span.frame, span.count);
    text += line;
  }
  return text + "\n]}\n";
}

std::string timeline_svg(const std::vector<Span>& spans, std::uint32_t frame, const std::string& name) {
  double begin = 1e300, end = -1e300;
  for (const Span& span : spans) {
    if (span.frame != frame) continue;
    begin = std::min(begin, span.begin);
    end = std::max(end, span.end);
  }
  if (end <= begin) begin = 0.0, end = 1.0;
  constexpr double left = 80.0, width = 900.0;
  const auto x = [&](double t) { return left + width * (t - begin) / (end - begin); };
  char line[320];
  std::snprintf(line, sizeof line,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1000\" height=\"170\" font-family=\"sans-serif\" "
                "font-size=\"13\"><rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n"
                "<text x=\"500\" y=\"20\" text-anchor=\"middle\">frame %u of %s: %.2f ms</text>\n",
                frame, name.c_str(), 1e-3 * (end - begin));
  std::string svg = line;
  for (const Lane lane : {Lane::processor, Lane::device}) {
    const double y = lane == Lane::processor ? 40.0 : 90.0;
    std::snprintf(line, sizeof line, "<text x=\"8\" y=\"%.0f\">%s</text>\n", y + 24.0,
                  lane == Lane::processor ? "processor" : "device");
    svg += line;
    for (const Span& span : spans) {
      if (span.frame != frame || span.lane != lane) continue;
      const char* colour = span.kind == 'D'   ? "#1f6fb4"
                           : span.kind == 'Q' ? "#e58c2f"
                           : span.kind == 'R' ? "#2e933c"
                                              : "#d1495b";
      const double wide = std::max(1.0, x(span.end) - x(span.begin));
      std::snprintf(line, sizeof line,
                    "<rect x=\"%.1f\" y=\"%.0f\" width=\"%.1f\" height=\"38\" fill=\"%s\"/>"
                    "<text x=\"%.1f\" y=\"%.0f\" fill=\"white\" text-anchor=\"middle\">%s</text>\n",
                    x(span.begin), y, wide, colour, x(span.begin) + 0.5 * wide, y + 24.0,
                    wide < 14.0 ? "" : std::string(1, span.kind).c_str());
      svg += line;
    }
  }
  return svg +
         "<text x=\"80\" y=\"155\">D drawing, Q querying, R reading results, W waiting for one; the device's clock is "
         "its own</text>\n</svg>\n";
}

}  // namespace sightline::gl
