// A mean as remembered value: colours, and anything else that adds and scales.
#pragma once

#include "twohistory/history.h"

namespace twohistory {

/// value = (kept old + fresh x) / (kept + fresh). A fresh value of weight 0 is never read, so it may be anything.
template <class V>
struct Mean {
  template <class Before>
  V gather(const Before& before, const Step& step) const {
    V sum{0};
    for (int k = 0; k < 4; ++k)
      if (step.taps.b[k] > 0) sum += step.taps.b[k] * before.at(step.taps.pixel[k]);
    return sum;
  }
  V merge(const V& old, const V& fresh, const Step& step) const {
    return step.fresh > 0 ? old + step.alpha() * (fresh - old) : old;
  }
};

}  // namespace twohistory
