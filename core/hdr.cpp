// Parsing Radiance pictures.
#include "core/hdr.h"

#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/check.h"
#include "core/files.h"

namespace core {
namespace {

constexpr std::int64_t kMaxExtent = 1 << 17;                 // on a side, as for OpenEXR
constexpr std::int64_t kMostPixels = std::int64_t{1} << 27;  // 1.5 GiB as float RGB
constexpr int kLeastRun = 8, kMostRun = 32767;               // widths that the new encoding can have

using Rgbe = std::array<std::uint8_t, 4>;

/// Size and orientation of a picture, and the scale that its pixels were stored with.
struct Header {
  int width = 0, height = 0;
  bool fromBottom = false, fromRight = false;
  std::array<double, 3> stored{1, 1, 1};
};

class HdrReader {
 public:
  HdrReader(std::string bytes, std::string where) : bytes_(std::move(bytes)), where_(std::move(where)) {}

  Planes read() {
    const Header header = readHeader();
    if (static_cast<std::int64_t>(bytes_.size() - at_) < 4 * std::int64_t{header.height}) truncated();
    Planes image(header.width, header.height);
    std::vector<Rgbe> row(static_cast<std::size_t>(header.width));
    for (int i = 0; i < header.height; ++i) {
      readRow(row);
      storeRow(header, row, header.fromBottom ? header.height - 1 - i : i, image.view());
    }
    return image;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(where_, what, "give a complete Radiance picture in RGB (or OpenEXR)");
  }
  [[noreturn]] void truncated() const { fail("it ends before its last pixel"); }

  std::string line() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string::npos) fail("its header has no end");
    std::string text = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    if (!text.empty() && text.back() == '\r') text.pop_back();
    return text;
  }

  Header readHeader() {
    if (bytes_.compare(0, 2, "#?") != 0) fail("it is no Radiance picture");
    Header header;
    for (std::string text = line(); !text.empty(); text = line()) readVariable(text, header);
    readResolution(line(), header);
    return header;
  }

  void readVariable(const std::string& text, Header& header) const {
    const auto is = [&](std::string_view name) { return text.compare(0, name.size(), name) == 0; };
    const std::size_t equals = text.find('=');
    std::istringstream value(equals == std::string::npos ? "" : text.substr(equals + 1));
    if (is("FORMAT=")) {
      std::string format;
      value >> format;
      if (format != "32-bit_rle_rgbe") fail("its pixels are '" + shown(format) + "', not 32-bit_rle_rgbe");
    } else if (is("EXPOSURE=")) {
      double exposure = 0;
      value >> exposure;
      scale(header, {exposure, exposure, exposure});
    } else if (is("COLORCORR=")) {
      std::array<double, 3> correction{};
      value >> correction[0] >> correction[1] >> correction[2];
      scale(header, correction);
    }
  }

  void scale(Header& header, const std::array<double, 3>& factor) const {
    for (std::size_t c = 0; c < 3; ++c) {
      header.stored[c] *= factor[c];
      if (!(header.stored[c] > 0 && std::isfinite(header.stored[c]))) fail("its exposure is not a positive number");
    }
  }

  void readResolution(const std::string& text, Header& header) const {
    std::istringstream words(text);
    std::string y, x;
    std::int64_t height = 0, width = 0;
    words >> y >> height >> x >> width;
    if (!words || (y != "-Y" && y != "+Y") || (x != "-X" && x != "+X"))
      fail("'" + shown(text) + "' is no size such as '-Y 512 +X 1024'");
    if (width < 1 || height < 1 || width > kMaxExtent || height > kMaxExtent || width * height > kMostPixels)
      fail("it claims " + std::to_string(width) + " x " + std::to_string(height) + " pixels, 1 to 2^27 are allowed");
    header.width = static_cast<int>(width), header.height = static_cast<int>(height);
    header.fromBottom = y == "+Y", header.fromRight = x == "-X";
  }

  /// Text of the file as it may stand in a message: short and printable.
  static std::string shown(std::string text) {
    if (text.size() > 40) text = text.substr(0, 40) + "...";
    for (char& c : text)
      if (c < ' ' || c > '~') c = '?';
    return text;
  }

  std::uint8_t byte() {
    if (at_ >= bytes_.size()) truncated();
    return static_cast<std::uint8_t>(bytes_[at_++]);
  }
  Rgbe pixel() {
    Rgbe p;
    for (std::uint8_t& b : p) b = byte();
    return p;
  }

  void readRow(std::vector<Rgbe>& row) {
    const int width = static_cast<int>(row.size());
    const std::size_t start = at_;
    const Rgbe first = pixel();
    const bool encoded =
        width >= kLeastRun && width <= kMostRun && first[0] == 2 && first[1] == 2 && (first[2] & 0x80) == 0;
    if (!encoded) {
      at_ = start;
      return readOldRow(row);
    }
    if ((first[2] << 8 | first[3]) != width) fail("a row has another width than the picture");
    for (std::size_t c = 0; c < 4; ++c) readComponent(row, c);
  }

  /// One byte of every pixel of a row: runs (count above 128) and literal bytes.
  void readComponent(std::vector<Rgbe>& row, std::size_t c) {
    for (std::size_t i = 0; i < row.size();) {
      const std::uint8_t code = byte();
      const bool run = code > 128;
      const std::size_t count = run ? code - 128u : code;
      if (count == 0 || count > row.size() - i) fail("a run of pixels leaves its row");
      const std::uint8_t value = run ? byte() : std::uint8_t{0};
      for (const std::size_t end = i + count; i < end; ++i) row[i][c] = run ? value : byte();
    }
  }

  /// Pixels one by one; (1, 1, 1, n) repeats the one before n times, 256 n times if it follows another such.
  void readOldRow(std::vector<Rgbe>& row) {
    int shift = 0;
    for (std::size_t i = 0; i < row.size();) {
      const Rgbe p = pixel();
      if (!(p[0] == 1 && p[1] == 1 && p[2] == 1)) {
        row[i++] = p;
        shift = 0;
        continue;
      }
      const std::size_t count = shift <= 16 ? std::size_t{p[3]} << shift : row.size() + 1;
      if (i == 0 || count > row.size() - i) fail("a run of pixels leaves its row");
      std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(i), count, Rgbe(row[i - 1]));
      i += count;
      shift += 8;
    }
  }

  static void storeRow(const Header& header, const std::vector<Rgbe>& row, int y, PlanesView<float> image) {
    for (int x = 0; x < header.width; ++x) {
      const Rgbe& p = row[static_cast<std::size_t>(header.fromRight ? header.width - 1 - x : x)];
      const double step = p[3] > 0 ? std::ldexp(1.0, p[3] - 136) : 0.0;
      for (std::size_t c = 0; c < 3; ++c) image.plane[c](x, y) = static_cast<float>(step * p[c] / header.stored[c]);
    }
  }

  std::string bytes_, where_;
  std::size_t at_ = 0;
};

}  // namespace

Planes readHdr(const std::filesystem::path& path) { return HdrReader(readFile(path), path.string()).read(); }

}  // namespace core
