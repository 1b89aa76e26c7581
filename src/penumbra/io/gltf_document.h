#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "penumbra/io/asset_folder.h"
#include "penumbra/io/json_place.h"
#include "penumbra/io/json_value.h"
#include "penumbra/io/read_options.h"
#include "penumbra/io/warning_tally.h"

namespace penumbra {

/// A glTF 2.0 file: its JSON, and its bytes by buffer view.
class GltfDocument {
 public:
  /// Reads .glb (by its magic) or .gltf and its buffers, and checks version and required extensions; each unknown
  /// optional extension is one warning. Throws FileError.
  explicit GltfDocument(const std::filesystem::path& path, const ReadOptions& options = {});
  GltfDocument(const GltfDocument&) = delete;
  GltfDocument& operator=(const GltfDocument&) = delete;

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] const JsonPlace& root() const { return *root_; }
  [[nodiscard]] WarningTally& warnings() { return warnings_; }
  /// Bytes of the file and its buffers: what it holds is measured by this.
  [[nodiscard]] std::size_t byte_count() const { return byte_count_; }

  /// Counts steps of work for which the file need not hold data of their own, such as the vertices of a mesh that node
  /// after node bends anew: a small file could ask for any number. Throws FileError at `user` when they are more in all
  /// than an honest file of this size asks for.
  void count_work(std::size_t steps, const JsonPlace& user);

  /// How many elements the top-level list ("accessors") has; 0 when it is not there.
  [[nodiscard]] std::size_t count(std::string_view list) const;
  /// Element `index` of the top-level list `list`, called "`noun` index".
  /// Throws FileError at `user` when there is none.
  [[nodiscard]] JsonPlace item(std::string_view list, std::string_view noun, std::uint64_t index,
                               const JsonPlace& user) const;

  struct View {
    std::span<const std::byte> bytes;
    std::size_t stride = 0;  ///< bytes from element to element; 0 for tightly packed
  };
  /// The bytes of a buffer view, wholly inside its buffer. They live as long as the document.
  [[nodiscard]] View view(std::uint64_t index, const JsonPlace& user);

  /// The bytes that a `data:` URI holds or that a file beside the glTF holds. Throws FileError at `user`.
  [[nodiscard]] std::vector<std::byte> uri_bytes(const std::string& uri, const JsonPlace& user) const;
  /// The ordinary file that a URI means, for readers that open it themselves. Throws FileError at `user`.
  [[nodiscard]] std::filesystem::path uri_file(const std::string& uri, const JsonPlace& user) const;

 private:
  [[nodiscard]] std::filesystem::path asset(const std::string& uri) const;
  void split_glb();
  void check_version() const;
  void check_extensions();
  void read_buffers();
  [[nodiscard]] std::span<const std::byte> buffer(std::uint64_t index, const JsonPlace& user) const;
  [[nodiscard]] std::span<const std::byte> part_of_buffer(const JsonPlace& place) const;
  [[nodiscard]] const std::vector<std::byte>& unpacked(std::uint64_t view, const JsonPlace& compressed);

  std::filesystem::path path_;
  AssetFolder folder_;
  std::string file_;
  WarningTally warnings_;
  std::vector<std::byte> bytes_;
  std::string_view json_text_;
  std::optional<std::span<const std::byte>> binary_;  // the BIN chunk of a .glb
  JsonValue json_;
  std::optional<JsonPlace> root_;
  std::vector<std::vector<std::byte>> buffers_;               // those with a uri
  std::map<std::uint64_t, std::vector<std::byte>> unpacked_;  // views that were compressed
  std::size_t byte_count_ = 0;
  std::size_t work_ = 0;  // steps counted so far
};

}  // namespace penumbra
