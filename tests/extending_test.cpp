// The worked example of docs/extending.md is compiled, is what the page shows, and does what the page says.
#include <gtest/gtest.h>

#include "core/files.h"
#include "experiments/config.h"
#include "experiments/extensions/example.cpp"
#include "tests/synthetic.h"

namespace {

/// The blocks between [name] and [end] of the example.
std::vector<std::string> blocksOfExample() {
  const std::string text = core::readFile(TWOFOLD_SOURCE_DIR "/experiments/extensions/example.cpp");
  std::vector<std::string> blocks;
  const std::string close = "// [end]\n";
  for (const char* name : {"weighting", "blend", "variant", "value"}) {
    const std::string open = "// [" + std::string(name) + "]\n";
    const std::size_t begin = text.find(open) + open.size();
    blocks.push_back(text.substr(begin, text.find(close, begin) - begin));
  }
  return blocks;
}

TEST(Extending, ThePageShowsTheLinesThatAreCompiled) {
  const std::string page = core::readFile(TWOFOLD_SOURCE_DIR "/docs/extending.md");
  std::size_t at = 0;
  for (const std::string& block : blocksOfExample()) {
    at = page.find("```cpp\n" + block + "```\n", at);
    ASSERT_NE(at, std::string::npos) << "not on the page, or out of order:\n" << block;
  }
}

TEST(Extending, ConfigurationsKnowTheVariantByNameAndAsAStart) {
  experiments::Config config;
  config.variants = {"example", experiments::Json::parse(R"({"like": "example", "name": "checked",
                      "blend": {"validation": {"on": true}}})")};
  const auto variants = experiments::variantsOf(config);
  EXPECT_EQ(variants[0].blend.custom, byPrecision);
  EXPECT_EQ(variants[1].histories[0].weight, rootOfSamples);
  config.variants = {experiments::Json::parse(R"({"name": "bare", "blend": {"mode": "custom"}})")};
  EXPECT_THROW(experiments::variantsOf(config), core::UsageError);
}

TEST(Extending, TheWeightingIsKeptLikeAnyOther) {
  const experiments::Variant v = exampleVariant();
  const twohistory::Policies<2> policies{v.histories[0], v.histories[1]};
  twohistory::Ledger<2> l;
  double weight = 0, square = 0;
  for (const int n : {1, 8, 0, 4, 2}) {
    l = advance(l, policies, static_cast<float>(n));
    weight = 0.95 * weight + std::sqrt(n), square = 0.9025 * square + (n > 0 ? 1 : 0);  // sqrt(n)^2 / n = 1
  }
  EXPECT_NEAR(l.weight[0], weight, 1e-5);
  EXPECT_NEAR(l.covariance(0, 0), square / (weight * weight), 1e-6);
}

TEST(Extending, TheBlendFiltersAndIsQuieterThanItsNoise) {
  const auto one = [](int, int, int) { return core::vec3(1); };
  const auto counts = [](int x, int, int) { return x < 16 ? 8 : 1; };
  tests::Synthetic input(32, 24, 5, one, counts);
  const core::Planes image = tests::filterSequence(input, exampleVariant(), 24);
  EXPECT_LT(tests::squaredError(image, input, 24), 0.05);  // one sample has 1
}

TEST(Extending, TheValueIsCarriedByTheSameAccumulate) {
  core::Image<twohistory::Taps> taps(1, 1);
  core::Image<float> n(1, 1, 1.0f), x(1, 1), before(1, 1), now(1, 1);
  core::Image<twohistory::Ledger<1>> ledger(1, 1), next(1, 1);
  for (const float value : {1.0f, 5.0f, 2.0f}) {
    x(0, 0) = value;
    twohistory::accumulate<1>(taps.view(), n.view(), {twohistory::Policy{}}, ledger.view(), next.view(),
                              example::Brightest{}, std::array<core::In<float>, 1>{before}, x.view(),
                              std::array<core::ImageView<float>, 1>{now});
    std::swap(ledger, next), std::swap(before, now);
    taps(0, 0) = twohistory::stillTap(0);
  }
  EXPECT_LT(before(0, 0), 5);  // faded
  EXPECT_GT(before(0, 0), 2);  // not forgotten
}

}  // namespace
