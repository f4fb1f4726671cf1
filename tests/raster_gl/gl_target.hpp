// A small OpenGL target without a window (EGL surfaceless, through epoxy), set from the pipeline's own State, so that
// both draw the same. Images are kept with the row order of sightline: y is negated on the way in.
#pragma once

#ifdef SIGHTLINE_HAS_EPOXY
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#endif

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "sightline/raster/target.hpp"

namespace sightline::raster {

struct GlVertex {
  glm::vec4 position, colour;
};

#ifdef SIGHTLINE_HAS_EPOXY

class GlContext {
 public:
  /// Null where there is no EGL; `reason` says why.
  static std::unique_ptr<GlContext> make(std::string& reason) {
    setenv("LP_NUM_THREADS", "0", 0);
    std::unique_ptr<GlContext> gl(new GlContext);
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base") ||
        !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
      reason = "EGL has no surfaceless platform";
      return nullptr;
    }
    gl->display_ = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (gl->display_ == EGL_NO_DISPLAY || eglInitialize(gl->display_, nullptr, nullptr) == EGL_FALSE) {
      reason = "no EGL display";
      return nullptr;
    }
    const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    eglChooseConfig(gl->display_, wanted, &config, 1, &count);
    eglBindAPI(EGL_OPENGL_API);
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
    gl->context_ = eglCreateContext(gl->display_, count > 0 ? config : nullptr, EGL_NO_CONTEXT, version);
    if (gl->context_ == EGL_NO_CONTEXT ||
        eglMakeCurrent(gl->display_, EGL_NO_SURFACE, EGL_NO_SURFACE, gl->context_) == EGL_FALSE) {
      reason = "no OpenGL 3.3 context";
      return nullptr;
    }
    gl->prepare();
    return gl;
  }
  ~GlContext() {
    if (context_ == EGL_NO_CONTEXT) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
  }
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  static std::string renderer() { return reinterpret_cast<const char*>(glGetString(GL_RENDERER)); }

 private:
  GlContext() = default;

  static GLuint shader(GLenum kind, const char* text) {
    const GLuint id = glCreateShader(kind);
    glShaderSource(id, 1, &text, nullptr);
    glCompileShader(id);
    GLint ok = 0;
    glGetShaderiv(id, GL_COMPILE_STATUS, &ok);
    if (ok == 0) throw std::runtime_error("shader does not compile");
    return id;
  }

  void prepare() {
    program_ = glCreateProgram();
    glAttachShader(program_, shader(GL_VERTEX_SHADER,
                                    "#version 330\n"
                                    "layout(location=0) in vec4 p; layout(location=1) in vec4 c; out vec4 colour;\n"
                                    "void main() { gl_Position = p; colour = c; }\n"));
    // The alpha test as the fixed function had it; `func` is the index of raster::Compare.
    glAttachShader(program_, shader(GL_FRAGMENT_SHADER,
                                    "#version 330\n"
                                    "in vec4 colour; out vec4 result; uniform int func; uniform float ref;\n"
                                    "bool passes(float a) { switch (func) { case 0: return false; case 1: return a < "
                                    "ref; case 2: return a == ref; case 3: return a <= ref; case 4: return a > ref; "
                                    "case 5: return a != ref; case 6: return a >= ref; } return true; }\n"
                                    "void main() { if (!passes(colour.a)) discard; result = colour; }\n"));
    glLinkProgram(program_);
    glUseProgram(program_);
    func_ = glGetUniformLocation(program_, "func");
    ref_ = glGetUniformLocation(program_, "ref");
    GLuint array = 0, buffer = 0;
    glGenVertexArrays(1, &array);
    glBindVertexArray(array);
    glGenBuffers(1, &buffer);
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glEnableVertexAttribArray(0);
    glEnableVertexAttribArray(1);
    glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, sizeof(GlVertex), nullptr);
    glVertexAttribPointer(1, 4, GL_FLOAT, GL_FALSE, sizeof(GlVertex), reinterpret_cast<void*>(sizeof(glm::vec4)));
    glDisable(GL_DITHER);
  }

  friend class GlTarget;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  GLuint program_ = 0;
  GLint func_ = 0, ref_ = 0;
};

class GlTarget {
 public:
  GlTarget(const GlContext& gl, int width, int height, DepthFormat format)
      : gl_(gl), width_(width), height_(height), format_(format) {
    glGenFramebuffers(1, &buffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, buffer_);
    glGenRenderbuffers(2, attachments_);
    const bool stencil = format != DepthFormat::unorm16;
    attach(attachments_[0], GL_RGBA8, GL_COLOR_ATTACHMENT0);
    attach(attachments_[1],
           format == DepthFormat::float32   ? GL_DEPTH32F_STENCIL8
           : format == DepthFormat::unorm24 ? GL_DEPTH24_STENCIL8
                                            : GL_DEPTH_COMPONENT16,
           stencil ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw std::runtime_error("framebuffer is not complete");
    glViewport(0, 0, width, height);
  }
  ~GlTarget() {
    glDeleteRenderbuffers(2, attachments_);
    glDeleteFramebuffers(1, &buffer_);
  }
  GlTarget(const GlTarget&) = delete;
  GlTarget& operator=(const GlTarget&) = delete;

  void set(const State& s) const {
    toggle(GL_SCISSOR_TEST, s.scissor.enabled);
    glScissor(s.scissor.x, s.scissor.y, s.scissor.width, s.scissor.height);
    glUniform1i(gl_.func_, s.alpha_test.enabled ? static_cast<int>(s.alpha_test.func) : 7);
    glUniform1f(gl_.ref_, s.alpha_test.ref);
    toggle(GL_STENCIL_TEST, s.stencil.enabled);
    side(GL_FRONT, s.stencil.front);
    side(GL_BACK, s.stencil.back);
    toggle(GL_DEPTH_TEST, s.depth.enabled);
    glDepthFunc(GL_NEVER + static_cast<GLenum>(s.depth.func));
    glDepthMask(s.depth.mask ? GL_TRUE : GL_FALSE);
    toggle(GL_BLEND, s.blend.enabled);
    glBlendFuncSeparate(factor(s.blend.src_rgb), factor(s.blend.dst_rgb), factor(s.blend.src_alpha),
                        factor(s.blend.dst_alpha));
    glBlendEquationSeparate(equation(s.blend.rgb), equation(s.blend.alpha));
    glBlendColor(s.blend.constant.r, s.blend.constant.g, s.blend.constant.b, s.blend.constant.a);
    glColorMask(s.color_mask[0], s.color_mask[1], s.color_mask[2], s.color_mask[3]);
    toggle(GL_CULL_FACE, s.cull != CullFace::none);
    glCullFace(s.cull == CullFace::front ? GL_FRONT : s.cull == CullFace::both ? GL_FRONT_AND_BACK : GL_BACK);
    glFrontFace(s.front_is_ccw ? GL_CW : GL_CCW);  // the image stands on its head
  }

  void clear_colour(const State& state, const glm::vec4& v) const {
    set(state);
    glClearColor(v.r, v.g, v.b, v.a);
    glClear(GL_COLOR_BUFFER_BIT);
  }
  void clear_depth(const State& state, double z) const {
    set(state);
    glClearDepth(z);
    glClear(GL_DEPTH_BUFFER_BIT);
  }
  void clear_stencil(const State& state, int value) const {
    set(state);
    glClearStencil(value);
    glClear(GL_STENCIL_BUFFER_BIT);
  }

  void draw(const State& state, std::vector<GlVertex> vertices) const {
    set(state);
    for (GlVertex& v : vertices) v.position.y = -v.position.y;
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(GlVertex)), vertices.data(),
                 GL_STREAM_DRAW);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
  }

  /// Colour, depth codes and stencil as the pipeline stores them.
  void read(Target& target) const {
    glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, target.colour.data());
    if (format_ == DepthFormat::float32) {
      glReadPixels(0, 0, width_, height_, GL_DEPTH_COMPONENT, GL_FLOAT, target.depth.data());
    } else if (format_ == DepthFormat::unorm24) {
      glReadPixels(0, 0, width_, height_, GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8, target.depth.data());
      for (std::uint32_t& code : target.depth) code >>= 8;
    } else {
      std::vector<std::uint16_t> codes(target.depth.size());
      glReadPixels(0, 0, width_, height_, GL_DEPTH_COMPONENT, GL_UNSIGNED_SHORT, codes.data());
      std::copy(codes.begin(), codes.end(), target.depth.begin());
    }
    if (format_ != DepthFormat::unorm16)
      glReadPixels(0, 0, width_, height_, GL_STENCIL_INDEX, GL_UNSIGNED_BYTE, target.stencil.data());
  }

 private:
  void attach(GLuint id, GLenum format, GLenum point) const {
    glBindRenderbuffer(GL_RENDERBUFFER, id);
    glRenderbufferStorage(GL_RENDERBUFFER, format, width_, height_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, point, GL_RENDERBUFFER, id);
  }
  static void toggle(GLenum what, bool on) { on ? glEnable(what) : glDisable(what); }
  static GLenum op(StencilOp o) {
    constexpr GLenum names[] = {GL_KEEP, GL_ZERO, GL_REPLACE, GL_INCR, GL_DECR, GL_INVERT, GL_INCR_WRAP, GL_DECR_WRAP};
    return names[static_cast<int>(o)];
  }
  static void side(GLenum face, const StencilFace& s) {
    glStencilFuncSeparate(face, GL_NEVER + static_cast<GLenum>(s.func), s.ref, s.mask);
    glStencilOpSeparate(face, op(s.sfail), op(s.zfail), op(s.zpass));
    glStencilMaskSeparate(face, s.write_mask);
  }
  static GLenum factor(BlendFactor f) {
    constexpr GLenum names[] = {GL_ZERO,
                                GL_ONE,
                                GL_SRC_COLOR,
                                GL_ONE_MINUS_SRC_COLOR,
                                GL_DST_COLOR,
                                GL_ONE_MINUS_DST_COLOR,
                                GL_SRC_ALPHA,
                                GL_ONE_MINUS_SRC_ALPHA,
                                GL_DST_ALPHA,
                                GL_ONE_MINUS_DST_ALPHA,
                                GL_CONSTANT_COLOR,
                                GL_ONE_MINUS_CONSTANT_COLOR,
                                GL_CONSTANT_ALPHA,
                                GL_ONE_MINUS_CONSTANT_ALPHA,
                                GL_SRC_ALPHA_SATURATE};
    return names[static_cast<int>(f)];
  }
  static GLenum equation(BlendEquation e) {
    constexpr GLenum names[] = {GL_FUNC_ADD, GL_FUNC_SUBTRACT, GL_FUNC_REVERSE_SUBTRACT, GL_MIN, GL_MAX};
    return names[static_cast<int>(e)];
  }

  const GlContext& gl_;
  int width_, height_;
  DepthFormat format_;
  GLuint buffer_ = 0;
  GLuint attachments_[2] = {0, 0};
};

#endif

}  // namespace sightline::raster
