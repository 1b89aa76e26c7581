#include "lens_options.h"

#include <charconv>
#include <cmath>
#include <numbers>

#include "penumbra/image/image_io.h"

namespace penumbra::cli {
namespace {

using Projection = LensOptions::Projection;

constexpr double radians_per_degree = std::numbers::pi / 180;
constexpr double usual_frame_height = 0.024;  // m, of 35 mm film
const std::vector<std::pair<std::string, Projection>> projections{
    {"perspective", Projection::perspective}, {"panorama", Projection::panorama}, {"fisheye", Projection::fisheye}};

std::optional<double> number_in(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// "N" or "N:DEGREES".
BladeAperture blades(std::string_view text, const std::string& whole) {
  const std::size_t colon = text.find(':');
  const auto count = number_in(text.substr(0, colon));
  const auto degrees = colon == std::string_view::npos ? std::optional(0.0) : number_in(text.substr(colon + 1));
  if (!count || *count < 3 || *count > 64 || *count != std::floor(*count) || !degrees) {
    throw UsageError(fmt::format(
        "--aperture blades:N[:DEGREES] takes 3 to 64 blades and a rotation, such as blades:6:15, not '{}'", whole));
  }
  return {.blades = static_cast<int>(*count), .rotation = *degrees * radians_per_degree};
}

ImageAperture picture(const std::string& path) {
  const Image image = read_image(path);
  TextureImage grey{.name = path, .width = image.width, .height = image.height, .channels = 1, .texels = {}};
  std::vector<float> texels;
  bool any = false;
  for (std::size_t i = 0; i < image.data.size(); i += image.channels.size()) {
    texels.push_back(image.data[i]);
    any = any || image.data[i] > 0;
  }
  if (!any) throw UsageError(fmt::format("--aperture {}: the picture is black, so no light passes", path));
  grey.texels = std::move(texels);
  return {std::move(grey)};
}

decltype(ThinLens::aperture) make_aperture(const std::string& text) {
  constexpr std::string_view iris = "blades:";
  if (text == "disk") return DiskAperture{};
  if (text.starts_with(iris)) return blades(std::string_view(text).substr(iris.size()), text);
  return picture(text);
}

double distance_in_the_middle(const Camera& camera, const RayTracer& tracer, double aspect) {
  Ray middle = camera.ray(0.5, 0.5, aspect);
  middle.time = 0.5;  // of the exposure
  const auto hit = tracer.nearest(middle);
  if (!hit) throw UsageError("--f-number: nothing stands in the middle of the picture to focus on; add --focus METRES");
  return hit->t;
}

Camera with_projection(Camera camera, const LensOptions& options) {
  if (options.projection == Projection::panorama) {
    camera.lens = PanoramicLens{};
  } else if (options.projection == Projection::fisheye) {
    camera.lens = FisheyeLens{options.fov.value_or(std::numbers::pi)};
  } else if (options.projection && !std::holds_alternative<PerspectiveLens>(camera.lens)) {
    camera.lens = PerspectiveLens{options.fov.value_or(PerspectiveLens{}.vertical_fov)};
  } else if (options.fov) {
    if (std::holds_alternative<OrthographicLens>(camera.lens)) {
      throw UsageError("--fov does not apply to the orthographic camera '" + camera.name + "'; leave it away");
    }
    camera.lens = PerspectiveLens{*options.fov};
  }
  return camera;
}

}  // namespace

void add_lens_options(OptionParser& parser, LensOptions& options) {
  parser.group("Lens");
  parser.value("--projection", "NAME",
               "perspective, panorama (all directions; twice as wide as high) or fisheye (angles grow evenly with the "
               "distance from the middle) (default: the camera's own)",
               [&](const OptionValue& v) { options.projection = choice<Projection>(v, projections); });
  parser.value("--fov", "DEG",
               "vertical field of view in degrees (default: the camera's own; 40 where it has none, 65 inside a room); "
               "of a fisheye the angle across its circle, up to 360 (default: 180)",
               [&](const OptionValue& v) {
                 options.fov = radians_per_degree * number_above_zero(v, "a field of view in degrees above 0");
               });
  parser.value(
      "--f-number", "N",
      "depth of field: focal length over aperture, smaller blurs more (default: a pinhole, all is sharp)",
      [&](const OptionValue& v) { options.f_number = number_above_zero(v, "an f-number above 0, such as 2.8"); });
  parser.value("--focus", "M", "distance of the plane in focus, m (default: of what the middle of the picture shows)",
               [&](const OptionValue& v) { options.focus = number_above_zero(v, "a distance in metres above 0"); });
  parser.value("--aperture", "SHAPE",
               "shape of points out of focus: disk, blades:N[:DEGREES] (an iris, turned), or a picture whose bright "
               "parts let light pass (default: disk)",
               [&](const OptionValue& v) { options.aperture = v.text; });
  parser.value("--cat-eye", "X",
               "optical vignetting, 0 to 1: cuts the aperture to cat's eyes towards the corners, which darken "
               "(default: 0)",
               [&](const OptionValue& v) {
                 options.cat_eye = real_number(v, "a share from 0 to 1");
                 if (*options.cat_eye < 0 || *options.cat_eye > 1) {
                   throw UsageError("--cat-eye takes a share from 0 to 1, not '" + v.text + "'");
                 }
               });
  parser.value(
      "--frame-height", "MM", "height of the film or sensor behind the lens, mm (default: 24)",
      [&](const OptionValue& v) { options.frame_height = number_above_zero(v, "millimetres above 0") / 1000; });
}

void check(const LensOptions& o) {
  const double widest = o.projection == Projection::fisheye ? 360 : 180;
  if (o.fov && (*o.fov > widest * radians_per_degree || (widest == 180 && *o.fov >= std::numbers::pi))) {
    throw UsageError(
        fmt::format("--fov takes a vertical field of view in degrees, above 0 and below 180 (up to 360 for a fisheye), "
                    "not '{:g}'",
                    *o.fov / radians_per_degree));
  }
  if (o.projection == Projection::panorama && o.fov) {
    throw UsageError("--fov does not apply to --projection panorama, which sees everything; leave it away");
  }
  const char* of_lens = o.focus          ? "--focus"
                        : o.aperture     ? "--aperture"
                        : o.cat_eye      ? "--cat-eye"
                        : o.frame_height ? "--frame-height"
                                         : nullptr;
  if (of_lens && !o.f_number) {
    throw UsageError(fmt::format("{} belongs to --f-number N, which opens the lens", of_lens));
  }
  if (o.f_number && o.projection.value_or(Projection::perspective) != Projection::perspective) {
    throw UsageError("--f-number does not apply to --projection panorama or fisheye, in which all is sharp");
  }
}

Camera with_lens(Camera camera, const LensOptions& options, const RayTracer& tracer, double aspect) {
  camera = with_projection(std::move(camera), options);
  if (!options.f_number) return camera;
  const auto* perspective = std::get_if<PerspectiveLens>(&camera.lens);
  if (!perspective) {
    throw UsageError("--f-number does not apply to the orthographic camera '" + camera.name + "'; leave it away");
  }
  const double focus = options.focus ? *options.focus : distance_in_the_middle(camera, tracer, aspect);
  ThinLens lens =
      thin_lens(*options.f_number, focus, perspective->vertical_fov, options.frame_height.value_or(usual_frame_height));
  lens.cat_eye = options.cat_eye.value_or(0);
  if (options.aperture) lens.aperture = make_aperture(*options.aperture);
  camera.thin_lens = std::move(lens);
  return camera;
}

}  // namespace penumbra::cli
