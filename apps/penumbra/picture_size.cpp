#include "picture_size.h"

#include "penumbra/image/image_io.h"

namespace penumbra::cli {

void add_picture_size_option(OptionParser& parser, PictureSize& size) {
  parser.value("--size", "WxH", "width and height in pixels (default: 800x600)", [&size](const OptionValue& value) {
    const std::size_t cross = value.text.find('x');
    try {
      if (cross == std::string::npos) throw UsageError("no x");
      size.width = static_cast<int>(whole_number({"", value.text.substr(0, cross)}, 1, max_image_side, ""));
      size.height = static_cast<int>(whole_number({"", value.text.substr(cross + 1)}, 1, max_image_side, ""));
    } catch (const UsageError&) {
      throw UsageError(fmt::format("{} takes WIDTHxHEIGHT in pixels, each from 1 to {}, such as 800x600, not '{}'",
                                   value.option, max_image_side, value.text));
    }
  });
}

}  // namespace penumbra::cli
