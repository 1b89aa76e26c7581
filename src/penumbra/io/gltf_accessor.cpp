#include "penumbra/io/gltf_accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>
#include <string>

namespace penumbra {
namespace {

template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);  // accessors of real files are not always aligned
  return value;
}

template <class T>
double integer(const std::byte* from, bool normalised) {
  const auto value = static_cast<double>(load<T>(from));
  return normalised ? std::max(value / static_cast<double>(std::numeric_limits<T>::max()), -1.0) : value;
}

GltfComponent component_type(std::uint64_t number, const JsonPlace& place) {
  switch (number) {
    case 5120:
    case 5121:
    case 5122:
    case 5123:
    case 5125:
    case 5126:
      return static_cast<GltfComponent>(number);
    default:
      place.fail(fmt::format("its componentType {} is none of glTF's (5120 to 5126); export the file again", number));
  }
}

int component_count(const std::string& type, const JsonPlace& place) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  if (type == "MAT4") return 16;
  place.fail(type.starts_with("MAT") ? "holds matrices of a kind that nothing read has"
                                     : "its type is none of SCALAR, VEC2, VEC3, VEC4 and MAT4; export the file again");
}

// Where the elements lie in a view. Sizes are 64 bits and the count is compared by division, so nothing overflows.
GltfElements inside_view(const GltfDocument::View& view, std::uint64_t offset, const GltfAccessors::Shape& shape,
                         const JsonPlace& place) {
  const std::size_t element = component_size(shape.type) * static_cast<std::size_t>(shape.components);
  const std::size_t stride = view.stride == 0 ? element : view.stride;
  if (stride < element) {
    place.fail(
        fmt::format("its elements of {} bytes overlap at the bufferView's byteStride of {}; export the file again",
                    element, stride));
  }
  const bool fits = offset <= view.bytes.size() && view.bytes.size() - offset >= element &&
                    shape.count - 1 <= (view.bytes.size() - offset - element) / stride;
  if (shape.count > 0 && !fits) {
    place.fail(fmt::format("its {} elements reach beyond their bufferView of {} bytes; export the file again",
                           shape.count, view.bytes.size()));
  }
  return {.data = shape.count > 0 ? view.bytes.data() + offset : nullptr,
          .count = shape.count,
          .stride = stride,
          .components = shape.components,
          .type = shape.type,
          .normalised = shape.normalised};
}

}  // namespace

std::size_t component_size(GltfComponent type) {
  switch (type) {
    case GltfComponent::int8:
    case GltfComponent::uint8:
      return 1;
    case GltfComponent::int16:
    case GltfComponent::uint16:
      return 2;
    case GltfComponent::uint32:
    case GltfComponent::float32:
      return 4;
  }
  return 4;
}

double GltfElements::value(std::size_t i, int c) const {
  assert(i < count && c < components);
  const std::byte* from = data + i * stride + static_cast<std::size_t>(c) * component_size(type);
  switch (type) {
    case GltfComponent::int8:
      return integer<std::int8_t>(from, normalised);
    case GltfComponent::uint8:
      return integer<std::uint8_t>(from, normalised);
    case GltfComponent::int16:
      return integer<std::int16_t>(from, normalised);
    case GltfComponent::uint16:
      return integer<std::uint16_t>(from, normalised);
    case GltfComponent::uint32:
      return integer<std::uint32_t>(from, normalised);
    case GltfComponent::float32:
      return static_cast<double>(load<float>(from));
  }
  return 0;
}

std::uint32_t GltfElements::index(std::size_t i, int c) const {
  assert(i < count && c < components);
  const std::byte* from = data + i * stride + static_cast<std::size_t>(c) * component_size(type);
  if (type == GltfComponent::uint8) return load<std::uint8_t>(from);
  if (type == GltfComponent::uint16) return load<std::uint16_t>(from);
  return load<std::uint32_t>(from);
}

GltfAccessors::Shape GltfAccessors::shape(std::uint64_t index, const JsonPlace& user) const {
  const JsonPlace place = document_->item("accessors", "accessor", index, user);
  const std::uint64_t count = place.required_whole("count");
  if (count > std::numeric_limits<std::uint32_t>::max()) {
    place.fail(fmt::format("its count of {} is beyond 4294967295, the most that can be read", count));
  }
  return {.count = static_cast<std::size_t>(count),
          .components = component_count(place.text("type"), place),
          .type = component_type(place.required_whole("componentType"), place),
          .normalised = place.flag("normalized", false)};
}

const GltfElements& GltfAccessors::elements(std::uint64_t index, const JsonPlace& user) {
  (void)document_->item("accessors", "accessor", index, user);  // throws when there is none
  if (read_.empty()) read_.resize(document_->count("accessors"));
  auto& slot = read_[static_cast<std::size_t>(index)];
  if (!slot) slot = read(index, user);
  return *slot;
}

GltfElements GltfAccessors::read(std::uint64_t index, const JsonPlace& user) {
  const JsonPlace place = document_->item("accessors", "accessor", index, user);
  const Shape shape = this->shape(index, user);
  const std::size_t element = component_size(shape.type) * static_cast<std::size_t>(shape.components);
  GltfElements elements{.data = nullptr,
                        .count = shape.count,
                        .stride = element,
                        .components = shape.components,
                        .type = shape.type,
                        .normalised = shape.normalised};
  if (const auto view = place.whole("bufferView")) {
    elements = inside_view(document_->view(*view, place), place.whole("byteOffset").value_or(0), shape, place);
  } else {
    elements.data = own(shape.count * element, place);  // without a view all elements are zero
  }
  if (const auto sparse = place.object("sparse")) substitute(*sparse, elements);
  return elements;
}

void GltfAccessors::substitute(const JsonPlace& sparse, GltfElements& elements) {
  const auto indices = sparse.object("indices");
  const auto values = sparse.object("values");
  if (!indices || !values) sparse.fail("must have indices and values; export the file again");
  const std::uint64_t count = sparse.required_whole("count");
  if (count > elements.count) {
    sparse.fail(fmt::format("substitutes {} of only {} elements; export the file again", count, elements.count));
  }
  const auto part = [&](const JsonPlace& place, int components, GltfComponent type) {
    const Shape shape{
        .count = static_cast<std::size_t>(count), .components = components, .type = type, .normalised = false};
    return inside_view(document_->view(place.required_whole("bufferView"), place),
                       place.whole("byteOffset").value_or(0), shape, place);
  };
  const GltfComponent index_type = component_type(indices->required_whole("componentType"), *indices);
  if (index_type != GltfComponent::uint8 && index_type != GltfComponent::uint16 &&
      index_type != GltfComponent::uint32) {
    indices->fail("its componentType is not an unsigned integer; export the file again");
  }
  const GltfElements targets = part(*indices, 1, index_type);
  const GltfElements sources = part(*values, elements.components, elements.type);

  const std::size_t element = component_size(elements.type) * static_cast<std::size_t>(elements.components);
  std::byte* changed = own(elements.count * element, sparse);
  for (std::size_t i = 0; i < elements.count; ++i) {
    std::memcpy(changed + i * element, elements.data + i * elements.stride, element);
  }
  for (std::size_t i = 0; i < targets.count; ++i) {
    const std::uint32_t target = targets.index(i);
    if (target >= elements.count) {
      indices->fail(
          fmt::format("index {} is beyond the accessor's {} elements; export the file again", target, elements.count));
    }
    std::memcpy(changed + target * element, sources.data + i * sources.stride, element);
  }
  elements.data = changed;
  elements.stride = element;
}

std::byte* GltfAccessors::own(std::size_t bytes, const JsonPlace& place) {
  // A count of any size costs nothing to write down where no bufferView backs it.
  constexpr std::size_t most = std::size_t{512} << 20;
  if (bytes > most - owned_bytes_) {
    place.fail("asks for more than 512 MiB of sparse or zero elements; export the file without sparse accessors");
  }
  owned_bytes_ += bytes;
  return owned_.emplace_back(bytes).data();
}

}  // namespace penumbra
