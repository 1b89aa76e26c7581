#pragma once

#include <optional>
#include <string>

#include "option_parser.h"
#include "penumbra/image/image.h"
#include "penumbra/image/tonemap.h"

namespace penumbra::cli {

/// The picture that a command writes, and how radiance becomes its values.
struct PictureFile {
  std::string path;
  std::optional<double> exposure;  ///< stops (EV)
  std::optional<ToneCurve> curve;
};

/// `picture` must outlive `parser`'s last parse.
void add_picture_options(OptionParser& parser, PictureFile& picture);

/// Whether the format holds scene-linear radiance (.exr, .hdr) rather than colours for a screen (.png).
[[nodiscard]] bool is_scene_linear(const PictureFile& picture);
/// Whether the format holds layers beside the colour.
[[nodiscard]] bool holds_layers(const PictureFile& picture);

/// Fails before any work is done when the extension is unknown, an option does not fit it, or the file cannot be
/// created. Throws UsageError, FileError.
void check(const PictureFile& picture);

/// Exposes and tone maps as asked, and writes. Throws FileError, std::system_error.
void write_picture(const PictureFile& picture, Image image);

}  // namespace penumbra::cli
