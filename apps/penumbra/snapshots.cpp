#include "snapshots.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "penumbra/radiosity/solvers/ambient.h"
#include "picture_file.h"
#include "solution_file.h"

namespace penumbra::cli {
namespace {

constexpr int width = 400, height = 400;
constexpr int samples = 4;
constexpr std::size_t shots_between = 100;

/// What must arrive for elements to send out `radiosity`; 0 where nothing is reflected.
std::vector<double> irradiance_for(const RadiositySetup& setup, const std::vector<double>& radiosity) {
  std::vector<double> irradiance(radiosity.size(), 0.0);
  for (std::size_t k = 0; k < radiosity.size(); ++k) {
    const double rho = setup.problem.reflectance[k];
    if (rho > 0) irradiance[k] = std::max(0.0, radiosity[k] - setup.problem.emission[k]) / rho;
  }
  return irradiance;
}

}  // namespace

Snapshots::Snapshots(const BakeArguments& arguments, const Scene& scene, const RadiositySetup& setup)
    : arguments_(arguments),
      scene_(scene),
      setup_(setup),
      view_(make_view()),
      shown_(setup.mesh.surface_count()),
      camera_(choose_camera(arguments.camera, RayTracer(scene), static_cast<double>(width) / height,
                            arguments.scene.source)),
      every_(arguments.snapshot_every.value_or(setup.solver == "shooting" ? shots_between : 1)) {}

RadiosityView Snapshots::make_view() const {
  return RadiosityView(setup_.mesh, std::vector<double>(3 * setup_.mesh.surface_count(), 0.0), scene_);
}

void Snapshots::take(const SolverStage& stage) {
  if (stage.iteration < next_) return;
  next_ = std::max(stage.iteration, next_) + every_;
  const std::vector<double> shown =
      stage.unshot.empty() ? stage.radiosity : with_ambient(setup_.problem, stage.radiosity, stage.unshot);
  if (shown_ != setup_.mesh.surface_count()) {
    view_ = make_view();
    shown_ = setup_.mesh.surface_count();
  }
  view_.relight(irradiance_for(setup_, shown));
  RenderOptions options;
  options.width = width;
  options.height = height;
  options.samples_per_pixel = samples;
  PictureFile picture;
  const auto folder = std::filesystem::path(*arguments_.snapshots);
  picture.path = (folder / fmt::format("stage-{:05}.png", stage.iteration)).string();
  picture.exposure = arguments_.exposure;
  write_picture(picture, render(view_, camera_, options).image);
  if (arguments_.snapshot_meshes) {
    write_mesh((folder / fmt::format("stage-{:05}.ply", stage.iteration)).string(), shown);
  }
}

void Snapshots::write_mesh(const std::string& path, const std::vector<double>& radiosity) const {
  RadiositySolution stage;
  stage.radiosity = radiosity;
  stage.irradiance = irradiance_for(setup_, radiosity);
  (void)write_solution(path, diffuse_solution(scene_, setup_.mesh, stage), scene_,
                       {arguments_.exposure.value_or(0), arguments_.scene.photometric});
}

}  // namespace penumbra::cli
