// How differences of histories are stored, and the switches of storage layouts that docs/results.md compares.
//
// All are compile-time: -D CMAKE_CXX_FLAGS="-DTWOFOLD_FLOAT_DIFFERENCES -DTWOFOLD_FLOAT_LEDGERS" builds what costs
// most and rounds least; TWOFOLD_HALF_DIFFERENCES and TWOFOLD_SHARED_EXPONENT are the other two.
#pragma once

#include "core/bfloat16.h"
#include "core/half.h"
#include "core/shared_exponent.h"

namespace core {

#if defined(TWOFOLD_FLOAT_DIFFERENCES)
using Stored = float;
#elif defined(TWOFOLD_HALF_DIFFERENCES)
using Stored = Half;  ///< as many bytes as the default and three more bits, but no more than 65504
#elif defined(TWOFOLD_SHARED_EXPONENT)
using Stored = SharedExponent;  ///< a third fewer bytes, and one less bit
#else
using Stored = Bfloat16;  ///< half of the bytes; anything that a float holds fits
#endif

}  // namespace core
