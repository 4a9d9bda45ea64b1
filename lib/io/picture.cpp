// Which file format, by extension; and the transfer curve of IEC 61966-2-1.
#include "io/picture.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/exr.h"
#include "io/raster.h"

namespace gonio::io {
namespace {

float linear_by_formula(float v) {
  const float a = std::abs(v);
  return std::copysign(a <= 0.04045f ? a / 12.92f : std::pow((a + 0.055f) / 1.055f, 2.4f), v);
}

// Of the codes c / 255 of 8-bit pictures.
struct LinearOfCode {
  std::array<float, 256> code{}, linear{};
  LinearOfCode() {
    for (std::size_t c = 0; c < code.size(); ++c) {
      code[c] = static_cast<float>(c) / 255.0f;
      linear[c] = linear_by_formula(code[c]);
    }
  }
};

constexpr const char* readable = "use .exr, .png, .jpg, .jpeg, .tif, .tiff, .bmp or .tga";

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace

PictureFormat picture_format(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".exr") return PictureFormat::exr;
  for (const char* known : {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".tga"}) {
    if (extension == known) return PictureFormat::raster;
  }
  throw Error(Exit::data, path.string(), "'" + extension + "' is not a picture that can be read", readable);
}

Image read_picture(const std::filesystem::path& path) {
  const PictureFormat format = picture_format(path);
  const std::string bytes = read_file(path);
  return format == PictureFormat::exr ? decode_exr(bytes, path.string()) : decode_raster(bytes, path.string());
}

void write_picture(const std::filesystem::path& path, const Image& image) {
  const std::string extension = lower_extension(path);
  if (extension == ".exr") return write_file(path, encode_exr(image));
  if (extension == ".png") return write_file(path, encode_png(image));
  throw Error(Exit::cannot_create, path.string(), "'" + extension + "' is not a picture that can be written",
              "use .exr or .png");
}

std::string encode_png(const Image& image) {
  return encode_raster_png(image);
}

float srgb_from_linear(float v) {
  const float a = std::abs(v);
  return std::copysign(a <= 0.0031308f ? 12.92f * a : 1.055f * std::pow(a, 1 / 2.4f) - 0.055f, v);
}

// Textures and vertex colours have millions of values, and most of them are one of 256.
float linear_from_srgb(float v) {
  static const LinearOfCode known;
  if (v >= 0 && v <= 1) {
    const auto c = static_cast<std::size_t>(v * 255 + 0.5f);
    if (known.code[c] == v) return known.linear[c];
  }
  return linear_by_formula(v);
}

}  // namespace gonio::io
