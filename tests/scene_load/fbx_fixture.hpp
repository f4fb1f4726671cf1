// A tetrahedron as FBX 7.4, ASCII or binary, with axes and unit of our choice. (Binary files of assimp's exporter lack
// the records that end a list of nodes, and cannot be read back.)
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <variant>
#include <vector>

namespace sightline::test {

struct FbxNode {
  using Value =
      std::variant<std::int32_t, std::int64_t, double, std::string, std::vector<double>, std::vector<std::int32_t>>;
  std::string name;
  std::vector<Value> values;
  std::vector<FbxNode> children;
};

/// Z or Y up; `unit` in centimetres. The model is moved by (10, 20, 30) units of the file.
inline std::vector<FbxNode> fbx_tetrahedron(bool z_up, double unit) {
  using namespace std::string_literals;
  const auto integer = [](const std::string& name, std::int32_t value) {
    return FbxNode{"P", {name, "int"s, "Integer"s, ""s, value}, {}};
  };
  const FbxNode settings{"GlobalSettings",
                         {},
                         {{"Version", {1000}, {}},
                          {"Properties70",
                           {},
                           {integer("UpAxis", z_up ? 2 : 1),
                            integer("UpAxisSign", 1),
                            integer("FrontAxis", z_up ? 1 : 2),
                            integer("FrontAxisSign", z_up ? -1 : 1),
                            integer("CoordAxis", 0),
                            integer("CoordAxisSign", 1),
                            {"P", {"UnitScaleFactor"s, "double"s, "Number"s, ""s, unit}, {}}}}}};
  const FbxNode geometry{
      "Geometry",
      {std::int64_t{11}, "Geometry::tetrahedron"s, "Mesh"s},
      {{"Vertices", {std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}}, {}},
       {"PolygonVertexIndex", {std::vector<std::int32_t>{0, 2, ~1, 0, 1, ~3, 0, 3, ~2, 1, 2, ~3}}, {}}}};
  const FbxNode model{
      "Model",
      {std::int64_t{12}, "Model::tetrahedron"s, "Mesh"s},
      {{"Properties70", {}, {{"P", {"Lcl Translation"s, "Lcl Translation"s, ""s, "A"s, 10.0, 20.0, 30.0}, {}}}}}};
  return {{"FBXHeaderExtension", {}, {{"FBXVersion", {7400}, {}}}},
          settings,
          {"Objects", {}, {geometry, model}},
          {"Connections",
           {},
           {{"C", {"OO"s, std::int64_t{12}, std::int64_t{0}}, {}},
            {"C", {"OO"s, std::int64_t{11}, std::int64_t{12}}, {}}}}};
}

inline std::string fbx_text(const std::vector<FbxNode>& nodes) {
  std::string text;
  for (const FbxNode& node : nodes) {
    text += node.name + ": ";
    bool first = true;
    for (const FbxNode::Value& value : node.values) {
      if (!first) text += ", ";
      first = false;
      std::visit(
          [&](const auto& v) {
            using Kind = std::decay_t<decltype(v)>;
            if constexpr (std::is_same_v<Kind, std::string>) {
              text += "\"" + v + "\"";
            } else if constexpr (std::is_arithmetic_v<Kind>) {
              text += std::to_string(v);
            } else {
              text += "*" + std::to_string(v.size()) + " {\na: ";
              for (std::size_t i = 0; i < v.size(); ++i) text += (i > 0 ? "," : "") + std::to_string(v[i]);
              text += "\n}";
            }
          },
          value);
    }
    if (!node.children.empty()) text += " {\n" + fbx_text(node.children) + "}";
    text += "\n";
  }
  return text;
}

class FbxBinary {
 public:
  explicit FbxBinary(const std::vector<FbxNode>& nodes) {
    bytes_ = std::string("Kaydara FBX Binary  \0\x1a\0", 23);
    append(std::uint32_t{7400});
    append(nodes);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  template <class Number>
  void append(Number number) {
    bytes_.append(reinterpret_cast<const char*>(&number), sizeof(number));
  }

  void append(const std::vector<FbxNode>& nodes) {
    for (const FbxNode& node : nodes) append(node);
    bytes_.append(13, '\0');
  }

  void append(const FbxNode& node) {
    const std::size_t start = bytes_.size();
    bytes_.append(8, '\0');
    append(std::uint32_t{0});
    append(static_cast<std::uint8_t>(node.name.size()));
    bytes_ += node.name;
    const std::size_t values = bytes_.size();
    for (const FbxNode::Value& value : node.values) {
      std::visit([&](const auto& v) { append_value(v); }, value);
    }
    const std::size_t values_end = bytes_.size();
    if (!node.children.empty()) append(node.children);
    const std::uint32_t header[3] = {static_cast<std::uint32_t>(bytes_.size()),
                                     static_cast<std::uint32_t>(node.values.size()),
                                     static_cast<std::uint32_t>(values_end - values)};
    std::memcpy(bytes_.data() + start, header, sizeof(header));
  }

  void append_value(std::int32_t v) { bytes_ += 'I', append(v); }
  void append_value(std::int64_t v) { bytes_ += 'L', append(v); }
  void append_value(double v) { bytes_ += 'D', append(v); }
  void append_value(const std::string& v) {
    // "Kind::name" of the ASCII form is name, 0, 1, kind here.
    std::string text = v;
    if (const std::size_t colons = v.find("::"); colons != std::string::npos) {
      text = v.substr(colons + 2) + std::string("\0\1", 2) + v.substr(0, colons);
    }
    bytes_ += 'S';
    append(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
  }
  template <class Number>
  void append_value(const std::vector<Number>& v) {
    bytes_ += sizeof(Number) == 8 ? 'd' : 'i';
    append(static_cast<std::uint32_t>(v.size()));
    append(std::uint32_t{0});
    append(static_cast<std::uint32_t>(v.size() * sizeof(Number)));
    for (const Number number : v) append(number);
  }

  std::string bytes_;
};

}  // namespace sightline::test
