#include "core/gltf_support.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

namespace core {
namespace {

constexpr std::array kSupported{"KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_mesh_quantization",
                                "KHR_texture_transform"};
constexpr std::array kCompressions{"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"};

template <class List>
bool holds(const List& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

/// What an extension's absence does to the picture.
std::string consequence(const std::string& extension) {
  static const std::map<std::string, std::string> known{
      {"KHR_animation_pointer", "its animations stay at rest"},
      {"KHR_materials_transmission", "its surfaces are opaque"},
      {"KHR_materials_volume", "its surfaces are opaque"},
      {"KHR_materials_ior", "the index of refraction is 1.5"},
      {"KHR_materials_unlit", "its materials are lit as others are"},
      {"KHR_materials_pbrSpecularGlossiness", "its materials are read as metallic-roughness"},
      {"KHR_materials_variants", "the default variant is shown"},
      {"EXT_mesh_gpu_instancing", "one instance is shown"},
      {"EXT_lights_image_based", "its light is left out"},
      {"KHR_draco_mesh_compression", "the uncompressed vertices are read"},
      {"EXT_meshopt_compression", "the uncompressed vertices are read"},
      {"KHR_meshopt_compression", "the uncompressed vertices are read"}};
  const auto found = known.find(extension);
  return found == known.end() ? "it is left out" : found->second;
}

}  // namespace

Error unreadable(const std::string& where, std::string complaint) {
  while (!complaint.empty() && std::isspace(static_cast<unsigned char>(complaint.back()))) complaint.pop_back();
  std::replace(complaint.begin(), complaint.end(), '\n', ' ');
  if (complaint.empty()) complaint = "an item lacks what it must have";
  return {where, "cannot be read as glTF (" + complaint.substr(0, 300) + ")", "repair the file or export it again"};
}

float inRange(double value, double low, double high, const std::string& where) {
  if (!(value >= low && value <= high))
    throw Error(where, "has a number out of range (" + std::to_string(value) + ")",
                "repair the file or export it again");
  return static_cast<float>(value);
}

void warnOnce(std::vector<std::string>& warnings, const std::string& warning) {
  if (!holds(warnings, warning)) warnings.push_back(warning);
}

void checkCompression(std::string_view json, const std::string& where) {
  const std::size_t start = json.find("\"extensionsRequired\"");
  if (start == std::string_view::npos) return;
  const std::string_view list = json.substr(start, json.find(']', start) - start);
  for (const char* name : kCompressions)
    if (list.find(name) != std::string_view::npos)
      throw Error(where, std::string("requires ") + name + ", which is not supported", "export it without compression");
}

void checkExtensions(const std::vector<std::string>& used, const std::vector<std::string>& required,
                     std::vector<std::string>& warnings) {
  std::vector<std::string> names = used;
  names.insert(names.end(), required.begin(), required.end());
  for (const std::string& name : names)
    if (!holds(kSupported, name)) warnOnce(warnings, name + " is not supported: " + consequence(name));
}

}  // namespace core
