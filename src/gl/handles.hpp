// Owners of OpenGL names: a buffer, a texture, a vertex array and a program that go away with their owner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace sightline::gl {

/// Deletes `name` when it goes; moves, does not copy.
template <void (*Delete)(unsigned)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(unsigned name) : name_(name) {}
  ~Handle() {
    if (name_ != 0) Delete(name_);
  }
  Handle(Handle&& other) noexcept : name_(std::exchange(other.name_, 0u)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  [[nodiscard]] unsigned name() const { return name_; }
  explicit operator bool() const { return name_ != 0; }

 private:
  unsigned name_ = 0;
};

void delete_buffer(unsigned name);
void delete_texture(unsigned name);
void delete_vertex_array(unsigned name);
void delete_framebuffer(unsigned name);
void delete_program(unsigned name);

using Buffer = Handle<delete_buffer>;
using Texture = Handle<delete_texture>;
using VertexArray = Handle<delete_vertex_array>;
using Framebuffer = Handle<delete_framebuffer>;
using Program = Handle<delete_program>;

/// A buffer of `bytes` bytes, filled from `data` unless that is null. Never of size 0. Throws Unavailable if there is
/// no memory for it.
Buffer make_buffer(std::size_t bytes, const void* data = nullptr);
template <class T>
Buffer make_buffer(const std::vector<T>& values) {
  return make_buffer(values.size() * sizeof(T), values.data());
}

/// A buffer that is filled anew again and again and grows as needed.
class StreamBuffer {
 public:
  /// Replaces the content; earlier content may still be in use by commands that were given.
  void fill(const void* data, std::size_t bytes);
  [[nodiscard]] unsigned name() const { return buffer_.name(); }

 private:
  Buffer buffer_;
  std::size_t capacity_ = 0;
};

/// Compiles and links; throws std::logic_error with the compiler's words, as the sources are ours.
Program make_program(const std::string& vertex, const std::string& fragment);
Program make_compute_program(const std::string& compute);

}  // namespace sightline::gl
