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

}  // namespace sightline::gl
