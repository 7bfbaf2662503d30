#include "core/gltf_assemble.h"

#include <map>

#include "core/check.h"
#include "core/gltf_hierarchy.h"
#include "core/gltf_support.h"
#include "core/gltf_track.h"

namespace core {
namespace {

template <class T>
const T& at(const std::vector<T>& list, int index, const char* what, const GltfFile& file) {
  if (index < 0 || static_cast<std::size_t>(index) >= list.size())
    throw Error(file.where, std::string(what) + " " + std::to_string(index) + " does not exist", kRepair);
  return list[index];
}

/// glTF's default material is made when the first primitive asks for it.
int materialOf(GltfFile& file, int& defaultMaterial, int index) {
  if (index >= 0) return at(file.scene.materials, index, "material", file), index;
  if (defaultMaterial < 0) {
    defaultMaterial = static_cast<int>(file.scene.materials.size());
    file.scene.materials.emplace_back();
  }
  return defaultMaterial;
}

bool drawsTriangles(PrimitiveMode mode) { return mode >= PrimitiveMode::triangles; }

/// The scene's meshes, one a primitive; returns for each of the file's meshes those it became.
std::vector<std::vector<int>> readMeshes(GltfFile& file) {
  std::vector<std::vector<int>> became(file.meshes.size());
  std::map<std::vector<int>, int> known;
  int defaultMaterial = -1;
  for (std::size_t m = 0; m < file.meshes.size(); ++m)
    for (const GltfPrimitive& primitive : file.meshes[m].primitives) {
      if (!drawsTriangles(primitive.source.mode)) {
        warnOnce(file.scene.warnings, "points and lines are not supported: they are left out");
        continue;
      }
      const auto [place, isNew] = known.emplace(primitive.identity, static_cast<int>(file.scene.meshes.size()));
      became[m].push_back(place->second);
      if (!isNew) continue;
      file.scene.meshes.push_back(meshOf(primitive.source));
      file.scene.meshes.back().name = file.meshes[m].name;
      file.scene.meshes.back().material = materialOf(file, defaultMaterial, primitive.material);
    }
  return became;
}

Hierarchy readHierarchy(GltfFile& file) {
  std::vector<std::vector<int>> children;
  for (const GltfNode& node : file.nodes) children.push_back(node.children);
  Hierarchy sorted = sortNodes(children, file.roots, file.where);
  for (std::size_t i = 0; i < sorted.order.size(); ++i) {
    file.scene.nodes.push_back(file.nodes[sorted.order[i]].node);
    file.scene.nodes.back().parent = sorted.parent[i];
  }
  return sorted;
}

void readInstances(GltfFile& file, const Hierarchy& sorted, const std::vector<std::vector<int>>& meshes) {
  for (std::size_t i = 0; i < sorted.order.size(); ++i) {
    const int mesh = file.nodes[sorted.order[i]].mesh;
    if (mesh < 0) continue;
    for (int m : at(meshes, mesh, "mesh", file)) file.scene.instances.push_back({m, static_cast<int>(i)});
  }
}

/// Calls place(item, node of the scene) for each node that refers to an item, in the items' order.
template <class Place>
void forEachUse(const GltfFile& file, const Hierarchy& sorted, std::size_t items, int GltfNode::*reference,
                const char* what, Place&& place) {
  std::vector<std::vector<int>> users(items);
  for (std::size_t i = 0; i < sorted.order.size(); ++i) {
    const int item = file.nodes[sorted.order[i]].*reference;
    if (item >= 0) at(users, item, what, file), users[item].push_back(static_cast<int>(i));
  }
  for (std::size_t item = 0; item < items; ++item)
    for (int node : users[item]) place(item, node);
}

void readCamerasAndLights(GltfFile& file, const Hierarchy& sorted) {
  forEachUse(file, sorted, file.cameras.size(), &GltfNode::camera, "camera", [&](std::size_t item, int node) {
    SceneCamera camera = file.cameras[item];
    camera.node = node;
    if (camera.yfov > 0) return file.scene.cameras.push_back(camera);
    warnOnce(file.scene.warnings, "orthographic cameras are not supported: they are left out");
  });
  forEachUse(file, sorted, file.lights.size(), &GltfNode::light, "light", [&](std::size_t item, int node) {
    file.scene.punctual.push_back(file.lights[item]);
    file.scene.punctual.back().node = node;
  });
}

Track* trackFor(Node& node, const std::string& path) {
  if (path == "translation") return &node.translationTrack;
  if (path == "rotation") return &node.rotationTrack;
  return path == "scale" ? &node.scaleTrack : nullptr;
}

void readChannel(GltfFile& file, const Hierarchy& sorted, const GltfChannel& channel) {
  if (channel.node < 0) return;  // the target is an extension's
  at(file.nodes, channel.node, "node", file);
  if (sorted.placed[channel.node] < 0) return;
  Node& node = file.scene.nodes[sorted.placed[channel.node]];
  Track* track = trackFor(node, channel.path);
  if (!track)
    return warnOnce(file.scene.warnings, "animation of " + channel.path + " is not supported: it stays at rest");
  if (!track->empty())
    return warnOnce(file.scene.warnings, "several animations move one node: the first of them is played");
  if (node.hasMatrix)
    throw Error(file.where, "node " + std::to_string(channel.node) + " is animated and has a matrix", kRepair);
  *track = trackOf(channel.times, channel.values, channel.interpolation, channel.path == "rotation" ? 4 : 3);
}

}  // namespace

Scene assemble(GltfFile file) {
  const std::vector<std::vector<int>> meshes = readMeshes(file);
  const Hierarchy sorted = readHierarchy(file);
  readInstances(file, sorted, meshes);
  readCamerasAndLights(file, sorted);
  for (const GltfChannel& channel : file.channels) readChannel(file, sorted, channel);
  return std::move(file.scene);
}

}  // namespace core
