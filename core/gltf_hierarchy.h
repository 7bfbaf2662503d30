// The node tree of a glTF file, checked to be one and sorted.
#pragma once

#include <string>
#include <vector>

namespace core {

/// Nodes that a scene reaches, parents before children and otherwise in the file's order.
struct Hierarchy {
  std::vector<int> order;   ///< the file's index of each node kept
  std::vector<int> placed;  ///< for each of the file's nodes its place in order, -1 = not part of the scene
  std::vector<int> parent;  ///< for each node kept its parent's place in order, -1 = none
};

/// children: per node of the file. roots: the scene's nodes. Throws Error naming `where` for an index out of range, a
/// node with two parents, a root that has a parent, and a cycle.
Hierarchy sortNodes(const std::vector<std::vector<int>>& children, const std::vector<int>& roots,
                    const std::string& where);

}  // namespace core
