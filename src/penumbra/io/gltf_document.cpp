#include "penumbra/io/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>
#include <stdexcept>

#include "penumbra/file/file_error.h"
#include "penumbra/file/input_file.h"
#include "penumbra/io/gltf_uri.h"
#include "penumbra/io/meshopt_view.h"

namespace penumbra {
namespace {

constexpr std::array known_extensions = {
    "KHR_lights_punctual",      "KHR_materials_emissive_strength", "KHR_materials_ior",   "KHR_materials_transmission",
    "KHR_materials_volume",     "KHR_materials_specular",          "KHR_materials_unlit", "KHR_texture_transform",
    "KHR_mesh_quantization",    "KHR_draco_mesh_compression",      "EXT_texture_webp",    "EXT_meshopt_compression",
    "KHR_materials_dispersion",
};

bool is_known(std::string_view extension) {
  return std::find(known_extensions.begin(), known_extensions.end(), extension) != known_extensions.end();
}

// Names in a message stay short and printable, whatever the file holds.
std::string shown(std::string_view name) {
  constexpr std::size_t longest = 60;
  std::string text(name.substr(0, longest));
  if (name.size() > longest) text += "...";
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }, '?');
  return text;
}

std::uint32_t little_endian_32(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  return value;
}

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

GltfDocument::GltfDocument(const std::filesystem::path& path, const ReadOptions& options)
    : path_(path),
      folder_(path, options.allow_outside),
      file_(path.string()),
      warnings_(file_),
      bytes_(read_file(path)) {
  if (as_text(bytes_).starts_with("glTF")) {
    split_glb();
  } else if (path_.extension() == ".glb" || path_.extension() == ".GLB") {
    throw FileError(
        file_, "byte 0",
        "does not start with 'glTF', so it is no binary glTF; export it again, or name it .gltf if it is JSON");
  } else {
    json_text_ = as_text(bytes_);
  }
  json_ = parse_json(json_text_, path_);
  root_.emplace(json_, file_, "");
  check_version();
  check_extensions();
  read_buffers();
}

// The container: a header of 12 bytes, then chunks of (length, type, bytes), JSON first (glTF 2.0, section 4.4).
void GltfDocument::split_glb() {
  constexpr std::size_t header = 12;
  constexpr std::uint32_t json_type = 0x4E4F534A;
  constexpr std::uint32_t binary_type = 0x004E4942;
  if (bytes_.size() < header) throw FileError(file_, "", "is cut off within its header; copy or export it again");
  const std::uint32_t version = little_endian_32(bytes_, 4);
  if (version != 2) {
    throw FileError(file_, "byte 4",
                    fmt::format("is binary glTF of version {}, and only version 2 is read; convert it", version));
  }
  const std::uint32_t length = little_endian_32(bytes_, 8);
  if (length > bytes_.size()) {
    throw FileError(file_, "byte 8",
                    fmt::format("is cut off: its header tells of {} bytes but the file has {}; copy or export it again",
                                length, bytes_.size()));
  }
  const auto all = std::span<const std::byte>(bytes_).first(length);
  bool has_json = false;
  for (std::size_t at = header; at + 8 <= all.size();) {
    const std::uint32_t size = little_endian_32(all, at);
    const std::uint32_t type = little_endian_32(all, at + 4);
    if (size > all.size() - at - 8) {
      throw FileError(file_, fmt::format("byte {}", at),
                      fmt::format("a chunk of {} bytes reaches beyond the file's end; copy or export it again", size));
    }
    const auto chunk = all.subspan(at + 8, size);
    if (!has_json && type == json_type) {
      json_text_ = as_text(chunk);
      has_json = true;
    } else if (!has_json) {
      break;
    } else if (type == binary_type && !binary_) {
      binary_ = chunk;
    }
    at += 8 + std::size_t{size};
  }
  if (!has_json) throw FileError(file_, "byte 12", "its first chunk is not JSON; export the file again");
}

void GltfDocument::check_version() const {
  const auto asset = root().object("asset");
  if (!asset) root().fail("has no asset, so it is no glTF 2.0; export it again");
  const std::string version = asset->text("version");
  if (!version.starts_with("2.")) {
    asset->fail(
        fmt::format("its version is '{}', and only glTF 2 is read; convert the file to glTF 2.0", shown(version)));
  }
  const std::string least = asset->text("minVersion");
  if (!least.empty() && least != "2.0") {
    asset->fail(
        fmt::format("it needs a reader of glTF {}, and this one reads 2.0; export it as glTF 2.0", shown(least)));
  }
}

void GltfDocument::check_extensions() {
  if (const auto required = root().list("extensionsRequired")) {
    for (std::size_t i = 0; i < required->size(); ++i) {
      if (const auto& name = required->text_item(i); !is_known(name)) {
        if (name == "KHR_texture_basisu") {
          required->fail(
              "the file requires KHR_texture_basisu: its pictures are in Basis Universal (.ktx2), which is not read; "
              "convert them to PNG, JPEG or WebP");
        }
        required->fail(
            fmt::format("the file requires {}, which is not supported; export it without that extension", shown(name)));
      }
    }
  }
  if (const auto used = root().list("extensionsUsed")) {
    constexpr std::size_t most_named = 20;
    std::set<std::string_view> unknown;
    for (std::size_t i = 0; i < used->size(); ++i) {
      const auto& name = used->text_item(i);
      if (is_known(name) || !unknown.insert(name).second) continue;
      warnings_.count(unknown.size() > most_named
                          ? "further extensions are not supported and were ignored"
                          : fmt::format("the extension {} is not supported and was ignored", shown(name)),
                      "");
    }
  }
}

std::size_t GltfDocument::count(std::string_view list) const {
  const auto elements = root().list(list);
  return elements ? elements->size() : 0;
}

JsonPlace GltfDocument::item(std::string_view list, std::string_view noun, std::uint64_t index,
                             const JsonPlace& user) const {
  const auto elements = root().list(list);
  const std::size_t size = elements ? elements->size() : 0;
  if (index >= size) {
    user.fail(
        fmt::format("names {} {}, but the file has {}, counted from 0; export the file again", noun, index, size));
  }
  return elements->item(static_cast<std::size_t>(index), noun);
}

void GltfDocument::count_work(std::size_t steps, const JsonPlace& user) {
  const std::size_t most = (std::size_t{1} << 24) + 16 * byte_count_;
  if (steps > most - work_) {
    user.fail(
        fmt::format("the file asks for the same data again and again, far more often than its {} bytes would be "
                    "used; export it again",
                    byte_count_));
  }
  work_ += steps;
}

void GltfDocument::read_buffers() {
  buffers_.resize(count("buffers"));
  byte_count_ = bytes_.size();
  for (std::size_t i = 0; i < buffers_.size(); ++i) {
    const JsonPlace place = item("buffers", "buffer", i, root());
    if (place.has("uri")) buffers_[i] = uri_bytes(place.text("uri"), place);
    byte_count_ += buffers_[i].size();
  }
}

std::span<const std::byte> GltfDocument::buffer(std::uint64_t index, const JsonPlace& user) const {
  const JsonPlace place = item("buffers", "buffer", index, user);
  const std::uint64_t length = place.required_whole("byteLength");
  std::span<const std::byte> bytes = buffers_[static_cast<std::size_t>(index)];
  if (!place.has("uri")) {
    if (index != 0 || !binary_) place.fail("has no uri, and there is no binary chunk for it; export the file again");
    bytes = *binary_;
  }
  if (length > bytes.size()) {
    place.fail(fmt::format("its byteLength is {} but only {} bytes are there; copy or export the file again", length,
                           bytes.size()));
  }
  return bytes.first(static_cast<std::size_t>(length));
}

std::span<const std::byte> GltfDocument::part_of_buffer(const JsonPlace& place) const {
  const auto bytes = buffer(place.required_whole("buffer"), place);
  const std::uint64_t offset = place.whole("byteOffset").value_or(0);
  const std::uint64_t length = place.required_whole("byteLength");
  if (offset > bytes.size() || length > bytes.size() - offset) {
    place.fail(fmt::format("its bytes {} to {} reach beyond its buffer of {} bytes; export the file again", offset,
                           offset + length, bytes.size()));
  }
  return bytes.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

const std::vector<std::byte>& GltfDocument::unpacked(std::uint64_t view, const JsonPlace& compressed) {
  if (const auto known = unpacked_.find(view); known != unpacked_.end()) return known->second;
  MeshoptPacking packing{.mode = compressed.text("mode"),
                         .filter = compressed.text("filter"),
                         .count = static_cast<std::size_t>(compressed.required_whole("count")),
                         .stride = static_cast<std::size_t>(compressed.required_whole("byteStride"))};
  if (packing.filter.empty()) packing.filter = "NONE";
  try {
    return unpacked_[view] = decode_meshopt(part_of_buffer(compressed), packing);
  } catch (const std::invalid_argument& wrong) {
    compressed.fail(wrong.what());
  }
}

GltfDocument::View GltfDocument::view(std::uint64_t index, const JsonPlace& user) {
  const JsonPlace place = item("bufferViews", "bufferView", index, user);
  const std::uint64_t stride = place.whole("byteStride").value_or(0);
  if (stride > 65535) place.fail(fmt::format("its byteStride of {} is beyond what glTF allows (252)", stride));
  const auto extensions = place.object("extensions");
  if (const auto compressed = extensions ? extensions->object("EXT_meshopt_compression") : std::nullopt) {
    return {unpacked(index, *compressed), static_cast<std::size_t>(stride)};
  }
  return {part_of_buffer(place), static_cast<std::size_t>(stride)};
}

// The file that a URI names.
std::filesystem::path GltfDocument::asset(const std::string& uri) const {
  const std::string name = uri_file_name(uri);
  try {
    return folder_.resolve(name);
  } catch (const std::invalid_argument& wrong) {
    throw std::invalid_argument(fmt::format("its URI '{}' {}", shown_uri(uri), wrong.what()));
  }
}

std::filesystem::path GltfDocument::uri_file(const std::string& uri, const JsonPlace& user) const {
  std::filesystem::path path;
  try {
    path = asset(uri);
  } catch (const std::invalid_argument& wrong) {
    user.fail(wrong.what());
  }
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    user.fail(fmt::format("its file {} is not there; put it beside the glTF or export to .glb", path.string()));
  }
  return path;
}

std::vector<std::byte> GltfDocument::uri_bytes(const std::string& uri, const JsonPlace& user) const {
  try {
    if (auto bytes = data_uri_bytes(uri)) return std::move(*bytes);
    return read_file(uri_file(uri, user));
  } catch (const std::invalid_argument& wrong) {
    user.fail(wrong.what());
  } catch (const FileError& unreadable) {
    if (unreadable.path() == file_) throw;
    user.fail(fmt::format("its file {}", unreadable.what()));
  }
}

}  // namespace penumbra
