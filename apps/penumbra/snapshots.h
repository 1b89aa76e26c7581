#pragma once

#include <memory>
#include <string>

#include "bake_arguments.h"
#include "penumbra/radiosity/pipeline/scene_radiosity.h"
#include "penumbra/render/radiosity_view.h"

namespace penumbra::cli {

/// Pictures of a solution as it grows: after each bounce or sweep, or every so many shots.
class Snapshots {
 public:
  /// Scene and setup must outlive it.
  Snapshots(const BakeArguments& arguments, const Scene& scene, const RadiositySetup& setup);

  /// Takes a picture when one is due. Shooting is shown with the ambient term. Throws FileError, std::system_error.
  void take(const SolverStage& stage);

 private:
  [[nodiscard]] RadiosityView make_view() const;
  void write_mesh(const std::string& path, const std::vector<double>& radiosity) const;

  const BakeArguments& arguments_;
  const Scene& scene_;
  const RadiositySetup& setup_;
  RadiosityView view_;
  std::size_t shown_;  ///< elements of the view; shooting may cut them as it goes
  Camera camera_;
  std::size_t every_;
  std::size_t next_ = 1;
};

}  // namespace penumbra::cli
