#include "penumbra/io/mtl_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <utility>

#include "penumbra/file/input_file.h"
#include "penumbra/io/obj_statements.h"
#include "penumbra/io/text_cursor.h"

namespace penumbra {
namespace {

constexpr auto ignored_maps =
    std::to_array<std::string_view>({"map_Ks", "map_Ns", "map_bump", "map_Bump", "bump", "norm", "map_Pr", "map_Pm",
                                     "map_Ps", "map_Tf", "map_Tr", "disp", "decal", "refl", "map_refl", "map_aat"});
// Ka and its map stand for ambient light, which nothing here knows; the others refine models that are not ours.
constexpr auto silent =
    std::to_array<std::string_view>({"map_Ka", "sharpness", "Pr", "Pm", "Ps", "Pc", "Pcr", "aniso", "anisor", "Km"});

bool holds(std::span<const std::string_view> words, std::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

class MtlParser {
 public:
  MtlParser(const std::string& path, std::string_view text, WarningTally& warnings)
      : statements_(path, text), warnings_(warnings) {}

  MtlLibrary parse() {
    while (statements_.next()) {
      if (statements_.keyword() == "newmtl") {
        begin_material();
      } else if (material_ == nullptr) {
        statements_.fail(
            fmt::format("{} comes before any newmtl; is this an MTL file?", in_quotes(statements_.keyword())));
      } else {
        read_statement();
      }
    }
    read_lamps_in_ambient();
    return std::move(library_);
  }

 private:
  void begin_material();
  void read_statement();
  bool read_colour_statement();
  bool read_number_statement();
  bool read_map_statement();
  Rgb read_colour(std::string_view first);
  float read_number(std::string_view what);
  MtlMap read_map();
  void read_lamps_in_ambient();
  void warn(std::string_view sentence, std::string_view place) {
    warnings_.count(sentence, fmt::format("{} of {}", place, statements_.path()));
  }

  ObjStatements statements_;
  WarningTally& warnings_;
  MtlLibrary library_;
  MtlMaterial* material_ = nullptr;
  MtlMaterial repeated_;
  bool has_dissolve_ = false;  // d rules over Tr
};

void MtlParser::begin_material() {
  const auto [found, is_new] = library_.try_emplace(std::string(statements_.rest()));
  has_dissolve_ = false;
  material_ = &found->second;
  if (!is_new) {
    warn("materials of one name: the first stands, the others were left out", statements_.place());
    repeated_ = MtlMaterial{};
    material_ = &repeated_;
  }
  material_->file = statements_.path();
  material_->place = statements_.place();
}

void MtlParser::read_statement() {
  if (read_colour_statement() || read_number_statement() || read_map_statement()) return;
  if (holds(silent, statements_.keyword())) return;
  warn("statements that are not known were left out",
       fmt::format("{} ({})", statements_.place(), in_quotes(statements_.keyword())));
}

bool MtlParser::read_colour_statement() {
  const std::string_view keyword = statements_.keyword();
  std::optional<Rgb>* colour = keyword == "Kd"   ? &material_->diffuse
                               : keyword == "Ks" ? &material_->specular
                               : keyword == "Ke" ? &material_->emission
                               : keyword == "Ka" ? &material_->ambient
                               : keyword == "Tf" ? &material_->filter
                                                 : nullptr;
  if (colour == nullptr) return false;
  const std::string_view first = statements_.word();
  if (first == "spectral" || first == "xyz") {
    warn("colours given as spectral files or XYZ were left out; write them as RGB", statements_.place());
    return true;
  }
  *colour = read_colour(first);
  return true;
}

// One number means grey.
Rgb MtlParser::read_colour(std::string_view first) {
  const auto component = [this](std::string_view word) {
    const auto value = static_cast<float>(statements_.number(word, "a component of the colour"));
    if (!std::isfinite(value)) statements_.fail("a component of the colour is too large");
    if (value < 0) {
      warn("negative components of colours were taken for 0", statements_.place());
      return 0.0F;
    }
    return value;
  };
  const float red = component(first);
  const std::string_view second = statements_.word();
  if (second.empty() || second.front() == '#') return Rgb(red);
  const float green = component(second);
  const std::string_view third = statements_.word();
  return {red, green, component(third)};
}

float MtlParser::read_number(std::string_view what) {
  const auto value = static_cast<float>(statements_.number(what));
  if (!std::isfinite(value)) statements_.fail(fmt::format("{} is too large", what));
  return value;
}

bool MtlParser::read_number_statement() {
  const std::string_view keyword = statements_.keyword();
  if (keyword == "Ns") {
    material_->shininess = std::max(0.0F, read_number("the shininess Ns"));
  } else if (keyword == "Ni") {
    material_->ior = read_number("the index of refraction Ni");
  } else if (keyword == "d") {
    std::string_view word = statements_.word();
    if (word == "-halo") word = statements_.word();
    material_->opacity = std::clamp(static_cast<float>(statements_.number(word, "the opacity d")), 0.0F, 1.0F);
    has_dissolve_ = true;
  } else if (keyword == "Tr") {
    const float transparency = std::clamp(read_number("the transparency Tr"), 0.0F, 1.0F);
    if (!has_dissolve_) material_->opacity = 1 - transparency;
  } else if (keyword == "illum") {
    const double model = statements_.number("the illumination model");
    if (!(model >= 0 && model <= 10)) {
      warn("illumination models beyond 0 to 10 were left out", statements_.place());
    } else {
      material_->illum = static_cast<int>(model);
    }
  } else {
    return false;
  }
  return true;
}

bool MtlParser::read_map_statement() {
  const std::string_view keyword = statements_.keyword();
  if (holds(ignored_maps, keyword)) {
    warn("maps other than map_Kd, map_Ke and map_d were left out",
         fmt::format("{} ({})", statements_.place(), in_quotes(keyword)));
    return true;
  }
  std::optional<MtlMap>* map = keyword == "map_Kd"   ? &material_->diffuse_map
                               : keyword == "map_Ke" ? &material_->emission_map
                               : keyword == "map_d"  ? &material_->opacity_map
                                                     : nullptr;
  if (map == nullptr) return false;
  *map = read_map();
  if ((*map)->file.empty()) statements_.fail("the map names no file");
  return true;
}

// Options, each with so many words, then a file name that may hold blanks.
MtlMap MtlParser::read_map() {
  static const std::map<std::string_view, int> words_of_option{
      {"-blendu", 1},  {"-blendv", 1}, {"-boost", 1}, {"-mm", 2}, {"-texres", 1}, {"-clamp", 1}, {"-bm", 1},
      {"-imfchan", 1}, {"-type", 1},   {"-cc", 1},    {"-o", 3},  {"-s", 3},      {"-t", 3}};
  MtlMap map;
  map.place = statements_.place();
  std::string_view word = statements_.word();
  for (auto option = words_of_option.find(word); option != words_of_option.end(); option = words_of_option.find(word)) {
    const bool may_be_fewer = option->second == 3;  // -o, -s and -t: up to three numbers, the first a must
    std::array<double, 3> numbers{option->first == "-s" ? 1.0 : 0.0, option->first == "-s" ? 1.0 : 0.0, 0.0};
    word = statements_.word();
    for (int n = 0; n < option->second && !word.empty(); ++n) {
      if (may_be_fewer) {
        double value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (n > 0 && (end != word.data() + word.size() || error != std::errc{})) break;
        numbers[static_cast<std::size_t>(n)] = statements_.number(word, "the option of the map");
      }
      if (option->first == "-clamp") map.clamp = word == "on";
      word = statements_.word();
    }
    if (option->first == "-o") map.offset = {numbers[0], numbers[1]};
    if (option->first == "-s") map.scale = {numbers[0], numbers[1]};
  }
  map.file = word;
  if (const std::string_view more = statements_.rest(); !word.empty() && !more.empty()) {
    map.file.append(" ").append(more);
  }
  return map;
}

// Ambient reflectance cannot exceed 1: files without any Ke that say so mean a lamp (the Cornell box that came with
// Embree is one).
void MtlParser::read_lamps_in_ambient() {
  const bool knows_emission =
      std::ranges::any_of(library_, [](const auto& m) { return m.second.emission.has_value(); });
  if (knows_emission) return;
  for (auto& [name, material] : library_) {
    if (!material.ambient || max_component(*material.ambient) <= 1) continue;
    material.emission = material.ambient;
    warn("Ka is above 1 in a file without Ke, so it was taken for emitted radiance; write it as Ke",
         fmt::format("{} ({})", material.place, in_quotes(name)));
  }
}

}  // namespace

MtlLibrary read_mtl(const std::filesystem::path& path, WarningTally& warnings) {
  const auto bytes = read_file(path);
  return MtlParser(path.string(), {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, warnings).parse();
}

}  // namespace penumbra
