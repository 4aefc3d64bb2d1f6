#include "scene/primitive.h"

#include <cmath>
#include <cstring>

#include "scene/error.h"

namespace alabaster {
namespace {

/// The elements of an accessor, checked to lie inside their buffer.
struct Elements {
  const unsigned char* first = nullptr;
  std::size_t count = 0, stride = 0;

  template <typename T>
  T at(std::size_t index) const {
    T value;
    std::memcpy(&value, first + index * stride, sizeof value);
    return value;
  }
};

template <typename T>
const T& item(const std::vector<T>& list, int index, const std::string& what) {
  if (index < 0 || std::size_t(index) >= list.size())
    throw UserError(what + " index " + std::to_string(index) + " is out of range; the file has " +
                    std::to_string(list.size()) + "; export the file again");
  return list[index];
}

Elements elements(const tinygltf::Model& model, const tinygltf::Accessor& accessor, const std::string& what) {
  if (accessor.sparse.isSparse) throw UserError(what + " uses a sparse accessor, which is not read; export without it");
  const tinygltf::BufferView& view = item(model.bufferViews, accessor.bufferView, what + ": buffer view");
  const tinygltf::Buffer& buffer = item(model.buffers, view.buffer, what + ": buffer");
  int stride = accessor.ByteStride(view);
  int size =
      tinygltf::GetComponentSizeInBytes(accessor.componentType) * tinygltf::GetNumComponentsInType(accessor.type);
  bool fits = size > 0 && stride >= size && view.byteOffset <= buffer.data.size() &&
              view.byteLength <= buffer.data.size() - view.byteOffset && accessor.byteOffset <= view.byteLength;
  std::size_t room = fits ? view.byteLength - accessor.byteOffset : 0;
  if (accessor.count > 0 && (!fits || room < std::size_t(size) || (room - size) / stride < accessor.count - 1))
    throw UserError(what + " reaches out of its buffer (index out of range); export the file again");
  return {buffer.data.data() + view.byteOffset + accessor.byteOffset, accessor.count, std::size_t(stride)};
}

std::vector<glm::vec3> positions(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                 const std::string& place) {
  auto found = primitive.attributes.find("POSITION");
  if (found == primitive.attributes.end())
    throw UserError(place + " has no POSITION attribute; export it with positions");
  std::string what = place + " POSITION";
  const tinygltf::Accessor& accessor = item(model.accessors, found->second, what + ": accessor");
  if (accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT || accessor.type != TINYGLTF_TYPE_VEC3)
    throw UserError(what + " must be three 32-bit floats; export without quantisation");
  Elements source = elements(model, accessor, what);
  std::vector<glm::vec3> result(source.count);
  for (std::size_t i = 0; i < source.count; ++i) {
    result[i] = source.at<glm::vec3>(i);
    if (!std::isfinite(result[i].x) || !std::isfinite(result[i].y) || !std::isfinite(result[i].z))
      throw UserError(what + " " + std::to_string(i) + " is not finite (NaN or infinite); repair the mesh");
  }
  return result;
}

std::vector<unsigned> indices(const tinygltf::Model& model, const tinygltf::Primitive& primitive, std::size_t vertices,
                              const std::string& place) {
  std::vector<unsigned> result;
  if (primitive.indices < 0) {
    for (unsigned i = 0; i < vertices; ++i) result.push_back(i);
    return result;
  }
  std::string what = place + " indices";
  const tinygltf::Accessor& accessor = item(model.accessors, primitive.indices, what + ": accessor");
  if (accessor.type != TINYGLTF_TYPE_SCALAR) throw UserError(what + " must be scalars; export the file again");
  Elements source = elements(model, accessor, what);
  result.resize(source.count);
  for (std::size_t i = 0; i < source.count; ++i) {
    switch (accessor.componentType) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        result[i] = source.at<std::uint8_t>(i);
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        result[i] = source.at<std::uint16_t>(i);
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        result[i] = source.at<std::uint32_t>(i);
        break;
      default:
        throw UserError(what + " must be unsigned integers; export the file again");
    }
    if (result[i] >= vertices)
      throw UserError(what + ": vertex index " + std::to_string(result[i]) + " is out of range; the mesh has " +
                      std::to_string(vertices) + " vertices; repair the mesh");
  }
  return result;
}

}  // namespace

Mesh read_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive, const std::string& place) {
  if (primitive.extensions.contains("KHR_draco_mesh_compression"))
    throw UserError(place +
                    " is compressed (KHR_draco_mesh_compression), which is not read; export without compression");
  int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  if (mode < TINYGLTF_MODE_TRIANGLES) return {};
  Mesh mesh{positions(model, primitive, place), {}};
  std::vector<unsigned> list = indices(model, primitive, mesh.positions.size(), place);
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    if (list.size() % 3) throw UserError(place + " has a number of indices that is no multiple of 3; repair the mesh");
    for (std::size_t i = 0; i + 2 < list.size(); i += 3) mesh.triangles.push_back({list[i], list[i + 1], list[i + 2]});
  } else {
    bool strip = mode == TINYGLTF_MODE_TRIANGLE_STRIP;
    for (std::size_t i = 0; i + 2 < list.size(); ++i) {
      bool odd = strip && i % 2;
      mesh.triangles.push_back({strip ? list[i] : list[0], list[i + 1 + odd], list[i + 2 - odd]});
    }
  }
  return mesh;
}

std::vector<glm::vec2> read_texcoords(const tinygltf::Model& model, const tinygltf::Primitive& primitive, int set,
                                      const std::string& place) {
  const std::string name = "TEXCOORD_" + std::to_string(set), what = place + " " + name;
  const auto found = primitive.attributes.find(name);
  if (found == primitive.attributes.end()) return {};
  const tinygltf::Accessor& accessor = item(model.accessors, found->second, what + ": accessor");
  if (accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT || accessor.type != TINYGLTF_TYPE_VEC2)
    throw UserError(what + " must be two 32-bit floats; export without quantisation");
  const Elements source = elements(model, accessor, what);
  std::vector<glm::vec2> result(source.count);
  for (std::size_t i = 0; i < source.count; ++i) {
    result[i] = source.at<glm::vec2>(i);
    if (!std::isfinite(result[i].x) || !std::isfinite(result[i].y))
      throw UserError(what + " " + std::to_string(i) + " is not finite (NaN or infinite); repair the mesh");
  }
  return result;
}

}  // namespace alabaster
