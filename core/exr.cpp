#include "core/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>

#include "core/files.h"

namespace core {
namespace {

constexpr int kMaxExtent = 1 << 17;                         // on a side; OpenEXR refuses the header above it
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 27;  // 512 MiB a channel

std::string prefixOf(const std::string& layer) { return layer.empty() ? "" : layer + "."; }

std::string listOf(const ExrImage& image) {
  std::string names;
  for (const auto& [name, values] : image.channels) names += (names.empty() ? "" : ", ") + name;
  return names;
}

Imf::Slice sliceOf(Image<float>& values, const Imath::Box2i& window) {
  return Imf::Slice::Make(Imf::FLOAT, values.data(), window, sizeof(float), sizeof(float) * values.width());
}

ExrImage allocate(const Imf::Header& header, const std::string& where) {
  const Imath::Box2i window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1 || width * height > kMaxPixels)
    throw Error(where, "claims " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
                "use an image of at most 2^27 pixels");
  ExrImage image{static_cast<int>(width), static_cast<int>(height), {}};
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
      throw Error(where, std::string("channel ") + c.name() + " is subsampled", "save it at full resolution");
    image.channels.emplace(c.name(), Image<float>(image.width, image.height));
  }
  return image;
}

ExrImage readChannels(const std::string& name) {
  Imf::Header::setMaxImageSize(kMaxExtent, kMaxExtent);
  Imf::InputFile file(name.c_str());
  ExrImage image = allocate(file.header(), name);
  const Imath::Box2i window = file.header().dataWindow();
  Imf::FrameBuffer buffer;
  for (auto& [channel, values] : image.channels) buffer.insert(channel, sliceOf(values, window));
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  return image;
}

std::string oneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

void ExrImage::add(const std::string& channel, In<float> values) {
  if (channels.empty()) width = values.width, height = values.height;
  CHECK_EQ(values.width, width);
  CHECK_EQ(values.height, height);
  Image<float> copy(width, height);
  for (int y = 0; y < height; ++y) std::copy_n(values.row(y), width, copy.view().row(y));
  channels[channel] = std::move(copy);
}

void ExrImage::add(const std::string& layer, PlanesView<const float> rgb) {
  for (int c = 0; c < 3; ++c) add(prefixOf(layer) + "RGB"[c], rgb.plane[c]);
}

ExrImage readExr(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) throw Error(path.string(), "no such file", "check the name");
  try {
    return readChannels(path.string());
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(path.string(), "cannot be read as OpenEXR (" + oneLine(e.what()) + ")", "give a complete EXR image");
  }
}

void writeExr(const std::filesystem::path& path, const ExrImage& image) {
  CHECK(!image.channels.empty());
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer buffer;
  for (const auto& [name, values] : image.channels) {
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    buffer.insert(name, sliceOf(const_cast<Image<float>&>(values), header.dataWindow()));  // only read from
  }
  PendingFile pending(path);
  try {
    Imf::OutputFile file(pending.temporary().c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(image.height);
  } catch (const std::exception& e) {
    throw Error(path.string(), "could not be written (" + oneLine(e.what()) + ")", "check the folder and the disk");
  }
  pending.commit();
}

const Image<float>& channelOf(const ExrImage& image, const std::string& channel, const std::string& where) {
  const auto found = image.channels.find(channel);
  if (found == image.channels.end())
    throw Error(where, "has no channel " + channel, "it has " + listOf(image) + ": name or rename one of these");
  return found->second;
}

Planes rgbOf(const ExrImage& image, const std::string& layer, const std::string& where) {
  const bool grey = !image.has(prefixOf(layer) + "R") && image.has(prefixOf(layer) + "Y");
  Planes rgb(image.width, image.height);
  for (int c = 0; c < 3; ++c) {
    const Image<float>& values = channelOf(image, prefixOf(layer) + (grey ? "YYY" : "RGB")[c], where);
    std::copy_n(values.data(), values.size(), rgb.view().plane[c].data);
  }
  return rgb;
}

Planes readExrRgb(const std::filesystem::path& path) { return rgbOf(readExr(path), "", path.string()); }

void writeExrRgb(const std::filesystem::path& path, PlanesView<const float> rgb) {
  ExrImage image;
  image.add("", rgb);
  writeExr(path, image);
}

}  // namespace core
