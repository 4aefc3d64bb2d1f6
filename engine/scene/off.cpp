#include "scene/off.h"

#include <charconv>
#include <cmath>

#include "scene/error.h"
#include "scene/files.h"

namespace alabaster {
namespace {

/// The words of a text; what follows a # is a comment.
class Words {
 public:
  Words(const std::string& text, const std::string& path)
      : next_(text.data()), end_(next_ + text.size()), path_(path) {}

  void skip_line() {
    while (next_ != end_ && *next_ != '\n') ++next_;
  }

  template <typename T>
  T number() {
    skip_space();
    T value{};
    auto [after, error] = std::from_chars(next_, end_, value);
    if (error != std::errc()) fail("is truncated or holds something that is no number; fetch it again");
    next_ = after;
    return value;
  }

  std::string word() {
    skip_space();
    const char* first = next_;
    while (next_ != end_ && !is_space(*next_)) ++next_;
    return {first, next_};
  }

  [[noreturn]] void fail(const std::string& what) const { throw UserError(path_ + ": " + what); }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }
  void skip_space() {
    for (; next_ != end_ && (is_space(*next_) || *next_ == '#'); ++next_)
      if (*next_ == '#') skip_line();
  }

  const char *next_, *end_;
  const std::string& path_;
};

}  // namespace

Mesh read_off(const std::string& path) {
  std::string text = read_file(path);
  Words words(text, path);
  if (words.word() != "OFF") words.fail("does not begin with OFF; give a text OFF file");
  auto vertices = words.number<unsigned>(), faces = words.number<unsigned>();
  words.skip_line();  // the number of edges, which nobody keeps right
  if (vertices > text.size() || faces > text.size()) words.fail("promises more vertices or faces than it can hold");
  Mesh mesh;
  mesh.positions.resize(vertices);
  for (glm::vec3& p : mesh.positions)
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = words.number<float>();
      if (!std::isfinite(p[axis])) words.fail("holds a coordinate that is not finite; fetch it again");
    }
  for (unsigned face = 0; face < faces; ++face) {
    auto corners = words.number<unsigned>();
    glm::uvec3 t(0);
    for (unsigned i = 0; i < corners; ++i) {
      auto vertex = words.number<unsigned>();
      if (vertex >= vertices) words.fail("vertex index " + std::to_string(vertex) + " is out of range; fetch it again");
      if (i == 0) t.x = vertex;
      t.y = t.z, t.z = vertex;
      if (i >= 2) mesh.triangles.push_back(t);
    }
    words.skip_line();  // colours
  }
  return mesh;
}

}  // namespace alabaster
