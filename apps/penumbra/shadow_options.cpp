#include "shadow_options.h"

#include <fmt/format.h>

#include "option_value.h"
#include "usage_error.h"

namespace penumbra::cli {
namespace {

constexpr int most_rays = 1 << 16;

/// Why an integrator has no shadow rays to be told about.
std::string reason(const std::string& integrator) {
  if (integrator == "radiosity") return "which shows light that was computed before";
  if (integrator == "two-pass") return "where light through glass is in the solution";
  if (integrator == "light") return "which sends no rays to lamps";
  return "which finds the light through glass by itself";
}

}  // namespace

void add_shadow_options(OptionParser& parser, ShadowOptions& shadows) {
  parser.value(
      "--shadow-samples", "N",
      "appel and whitted: rays that a sample sends to a lamp where a first pass saw that its shadow may end; "
      "one elsewhere (default: one everywhere)",
      [&](const OptionValue& v) { shadows.samples = static_cast<int>(whole_number(v, 1, most_rays, "rays")); });
  parser.flag("--shadow-samples-everywhere", "send as many elsewhere, too, to compare with", shadows.everywhere);
  parser.flag("--exact-shadows",
              "appel and whitted: light of flat lamps on matt surfaces without noise, by clipping the lamp, where at "
              "most 32 polygons stand in between (default: by shadow rays)",
              shadows.exact);
  parser.flag("--opaque-shadows", "glass stops shadow rays, for appel and whitted (default: it attenuates them)",
              shadows.opaque);
}

void apply(const ShadowOptions& shadows, const std::string& integrator, RenderOptions& options) {
  const bool applies = integrator == "appel" || integrator == "whitted";
  const auto refuse = [&](bool given, const char* option, const std::string& why) {
    if (!given || applies) return;
    throw UsageError(fmt::format("{} does not apply to --integrator {}, {}; leave it away", option, integrator, why));
  };
  refuse(shadows.opaque, "--opaque-shadows", reason(integrator));
  const std::string own = "which finds direct light in its own way";
  refuse(shadows.samples > 0, "--shadow-samples", own);
  refuse(shadows.everywhere, "--shadow-samples-everywhere", own);
  refuse(shadows.exact, "--exact-shadows", own);
  if (shadows.everywhere && shadows.samples == 0) {
    throw UsageError("--shadow-samples-everywhere needs the number of rays; give --shadow-samples N");
  }
  options.shadow_samples = shadows.samples;
  options.shadow_samples_everywhere = shadows.everywhere;
  options.exact_shadows = shadows.exact;
  options.opaque_shadows = shadows.opaque;
}

}  // namespace penumbra::cli
