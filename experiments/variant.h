// A variant: which histories a filter keeps and how it blends them. An experiment compares variants on the same frames.
#pragma once

#include <string>
#include <vector>

#include "restir/told.h"
#include "svgf/svgf.h"
#include "twohistory/blend.h"
#include "twohistory/policy.h"

namespace experiments {

struct Variant {
  std::string name;
  std::vector<twohistory::Policy> histories{twohistory::Policy{}};  ///< 1 to 3
  twohistory::BlendParameters blend;
  svgf::FilterParameters filter;
  restir::Told told = restir::Told::samples;  ///< what it takes as sample count
};

template <class V>
void describe(V& v, Variant& p) {
  v("name", p.name, "as in tables");
  v("histories", p.histories, "one to three policies");
  v("blend", p.blend, "how the histories become one image");
  v("filter", p.filter, "the filter around them");
  v.choice("told", p.told,
           {{"samples", restir::Told::samples},
            {"confidence", restir::Told::confidence},
            {"effective", restir::Told::effective}},
           "what it takes as sample count");
}

/// Adds a variant to the library while the program starts: one static object in a file of experiments/extensions. See
/// docs/extending.md.
struct Extension {
  explicit Extension(Variant variant);
};

/// The variants of the field and of this project by name: none, unweighted, unweighted-96, unweighted-98, weighted,
/// published, optimal, optimal-uwf, seed, seed-slide, consistent, lag-uw, lag-wf, lag-safe, lag-uwf, lag-checked,
/// lag-bold, lag-debiased, lag-even, oracle; then those of extensions.
std::vector<std::string> variantNames();
/// Throws core::UsageError, naming the known ones, for any other name.
Variant variantByName(const std::string& name);
/// Throws core::UsageError where a variant contradicts itself (no history, a decay above 1, a pair that does not
/// exist).
void requireConsistent(const Variant& variant);

}  // namespace experiments
