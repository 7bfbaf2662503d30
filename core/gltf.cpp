#include "core/gltf.h"

#include <tiny_gltf.h>

#include <cmath>
#include <optional>

#include "core/files.h"
#include "core/gltf_assemble.h"
#include "core/gltf_container.h"
#include "core/gltf_disk.h"
#include "core/gltf_image.h"
#include "core/gltf_support.h"
#include "core/gltf_track.h"

namespace core {
namespace {

namespace fs = std::filesystem;
using tinygltf::Model;
using tinygltf::Value;

const char* const kLightExtension = "KHR_lights_punctual";

/// Keeps an image's encoded bytes. Those in a buffer view may lie outside the buffer: they are not touched here.
bool keepImage(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes, int size,
               void*) {
  if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
  return true;
}

Model parse(const fs::path& path) {
  const std::string bytes = readFile(path), where = path.string();
  checkCompression(checkContainer(bytes, where), where);
  GltfFolder folder{where, path.has_parent_path() ? path.parent_path().string() : "."};
  tinygltf::TinyGLTF parser;
  parser.SetFsCallbacks({gltfFileExists, gltfFilePath, readGltfFile, nullptr, &folder});
  parser.SetImageLoader(keepImage, nullptr);
  Model model;
  std::string errors, ignored;
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const auto size = static_cast<unsigned>(bytes.size());
  const bool read = isGlb(bytes)
                        ? parser.LoadBinaryFromMemory(&model, &errors, &ignored, data, size, folder.path)
                        : parser.LoadASCIIFromString(&model, &errors, &ignored, bytes.data(), size, folder.path);
  if (!read) throw unreadable(where, errors);
  if (model.asset.version.substr(0, 2) != "2." || (!model.asset.minVersion.empty() && model.asset.minVersion != "2.0"))
    throw Error(where, "is glTF '" + model.asset.version + "'", "convert it to version 2.0");
  return model;
}

// ---- numbers of extensions and extras

double member(const Value& object, const char* key, double fallback) {
  return object.Has(key) && object.Get(key).IsNumber() ? object.Get(key).GetNumberAsDouble() : fallback;
}

std::vector<double> members(const Value& object, const char* key, std::vector<double> fallback = {}) {
  if (!object.Has(key) || !object.Get(key).IsArray()) return fallback;
  std::vector<double> numbers;
  for (const Value& value : object.Get(key).Get<Value::Array>())
    numbers.push_back(value.IsNumber() ? value.GetNumberAsDouble() : NAN);
  return numbers;
}

/// An extension's object, null if the item does not have it.
const Value& extension(const tinygltf::ExtensionMap& extensions, const char* name) {
  static const Value none;
  const auto found = extensions.find(name);
  return found == extensions.end() ? none : found->second;
}

/// Reads the model item by item; buffers are only pointed at.
class Reader {
 public:
  Reader(const Model& model, const std::string& where) : model_(model) { file_.where = where; }

  GltfFile read() {
    checkExtensions(model_.extensionsUsed, model_.extensionsRequired, file_.scene.warnings);
    if (!model_.skins.empty()) warn("skins are not supported: meshes keep the pose of their file");
    for (const tinygltf::Texture& texture : model_.textures) readTexture(texture);
    forEach(model_.materials, "material", [&](const auto& item, const auto& where) { readMaterial(item, where); });
    forEach(model_.meshes, "mesh", [&](const auto& item, const auto& where) { readMesh(item, where); });
    forEach(model_.nodes, "node", [&](const auto& item, const auto& where) { readNode(item, where); });
    forEach(model_.cameras, "camera", [&](const auto& item, const auto& where) { readCamera(item, where); });
    forEach(model_.lights, "light", [&](const auto& item, const auto& where) { readLight(item, where); });
    forEach(model_.animations, "animation", [&](const auto& item, const auto& where) { readAnimation(item, where); });
    readRoots();
    return std::move(file_);
  }

 private:
  // ---- checked access

  std::string in(const char* what, std::size_t i) const { return file_.where + ", " + what + " " + std::to_string(i); }
  void warn(const std::string& text) { warnOnce(file_.scene.warnings, text); }

  template <class T, class Body>
  void forEach(const std::vector<T>& items, const char* what, Body&& body) {
    for (std::size_t i = 0; i < items.size(); ++i) body(items[i], in(what, i));
  }

  template <class T>
  const T& at(const std::vector<T>& list, int index, const char* what) const {
    if (index < 0 || static_cast<std::size_t>(index) >= list.size())
      throw Error(file_.where, std::string(what) + " " + std::to_string(index) + " does not exist", kRepair);
    return list[index];
  }

  AccessorView viewOf(int bufferView, const std::string& where) const {
    const tinygltf::BufferView& part = at(model_.bufferViews, bufferView, "buffer view");
    AccessorView view;
    view.bytes = checkedPart(at(model_.buffers, part.buffer, "buffer").data, part.byteOffset, part.byteLength, where);
    view.stride = part.byteStride;
    view.where = where;
    return view;
  }

  AccessorView accessor(int index) const {
    const tinygltf::Accessor& source = at(model_.accessors, index, "accessor");
    AccessorView view;
    view.where = in("accessor", index);
    if (source.bufferView >= 0) view = viewOf(source.bufferView, view.where);
    view.zeros = source.bufferView < 0;
    view.offset = source.byteOffset;
    view.count = source.count;
    view.components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(source.type));
    view.componentType = source.componentType;
    view.normalized = source.normalized;
    if (source.sparse.isSparse) view.sparse = sparseViews(source, view);
    return view;
  }

  std::vector<AccessorView> sparseViews(const tinygltf::Accessor& source, const AccessorView& base) const {
    const auto& sparse = source.sparse;
    if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
      throw Error(base.where, "has a negative sparse count or offset", kRepair);
    AccessorView indices = viewOf(sparse.indices.bufferView, base.where);
    indices.offset = static_cast<std::uint64_t>(sparse.indices.byteOffset);
    indices.componentType = sparse.indices.componentType;
    const AccessorView part = viewOf(sparse.values.bufferView, base.where);
    AccessorView values = base;
    values.zeros = false;
    values.bytes = part.bytes;
    values.stride = part.stride;
    values.offset = static_cast<std::uint64_t>(sparse.values.byteOffset);
    indices.count = values.count = static_cast<std::uint64_t>(sparse.count);
    return {indices, values};
  }

  // ---- textures and materials

  void readTexture(const tinygltf::Texture& source) {
    textures_.push_back(source.source < 0 ? -1 : static_cast<int>(file_.scene.textures.size()));
    if (source.source < 0) return warn("textures without a PNG or JPEG image are left out");
    const tinygltf::Image& image = at(model_.images, source.source, "image");
    const std::string where = in("image", source.source);
    Texture texture = decode(image.bufferView < 0 ? image.image : viewOf(image.bufferView, where).bytes, where);
    if (source.sampler >= 0) {
      const tinygltf::Sampler& sampler = at(model_.samplers, source.sampler, "sampler");
      texture.wrapU = wrapOf(sampler.wrapS);
      texture.wrapV = wrapOf(sampler.wrapT);
    }
    file_.scene.textures.push_back(std::move(texture));
  }

  static Texture decode(std::span<const unsigned char> bytes, const std::string& where) {
    checkImage(bytes, where);
    tinygltf::Image image;
    std::string ignored;
    if (!tinygltf::LoadImageData(&image, 0, &ignored, &ignored, 0, 0, bytes.data(), static_cast<int>(bytes.size()),
                                 nullptr))
      throw Error(where, "cannot be decoded", "replace it by a whole PNG or JPEG file");
    Texture texture{image.width, image.height, std::move(image.image)};
    if (image.bits == 16) texture.texels = highBytes(texture.texels);
    return texture;
  }

  /// The scene's texture, -1 for none. transform: of the material's first texture; the others must agree.
  template <class Info>
  int textureOf(const Info& info, std::optional<UvTransform>& transform, const std::string& where) {
    if (info.index < 0) return -1;
    if (info.texCoord != 0) warn("TEXCOORD_1 and above are not supported: textures use TEXCOORD_0");
    const Value& extra = extension(info.extensions, "KHR_texture_transform");
    const UvTransform own{toVec<2>(members(extra, "offset", {0, 0}), -1e6, 1e6, where),
                          toVec<2>(members(extra, "scale", {1, 1}), -1e6, 1e6, where),
                          inRange(member(extra, "rotation", 0), -1e6, 1e6, where)};
    if (transform.value_or(own) != own)
      warn("texture transforms that differ within a material are not supported: its first one is used");
    if (!transform) transform = own;
    return at(textures_, info.index, "texture");
  }

  void readMaterial(const tinygltf::Material& source, const std::string& where) {
    const auto& pbr = source.pbrMetallicRoughness;
    const Value& strength = extension(source.extensions, "KHR_materials_emissive_strength");
    std::optional<UvTransform> transform;
    Material m;
    m.name = source.name;
    m.baseColor = toVec<3>(pbr.baseColorFactor, 0, 1, where);
    m.metallic = inRange(pbr.metallicFactor, 0, 1, where);
    m.roughness = inRange(pbr.roughnessFactor, 0, 1, where);
    std::vector<double> emission = source.emissiveFactor;
    for (double& e : emission) e *= member(strength, "emissiveStrength", 1);
    if (!emission.empty()) m.emission = toVec<3>(emission, 0, 1e30, where);
    m.doubleSided = source.doubleSided;
    m.baseColorTexture = textureOf(pbr.baseColorTexture, transform, where);
    m.metallicRoughnessTexture = textureOf(pbr.metallicRoughnessTexture, transform, where);
    m.emissionTexture = textureOf(source.emissiveTexture, transform, where);
    m.normalTexture = textureOf(source.normalTexture, transform, where);
    m.normalScale = inRange(source.normalTexture.scale, -1e6, 1e6, where);
    m.flicker = flickerIn(source.extras, where);
    if (source.alphaMode != "OPAQUE") warn("transparency (alphaMode) is not supported: its surfaces are opaque");
    uvTransforms_.push_back(transform.value_or(UvTransform{}));
    file_.scene.materials.push_back(m);
  }

  /// extras.twofold.emission as a track of the scene; materials that flicker alike share one.
  int flickerIn(const Value& extras, const std::string& where) {
    if (!extras.Has("twofold") || !extras.Get("twofold").Has("emission")) return -1;
    const Value& emission = extras.Get("twofold").Get("emission");
    const Value& name = emission.Get("interpolation");
    const Interpolation interpolation = interpolationOf(name.IsString() ? name.Get<std::string>() : "LINEAR", where);
    const Track track = flickerOf(members(emission, "times"), members(emission, "factors"), interpolation, where);
    return addOnce(file_.scene.flickers, track);
  }

  // ---- meshes, nodes and what hangs on them

  std::optional<AccessorView> attribute(const tinygltf::Primitive& primitive, const char* name) const {
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? std::nullopt : std::optional(accessor(found->second));
  }

  void readMesh(const tinygltf::Mesh& source, const std::string& where) {
    GltfMesh mesh{source.name, {}};
    for (const tinygltf::Primitive& primitive : source.primitives) {
      if (primitive.attributes.count("COLOR_0")) warn("vertex colours are not supported: they are left out");
      if (!primitive.targets.empty()) warn("morph targets are not supported: meshes keep their base shape");
      if (primitive.attributes.count("POSITION")) mesh.primitives.push_back(readPrimitive(primitive, where));
    }
    file_.meshes.push_back(std::move(mesh));
  }

  GltfPrimitive readPrimitive(const tinygltf::Primitive& source, const std::string& where) const {
    if (source.mode < 0 || source.mode > 6) throw Error(where, "has a mode that does not exist", kRepair);
    GltfPrimitive primitive{{where,
                             static_cast<PrimitiveMode>(source.mode),
                             *attribute(source, "POSITION"),
                             attribute(source, "NORMAL"),
                             attribute(source, "TEXCOORD_0"),
                             std::nullopt,
                             {}},
                            source.material,
                            {source.mode, source.indices, source.material}};
    if (source.indices >= 0) primitive.source.indices = accessor(source.indices);
    if (source.material >= 0) primitive.source.uvTransform = at(uvTransforms_, source.material, "material");
    for (const char* name : {"POSITION", "NORMAL", "TEXCOORD_0"}) {
      const auto found = source.attributes.find(name);
      primitive.identity.push_back(found == source.attributes.end() ? -1 : found->second);
    }
    return primitive;
  }

  void readNode(const tinygltf::Node& source, const std::string& where) {
    GltfNode n;
    n.node.name = source.name;
    n.node.hasMatrix = !source.matrix.empty();
    if (n.node.hasMatrix) {
      if (source.matrix.size() != 16) throw Error(where, "has a matrix of other than 16 numbers", kRepair);
      for (int i = 0; i < 16; ++i) n.node.matrix[i / 4][i % 4] = inRange(source.matrix[i], -1e30, 1e30, where);
    }
    if (!source.translation.empty()) n.node.translation = toVec<3>(source.translation, -1e30, 1e30, where);
    if (!source.scale.empty()) n.node.scale = toVec<3>(source.scale, -1e30, 1e30, where);
    if (!source.rotation.empty()) {
      const vec4 r = unitRotation(toVec<4>(source.rotation, -1e6, 1e6, where), where);
      n.node.rotation = quat(r.w, r.x, r.y, r.z);
    }
    n.children = source.children;
    n.mesh = source.mesh;
    n.camera = source.camera;
    n.light = static_cast<int>(member(extension(source.extensions, kLightExtension), "light", -1));
    file_.nodes.push_back(std::move(n));
  }

  void readRoots() {
    if (!model_.scenes.empty() || model_.defaultScene >= 0) {
      file_.roots = at(model_.scenes, std::max(model_.defaultScene, 0), "scene").nodes;
      return;
    }
    std::vector<bool> isChild(model_.nodes.size(), false);
    for (const tinygltf::Node& node : model_.nodes)
      for (int child : node.children) at(model_.nodes, child, "node"), isChild[child] = true;
    for (std::size_t i = 0; i < isChild.size(); ++i)
      if (!isChild[i]) file_.roots.push_back(static_cast<int>(i));
  }

  void readCamera(const tinygltf::Camera& source, const std::string& where) {
    const bool perspective = source.type == "perspective";
    const float yfov = perspective ? inRange(source.perspective.yfov, 1e-4, 3.14, where) : 0;
    file_.cameras.push_back({source.name, yfov, 0});
  }

  void readLight(const tinygltf::Light& source, const std::string& where) {
    PunctualLight light;
    std::vector<double> color = source.color.empty() ? std::vector<double>{1, 1, 1} : source.color;
    for (double& c : color) c *= source.intensity;
    light.intensity = toVec<3>(color, 0, 1e30, where);
    if (source.type == "spot") {
      light.type = PunctualLight::Type::spot;
      light.innerAngle = inRange(source.spot.innerConeAngle, 0, kPi / 2, where);
      light.outerAngle = inRange(source.spot.outerConeAngle, light.innerAngle, kPi / 2, where);
    } else if (source.type == "directional") {
      light.type = PunctualLight::Type::directional;
    } else if (source.type != "point") {
      throw Error(where, "has type " + source.type, "use point, spot or directional");
    }
    file_.lights.push_back(light);
  }

  void readAnimation(const tinygltf::Animation& source, const std::string& where) {
    for (const tinygltf::AnimationChannel& channel : source.channels) {
      if (channel.target_node < 0) continue;
      const tinygltf::AnimationSampler& sampler = at(source.samplers, channel.sampler, "animation sampler");
      file_.channels.push_back({channel.target_node, channel.target_path, accessor(sampler.input),
                                accessor(sampler.output), interpolationOf(sampler.interpolation, where)});
    }
  }

  const Model& model_;
  GltfFile file_;
  std::vector<int> textures_;              ///< for each of the file's textures the scene's, -1 = not readable
  std::vector<UvTransform> uvTransforms_;  ///< for each material
};

}  // namespace

Scene loadGltf(const fs::path& path) {
  try {
    const Model model = parse(path);
    Scene scene = assemble(Reader(model, path.string()).read());
    scene.name = path.stem().string();
    return scene;
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw unreadable(path.string(), e.what());
  }
}

}  // namespace core
