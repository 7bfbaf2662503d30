#include "core/gltf_track.h"

#include "core/check.h"
#include "core/gltf_support.h"

namespace core {
namespace {

void checkTimes(const std::vector<float>& times, const std::string& where) {
  bool valid = !times.empty() && isFinite(times.front()) && isFinite(times.back()) && times.front() >= 0;
  for (std::size_t i = 1; i < times.size(); ++i) valid = valid && times[i - 1] < times[i];
  if (!valid) throw Error(where, "its key times do not ascend from 0", kRepair);
}

void checkKeys(const Track& track, const std::string& where) {
  checkTimes(track.times, where);
  const std::size_t perKey = track.interpolation == Interpolation::cubic ? 3 : 1;
  if (track.values.size() != perKey * track.times.size())
    throw Error(
        where,
        "it has " + std::to_string(track.values.size()) + " values for " + std::to_string(track.times.size()) + " keys",
        kRepair);
}

}  // namespace

Interpolation interpolationOf(const std::string& name, const std::string& where) {
  if (name == "LINEAR") return Interpolation::linear;
  if (name == "STEP") return Interpolation::step;
  if (name == "CUBICSPLINE") return Interpolation::cubic;
  throw Error(where, "interpolation " + name + " does not exist", "use LINEAR, STEP or CUBICSPLINE");
}

int addOnce(std::vector<Track>& tracks, const Track& track) {
  const auto same = [&](const Track& t) {
    return t.times == track.times && t.values == track.values && t.interpolation == track.interpolation;
  };
  const auto found = std::find_if(tracks.begin(), tracks.end(), same);
  const int index = static_cast<int>(found - tracks.begin());
  if (found == tracks.end()) tracks.push_back(track);
  return index;
}

vec4 unitRotation(const vec4& xyzw, const std::string& where) {
  const float square = dot(xyzw, xyzw);
  if (!(square > 1e-12f) || !isFinite(square)) throw Error(where, "holds a rotation of length 0", kRepair);
  return std::abs(square - 1) < 1e-5f ? xyzw : xyzw / std::sqrt(square);
}

Track trackOf(const AccessorView& times, const AccessorView& values, Interpolation interpolation, int components) {
  Track track;
  track.interpolation = interpolation;
  track.times = readFloats(times, 1);
  const std::vector<float> numbers = readFloats(values, components);
  track.values.assign(numbers.size() / components, vec4(0));
  for (std::size_t i = 0; i < numbers.size(); ++i) track.values[i / components][i % components] = numbers[i];
  checkKeys(track, values.where);
  if (components == 4 && interpolation != Interpolation::cubic)
    for (vec4& rotation : track.values) rotation = unitRotation(rotation, values.where);
  return track;
}

Track flickerOf(const std::vector<double>& times, const std::vector<double>& factors, Interpolation interpolation,
                const std::string& where) {
  Track track;
  track.interpolation = interpolation;
  for (double time : times) track.times.push_back(static_cast<float>(time));
  for (double factor : factors) {
    if (!(factor >= 0) || !isFinite(static_cast<float>(factor))) throw Error(where, "has a negative factor", kRepair);
    track.values.emplace_back(static_cast<float>(factor), 0, 0, 0);
  }
  if (interpolation == Interpolation::cubic) throw Error(where, "is a spline", "use LINEAR or STEP");
  checkKeys(track, where);
  return track;
}

}  // namespace core
