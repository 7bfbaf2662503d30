#include "core/gltf_hierarchy.h"

#include <functional>
#include <queue>

#include "core/check.h"
#include "core/gltf_support.h"

namespace core {
namespace {

void checkNode(int node, std::size_t count, const std::string& where) {
  if (node < 0 || static_cast<std::size_t>(node) >= count)
    throw Error(where, "node " + std::to_string(node) + " does not exist", kRepair);
}

std::vector<int> parentsOf(const std::vector<std::vector<int>>& children, const std::string& where) {
  std::vector<int> parents(children.size(), -1);
  for (std::size_t node = 0; node < children.size(); ++node)
    for (int child : children[node]) {
      checkNode(child, children.size(), where);
      if (parents[child] >= 0) throw Error(where, "node " + std::to_string(child) + " has two parents", kRepair);
      parents[child] = static_cast<int>(node);
    }
  return parents;
}

/// Every node must lead to one without a parent.
void checkNoCycle(const std::vector<int>& parents, const std::string& where) {
  std::vector<int> seenFrom(parents.size(), -1);
  for (int start = 0; start < static_cast<int>(parents.size()); ++start)
    for (int node = start; node >= 0; node = parents[node]) {
      if (seenFrom[node] == start) throw Error(where, "node " + std::to_string(node) + " is its own ancestor", kRepair);
      if (seenFrom[node] >= 0) break;
      seenFrom[node] = start;
    }
}

}  // namespace

Hierarchy sortNodes(const std::vector<std::vector<int>>& children, const std::vector<int>& roots,
                    const std::string& where) {
  const std::vector<int> parents = parentsOf(children, where);
  checkNoCycle(parents, where);
  std::priority_queue<int, std::vector<int>, std::greater<>> ready;  // the file's order wherever it can be kept
  for (int root : roots) {
    checkNode(root, children.size(), where);
    if (parents[root] >= 0) throw Error(where, "scene root " + std::to_string(root) + " has a parent", kRepair);
    ready.push(root);
  }
  Hierarchy sorted;
  sorted.placed.assign(children.size(), -1);
  while (!ready.empty()) {
    const int node = ready.top();
    ready.pop();
    if (sorted.placed[node] >= 0) continue;  // a root that is named twice
    sorted.placed[node] = static_cast<int>(sorted.order.size());
    sorted.order.push_back(node);
    sorted.parent.push_back(parents[node] < 0 ? -1 : sorted.placed[parents[node]]);
    for (int child : children[node]) ready.push(child);
  }
  return sorted;
}

}  // namespace core
