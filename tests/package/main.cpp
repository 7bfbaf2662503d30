// Runs a schedule of sample counts through the installed ledger and compares it with sums over the whole sequence;
// exits with the number of differences. Formulas: twohistory/ledger.h, [ledger 1] to [ledger 4].
#include <core/check.h>
#include <core/exr.h>
#include <twohistory/ledger.h>

#include <cmath>
#include <cstdio>
#include <vector>

namespace {

constexpr double kDecay = 0.95;
const std::vector<double> kCounts{1, 1, 8, 8, 0, 1, 0, 0, 64, 1, 2};

int failures = 0;

void expectNear(const char* what, double found, double expected) {
  if (std::abs(found - expected) <= 1e-12 * std::abs(expected)) return;
  std::printf("%s: %.17g, expected %.17g\n", what, found, expected);
  ++failures;
}

/// sum over frames i of rate^(last - i) n_i^power, frames without samples left out.
double brute(double rate, double power) {
  double sum = 0;
  for (std::size_t i = 0; i < kCounts.size(); ++i)
    if (kCounts[i] > 0)
      sum += std::pow(rate, static_cast<double>(kCounts.size() - 1 - i)) * std::pow(kCounts[i], power);
  return sum;
}

void checkSchedule() {
  using twohistory::Forgetting, twohistory::Weighting;
  const twohistory::Policies<2> policies{
      {{Weighting::frames, Forgetting::decay, kDecay}, {Weighting::samples, Forgetting::decay, kDecay}}};
  twohistory::Ledger<2, double> ledger;
  for (const double n : kCounts) ledger = advance(ledger, policies, n);

  expectNear("weight, frames", ledger.weight[0], brute(kDecay, 0));
  expectNear("weight, samples", ledger.weight[1], brute(kDecay, 1));
  const double squared = kDecay * kDecay;
  expectNear("variance, frames", ledger.covariance(0, 0), brute(squared, -1) / std::pow(brute(kDecay, 0), 2));
  expectNear("covariance", ledger.covariance(0, 1), brute(squared, 0) / (brute(kDecay, 0) * brute(kDecay, 1)));
  expectNear("variance, samples", ledger.covariance(1, 1), brute(squared, 1) / std::pow(brute(kDecay, 1), 2));
}

/// core's own libraries were linked too.
void checkCoreLinks() {
  try {
    core::readExr("absent.exr");
    std::printf("an absent file was read\n");
    ++failures;
  } catch (const core::Error&) {
  }
}

}  // namespace

int main() {
  checkSchedule();
  checkCoreLinks();
  std::printf("%d differences\n", failures);
  return failures;
}
