// An OpenGL 4.5 core context: one without window or display (EGL), or the one that a window has made current.
// Everything in this folder takes its context at construction.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

namespace sightline::gl {

/// There is no OpenGL here that could be used, or it went away; what() is one line. What needs it is skipped.
class Unavailable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct ContextConfig {
  int major = 4, minor = 5;     // least version, core profile
  bool prefer_hardware = true;  // a device of the machine before the software renderer
};

/// Serves one thread: the one in which it was made.
class Context {
 public:
  /// Makes a context without a surface and makes it current. Throws Unavailable: no EGL, no device, too old.
  explicit Context(const ContextConfig& config = {});
  /// Takes the context that is current in this thread and leaves its ownership to the caller. Throws Unavailable.
  static Context of_current(const ContextConfig& config = {});
  ~Context();
  Context(Context&&) noexcept;
  Context& operator=(Context&&) = delete;

  void make_current();
  /// True if the processor draws (llvmpipe and the like).
  [[nodiscard]] bool software() const;
  /// "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5".
  [[nodiscard]] const std::string& description() const;
  [[nodiscard]] bool has_extension(const char* name) const;
  /// Throws Unavailable if the context was lost or ran out of memory since the last call; `where` is named in it.
  void check(const char* where) const;

 private:
  struct State;
  explicit Context(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace sightline::gl
