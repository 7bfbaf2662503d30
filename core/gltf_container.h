// What can be checked of a glTF file before a parser sees it: the GLB frame, and how deep its JSON nests.
// Source: glTF 2.0 specification, section 4 (binary glTF).
#pragma once

#include <string>
#include <string_view>

namespace core {

/// True if bytes begin a GLB.
bool isGlb(std::string_view bytes);

/// The JSON text of a .gltf or .glb file. Throws Error naming `where` for what is neither, a GLB of another version,
/// chunks that reach beyond the file, and JSON nested deeper than any parser's stack should be trusted with.
std::string_view checkContainer(std::string_view bytes, const std::string& where);

}  // namespace core
