// From what a glTF file says, item by item, to a scene: meshes, sorted nodes, instances, animation.
#pragma once

#include "core/gltf_mesh.h"
#include "core/scene.h"

namespace core {

struct GltfPrimitive {
  PrimitiveSource source;
  int material = -1;          ///< into GltfFile::scene.materials, -1 = glTF's default material
  std::vector<int> identity;  ///< what it refers to; primitives of equal identity become one mesh
};

struct GltfMesh {
  std::string name;
  std::vector<GltfPrimitive> primitives;
};

struct GltfNode {
  Node node;  ///< its own transform and name
  std::vector<int> children;
  int mesh = -1, camera = -1, light = -1;
};

struct GltfChannel {
  int node = -1;
  std::string path;
  AccessorView times, values;
  Interpolation interpolation = Interpolation::linear;
};

/// A file's items, numbers still in its buffers. Indices are the file's, not checked yet.
struct GltfFile {
  std::string where;  ///< the file, for messages
  Scene scene;        ///< textures, materials, flickers and warnings so far
  std::vector<GltfMesh> meshes;
  std::vector<GltfNode> nodes;
  std::vector<int> roots;
  std::vector<SceneCamera> cameras;  ///< yfov <= 0: one that is not supported
  std::vector<PunctualLight> lights;
  std::vector<GltfChannel> channels;  ///< of all animations
};

/// The file as a scene. Throws Error.
Scene assemble(GltfFile file);

}  // namespace core
