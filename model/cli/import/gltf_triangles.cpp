#include "import/gltf_triangles.hpp"

#include <cstdint>
#include <cstring>
#include <string>

#include <fmt/format.h>

#include "fringe/error.hpp"

namespace fringe::cli {
namespace {

/// The bytes of one accessor, whose bounds were checked: element i begins at data + i·stride.
struct Elements {
  const unsigned char* data;
  std::size_t stride;
  std::size_t count;
};

/// Locates an accessor's elements; throws InputError unless they are within their buffer.
Elements elements(const tinygltf::Model& model, int number) {
  const auto refuse = [number](const char* reason) {
    throw InputError(fmt::format("accessor {}: {}", number, reason));
  };
  if (number < 0 || static_cast<std::size_t>(number) >= model.accessors.size())
    refuse("does not exist");
  const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(number)];
  if (accessor.sparse.isSparse)
    refuse("is sparse, which is not read");
  if (accessor.bufferView < 0 || static_cast<std::size_t>(accessor.bufferView) >= model.bufferViews.size())
    refuse("has no buffer view");
  const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size())
    refuse("has no buffer");
  const std::vector<unsigned char>& bytes = model.buffers[static_cast<std::size_t>(view.buffer)].data;
  const int component = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
  const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  const int stride = accessor.ByteStride(view);
  if (component <= 0 || components <= 0 || stride <= 0)
    refuse("has a type that does not exist");
  const auto size = static_cast<std::size_t>(component) * static_cast<std::size_t>(components);
  const auto step = static_cast<std::size_t>(stride);
  if (accessor.count == 0)
    return {nullptr, step, 0};
  // Each condition is tested separately, since sums could overflow.
  const bool fits = view.byteOffset <= bytes.size() && view.byteLength <= bytes.size() - view.byteOffset &&
                    accessor.byteOffset <= view.byteLength && size <= view.byteLength - accessor.byteOffset &&
                    (accessor.count - 1) <= (view.byteLength - accessor.byteOffset - size) / step;
  if (!fits)
    refuse("reaches beyond its buffer");
  return {bytes.data() + view.byteOffset + accessor.byteOffset, step, accessor.count};
}

template <typename Number>
Number number_at(const unsigned char* data) {
  Number number;
  std::memcpy(&number, data, sizeof number);
  return number;
}

std::vector<Eigen::Vector3d> positions(const tinygltf::Model& model, int number) {
  const Elements found = elements(model, number);
  const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(number)];
  if (accessor.type != TINYGLTF_TYPE_VEC3 || accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
    throw InputError(fmt::format("accessor {}: positions must be vectors of three floats", number));
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < found.count; ++i) {
    const unsigned char* data = found.data + i * found.stride;
    points.emplace_back(number_at<float>(data), number_at<float>(data + sizeof(float)),
                        number_at<float>(data + 2 * sizeof(float)));
    if (!points.back().allFinite())
      throw InputError(fmt::format("accessor {}: vertex {} is not finite", number, i));
  }
  return points;
}

/// Returns the order of the vertices: that of the indices, or all vertices in turn if there are none (number
/// −1).
std::vector<std::size_t> indices(const tinygltf::Model& model, int number, std::size_t vertices) {
  std::vector<std::size_t> result;
  if (number == -1) {
    for (std::size_t i = 0; i < vertices; ++i)
      result.push_back(i);
    return result;
  }
  const Elements found = elements(model, number);
  const int type = model.accessors[static_cast<std::size_t>(number)].componentType;
  for (std::size_t i = 0; i < found.count; ++i) {
    const unsigned char* data = found.data + i * found.stride;
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE)
      result.push_back(*data);
    else if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT)
      result.push_back(number_at<std::uint16_t>(data));
    else if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
      result.push_back(number_at<std::uint32_t>(data));
    else
      throw InputError(fmt::format("accessor {}: indices must be whole numbers without a sign", number));
    if (result.back() >= vertices)
      throw InputError(fmt::format("accessor {}: names vertex {} of {}", number, result.back(), vertices));
  }
  return result;
}

/// Appends the triangles of a primitive; ignores points and lines.
void append(std::vector<Triangle>& triangles, const tinygltf::Model& model,
            const tinygltf::Primitive& primitive) {
  // A primitive without a mode consists of triangles.
  const int mode = primitive.mode == -1 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  if (mode < TINYGLTF_MODE_TRIANGLES || mode > TINYGLTF_MODE_TRIANGLE_FAN)
    return;
  if (!primitive.targets.empty())
    throw InputError("has morph targets, which are not read");
  const auto attribute = primitive.attributes.find("POSITION");
  if (attribute == primitive.attributes.end())
    throw InputError("has no positions");
  const std::vector<Eigen::Vector3d> points = positions(model, attribute->second);
  const std::vector<std::size_t> order = indices(model, primitive.indices, points.size());
  if (mode == TINYGLTF_MODE_TRIANGLES && order.size() % 3 != 0)
    throw InputError("the number of its vertices is not one of triangles");
  const std::size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
  for (std::size_t i = 0; i + 2 < order.size(); i += step) {
    // In a strip every other triangle has reversed orientation; in a fan all triangles share the first
    // vertex.
    const bool turned = mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 == 1;
    const std::size_t first = mode == TINYGLTF_MODE_TRIANGLE_FAN ? 0 : i;
    const std::size_t second = turned ? i + 2 : i + 1;
    const std::size_t third = turned ? i + 1 : i + 2;
    triangles.push_back({points[order[first]], points[order[second]], points[order[third]]});
  }
}

}  // namespace

std::vector<Triangle> gltf_triangles(const tinygltf::Model& model, int mesh) {
  if (mesh < 0 || static_cast<std::size_t>(mesh) >= model.meshes.size())
    throw InputError(fmt::format("mesh {}: does not exist", mesh));
  std::vector<Triangle> triangles;
  try {
    for (const tinygltf::Primitive& primitive : model.meshes[static_cast<std::size_t>(mesh)].primitives)
      append(triangles, model, primitive);
  } catch (const InputError& error) {
    throw InputError(fmt::format("mesh {}: {}", mesh, error.what()));
  }
  return triangles;
}

}  // namespace fringe::cli
