#include "gl/handles.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <stdexcept>

#include "gl/context.hpp"

namespace sightline::gl {

void delete_buffer(unsigned name) { glDeleteBuffers(1, &name); }
void delete_texture(unsigned name) { glDeleteTextures(1, &name); }
void delete_vertex_array(unsigned name) { glDeleteVertexArrays(1, &name); }
void delete_framebuffer(unsigned name) { glDeleteFramebuffers(1, &name); }
void delete_program(unsigned name) { glDeleteProgram(name); }

Buffer make_buffer(std::size_t bytes, const void* data) {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  Buffer buffer(name);
  glNamedBufferStorage(name, static_cast<GLsizeiptr>(std::max<std::size_t>(bytes, 16)), nullptr,
                       GL_DYNAMIC_STORAGE_BIT);
  if (glGetError() == GL_OUT_OF_MEMORY)
    throw Unavailable("OpenGL has no memory for a buffer of " + std::to_string(bytes) + " bytes");
  if (data != nullptr && bytes > 0) glNamedBufferSubData(name, 0, static_cast<GLsizeiptr>(bytes), data);
  return buffer;
}

void StreamBuffer::fill(const void* data, std::size_t bytes) {
  if (!buffer_) {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    buffer_ = Buffer(name);
  }
  capacity_ = std::max<std::size_t>({capacity_, bytes, 4096});
  // Orphaned, so that nobody waits for commands that read the old content.
  glNamedBufferData(buffer_.name(), static_cast<GLsizeiptr>(capacity_), nullptr, GL_STREAM_DRAW);
  if (bytes > 0) glNamedBufferSubData(buffer_.name(), 0, static_cast<GLsizeiptr>(bytes), data);
}

namespace {

GLuint compile(GLenum stage, const std::string& source) {
  const GLuint shader = glCreateShader(stage);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good != 0) return shader;
  char log[2048] = "";
  glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  glDeleteShader(shader);
  throw std::logic_error(std::string("a shader does not compile: ") + log);
}

Program link(std::initializer_list<GLuint> shaders) {
  Program program(glCreateProgram());
  for (const GLuint shader : shaders) glAttachShader(program.name(), shader);
  glLinkProgram(program.name());
  for (const GLuint shader : shaders) {
    glDetachShader(program.name(), shader);
    glDeleteShader(shader);
  }
  GLint good = 0;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &good);
  if (good != 0) return program;
  char log[2048] = "";
  glGetProgramInfoLog(program.name(), sizeof log, nullptr, log);
  throw std::logic_error(std::string("a shader program does not link: ") + log);
}

}  // namespace

Program make_program(const std::string& vertex, const std::string& fragment) {
  return link({compile(GL_VERTEX_SHADER, vertex), compile(GL_FRAGMENT_SHADER, fragment)});
}

Program make_compute_program(const std::string& compute) { return link({compile(GL_COMPUTE_SHADER, compute)}); }

}  // namespace sightline::gl
