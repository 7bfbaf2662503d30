// How differences of histories are stored, and the switches of storage layouts that docs/results.md compares.
//
// Both are compile-time: -D CMAKE_CXX_FLAGS="-DTWOFOLD_FLOAT_DIFFERENCES -DTWOFOLD_FLOAT_LEDGERS" builds what costs
// most and rounds least.
#pragma once

#include "core/bfloat16.h"

namespace core {

#ifdef TWOFOLD_FLOAT_DIFFERENCES
using Stored = float;
#else
using Stored = Bfloat16;  ///< half of the bytes; anything that a float holds fits
#endif

}  // namespace core
