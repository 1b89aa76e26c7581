#pragma once

#include <string>
#include <vector>

namespace penumbra::cli {

// Each command takes the arguments after its name and returns an ExitCode. What fails is thrown: see exit_code.h.

/// Draws a picture of a scene.
[[nodiscard]] int run_render(const std::vector<std::string>& arguments);
/// Solves the diffuse light of a scene.
[[nodiscard]] int run_bake(const std::vector<std::string>& arguments);
/// Shows the ray tree of a pixel.
[[nodiscard]] int run_explain(const std::vector<std::string>& arguments);
/// Measures how far two pictures lie apart.
[[nodiscard]] int run_compare(const std::vector<std::string>& arguments);
/// Computes the form factors of a mesh.
[[nodiscard]] int run_factors(const std::vector<std::string>& arguments);
/// Computes the exchange of heat by radiation between grey, diffuse surfaces.
[[nodiscard]] int run_exchange(const std::vector<std::string>& arguments);
/// Looks for leaks and odd numbers in a scene.
[[nodiscard]] int run_check(const std::vector<std::string>& arguments);
/// Lists the built-in scenes, or writes one as a file.
[[nodiscard]] int run_scene(const std::vector<std::string>& arguments);

}  // namespace penumbra::cli
