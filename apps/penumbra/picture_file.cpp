#include "picture_file.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "penumbra/file/output_file.h"
#include "penumbra/image/image_io.h"

namespace penumbra::cli {
namespace {

const std::vector<std::pair<std::string, ToneCurve>> curves{
    {"none", ToneCurve::none}, {"srgb", ToneCurve::srgb}, {"filmic", ToneCurve::filmic}};

std::string extension(const PictureFile& picture) {
  std::string text = std::filesystem::path(picture.path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

void add_picture_options(OptionParser& parser, PictureFile& picture) {
  parser.group("Picture");
  parser.value("-o,--output", "IMAGE",
               "the file to write: .png (8-bit sRGB), .exr (32-bit float, with layers and metadata) or .hdr",
               [&](const OptionValue& v) { picture.path = v.text; });
  parser.value("--exposure", "EV", "brighten by this many stops, a factor of 2 each (default: 0)",
               [&](const OptionValue& v) {
                 constexpr double most = 64;
                 const double stops = real_number(v, "a number of stops (EV) from -64 to 64");
                 if (stops < -most || stops > most)
                   throw UsageError("--exposure takes a number of stops (EV) from -64 to 64, not '" + v.text + "'");
                 picture.exposure = stops;
               });
  parser.value(
      "--tonemap", "none|srgb|filmic",
      "srgb clips at white, filmic rolls highlights off, none leaves values as they are (default: srgb for .png; "
      "none for .exr and .hdr, which hold scene-linear radiance)",
      [&](const OptionValue& v) { picture.curve = choice<ToneCurve>(v, curves); });
}

bool is_scene_linear(const PictureFile& picture) { return extension(picture) != ".png"; }

bool holds_layers(const PictureFile& picture) { return extension(picture) == ".exr"; }

void check(const PictureFile& picture) {
  if (picture.path.empty()) throw UsageError("no picture to write to; add -o IMAGE, such as -o picture.png");
  const std::string kind = extension(picture);
  if (kind != ".png" && kind != ".exr" && kind != ".hdr") {
    throw UsageError(
        fmt::format("-o {}: {} is no picture format that can be written; end the name in .png, .exr or .hdr",
                    picture.path, kind.empty() ? "a name without an extension" : kind));
  }
  if (is_scene_linear(picture) && picture.curve == ToneCurve::srgb) {
    throw UsageError("--tonemap srgb does not apply to " + kind +
                     ", which holds linear values; use none or filmic, or write .png");
  }
  check_creatable(picture.path);
}

void write_picture(const PictureFile& picture, Image image) {
  const double exposure = picture.exposure.value_or(0);
  const ToneCurve curve = picture.curve.value_or(is_scene_linear(picture) ? ToneCurve::none : ToneCurve::srgb);
  if (exposure != 0 || curve == ToneCurve::filmic) {
    auto metadata = std::move(image.metadata);
    image = tonemapped(image, exposure, curve);
    image.metadata = std::move(metadata);
    if (curve == ToneCurve::filmic) image.metadata["tonemap"] = "filmic";
  }
  if (curve != ToneCurve::none || exposure != 0) image.metadata["exposure_ev"] = fmt::format("{}", exposure);
  write_image(picture.path, image);
}

}  // namespace penumbra::cli
