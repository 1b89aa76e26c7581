#include "penumbra/radiosity/solvers/shooting.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/solvers/energy_balance.h"
#include "penumbra/radiosity/solvers/solver_course.h"

namespace penumbra {
namespace {

constexpr std::size_t receivers_a_task = 2048;

/// What was sent, received and is still to be sent.
class ShootingState {
 public:
  ShootingState(const RadiosityProblem& problem, std::size_t at_once)
      : problem_(problem), bands_(problem.bands), rows_(at_once), sent_(at_once * problem.bands) {
    irradiance_ = irradiance_of_lights(problem);
    irradiance_.resize(problem.emission.size(), 0.0);
    if (problem.specular) specular_ = transposed(*problem.specular);
    radiosity_ = problem.emission;
    for (std::size_t k = 0; k < radiosity_.size(); ++k) radiosity_[k] += problem.reflectance[k] * irradiance_[k];
    unshot_ = radiosity_;
    energy_.resize(problem.element_count());
    largest_source_ = radiosity_.empty() ? 0 : *std::max_element(radiosity_.begin(), radiosity_.end());
    escaped_ = power_past_all(problem);
    weigh();
  }

  [[nodiscard]] const std::vector<double>& radiosity() const { return radiosity_; }
  [[nodiscard]] const std::vector<double>& unshot() const { return unshot_; }
  [[nodiscard]] double unshot_power() const { return unshot_power_; }
  [[nodiscard]] double residual_bound() const { return residual_bound_; }
  [[nodiscard]] double relative_residual() const { return largest_source_ > 0 ? residual_bound_ / largest_source_ : 0; }

  [[nodiscard]] const std::vector<double>& energy() const { return energy_; }

  void shoot(const std::vector<std::uint32_t>& shooters, const FactorRowSource& source) {
    parallel_for(shooters.size(), 1, [&](std::size_t k, std::size_t) { source.read(shooters[k], rows_[k]); });
    for (std::size_t k = 0; k < shooters.size(); ++k) take_out(shooters[k], k);
    parallel_for(problem_.element_count(), receivers_a_task, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = 0; k < shooters.size(); ++k) {
        receive(k, first, last);
        if (problem_.specular) receive_by_mirrors(shooters[k], k, first, last);
      }
    });
    weigh();
  }

  [[nodiscard]] RadiositySolution take() {
    RadiositySolution solution;
    solution.energy.emitted = emitted_power(problem_);
    solution.energy.absorbed = absorbed_power(problem_, irradiance_);
    std::vector<double> shot = radiosity_;
    for (std::size_t k = 0; k < shot.size(); ++k) shot[k] -= unshot_[k];
    const SpecularFlow flow = specular_flow(problem_, shot);
    solution.energy.absorbed -= flow.arrived + flow.left;
    solution.energy.escaped = escaped_ + flow.left;
    solution.energy.unshot = unshot_power_;
    solution.unshot_fraction = solution.energy.emitted > 0 ? unshot_power_ / solution.energy.emitted : 0;
    const double most =
        problem_.reflectance.empty() ? 0 : *std::max_element(problem_.reflectance.begin(), problem_.reflectance.end());
    if (most < 1) solution.error_bound = residual_bound_ / (1 - most);
    solution.radiosity = std::move(radiosity_);
    solution.irradiance = std::move(irradiance_);
    return solution;
  }

 private:
  // The shooter's power leaves it; what no element will receive is gone.
  void take_out(std::uint32_t shooter, std::size_t place) {
    double seen = 0;
    for (const double f : rows_[place].factors) seen += f;
    for (std::size_t b = 0; b < bands_; ++b) {
      double& unshot = unshot_[shooter * bands_ + b];
      sent_[place * bands_ + b] = unshot * problem_.areas[shooter];
      escaped_ += sent_[place * bands_ + b] * (1 - seen);
      unshot = 0;
    }
  }

  // What the elements [first, last) receive from one shooter.
  void receive(std::size_t place, std::size_t first, std::size_t last) {
    const FactorRow& row = rows_[place];
    const auto begin = std::lower_bound(row.columns.begin(), row.columns.end(), static_cast<std::uint32_t>(first));
    for (auto k = static_cast<std::size_t>(begin - row.columns.begin()); k < row.columns.size(); ++k) {
      const std::size_t j = row.columns[k];
      if (j >= last) break;
      const double share = row.factors[k] / problem_.areas[j];
      for (std::size_t b = 0; b < bands_; ++b) add(j * bands_ + b, share * sent_[place * bands_ + b]);
    }
  }

  // The same by way of mirrors and glass.
  void receive_by_mirrors(std::uint32_t shooter, std::size_t place, std::size_t first, std::size_t last) {
    const auto columns = specular_.row_columns(shooter);
    const auto begin = std::lower_bound(columns.begin(), columns.end(), static_cast<std::uint32_t>(first));
    for (auto k = static_cast<std::size_t>(begin - columns.begin()); k < columns.size() && columns[k] < last; ++k) {
      const float* const values = &specular_.values[bands_ * (specular_.offsets[shooter] + k)];
      for (std::size_t b = 0; b < bands_; ++b) {
        add(columns[k] * bands_ + b,
            static_cast<double>(values[b]) * sent_[place * bands_ + b] / problem_.areas[shooter]);
      }
    }
  }

  void add(std::size_t value, double received) {
    const double reflected = problem_.reflectance[value] * received;
    irradiance_[value] += received;
    radiosity_[value] += reflected;
    unshot_[value] += reflected;
  }

  void weigh() {
    unshot_power_ = 0;
    std::vector<double> most_unshot(bands_, 0.0), most_reflective(bands_, 0.0);
    for (std::size_t i = 0; i < energy_.size(); ++i) {
      double sum = 0;
      for (std::size_t b = 0; b < bands_; ++b) {
        sum += unshot_[i * bands_ + b];
        most_unshot[b] = std::max(most_unshot[b], unshot_[i * bands_ + b]);
        most_reflective[b] = std::max(most_reflective[b], problem_.reflectance[i * bands_ + b]);
      }
      energy_[i] = problem_.areas[i] * sum;
      unshot_power_ += energy_[i];
    }
    residual_bound_ = 0;
    for (std::size_t b = 0; b < bands_; ++b) {
      residual_bound_ = std::max(residual_bound_, most_unshot[b] * most_reflective[b]);
    }
  }

  const RadiosityProblem& problem_;
  std::size_t bands_;
  std::vector<double> radiosity_, irradiance_, unshot_;
  std::vector<double> energy_;  ///< unshot, W, a value an element
  SpecularTransport specular_;  ///< by shooters
  std::vector<FactorRow> rows_;
  std::vector<double> sent_;  ///< W, [place * bands + band]
  double largest_source_ = 0;
  double residual_bound_ = 0;
  double unshot_power_ = 0;
  double escaped_ = 0;
};

}  // namespace

std::vector<std::uint32_t> choose_shooters(std::span<const double> energy, std::size_t most) {
  if (energy.empty()) return {};
  const double least = 0.25 * *std::max_element(energy.begin(), energy.end());
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t i = 0; i < energy.size(); ++i) {
    if (energy[i] > 0 && energy[i] >= least) chosen.push_back(i);
  }
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return energy[a] != energy[b] ? energy[a] > energy[b] : a < b;
  };
  const std::size_t count = std::min(most, chosen.size());
  std::partial_sort(chosen.begin(), chosen.begin() + static_cast<std::ptrdiff_t>(count), chosen.end(), before);
  chosen.resize(count);
  return chosen;
}

RadiositySolution solve_shooting(const RadiosityProblem& problem, const FactorRowSource& rows,
                                 const SolverOptions& options, const ShootingOptions& shooting) {
  validate(problem);
  if (rows.size() != problem.element_count()) {
    throw std::invalid_argument(
        fmt::format("the form factors are of {} elements, the problem of {}; compute them for the same mesh",
                    rows.size(), problem.element_count()));
  }
  if (shooting.at_once == 0) throw std::invalid_argument("at least one element should shoot at a time");
  SolverCourse course(options, 100000 + 10000 * problem.element_count());
  ShootingState state(problem, shooting.at_once);
  const double emitted = emitted_power(problem);
  while (course.goes_on()) {
    std::vector<std::uint32_t> shooters;
    if (state.unshot_power() > 0) {
      shooters = choose_shooters(state.energy(), std::min(shooting.at_once, course.left()));
    }
    state.shoot(shooters, rows);
    course.note(std::max<std::size_t>(shooters.size(), 1), state.relative_residual(),
                emitted > 0 ? state.unshot_power() / emitted : 0, emitted > 0 ? 1 - state.unshot_power() / emitted : 1,
                state.radiosity(), state.unshot());
  }
  RadiositySolution solution = state.take();
  course.record(solution);
  return solution;
}

RadiositySolution solve_shooting(const RadiosityProblem& problem, const FactorMatrix& factors,
                                 const SolverOptions& options, const ShootingOptions& shooting) {
  return solve_shooting(problem, MatrixRows(factors), options, shooting);
}

}  // namespace penumbra
