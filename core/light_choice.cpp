// Drawing lights in one of three ways.
#include "core/light_choice.h"

namespace core {

LightChoice::LightChoice(const Lights& lights, LightSampler sampler) : lights_(&lights), sampler_(sampler) {
  if (sampler == LightSampler::uniform)
    for (std::uint32_t i = 0; i < lights.size(); ++i)
      if (lights.probability(i) > 0) lit_.push_back(i);
  if (sampler == LightSampler::tree) {
    tree_ = LightTree(lights);
    listInfinite();
  }
}

void LightChoice::listInfinite() {
  for (std::uint32_t i = lights_->triangleCount(); i < lights_->size(); ++i)
    if (lights_->isInfinite(i) && lights_->probability(i) > 0) {
      infiniteShare_ += double{lights_->probability(i)};
      infinite_.push_back({i, infiniteShare_});
    }
  if (tree_.empty() && !infinite_.empty()) infiniteShare_ = infinite_.back().until = 1;
}

LightDraw LightChoice::sample(const vec3& position, const vec3& normal, const LightBits& bits, Rng& rng) const {
  if (lights_->empty()) return {};
  if (sampler_ == LightSampler::uniform) return sampleUniform(bits, rng);
  if (sampler_ == LightSampler::tree) return sampleTree(position, normal, bits, rng);
  const LightSample y = lights_->sampleAt(bits.high, bits.low, bits.where, rng);
  return {y, lights_->pdf(y)};
}

LightDraw LightChoice::sampleUniform(const LightBits& bits, Rng& rng) const {
  const std::uint64_t count = lit_.size();
  const std::uint64_t index =
      (bits.high * count + ((bits.low * count) >> 32)) >> 32;  // all 64 bits times count, over 2^64
  const LightSample y = lights_->pointOn(lit_[index], bits.where, rng);
  return {y, lights_->pdfWithin(y) / static_cast<float>(count)};
}

LightDraw LightChoice::sampleTree(const vec3& position, const vec3& normal, const LightBits& bits, Rng& rng) const {
  const double u = static_cast<double>(((std::uint64_t{bits.high} << 32) | bits.low) >> 11) * 0x1p-53;
  if (u < infiniteShare_ || tree_.empty()) {
    std::size_t i = 0;
    while (i + 1 < infinite_.size() && u >= infinite_[i].until) ++i;
    const LightSample y = lights_->pointOn(infinite_[i].light, bits.where, rng);
    return {y, lights_->pdf(y)};
  }
  const double rest = 1 - infiniteShare_;
  const LightTree::Drawn drawn = tree_.sample(position, normal, std::min((u - infiniteShare_) / rest, 1 - 0x1p-53));
  return {lights_->pointOn(drawn.light, bits.where, rng), static_cast<float>(rest * drawn.probability)};
}

float LightChoice::pdf(const LightSample& y, const vec3& position, const vec3& normal) const {
  const float power = lights_->pdf(y);
  if (!(power > 0) || sampler_ == LightSampler::power) return power;
  if (sampler_ == LightSampler::uniform) return lights_->pdfWithin(y) / static_cast<float>(lit_.size());
  if (lights_->isInfinite(y.light)) return power;
  return static_cast<float>((1 - infiniteShare_) * tree_.pdf(position, normal, y.light));
}

}  // namespace core
