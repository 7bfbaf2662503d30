// Logic checks that print both operands, and the exception for wrong input from outside.
//
// Policy: a broken invariant of the program is a CHECK (always on) or DCHECK (debug builds, hot loops); wrong input
// (file, configuration, frame data) throws core::Error, which main catches once and prints as one line.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string>

namespace core {

/// Wrong input from outside. The message is one line: what is wrong, where, and what to do.
struct Error : std::runtime_error {
  Error(const std::string& where, const std::string& what, const std::string& remedy)
      : std::runtime_error(where + ": " + what + "; " + remedy) {}
};

/// Wrong usage of a command or a configuration: exit code 2 instead of 1.
struct UsageError : Error {
  using Error::Error;
};

template <class A, class B>
[[noreturn]] void checkFailed(const char* file, int line, const char* expression, const A& a, const B& b) {
  std::ostringstream text;
  text << file << ":" << line << ": CHECK failed: " << expression << " (" << a << " vs " << b << ")";
  std::fprintf(stderr, "%s\n", text.str().c_str());
  std::abort();
}

}  // namespace core

#define CHECK_OP(op, a, b)                                                                             \
  do {                                                                                                 \
    const auto& checkA = (a);                                                                          \
    const auto& checkB = (b);                                                                          \
    if (!(checkA op checkB)) core::checkFailed(__FILE__, __LINE__, #a " " #op " " #b, checkA, checkB); \
  } while (false)
#define CHECK_EQ(a, b) CHECK_OP(==, a, b)
#define CHECK_LT(a, b) CHECK_OP(<, a, b)
#define CHECK_LE(a, b) CHECK_OP(<=, a, b)
#define CHECK_GE(a, b) CHECK_OP(>=, a, b)
#define CHECK_GT(a, b) CHECK_OP(>, a, b)
#define CHECK(condition) CHECK_OP(==, static_cast<bool>(condition), true)
#ifdef NDEBUG
#define DCHECK(condition) static_cast<void>(0)
#else
#define DCHECK(condition) CHECK(condition)
#endif
