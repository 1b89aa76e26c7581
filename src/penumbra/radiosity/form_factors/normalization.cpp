#include "penumbra/radiosity/form_factors/normalization.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace penumbra {
namespace {

constexpr int most_rounds = 20;
constexpr double solved = 1e-13;  // of the first residual

double largest_defect(const FactorMatrix& m) {
  double worst = 0;
  for (std::size_t i = 0; i < m.rows(); ++i) {
    if (!m.row_values(i).empty()) worst = std::max(worst, std::abs(m.row_sum(i) - 1));
  }
  return worst;
}

// What changed between the values before and now.
void measure(const FactorMatrix& m, const std::vector<double>& before, Normalization& report) {
  for (std::size_t i = 0; i < m.rows(); ++i) {
    double row = 0;
    for (std::uint64_t k = m.offsets[i]; k < m.offsets[i + 1]; ++k) {
      const double change = std::abs(m.values[k] - before[k]);
      report.largest_change = std::max(report.largest_change, change);
      row += change;
    }
    report.largest_row_change = std::max(report.largest_row_change, row);
  }
}

// Correction d_ij = w_ij (l_i + l_j) with w = x^2; the rows ask for (D + W) l = r, D the row sums of W.
class LeastSquares {
 public:
  explicit LeastSquares(const FactorMatrix& m) : m_(m), diagonal_(m.rows(), 0.0) {
    for (std::size_t i = 0; i < m.rows(); ++i) {
      for (std::uint64_t k = m.offsets[i]; k < m.offsets[i + 1]; ++k) {
        diagonal_[i] += weight(i, k) * (m.columns[k] == i ? 2 : 1);
      }
    }
  }

  [[nodiscard]] double weight(std::size_t i, std::uint64_t k) const {
    const double x = m_.areas[i] * m_.values[k];
    return x * x;
  }

  [[nodiscard]] std::vector<double> solve(const std::vector<double>& right, int& iterations) const {
    const std::size_t n = m_.rows();
    std::vector<double> l(n, 0.0), r = right, z(n), p, q(n);
    const auto precondition = [&] {
      for (std::size_t i = 0; i < n; ++i) z[i] = diagonal_[i] > 0 ? r[i] / diagonal_[i] : 0.0;
    };
    precondition();
    p = z;
    double rz = std::inner_product(r.begin(), r.end(), z.begin(), 0.0);
    const double goal = solved * solved * rz;
    const int most = 10 * static_cast<int>(std::min<std::size_t>(n, 1000)) + 100;
    for (int step = 0; step < most && rz > goal && rz > 0; ++step, ++iterations) {
      apply(p, q);
      const double pq = std::inner_product(p.begin(), p.end(), q.begin(), 0.0);
      if (!(pq > 0)) break;
      const double a = rz / pq;
      for (std::size_t i = 0; i < n; ++i) {
        l[i] += a * p[i];
        r[i] -= a * q[i];
      }
      precondition();
      const double next = std::inner_product(r.begin(), r.end(), z.begin(), 0.0);
      for (std::size_t i = 0; i < n; ++i) p[i] = z[i] + next / rz * p[i];
      rz = next;
    }
    return l;
  }

 private:
  void apply(const std::vector<double>& p, std::vector<double>& q) const {
    for (std::size_t i = 0; i < m_.rows(); ++i) {
      double sum = 0;
      for (std::uint64_t k = m_.offsets[i]; k < m_.offsets[i + 1]; ++k) sum += weight(i, k) * (p[i] + p[m_.columns[k]]);
      q[i] = sum;
    }
  }

  const FactorMatrix& m_;
  std::vector<double> diagonal_;
};

}  // namespace

Normalization normalize_rows(FactorMatrix& m) {
  Normalization report;
  report.largest_defect = largest_defect(m);
  const std::vector<double> before = m.values;
  for (std::size_t i = 0; i < m.rows(); ++i) {
    const double sum = m.row_sum(i);
    if (!(sum > 0)) continue;
    for (std::uint64_t k = m.offsets[i]; k < m.offsets[i + 1]; ++k) m.values[k] /= sum;
  }
  measure(m, before, report);
  return report;
}

double limit_row_sums(FactorMatrix& matrix) {
  std::vector<double> share(matrix.rows(), 1);
  double excess = 0;
  for (std::size_t i = 0; i < matrix.rows(); ++i) {
    const double sum = matrix.row_sum(i);
    if (sum <= 1) continue;
    excess = std::max(excess, sum - 1);
    share[i] = 1 / sum;
  }
  if (excess == 0) return 0;
  for (std::size_t i = 0; i < matrix.rows(); ++i) {
    for (std::uint64_t k = matrix.offsets[i]; k < matrix.offsets[i + 1]; ++k) {
      matrix.values[k] *= std::min(share[i], share[matrix.columns[k]]);
    }
  }
  return excess;
}

Normalization normalize_least_squares(FactorMatrix& m) {
  Normalization report;
  report.largest_defect = largest_defect(m);
  const std::vector<double> before = m.values;
  for (int round = 0; round < most_rounds; ++round) {
    const LeastSquares system(m);
    std::vector<double> missing(m.rows(), 0.0);
    for (std::size_t i = 0; i < m.rows(); ++i) {
      if (!m.row_values(i).empty()) missing[i] = m.areas[i] * (1 - m.row_sum(i));
    }
    const std::vector<double> l = system.solve(missing, report.iterations);
    bool cut_short = false;
    for (std::size_t i = 0; i < m.rows(); ++i) {
      for (std::uint64_t k = m.offsets[i]; k < m.offsets[i + 1]; ++k) {
        // w / A_i = x F; by the symmetric x, the two directions change alike to rounding.
        const double x = m.areas[i] * m.values[k];
        const double change = x * (l[i] + l[m.columns[k]]);
        cut_short = cut_short || change < -0.5;
        m.values[k] *= 1 + std::max(change, -0.5);
      }
    }
    if (!cut_short) break;
  }
  measure(m, before, report);
  return report;
}

}  // namespace penumbra
