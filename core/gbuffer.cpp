#include "core/gbuffer.h"

#include "core/environment.h"
#include "core/texture.h"

namespace core {
namespace {

/// Everything one frame's kernel reads.
struct View {
  const Scene& scene;
  const Pose& pose;
  const std::vector<InstanceState>& instances;
  Projection now, before;
  bool cameraMoved;
};

/// A hit with its mesh looked up: object-space position, texture coordinates, both normals in world space.
struct Vertexed {
  vec3 object;
  vec2 uv{0};
  vec3 front;   ///< unit geometric normal of the front face
  vec3 normal;  ///< unit shading normal on the front side
};

vec3 mix3(const std::vector<vec3>& v, const uvec3& t, const vec3& b) {
  return b.x * v[t.x] + b.y * v[t.y] + b.z * v[t.z];
}

/// Tangent-space normal from a texture, in world space. Tangents follow the texture's own axes on the triangle.
vec3 mappedNormal(const View& view, const Mesh& mesh, const Material& material, const InstanceState& state,
                  const uvec3& t, const Vertexed& v) {
  const vec3 e1 = mesh.positions[t.y] - mesh.positions[t.x], e2 = mesh.positions[t.z] - mesh.positions[t.x];
  const vec2 d1 = mesh.uvs[t.y] - mesh.uvs[t.x], d2 = mesh.uvs[t.z] - mesh.uvs[t.x];
  const float determinant = d1.x * d2.y - d2.x * d1.y;
  if (determinant == 0) return v.normal;
  vec3 tangent = glm::mat3(state.toWorld) * ((e1 * d2.y - e2 * d1.y) / determinant);
  tangent -= v.normal * dot(v.normal, tangent);
  const float length2 = dot(tangent, tangent);
  if (!(length2 > 0) || !isFinite(length2)) return v.normal;
  tangent /= std::sqrt(length2);
  vec3 bitangent = cross(v.normal, tangent);
  if (dot(bitangent, glm::mat3(state.toWorld) * ((e2 * d1.x - e1 * d2.x) / determinant)) < 0) bitangent = -bitangent;
  // glTF's v runs down the image, the map's green axis up it: hence the minus below.
  const vec3 m = 2.0f * vec3(sampleLinear(view.scene.textures[material.normalTexture], v.uv)) - 1.0f;
  const vec3 n = m.x * material.normalScale * tangent - m.y * material.normalScale * bitangent + m.z * v.normal;
  return dot(n, n) > 0 ? normalize(n) : v.normal;
}

template <SurfaceFeatures F>
Vertexed lookUp(const View& view, const Mesh& mesh, const Material& material, const InstanceState& state,
                const Hit& hit) {
  const uvec3 t = mesh.triangles[hit.primitive];
  const vec3 b(1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric);
  Vertexed v;
  v.object = mix3(mesh.positions, t, b);
  const vec3 edges = cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
  v.front = normalize(state.normalToWorld * edges);
  v.normal = v.front;
  if (!mesh.normals.empty()) {
    const vec3 n = state.normalToWorld * mix3(mesh.normals, t, b);
    if (dot(n, n) > 0) v.normal = normalize(n);
    if (dot(v.normal, v.front) < 0) v.normal = -v.normal;
  }
  if constexpr (F.textured) {
    if (!mesh.uvs.empty()) {
      v.uv = b.x * mesh.uvs[t.x] + b.y * mesh.uvs[t.y] + b.z * mesh.uvs[t.z];
      if (material.normalTexture >= 0) v.normal = mappedNormal(view, mesh, material, state, t, v);
    }
  }
  return v;
}

template <SurfaceFeatures F>
void applyMaterial(const Scene& scene, const Material& material, vec2 uv, Surface& s) {
  s.baseColor = material.baseColor;
  s.metallic = material.metallic;
  s.roughness = material.roughness;
  if constexpr (F.textured) {
    if (material.baseColorTexture >= 0) s.baseColor *= vec3(sampleSrgb(scene.textures[material.baseColorTexture], uv));
    if (material.metallicRoughnessTexture >= 0) {
      const vec4 texel = sampleLinear(scene.textures[material.metallicRoughnessTexture], uv);
      s.roughness *= texel.g;
      s.metallic *= texel.b;
    }
  }
}

template <SurfaceFeatures F>
vec3 emissionOf(const View& view, int materialIndex, vec2 uv) {
  const Material& material = view.scene.materials[materialIndex];
  vec3 emission = material.emission * view.pose.materialEmission[materialIndex];
  if constexpr (F.textured)
    if (material.emissionTexture >= 0) emission *= vec3(sampleSrgb(view.scene.textures[material.emissionTexture], uv));
  return emission;
}

/// Turns n into the viewer's half space, bending it where interpolation or a map tipped it over.
vec3 facing(const vec3& n, const vec3& toViewer) {
  constexpr float kLeastCosine = 1e-3f;
  const float cosine = dot(n, toViewer);
  return cosine >= kLeastCosine ? n : normalize(n + (kLeastCosine - cosine) * toViewer);
}

/// |dz/dx| + |dz/dy| of the tangent plane: z = n.(p - o) / n.d, so dz/dx = -z n.(dd/dx) / n.d.
float depthSlopeOf(const Projection& view, const vec3& direction, const vec3& n, float depth) {
  constexpr float kSteepest = 1e3f;  // depths a pixel, seen edge-on
  const float slope = (std::abs(dot(n, view.stepX())) + std::abs(dot(n, view.stepY()))) / std::abs(dot(n, direction));
  return depth * std::min(slope, kSteepest);
}

template <SurfaceFeatures F>
void writeMotion(const View& view, const InstanceState& state, const vec3& object, const vec3& world, vec2 pixel,
                 float depth, int x, int y, GuideImages& out) {
  const bool moved = F.moving && state.moved;
  if (!moved && !view.cameraMoved) {
    out.motion(x, y) = vec2(0);
    out.depthChange(x, y) = 0;
    return;
  }
  const vec3 past = moved ? vec3(state.toWorldBefore * vec4(object, 1)) : world;
  const float pastDepth = view.before.depth(past);
  const bool visible = pastDepth > 0;
  out.motion(x, y) = visible ? view.before.project(past) - pixel : vec2(kInfinity);
  out.depthChange(x, y) = visible ? pastDepth - depth : 0;
}

void writeMiss(const View& view, const vec3& direction, int x, int y, GBuffer& out) {
  const Environment* environment = view.scene.environment.get();
  out.surfaces(x, y) = Surface{};
  out.emission.view().store(x, y, environment ? environment->radiance(Environment::uvOf(direction)) : vec3(0));
  out.guide.depth(x, y) = kInfinity;
  out.guide.depthSlope(x, y) = out.guide.depthChange(x, y) = 0;
  out.guide.normal.view().store(x, y, vec3(0));
  out.guide.id(x, y) = kNoId;
  out.guide.motion(x, y) = vec2(0);
}

template <SurfaceFeatures F>
void writeHit(const View& view, const Hit& hit, const vec3& direction, int x, int y, GBuffer& out) {
  const InstanceState& state = view.instances[hit.instance];
  const Mesh& mesh = view.scene.meshes[view.scene.instances[hit.instance].mesh];
  const Material& material = view.scene.materials[mesh.material];
  const Vertexed v = lookUp<F>(view, mesh, material, state, hit);

  Surface s;
  s.position = vec3(state.toWorld * vec4(v.object, 1));
  s.id = hit.instance;
  s.primitive = hit.primitive;
  applyMaterial<F>(view.scene, material, v.uv, s);
  const vec3 toViewer = -normalize(direction);
  const bool front = dot(v.front, toViewer) >= 0;
  s.geometricNormal = front ? v.front : -v.front;
  s.normal = facing(front ? v.normal : -v.normal, toViewer);

  const float depth = hit.distance;  // direction has length 1 along the view axis
  out.surfaces(x, y) = s;
  out.emission.view().store(x, y, front || material.doubleSided ? emissionOf<F>(view, mesh.material, v.uv) : vec3(0));
  out.guide.depth(x, y) = depth;
  out.guide.depthSlope(x, y) = depthSlopeOf(view.now, direction, s.geometricNormal, depth);
  out.guide.normal.view().store(x, y, s.normal);
  out.guide.id(x, y) = s.id;
  writeMotion<F>(view, state, v.object, s.position, vec2(x + 0.5f, y + 0.5f), depth, x, y, out.guide);
}

template <SurfaceFeatures F>
void traceRow(const View& view, const Tracer& tracer, int x0, int x1, int y, GBuffer& out) {
  for (int x = x0; x < x1; x += kPacket) {
    vec3 directions[kPacket];
    Hit hits[kPacket];
    const int count = std::min(kPacket, x1 - x);
    for (int i = 0; i < count; ++i) directions[i] = view.now.direction({x + i + 0.5f, y + 0.5f});
    tracer.intersectPacket(view.pose.camera.position, directions, count, hits);
    for (int i = 0; i < count; ++i)
      if (hits[i].hit())
        writeHit<F>(view, hits[i], directions[i], x + i, y, out);
      else
        writeMiss(view, directions[i], x + i, y, out);
  }
}

template <SurfaceFeatures F>
void traceAll(const View& view, const Tracer& tracer, GBuffer& out, int tile) {
  const int packetTile = (tile + kPacket - 1) / kPacket * kPacket;  // packets lie on one grid whatever the tile
  forEachTile(
      out.surfaces.width(), out.surfaces.height(),
      [&](int x0, int y0, int x1, int y1) {
        for (int y = y0; y < y1; ++y) traceRow<F>(view, tracer, x0, x1, y, out);
      },
      packetTile);
}

bool sameCamera(const Camera& a, const Camera& b) {
  return a.position == b.position && a.right == b.right && a.up == b.up && a.forward == b.forward &&
         a.tanHalfFovY == b.tanHalfFovY;
}

}  // namespace

std::vector<InstanceState> instanceStates(const Scene& scene, const Pose& now, const Pose& before) {
  std::vector<InstanceState> states(scene.instances.size());
  for (std::size_t i = 0; i < states.size(); ++i) {
    InstanceState& s = states[i];
    s.toWorld = now.nodeToWorld[scene.instances[i].node];
    s.toWorldBefore = before.nodeToWorld[scene.instances[i].node];
    s.moved = s.toWorld != s.toWorldBefore;
    s.normalToWorld = glm::transpose(glm::inverse(glm::mat3(s.toWorld)));
  }
  return states;
}

SurfaceFeatures featuresOf(const Scene& scene, const SceneMotion& motion) {
  bool textured = false;
  for (const Material& m : scene.materials)
    textured |= std::max(std::max(m.baseColorTexture, m.metallicRoughnessTexture),
                         std::max(m.emissionTexture, m.normalTexture)) >= 0;
  return {textured, motion.instances};
}

void traceGBuffer(const Scene& scene, const Pose& now, const Pose& before, const Tracer& tracer,
                  const SurfaceFeatures& features, GBuffer& out, int tile) {
  const int width = out.surfaces.width(), height = out.surfaces.height();
  const std::vector<InstanceState> instances = instanceStates(scene, now, before);
  const View view{scene,
                  now,
                  instances,
                  Projection(now.camera, width, height),
                  Projection(before.camera, width, height),
                  !sameCamera(now.camera, before.camera)};
  if (features.textured && features.moving) return traceAll<SurfaceFeatures{true, true}>(view, tracer, out, tile);
  if (features.textured) return traceAll<SurfaceFeatures{true, false}>(view, tracer, out, tile);
  if (features.moving) return traceAll<SurfaceFeatures{false, true}>(view, tracer, out, tile);
  traceAll<SurfaceFeatures{false, false}>(view, tracer, out, tile);
}

}  // namespace core
