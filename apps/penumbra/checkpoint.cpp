#include "checkpoint.h"

#include <fmt/core.h>

#include <algorithm>

#include "penumbra/file/file_error.h"
#include "penumbra/file/output_file.h"
#include "penumbra/io/npy_array.h"
#include "penumbra/io/npz_reader.h"
#include "penumbra/io/zip_writer.h"
#include "penumbra/scene/fingerprint.h"

namespace penumbra::cli {
namespace {

constexpr const char* not_a_checkpoint = "is no checkpoint of penumbra bake, or damaged; bake again without --resume";

template <class T>
std::vector<std::int64_t> integers(const std::vector<T>& values) {
  return {values.begin(), values.end()};
}
std::vector<double> doubles(const std::vector<float>& values) { return {values.begin(), values.end()}; }
template <class T, class From>
std::vector<T> narrowed(const std::vector<From>& values) {
  std::vector<T> out;
  out.reserve(values.size());
  for (const From& v : values) out.push_back(static_cast<T>(v));
  return out;
}

void add_mesh(ZipWriter& zip, const PatchMesh& mesh) {
  std::vector<double> vertices;
  for (const Vec3d& v : mesh.vertices) vertices.insert(vertices.end(), {v.x, v.y, v.z});
  std::vector<std::int64_t> faces, objects, backs;
  std::vector<std::string> names;
  for (const PatchSurface& s : mesh.surfaces) {
    faces.push_back(s.face);
    objects.push_back(s.object);
    backs.push_back(s.back ? 1 : 0);
  }
  zip.add("vertices.npy", npy_array(vertices));
  zip.add("corner_offsets.npy", npy_array(integers(mesh.corner_offsets)));
  zip.add("corners.npy", npy_array(integers(mesh.corners)));
  zip.add("faces.npy", npy_array(faces));
  zip.add("objects.npy", npy_array(objects));
  zip.add("backs.npy", npy_array(backs));
}

void add_lights(ZipWriter& zip, const std::string& name, const std::vector<LightIrradiance>& lights,
                std::size_t values) {
  std::vector<std::int64_t> numbers;
  std::vector<double> units, power;
  for (const LightIrradiance& l : lights) {
    numbers.push_back(l.light == LightIrradiance::environment ? -1 : static_cast<std::int64_t>(l.light));
    std::vector<double> unit = l.unit;
    unit.resize(values, 0.0);
    units.insert(units.end(), unit.begin(), unit.end());
    power.insert(power.end(), {l.power.x, l.power.y, l.power.z});
  }
  zip.add(name + "_numbers.npy", npy_array(numbers));
  zip.add(name + "_unit.npy", npy_array(units));
  zip.add(name + "_power.npy", npy_array(power));
}

/// A checkpoint's arrays, each checked against the number of elements.
class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path), file_(path) {}

  [[noreturn]] void refuse(const std::string& why) const { throw FileError(path_, "", why); }
  void require(bool good) const {
    if (!good) refuse(not_a_checkpoint);
  }

  void check_scene(const Scene& scene, bool front_sides_only) const {
    require(file_.has("fingerprint") && file_.has("sides"));
    const std::vector<std::string> text = file_.texts("fingerprint");
    require(text.size() == 1);
    if (hash_of_text(text[0]) != fingerprint(scene).ways) {
      refuse(
          "was made of a scene with other surfaces, mirrors, glass or places of lights; only colours and intensities "
          "may "
          "change, so bake again without --resume");
    }
    const std::vector<std::int64_t> sides = file_.integers("sides");
    require(sides.size() == 1);
    if ((sides[0] == 1) != front_sides_only) refuse("was made with the other --sides; bake again without --resume");
  }

  PatchMesh mesh() const {
    PatchMesh mesh;
    const std::vector<double> v = file_.doubles("vertices");
    for (std::size_t i = 0; i + 2 < v.size(); i += 3) mesh.vertices.emplace_back(v[i], v[i + 1], v[i + 2]);
    const auto offsets = file_.integers("corner_offsets"), corners = file_.integers("corners");
    const auto faces = file_.integers("faces"), objects = file_.integers("objects"), backs = file_.integers("backs");
    const std::size_t n = faces.size();
    require(offsets.size() == n + 1 && objects.size() == n && backs.size() == n);
    for (std::size_t i = 0; i < n; ++i) {
      require(0 <= offsets[i] && offsets[i] + 3 <= offsets[i + 1] &&
              offsets[i + 1] <= static_cast<std::int64_t>(corners.size()));
      std::vector<std::uint32_t> polygon;
      for (auto k = static_cast<std::size_t>(offsets[i]); k < static_cast<std::size_t>(offsets[i + 1]); ++k) {
        require(corners[k] >= 0 && corners[k] < static_cast<std::int64_t>(mesh.vertices.size()));
        polygon.push_back(static_cast<std::uint32_t>(corners[k]));
      }
      const auto face = static_cast<std::uint32_t>(faces[i]);
      mesh.surfaces.push_back({.name = "",
                               .face = face,
                               .object = static_cast<std::uint32_t>(objects[i]),
                               .back = backs[i] != 0,
                               .area = 0});
      add_patch(mesh, polygon, static_cast<std::uint32_t>(i), face);
    }
    mesh.radiating_count = n;
    mesh.reflectance.assign(3 * n, 0.0);
    mesh.emission.assign(3 * n, 0.0);
    return mesh;
  }

  FactorMatrix factors(const PatchMesh& mesh) const {
    FactorMatrix m;
    for (const PatchSurface& s : mesh.surfaces) m.areas.push_back(s.area);
    m.offsets = narrowed<std::uint64_t>(file_.integers("factor_offsets"));
    m.columns = narrowed<std::uint32_t>(file_.integers("factor_columns"));
    m.values = file_.doubles("factor_values");
    m.row_errors = file_.doubles("factor_errors");
    m.row_dropped = file_.doubles("factor_dropped");
    require_rows(m.offsets, m.columns, m.values.size(), m.rows());
    require(m.row_errors.size() == m.rows() && m.row_dropped.size() == m.rows());
    return m;
  }

  std::shared_ptr<const SpecularTransport> specular(std::size_t rows) const {
    if (!file_.has("specular_offsets")) return nullptr;
    SpecularTransport t;
    t.offsets = narrowed<std::uint64_t>(file_.integers("specular_offsets"));
    t.columns = narrowed<std::uint32_t>(file_.integers("specular_columns"));
    t.values = narrowed<float>(file_.doubles("specular_values"));
    t.deviations = narrowed<float>(file_.doubles("specular_deviations"));
    t.leaving = narrowed<float>(file_.doubles("specular_leaving"));
    require_rows(t.offsets, t.columns, t.values.size() / 3, rows);
    require(t.values.size() == t.deviations.size() && t.leaving.size() == 3 * rows);
    return std::make_shared<const SpecularTransport>(std::move(t));
  }

  std::vector<LightIrradiance> lights(const std::string& name, const Scene& scene, std::size_t values) const {
    const auto numbers = file_.integers(name + "_numbers");
    const auto units = file_.doubles(name + "_unit"), power = file_.doubles(name + "_power");
    require(units.size() == values * numbers.size() && power.size() == 3 * numbers.size());
    std::vector<LightIrradiance> lights;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      require(numbers[i] >= -1 && numbers[i] < static_cast<std::int64_t>(scene.lights.size()));
      const auto first = units.begin() + static_cast<std::ptrdiff_t>(i * values);
      lights.push_back({numbers[i] < 0 ? LightIrradiance::environment : static_cast<std::size_t>(numbers[i]),
                        {first, first + static_cast<std::ptrdiff_t>(values)},
                        {power[3 * i], power[3 * i + 1], power[3 * i + 2]}});
    }
    return lights;
  }

  /// A light that was dark then has left nothing to be scaled.
  void refuse_new_lights(const Scene& scene, const std::vector<LightIrradiance>& lights) const {
    const auto known = [&](std::size_t light) {
      return std::any_of(lights.begin(), lights.end(), [&](const auto& l) { return l.light == light; });
    };
    const auto check = [&](std::size_t light, const std::string& name) {
      const Vec3d strength = light_strength(scene, light);
      if (strength == Vec3d(0) || known(light)) return;
      refuse(fmt::format("was made when {} was dark, so it does not know what that brings; bake again without --resume",
                         name));
    };
    for (std::size_t l = 0; l < scene.lights.size(); ++l) check(l, "light '" + scene.lights[l].name + "'");
    if (scene.environment && !scene.environment->backdrop_only) check(LightIrradiance::environment, "the environment");
  }

 private:
  void require_rows(const std::vector<std::uint64_t>& offsets, const std::vector<std::uint32_t>& columns,
                    std::size_t values, std::size_t rows) const {
    require(offsets.size() == rows + 1 && offsets.front() == 0 && offsets.back() == columns.size() &&
            values == columns.size() && std::is_sorted(offsets.begin(), offsets.end()) &&
            std::all_of(columns.begin(), columns.end(), [&](std::uint32_t c) { return c < rows; }));
  }

  std::string path_;
  NpzReader file_;
};

}  // namespace

void write_checkpoint(const std::string& path, const Scene& scene, const RadiositySetup& setup) {
  OutputFile out(path);
  ZipWriter zip(out);
  zip.add("fingerprint.npy", npy_array(std::vector<std::string>{to_text(fingerprint(scene).ways)}));
  zip.add("sides.npy", npy_array(std::vector<std::int64_t>{setup.front_sides_only ? 1 : 0}));
  add_mesh(zip, setup.mesh);
  const FactorMatrix& m = setup.factors;
  zip.add("factor_offsets.npy", npy_array(integers(m.offsets)));
  zip.add("factor_columns.npy", npy_array(integers(m.columns)));
  zip.add("factor_values.npy", npy_array(m.values));
  zip.add("factor_errors.npy", npy_array(m.row_errors));
  zip.add("factor_dropped.npy", npy_array(m.row_dropped));
  if (setup.problem.specular) {
    const SpecularTransport& t = *setup.problem.specular;
    zip.add("specular_offsets.npy", npy_array(integers(t.offsets)));
    zip.add("specular_columns.npy", npy_array(integers(t.columns)));
    zip.add("specular_values.npy", npy_array(doubles(t.values)));
    zip.add("specular_deviations.npy", npy_array(doubles(t.deviations)));
    zip.add("specular_leaving.npy", npy_array(doubles(t.leaving)));
  }
  const std::size_t values = 3 * setup.mesh.surface_count();
  add_lights(zip, "lights", setup.lights, values);
  add_lights(zip, "specular_lights", setup.specular_lights, values);
  zip.finish();
  out.commit();
}

std::unique_ptr<RadiositySetup> read_checkpoint(const std::string& path, const Scene& scene,
                                                const RadiositySetupOptions& options) {
  const Reader file(path);
  file.check_scene(scene, options.front_sides_only);
  auto setup = std::make_unique<RadiositySetup>();
  setup->solver = options.solver;
  setup->front_sides_only = options.front_sides_only;
  setup->mesh = file.mesh();
  const std::size_t n = setup->mesh.surface_count();
  std::shared_ptr<const SpecularTransport> specular = file.specular(n);
  for (PatchSurface& s : setup->mesh.surfaces) {
    if (s.object >= scene.object_count()) file.refuse(not_a_checkpoint);
    s.name = scene.object_name(s.object);
  }
  repaint(scene, specular != nullptr, *setup);
  setup->problem = make_radiosity_problem(setup->mesh);
  setup->problem.specular = std::move(specular);
  setup->factors = file.factors(setup->mesh);
  setup->lights = file.lights("lights", scene, 3 * n);
  setup->specular_lights = file.lights("specular_lights", scene, 3 * n);
  file.refuse_new_lights(scene, setup->lights);
  relight(scene, *setup);
  return setup;
}

}  // namespace penumbra::cli
