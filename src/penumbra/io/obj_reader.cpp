#include "penumbra/io/obj_reader.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include "penumbra/file/file_error.h"
#include "penumbra/file/input_file.h"
#include "penumbra/io/asset_folder.h"
#include "penumbra/io/mtl_library.h"
#include "penumbra/io/mtl_material.h"
#include "penumbra/io/obj_mesh.h"
#include "penumbra/io/obj_model.h"
#include "penumbra/io/text_cursor.h"
#include "penumbra/io/warning_tally.h"

namespace penumbra {
namespace {

bool is_there(const std::string& name, const AssetFolder& folder) {
  try {
    return std::filesystem::exists(folder.resolve(name));
  } catch (const std::exception&) {
    return false;  // no name of a file here, or none that the system can look at
  }
}

// The names of one mtllib statement: a single file with blanks in its name if there is one, else several.
std::vector<std::string> library_names(const std::string& names, const AssetFolder& folder) {
  if (is_there(names, folder)) return {names};
  std::vector<std::string> parted;
  for (std::size_t at = names.find_first_not_of(" \t"); at != std::string::npos;) {
    const std::size_t end = names.find_first_of(" \t", at);
    parted.push_back(names.substr(at, end - at));
    at = names.find_first_not_of(" \t", end);
  }
  return parted;
}

MtlLibrary read_libraries(const ObjModel& model, const AssetFolder& folder, WarningTally& warnings) {
  MtlLibrary all;
  std::set<std::filesystem::path> known;
  for (const auto& [names, place] : model.libraries) {
    for (const std::string& name : library_names(names, folder)) {
      const std::string named = fmt::format("{} ({})", place, in_quotes(name));
      try {
        const auto path = folder.resolve(name);
        std::error_code ignored;
        if (!known.insert(path).second) continue;
        if (std::filesystem::exists(path, ignored)) {
          all.merge(read_mtl(path, warnings));
        } else {
          warnings.count("the MTL file is not there, so its materials are matt grey; put it beside the OBJ", named);
        }
      } catch (const std::invalid_argument& wrong) {
        warnings.count(fmt::format("an MTL file is not read, so its materials are matt grey: it {}", wrong.what()),
                       named);
      }
    }
  }
  return all;
}

// A name as written, or else what stands before a comment.
MtlLibrary::const_iterator find_material(const MtlLibrary& library, const std::string& name) {
  const auto found = library.find(name);
  if (found != library.end()) return found;
  const std::size_t comment = name.find(" #");
  return comment == std::string::npos ? found : library.find(name.substr(0, name.find_last_not_of(" \t", comment) + 1));
}

// One material for each that faces use, in their order.
void add_materials(const ObjModel& model, const MtlLibrary& library, const AssetFolder& folder, Scene& scene,
                   WarningTally& warnings) {
  MtlMaterials materials(folder, scene, warnings);
  for (const std::string& name : model.material_names) {
    if (const auto found = find_material(library, name); found != library.end()) {
      scene.materials.push_back(materials.material(found->first, found->second));
      continue;
    }
    Material material = default_obj_material();
    if (!name.empty()) material.name = name;
    scene.materials.push_back(std::move(material));
    if (!name.empty() && !library.empty()) {
      warnings.count("materials that no MTL file defines are matt grey", in_quotes(name));
    }
  }
}

// By its byte order mark, or a first letter of two bytes.
bool is_utf_16(std::span<const std::byte> bytes) {
  if (bytes.size() < 2) return false;
  const auto first = std::to_integer<int>(bytes[0]);
  const auto second = std::to_integer<int>(bytes[1]);
  return (first == 0xFE && second == 0xFF) || (first == 0xFF && second == 0xFE) || (first == 0) != (second == 0);
}

}  // namespace

LoadedScene read_obj(const std::filesystem::path& path, const ReadOptions& options) {
  const double unit = options.unit;
  if (!(unit > 0) || !std::isfinite(unit))
    throw std::invalid_argument("the unit of an OBJ must be a positive number of metres");
  const std::string name = path.string();
  WarningTally warnings(name);
  LoadedScene loaded;
  Scene& scene = loaded.scene;

  const ObjModel model = [&] {
    const auto bytes = read_file(path);
    if (is_utf_16(bytes)) throw FileError(name, "byte 0", "is UTF-16 text; save it as UTF-8 or plain ASCII");
    return parse_obj(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, unit, warnings);
  }();
  const AssetFolder folder(path, options.allow_outside);
  add_materials(model, read_libraries(model, folder, warnings), folder, scene, warnings);
  scene.meshes = make_obj_meshes(model, name, warnings);
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
    scene.instances.push_back({scene.meshes[m].name, m, Mat4d(1.0)});
  loaded.warnings = warnings.sentences();
  try {
    validate(scene);
  } catch (const std::invalid_argument& error) {
    throw FileError(name, "", error.what());
  }
  return loaded;
}

}  // namespace penumbra
