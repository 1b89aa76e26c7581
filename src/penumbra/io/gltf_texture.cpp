#include "penumbra/io/gltf_texture.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "penumbra/file/file_error.h"
#include "penumbra/image/image_io.h"

namespace penumbra {
namespace {

/// An extension's object of a glTF element, if it has one.
std::optional<JsonPlace> extension(const JsonPlace& place, std::string_view name) {
  const auto all = place.object("extensions");
  return all ? all->object(name) : std::nullopt;
}

Wrap wrap_of(const JsonPlace& sampler, std::string_view key) {
  switch (sampler.whole(key).value_or(10497)) {
    case 10497:
      return Wrap::repeat;
    case 33071:
      return Wrap::clamp;
    case 33648:
      return Wrap::mirror;
    default:
      sampler.fail(fmt::format("its {} is none of 10497, 33071 and 33648; export the file again", key));
  }
}

// offset, then rotation, then scale, applied from the right. The angle turns the UVs counter-clockwise as seen with v
// downwards, so u' = u cos + v sin; the extension's own example (a quarter of the picture, turned) holds only so.
Mat3f transform_of(const JsonPlace& place) {
  const auto offset = place.numbers<2>("offset", {0, 0});
  const auto scale = place.numbers<2>("scale", {1, 1});
  const double angle = place.number("rotation", 0);
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return Mat3f(Mat3d(scale[0] * c, -scale[0] * s, 0,  // what u adds
                     scale[1] * s, scale[1] * c, 0,   // what v adds
                     offset[0], offset[1], 1));
}

}  // namespace

std::optional<TextureRef> GltfTextures::read(const JsonPlace& user, std::string_view key, bool& unreadable) {
  const auto info = user.object(key);
  if (!info) return std::nullopt;
  const auto index = texture(info->required_whole("index"), *info);
  if (!index) {
    unreadable = true;
    return std::nullopt;
  }
  TextureRef ref{.texture = *index, .uv_set = 0, .transform = Mat3f(1.0F)};
  std::uint64_t uv_set = info->whole("texCoord").value_or(0);
  if (const auto transform = extension(*info, "KHR_texture_transform")) {
    ref.transform = transform_of(*transform);
    uv_set = transform->whole("texCoord").value_or(uv_set);
  }
  if (uv_set > 1) {
    document_->warnings().count("textures on TEXCOORD_2 and above are not drawn; put them on TEXCOORD_0 or 1",
                                info->place());
    return std::nullopt;
  }
  ref.uv_set = static_cast<std::uint32_t>(uv_set);
  return ref;
}

std::optional<std::uint32_t> GltfTextures::texture(std::uint64_t index, const JsonPlace& user) {
  const JsonPlace place = document_->item("textures", "texture", index, user);
  if (const auto known = texture_of_.find(index); known != texture_of_.end()) return known->second;
  Texture made;
  if (const auto sampler_index = place.whole("sampler")) {
    const JsonPlace sampler = document_->item("samplers", "sampler", *sampler_index, place);
    made.wrap_u = wrap_of(sampler, "wrapS");
    made.wrap_v = wrap_of(sampler, "wrapT");
    if (sampler.whole("magFilter") == 9728) made.filter = TexelFilter::nearest;
    made.mipmaps = sampler.whole("minFilter").value_or(9987) > 9729;  // 9728 and 9729 have none
  }
  std::optional<std::uint64_t> source = place.whole("source");
  if (const auto webp = extension(place, "EXT_texture_webp")) source = webp->required_whole("source");
  auto& slot = texture_of_[index];
  if (!source && extension(place, "KHR_texture_basisu")) {
    document_->warnings().count(
        "a texture has only a Basis Universal picture (.ktx2, KHR_texture_basisu), which is not read, so its material "
        "goes without it; convert it to PNG, JPEG or WebP",
        place.place());
    return slot;
  }
  if (!source) {
    document_->warnings().count("a texture names no image that is supported, so its material goes without it",
                                place.place());
    return slot;
  }
  const auto image_index = image(*source, place);
  if (!image_index) return slot;
  made.image = *image_index;
  slot = static_cast<std::uint32_t>(scene_->textures.size());
  scene_->textures.push_back(made);
  return slot;
}

std::optional<std::uint32_t> GltfTextures::image(std::uint64_t index, const JsonPlace& user) {
  const JsonPlace place = document_->item("images", "image", index, user);
  if (const auto known = image_of_.find(index); known != image_of_.end()) return known->second;
  auto& slot = image_of_[index];
  try {
    const std::string uri = place.text("uri");
    const auto view = place.whole("bufferView");
    if (!view && uri.empty()) place.fail("has neither uri nor bufferView");
    Image8 decoded;
    if (view) {
      decoded = decode_image8(document_->view(*view, place).bytes, place.place());
    } else {
      decoded = decode_image8(document_->uri_bytes(uri, place), place.place());
    }
    std::string name = place.text("name");
    if (name.empty()) name = uri.empty() || uri.starts_with("data:") ? place.place() : uri;
    slot = static_cast<std::uint32_t>(scene_->images.size());
    scene_->images.push_back({.name = std::move(name),
                              .width = decoded.width,
                              .height = decoded.height,
                              .channels = decoded.channels,
                              .texels = std::move(decoded.data)});
  } catch (const FileError& error) {
    // The scene can still be drawn; where the image is to blame, its material goes without.
    const std::string_view cause =
        std::string_view(error.what()).substr(error.path() == document_->file() ? error.path().size() + 2 : 0);
    document_->warnings().count("an image could not be read, so factors stand for it (black for emission)", cause);
  }
  return slot;
}

}  // namespace penumbra
