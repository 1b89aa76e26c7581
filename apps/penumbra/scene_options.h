#pragma once

#include <optional>
#include <string>
#include <vector>

#include "option_parser.h"
#include "penumbra/io/load_report.h"
#include "penumbra/io/read_options.h"
#include "penumbra/scene/scene.h"
#include "world_options.h"

namespace penumbra::cli {

/// The SCENE of a command and how to read it.
struct SceneOptions {
  std::string source;                      ///< a path, or "builtin:NAME?key=value"
  std::optional<double> unit;              ///< metres per file unit
  std::optional<std::string> scene;        ///< of a glTF, by name or index
  std::optional<std::string> animation;    ///< of a glTF, by name or index
  std::optional<double> time;              ///< of the animation, s
  std::optional<Shutter> shutter;          ///< of the animation, s
  std::optional<std::string> environment;  ///< "R,G,B" or a picture's path
  bool front_sides_only = false;
  bool photometric = false;
  WorldOptions world;
  bool allow_outside = false;  ///< read what the scene names outside its folder
  bool fix_energy = false;     ///< scale materials that would send on more light than arrives
};

/// Adds SCENE and its options. `options` must outlive `parser`'s last parse.
void add_scene_options(OptionParser& parser, SceneOptions& options);

/// Adds SCENE and how to read it alone, for commands that take the file as it is.
void add_scene_source(OptionParser& parser, SceneOptions& options);

/// Adds --allow-outside.
void add_allow_outside(OptionParser& parser, bool& allow_outside);

/// Adds --shutter, for methods that see motion.
void add_shutter_option(OptionParser& parser, SceneOptions& options);

/// Reads the scene as it stands in the file. Throws as read_scene.
[[nodiscard]] LoadedScene read_source(const SceneOptions& options);

/// Refuses a scene whose triangles, each instance's own, would not fit into the memory that is left: instances of
/// instances make a thousand million of them in a small file. For commands that give each triangle a face of its own.
/// @param source what messages call the scene. Throws FileError.
void require_room_for_faces(const Scene& scene, const std::string& source);

/// Throws UsageError when an option does not fit the scene's format.
void check(const SceneOptions& options);

/// Reads the scene, turns photometric emission into radiance, and sets its environment; materials that reflect and
/// transmit more than arrives are refused or, when asked, scaled, with a warning; a scene without any light
/// (see `is_lit`) gets a white one, with a warning. Throws FileError, UsageError, std::invalid_argument.
[[nodiscard]] Scene load_scene(const SceneOptions& options, std::vector<std::string>& warnings);

/// Warns, once, of dyes that red, green and blue cannot show. @param spectral whether wavelengths are followed.
void warn_of_dyes(const Scene& scene, bool spectral, std::vector<std::string>& warnings);

}  // namespace penumbra::cli
