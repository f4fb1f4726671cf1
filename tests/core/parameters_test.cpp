// Methods as a person types them: what is read, and one clear line for what cannot be.
#include "sightline/core/parameters.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

TEST(Parameters, NameAlone) {
  const MethodSpec spec = parse_method("frustum_linear");
  EXPECT_EQ(spec.name, "frustum_linear");
  EXPECT_TRUE(spec.parameters.empty());
}

TEST(Parameters, NameWithValues) {
  const MethodSpec spec = parse_method("m:width=640:depth=1e-4:path=a=b:empty=");
  EXPECT_EQ(spec.name, "m");
  EXPECT_EQ(spec.parameters.at("width"), "640");
  EXPECT_EQ(spec.parameters.at("depth"), "1e-4");
  EXPECT_EQ(spec.parameters.at("path"), "a=b");
  EXPECT_EQ(spec.parameters.at("empty"), "");
}

TEST(Parameters, MalformedMethodsAreErrors) {
  for (const char* text : {"", ":a=1", "m:", "m:a", "m:=1", "m:a=1:", "m:a=1:a=2"})
    EXPECT_THROW(parse_method(text), InputError) << text;
}

TEST(Parameters, ValuesAreReadByType) {
  const MethodSpec spec = parse_method("m:i=-7:d=2.5e-3:b=on:c=off:s=text");
  ParameterReader reader(spec);
  int i = 0;
  double d = 0;
  bool b = false, c = true;
  std::string s;
  reader.read("i", i, -10, 10);
  reader.read("d", d, 0.0, 1.0);
  reader.read("b", b);
  reader.read("c", c);
  reader.read("s", s);
  EXPECT_EQ(i, -7);
  EXPECT_EQ(d, 2.5e-3);
  EXPECT_TRUE(b);
  EXPECT_FALSE(c);
  EXPECT_EQ(s, "text");
  EXPECT_NO_THROW(reader.finish());
}

TEST(Parameters, WhatIsNotGivenKeepsItsDefault) {
  const MethodSpec spec = parse_method("m");
  ParameterReader reader(spec);
  int i = 3;
  double d = 0.5;
  bool b = true;
  reader.read("i", i, 0, 10);
  reader.read("d", d, 0.0, 1.0);
  reader.read("b", b);
  reader.finish();
  EXPECT_EQ(i, 3);
  EXPECT_EQ(d, 0.5);
  EXPECT_TRUE(b);
}

std::string error_of(const std::string& method, const std::function<void(ParameterReader&)>& read) {
  const MethodSpec spec = parse_method(method);
  ParameterReader reader(spec);
  try {
    read(reader);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Parameters, BadValuesAreErrorsThatNameThem) {
  const auto read_int = [](ParameterReader& r) {
    int i = 0;
    r.read("width", i, 1, 100);
  };
  for (const char* value : {"", "x", "1x", "1.5", " 1", "0", "101", "99999999999999999999", "0x10"}) {
    const std::string error = error_of(std::string("tool:width=") + value, read_int);
    EXPECT_NE(error.find("tool: width"), std::string::npos) << "'" << value << "': " << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
  const auto read_double = [](ParameterReader& r) {
    double d = 0;
    r.read("depth", d, 0.0, 1.0);
  };
  for (const char* value : {"", "nan", "inf", "-0.5", "1.5", "1e999", "0.5m"})
    EXPECT_NE(error_of(std::string("tool:depth=") + value, read_double).find("tool: depth"), std::string::npos)
        << value;
  const auto read_bool = [](ParameterReader& r) {
    bool b = false;
    r.read("fast", b);
  };
  for (const char* value : {"", "yes", "1", "ON"})
    EXPECT_NE(error_of(std::string("tool:fast=") + value, read_bool).find("tool: fast"), std::string::npos) << value;
}

TEST(Parameters, UnknownOnesAreErrorsThatNameTheKnown) {
  const std::string error = error_of("tool:widht=5", [](ParameterReader& r) {
    int i = 0;
    double d = 0;
    r.read("width", i, 1, 100);
    r.read("depth", d, 0.0, 1.0);
    r.finish();
  });
  for (const char* part : {"widht", "width", "depth"}) EXPECT_NE(error.find(part), std::string::npos) << error;
}

}  // namespace
}  // namespace sightline
