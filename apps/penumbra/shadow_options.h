#pragma once

#include <string>

#include "option_parser.h"
#include "penumbra/render/render.h"

namespace penumbra::cli {

/// How shadow rays are spent, as far as the user said.
struct ShadowOptions {
  int samples = 0;          ///< rays to a lamp where its shadow may end; 0: as elsewhere
  bool everywhere = false;  ///< as many elsewhere
  bool exact = false;
  bool opaque = false;  ///< glass stops shadow rays
};

void add_shadow_options(OptionParser& parser, ShadowOptions& shadows);

/// Writes them into the render's options. Throws UsageError for those that do not apply to the integrator.
void apply(const ShadowOptions& shadows, const std::string& integrator, RenderOptions& options);

}  // namespace penumbra::cli
