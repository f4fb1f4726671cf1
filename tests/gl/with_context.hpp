// The one context of a test program. Where OpenGL cannot be had, tests are skipped and say why; they never pass.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "gl/context.hpp"

namespace sightline::gl {

class WithContext : public testing::Test {
 protected:
  void SetUp() override {
    if (context() == nullptr) GTEST_SKIP() << "NO OPENGL HERE: " << reason();
    context()->make_current();
  }
  static Context* context() {
    static const std::unique_ptr<Context> one = [] {
      try {
        return std::make_unique<Context>();
      } catch (const Unavailable& error) {
        reason() = error.what();
        return std::unique_ptr<Context>();
      }
    }();
    return one.get();
  }

 private:
  static std::string& reason() {
    static std::string text;
    return text;
  }
};

}  // namespace sightline::gl
