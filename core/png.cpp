#include "core/png.h"

#include <png.h>

#include "core/check.h"
#include "core/files.h"

namespace core {

std::string pngBytes(const ByteImage& image) {
  CHECK(image.channels == 3 || image.channels == 4);
  CHECK_GT(image.width, 0);
  CHECK_GT(image.height, 0);
  CHECK_EQ(image.bytes.size(), std::size_t(image.width) * image.height * image.channels);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = image.channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, image.bytes.data(), 0, nullptr))
    throw Error("PNG", png.message, "report this: the pixels were valid");
  bytes.resize(size);
  return bytes;
}

void writePng(const std::filesystem::path& path, const ByteImage& image) { writeFileAtomically(path, pngBytes(image)); }

}  // namespace core
