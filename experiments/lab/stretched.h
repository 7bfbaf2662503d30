// Cases that nobody designed for: every number of a given case times one factor.
#pragma once

#include "experiments/lab/synthetic.h"

namespace experiments::lab {

/// The case with its numbers times `factor` > 0, named NAME-xFACTOR: radiances, rates, periods, sizes, speeds and the
/// frame of a step; noise; motion; sample counts, the fovea's radius and the gaze's frequencies. Counts stay whole, and
/// at least 1 where they were. Of a probability to hold noise the mean number of frames held, 1 / (1 - p), is what
/// grows. Frame sizes, and where the gaze's path lies, stay.
Case stretched(const Case& original, double factor);

/// All cases by all factors, factor by factor; the cases themselves where there is no factor.
std::vector<Case> stretched(const std::vector<Case>& cases, const std::vector<double>& factors);

}  // namespace experiments::lab
