// Wavefront OBJ into a scene: faces of one object and group name are one object, those that let light through another.
// tinyobjloader tells the lines apart and reads groups and materials; the numbers of vertices and faces are read here,
// because it takes wrong ones as zero. Polygons are triangulated whatever their shape.
#include <tiny_obj_loader.h>

#include <array>
#include <charconv>
#include <cmath>
#include <istream>
#include <map>
#include <set>
#include <span>
#include <sstream>
#include <streambuf>
#include <string>
#include <string_view>

#include "sightline/geometry/triangulate.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/readers.hpp"
#include "sightline/scene/load/vertex_pool.hpp"

namespace sightline {

namespace {

constexpr std::string_view blanks = " \t\r\n\f\v";

/// Hands out a text line by line (lines that end in a backslash joined with the next) and knows which one it is.
class NumberedLines : public std::streambuf {
 public:
  explicit NumberedLines(std::string_view text) : rest_(text) {}

  /// The number of the last line handed out, from 1.
  [[nodiscard]] std::size_t number() const { return number_; }
  [[nodiscard]] std::string_view line() const { return line_; }
  /// How many of them were points, lines, curves and free-form surfaces.
  [[nodiscard]] std::size_t left_out() const { return left_out_; }

 protected:
  int_type underflow() override {
    if (rest_.empty()) return traits_type::eof();
    line_.clear();
    number_ += lines_;
    lines_ = 0;
    do {
      if (lines_ > 0) line_.back() = ' ';
      // Lines end where tinyobjloader lets them end: at "\n", "\r\n" or "\r".
      const std::size_t length = std::min(rest_.find_first_of("\r\n"), rest_.size());
      line_.append(rest_.substr(0, length));
      rest_.remove_prefix(length);
      rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : std::min(std::size_t{1}, rest_.size()));
      ++lines_;
    } while (line_.ends_with('\\') && !rest_.empty());
    line_ += '\n';
    if (is_no_face(line_)) ++left_out_;
    setg(line_.data(), line_.data(), line_.data() + line_.size());
    return traits_type::to_int_type(line_.front());
  }

 private:
  static bool is_no_face(std::string_view line) {
    for (const std::string_view word : {"p ", "l ", "curv ", "curv2 ", "surf "}) {
      if (line.starts_with(word)) return true;
    }
    return false;
  }

  std::string_view rest_;
  std::string line_;
  std::size_t number_ = 1, lines_ = 0, left_out_ = 0;
};

/// Reads material files beside the scene, and notes which materials let light through.
class Materials : public tinyobj::MaterialReader {
 public:
  Materials(std::filesystem::path folder, std::vector<std::string>& warnings)
      : folder_(std::move(folder)), warnings_(warnings) {}

  bool operator()(const std::string& name, std::vector<tinyobj::material_t>* materials,
                  std::map<std::string, int>* numbers, std::string*, std::string*) override {
    // Always false: then tinyobjloader goes on to the other files of the line.
    if (!names_.insert(name).second) return false;
    const std::filesystem::path relative = std::filesystem::path(name).lexically_normal();
    if (relative.empty() || relative.is_absolute() || *relative.begin() == "..") {
      warnings_.push_back("material file " + in_quotes(name) + " lies outside the folder of the scene, not read");
      return false;
    }
    try {
      const Bytes bytes = read_file(folder_ / relative);
      std::istringstream stream(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
      std::string ignored_warnings, ignored_errors;
      tinyobj::LoadMtl(numbers, materials, &stream, &ignored_warnings, &ignored_errors);
    } catch (const InputError& error) {
      warnings_.push_back("material file " + in_quotes(name) + " " + error.reason());
    }
    opaque_.clear();
    for (const tinyobj::material_t& material : *materials) {
      opaque_.push_back(material.dissolve >= 1.0f && material.alpha_texname.empty());
    }
    return false;
  }

  [[nodiscard]] bool is_opaque(int material) const {
    return material < 0 || static_cast<std::size_t>(material) >= opaque_.size() ||
           opaque_[static_cast<std::size_t>(material)];
  }

 private:
  std::filesystem::path folder_;
  std::vector<std::string>& warnings_;
  std::vector<bool> opaque_;
  std::set<std::string> names_;
};

class ObjReader {
 public:
  ObjReader(const std::filesystem::path& file, std::string_view text)
      : file_(file.string()), lines_(text), materials_(file.parent_path(), warnings_) {}

  LoadedScene read() {
    tinyobj::callback_t callbacks;
    callbacks.vertex_cb = [](void* self, float, float, float, float) { reader(self).add_vertex(); };
    callbacks.index_cb = [](void* self, tinyobj::index_t*, int) { reader(self).add_face(); };
    callbacks.usemtl_cb = [](void* self, const char* name, int material) { reader(self).use_material(name, material); };
    callbacks.group_cb = [](void* self, const char** names, int count) {
      reader(self).set_group({names, static_cast<std::size_t>(count)});
    };
    callbacks.object_cb = [](void* self, const char* name) { reader(self).set_object(name); };
    std::istream stream(&lines_);
    std::string warning, error;
    if (!tinyobj::LoadObjWithCallback(stream, callbacks, this, &materials_, &warning, &error)) fail(one_line(error));
    return build();
  }

 private:
  struct Group {
    std::string name;
    std::array<std::vector<glm::uvec3>, 2> triangles;  // opaque ones, then the others
  };

  static ObjReader& reader(void* self) { return *static_cast<ObjReader*>(self); }

  [[noreturn]] void fail(std::string reason) const {
    throw InputError(file_, "line " + std::to_string(lines_.number()), std::move(reason));
  }

  void add_vertex() {
    std::string_view text = lines_.line();
    text.remove_prefix(text.find('v') + 1);
    glm::vec3 point;
    for (int axis = 0; axis < 3; ++axis) {
      text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
      if (text.starts_with('+')) text.remove_prefix(1);
      double number = 0.0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
      point[axis] = static_cast<float>(number);
      const std::string_view after = text.substr(static_cast<std::size_t>(end - text.data()));
      const bool whole_word = after.empty() || blanks.find(after.front()) != std::string_view::npos;
      if (error == std::errc::invalid_argument || !whole_word) fail("a vertex needs three numbers");
      if (error != std::errc() || !std::isfinite(point[axis])) fail("a coordinate is not finite");
      text = after;
    }
    points_.push_back(point);
  }

  /// The vertex of a corner "7", "7/3", "-1//2" and so on: 1 is the first one, -1 the last one so far.
  [[nodiscard]] std::uint32_t vertex(std::string_view corner) const {
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(corner.data(), corner.data() + corner.size(), number);
    const bool is_number = error == std::errc() && (end == corner.data() + corner.size() || *end == '/');
    if (!is_number || number == 0) fail(in_quotes(corner) + " is no vertex number");
    const auto count = static_cast<std::int64_t>(points_.size());
    if (number > count || number < -count) {
      fail("vertex " + std::to_string(number) + " is not among the " + std::to_string(count) + " so far");
    }
    return static_cast<std::uint32_t>(number > 0 ? number - 1 : count + number);
  }

  void add_face() {
    face_.clear();
    face_points_.clear();
    std::string_view text = lines_.line();
    text.remove_prefix(text.find('f') + 1);
    while (true) {
      text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
      if (text.empty()) break;
      const std::size_t length = std::min(text.find_first_of(blanks), text.size());
      face_.push_back(vertex(text.substr(0, length)));
      face_points_.push_back(points_[face_.back()]);
      text.remove_prefix(length);
    }
    if (face_.size() < 3) fail("a face needs three corners");
    const std::vector<glm::uvec3> triangles = triangulate_polygon(face_points_);
    if (triangles.empty()) {
      fail("a face that is not convex has more than " + std::to_string(most_concave_corners) + " corners");
    }
    std::vector<glm::uvec3>& group = current_group().triangles[opaque_ ? 0 : 1];
    for (const glm::uvec3& t : triangles) group.emplace_back(face_[t.x], face_[t.y], face_[t.z]);
  }

  /// The group of the current names, made when its first face comes, so that objects are in the order of their faces.
  Group& current_group() {
    if (current_ == no_group) {
      const auto [entry, is_new] = numbers_.try_emplace({object_, group_}, groups_.size());
      if (is_new)
        groups_.push_back({object_.empty() || group_.empty() ? object_ + group_ : object_ + "/" + group_, {}});
      current_ = entry->second;
    }
    return groups_[current_];
  }

  void use_material(const char* name, int material) {
    opaque_ = materials_.is_opaque(material);
    if (material < 0 && unknown_materials_.insert(name).second) {
      warnings_.push_back("material " + in_quotes(name) + " is not known, taken as opaque");
    }
  }

  void set_group(std::span<const char*> names) {
    group_.clear();
    for (const char* name : names) group_ += (group_.empty() ? "" : " ") + std::string(name);
    current_ = no_group;
  }

  void set_object(const char* name) {
    object_ = one_line(name);
    group_.clear();
    current_ = no_group;
  }

  LoadedScene build() {
    if (lines_.left_out() > 0) {
      warnings_.push_back(std::to_string(lines_.left_out()) + " points, lines, curves and surfaces are left out");
    }
    if (groups_.empty()) throw InputError(file_, "", "has no faces");
    SceneBuilder builder;
    VertexPool pool(std::move(points_));
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      for (std::size_t part = 0; part < 2; ++part) {
        if (groups_[i].triangles[part].empty()) continue;
        Mesh mesh = pool.mesh_of(std::move(groups_[i].triangles[part]));
        mesh.name = groups_[i].name.empty() ? "group " + std::to_string(i) : groups_[i].name;
        const std::string name = mesh.name;
        const Source source{static_cast<std::int32_t>(i), static_cast<std::int32_t>(part)};
        builder.add_object(builder.add_mesh(std::move(mesh)), identity_affine(), name, source, part == 0);
      }
    }
    LoadedScene loaded;
    loaded.scene = builder.build();
    loaded.warnings = std::move(warnings_);
    return loaded;
  }

  static constexpr std::size_t no_group = static_cast<std::size_t>(-1);

  std::string file_;
  NumberedLines lines_;
  std::vector<std::string> warnings_;
  Materials materials_;
  std::vector<glm::vec3> points_;
  std::vector<Group> groups_;
  std::map<std::pair<std::string, std::string>, std::size_t> numbers_;  // of groups, by object and group name
  std::string object_, group_;
  std::size_t current_ = no_group;
  bool opaque_ = true;
  std::set<std::string> unknown_materials_;
  std::vector<std::uint32_t> face_;
  std::vector<glm::vec3> face_points_;
};

}  // namespace

LoadedScene read_obj(const std::filesystem::path& file, const Bytes& bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.empty()) throw InputError(file.string(), "", "is empty");
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
    throw InputError(file.string(), "byte " + std::to_string(zero), "is no text");
  }
  return ObjReader(file, text).read();
}

}  // namespace sightline
