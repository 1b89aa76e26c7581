#pragma once

#include "option_parser.h"

namespace penumbra::cli {

/// Pixels of a picture.
struct PictureSize {
  int width = 800, height = 600;
};

/// `--size WxH`. `size` must outlive `parser`'s last parse.
void add_picture_size_option(OptionParser& parser, PictureSize& size);

}  // namespace penumbra::cli
