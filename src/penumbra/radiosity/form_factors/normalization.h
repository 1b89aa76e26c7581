#pragma once

#include "penumbra/radiosity/form_factors/factor_matrix.h"

namespace penumbra {

/// What a normalisation did to a matrix.
struct Normalization {
  double largest_change = 0;      ///< of one factor
  double largest_row_change = 0;  ///< sum over j of |change of F_ij|, the largest of all rows
  double largest_defect = 0;      ///< |row sum - 1| before, the largest of all rows that see anything
  int iterations = 0;             ///< of the linear solver, where there is one
};

/// Divides each row by its sum, so that an enclosure keeps its energy. Reciprocity is lost to the order of the change.
Normalization normalize_rows(FactorMatrix& matrix);

/// Lowers factors so that no row sums to more than 1 and none makes light out of nothing, as errors and faces that lie
/// on one another do; reciprocity is kept: an exchange is multiplied by the lesser of 1 / row sum of its two rows. Rows
/// and partners that sum to at most 1 stay as they are. Returns by how much the largest row sum was above 1.
double limit_row_sums(FactorMatrix& matrix);

/// Makes every row sum 1 and keeps reciprocity, with the least change: of all symmetric corrections d_ij of the
/// exchanges x_ij = A_i F_ij that give sum over j of (x_ij + d_ij) = A_i, the one with the smallest sum of d_ij^2 /
/// x_ij^2 (least-squares smoothing, van Leersum 1989; Loehrke, Dolaghan & Burns 1995, who weight so). The multipliers
/// solve a symmetric positive semi-definite system by conjugate gradients. No factor becomes negative: a correction
/// that would takes half of it instead and the rest is solved for again.
Normalization normalize_least_squares(FactorMatrix& matrix);

}  // namespace penumbra
