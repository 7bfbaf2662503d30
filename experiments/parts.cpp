#include "experiments/parts.h"

#include <fmt/format.h>

#include "core/check.h"
#include "core/files.h"
#include "core/random.h"

namespace experiments {

namespace fs = std::filesystem;

void makeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw core::Error(folder.string(), error.message(), "name a folder that can be written");
}

/// Of this program's own file: an edited blend must not find what another build made.
std::string programHash() {
  static const std::string hash = fmt::format("{:x}", std::hash<std::string>{}(core::readFile("/proc/self/exe")));
  return hash;
}

Parts::Parts(fs::path folder, Json identity) : folder_(std::move(folder)) {
  identity["program"] = programHash();
  identity_ = identity.dump();
  makeFolder(folder_);
}

fs::path Parts::fileOf(const std::string& scene, const std::string& sceneHash, std::uint64_t seed) const {
  const std::uint64_t key = core::mixBits(std::hash<std::string>{}(identity_ + sceneHash));
  return folder_ / fmt::format("{}-{}-{:016x}.json", scene, seed, key);
}

std::optional<SequenceResult> Parts::read(const std::string& scene, const std::string& sceneHash,
                                          std::uint64_t seed) const {
  const fs::path file = fileOf(scene, sceneHash, seed);
  if (!fs::exists(file)) return {};
  Results part = loadResults(file);
  std::vector<BorderContrasts> borders;
  for (const Json& b : part.config.value("borders", Json::array()))
    borders.push_back({b.at("variant"), b.at("region"), b.at("seed"), b.at("contrasts")});
  return SequenceResult{std::move(part.rows), std::move(part.series), std::move(borders), std::move(part.passes),
                        part.config.value("badPixels", std::int64_t{0})};
}

void Parts::write(const SequenceResult& result, const std::string& scene, const std::string& sceneHash,
                  std::uint64_t seed) const {
  Results part;  // a part is a results file of one sequence
  part.rows = result.rows;
  part.series = result.series;
  part.passes = result.passes;
  part.config["badPixels"] = result.badPixels;
  part.config["borders"] = Json::array();
  for (const BorderContrasts& b : result.borders)
    part.config["borders"].push_back(
        {{"variant", b.variant}, {"region", b.region}, {"seed", b.seed}, {"contrasts", b.contrasts}});
  core::writeFileAtomically(fileOf(scene, sceneHash, seed), resultsJson(part).dump());
}

}  // namespace experiments
