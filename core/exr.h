// OpenEXR images with any number of named channels; layers are spelled "layer.R" as OpenEXR recommends.
// Source: OpenEXR technical introduction, "Channel names".
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/image.h"

namespace core {

/// All channels of an EXR file, each width x height. Pixel (0, 0) is the corner of the file's data window.
struct ExrImage {
  int width = 0, height = 0;
  std::map<std::string, Image<float>> channels;

  bool has(const std::string& channel) const { return channels.count(channel) > 0; }
  /// Adds (or replaces) a channel; the first one gives the image its size, the others must have it too.
  void add(const std::string& channel, In<float> values);
  /// Adds R, G and B, of a layer if one is named.
  void add(const std::string& layer, PlanesView<const float> rgb);
};

/// Reads every channel (half, float or uint; scan lines or tiles; any compression) as float.
/// Throws Error where the file is missing, no EXR, truncated, subsampled, deep, or above 2^27 pixels.
ExrImage readExr(const std::filesystem::path& path);

/// Writes all channels as float, ZIP-compressed, under a temporary name, and renames. Equal images give equal bytes.
void writeExr(const std::filesystem::path& path, const ExrImage& image);

/// A layer's colour ("" = the file's own R, G, B; a lone Y counts for all three). Throws Error naming `where` if
/// absent.
Planes rgbOf(const ExrImage& image, const std::string& layer, const std::string& where);

/// One channel. Throws Error naming `where` if absent.
const Image<float>& channelOf(const ExrImage& image, const std::string& channel, const std::string& where);

/// The colour alone.
Planes readExrRgb(const std::filesystem::path& path);
void writeExrRgb(const std::filesystem::path& path, PlanesView<const float> rgb);

}  // namespace core
