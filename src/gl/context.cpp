#include "gl/context.hpp"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <cstring>
#include <vector>

namespace sightline::gl {

struct Context::State {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  bool owned = false;
  bool software = true;
  std::string description;

  ~State() {
    if (!owned || display == EGL_NO_DISPLAY) return;
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
    // The display stays initialised: EGL hands out the same one to everybody who asks for it.
  }
};

namespace {

/// Epoxy aborts the program where a library is missing; so it is looked for first.
void require_library(std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (dlopen(name, RTLD_LAZY | RTLD_LOCAL) != nullptr) return;  // stays loaded: epoxy opens it again
  throw Unavailable(std::string("no OpenGL: the library ") + *names.begin() + " cannot be loaded");
}

bool is_software(const std::string& renderer) {
  for (const char* word : {"llvmpipe", "softpipe", "swrast", "SWR", "Software"})
    if (renderer.find(word) != std::string::npos) return true;
  return false;
}

/// Displays worth trying, devices first if they are preferred.
std::vector<EGLDisplay> displays(bool devices_first) {
  std::vector<EGLDisplay> found;
  const auto add = [&](EGLenum platform, void* native) {
    const EGLDisplay display = eglGetPlatformDisplayEXT(platform, native, nullptr);
    if (display != EGL_NO_DISPLAY) found.push_back(display);
  };
  const bool surfaceless = epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless");
  if (!devices_first && surfaceless) add(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY);
  if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
      epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base")) {
    EGLDeviceEXT devices[16];
    EGLint count = 0;
    if (eglQueryDevicesEXT(16, devices, &count))
      for (EGLint i = 0; i < count; ++i) add(EGL_PLATFORM_DEVICE_EXT, devices[i]);
  }
  if (devices_first && surfaceless) add(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY);
  return found;
}

EGLContext make_context(EGLDisplay display, const ContextConfig& config) {
  const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
  EGLConfig chosen = EGL_NO_CONFIG_KHR;
  EGLint count = 0;
  if (!eglChooseConfig(display, wanted, &chosen, 1, &count) || count == 0) chosen = EGL_NO_CONFIG_KHR;
  std::vector<EGLint> attributes = {EGL_CONTEXT_MAJOR_VERSION,       config.major,
                                    EGL_CONTEXT_MINOR_VERSION,       config.minor,
                                    EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
  // Without this a context that is lost does not say so. Not every driver knows it.
  std::vector<EGLint> told = attributes;
  told.insert(told.end(), {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET, EGL_NONE});
  const EGLContext context = eglCreateContext(display, chosen, EGL_NO_CONTEXT, told.data());
  if (context != EGL_NO_CONTEXT) return context;
  attributes.push_back(EGL_NONE);
  return eglCreateContext(display, chosen, EGL_NO_CONTEXT, attributes.data());
}

/// Fills in what the current context is; throws if it is too old.
template <class State>
void look_at_current(State& state, const ContextConfig& config) {
  const auto* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  if (renderer == nullptr) throw Unavailable("no OpenGL: the context does not answer");
  const int version = epoxy_gl_version();
  state.description =
      std::string(renderer) + ", OpenGL " + std::to_string(version / 10) + "." + std::to_string(version % 10);
  state.software = is_software(renderer);
  if (version < 10 * config.major + config.minor)
    throw Unavailable("OpenGL " + std::to_string(config.major) + "." + std::to_string(config.minor) +
                      " is needed, there is " + state.description);
}

}  // namespace

Context::Context(std::unique_ptr<State> state) : state_(std::move(state)) {}
Context::Context(Context&&) noexcept = default;
Context::~Context() = default;

Context::Context(const ContextConfig& config) {
  require_library({"libEGL.so.1", "libEGL.so"});
  require_library({"libOpenGL.so.0", "libGL.so.1"});
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base"))
    throw Unavailable("no OpenGL: EGL has no driver that draws without a display");
  std::string reason = "EGL knows no device";
  std::unique_ptr<State> fallback;
  for (const EGLDisplay display : displays(config.prefer_hardware)) {
    EGLint major = 0, minor = 0;
    if (!eglInitialize(display, &major, &minor) || !eglBindAPI(EGL_OPENGL_API)) {
      reason = "EGL cannot start its device";
      continue;
    }
    auto state = std::make_unique<State>();
    state->display = display;
    state->owned = true;
    state->context = make_context(display, config);
    if (state->context == EGL_NO_CONTEXT || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, state->context)) {
      reason = "OpenGL " + std::to_string(config.major) + "." + std::to_string(config.minor) +
               " core cannot be had on this machine";
      continue;
    }
    try {
      look_at_current(*state, config);
    } catch (const Unavailable& error) {
      reason = error.what();
      continue;
    }
    if (!state->software || !config.prefer_hardware) {
      state_ = std::move(state);
      break;
    }
    if (!fallback) fallback = std::move(state);
  }
  if (!state_) state_ = std::move(fallback);
  if (!state_) throw Unavailable("no OpenGL: " + reason);
  make_current();
}

Context Context::of_current(const ContextConfig& config) {
  auto state = std::make_unique<State>();
  look_at_current(*state, config);
  return Context(std::move(state));
}

void Context::make_current() {
  if (state_->owned && !eglMakeCurrent(state_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, state_->context))
    throw Unavailable("the OpenGL context cannot be made current");
}

bool Context::software() const { return state_->software; }
const std::string& Context::description() const { return state_->description; }
bool Context::has_extension(const char* name) const { return epoxy_has_gl_extension(name); }

void Context::check(const char* where) const {
  const GLenum reset = glGetGraphicsResetStatus();
  if (reset != GL_NO_ERROR) throw Unavailable(std::string("the OpenGL context was lost in ") + where);
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  if (error == GL_OUT_OF_MEMORY) throw Unavailable(std::string("OpenGL ran out of memory in ") + where);
  char code[16];
  std::snprintf(code, sizeof code, "0x%04x", error);
  throw std::logic_error(std::string("OpenGL error ") + code + " in " + where);
}

}  // namespace sightline::gl
