// See archive_pictures.h.
#include "print/archive_pictures.h"

#include <algorithm>
#include <cmath>

#include "io/grey.h"
#include "io/png_grey.h"
#include "io/raster.h"
#include "io/raster_header.h"
#include "print/archive_checks.h"

namespace gonio::print {
namespace {

constexpr std::size_t png_head = 33;  // signature and IHDR

std::int64_t big_endian(std::string_view bytes, std::size_t at) {
  std::int64_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

}  // namespace

std::string png_of_layer(const Job& job, std::span<const std::uint8_t> picture) {
  return io::encode_png_of_grey_bytes(picture, static_cast<std::size_t>(job.width_px));
}

void read_png_sides(std::string_view beginning, const std::string& place, int& width_px, int& height_px) {
  if (beginning.size() < png_head || !beginning.starts_with("\x89PNG\r\n\x1a\n") || beginning.substr(12, 4) != "IHDR")
    refuse_archive(place, "is no PNG picture", "write or copy it again");
  const std::int64_t width = big_endian(beginning, 16), height = big_endian(beginning, 20);
  check_pixels(width, height, place);
  width_px = static_cast<int>(width), height_px = static_cast<int>(height);
}

void read_png_layer(const std::string& png, const Job& job, const std::string& place, std::span<std::uint8_t> to) {
  int width_px = 0, height_px = 0;
  read_png_sides(png, place, width_px, height_px);
  if (width_px != job.width_px || height_px != job.height_px)
    refuse_archive(place,
                   "has " + std::to_string(width_px) + " x " + std::to_string(height_px) +
                       " pixels, and other layers " + std::to_string(job.width_px) + " x " +
                       std::to_string(job.height_px),
                   "slice all layers on one grid");
  const io::RasterHeader header = io::read_raster_header(png, place);
  if (header.code_bits != 8)
    refuse_archive(place, "has " + std::to_string(header.code_bits) + " bits a pixel", "layers have 8");
  const io::GreyImage grey = io::decode_grey(png, place);
  std::copy(grey.bytes.begin(), grey.bytes.end(), to.begin());
}

std::uint64_t most_png_bytes(const Job& job) {
  const auto width = static_cast<std::uint64_t>(job.width_px), height = static_cast<std::uint64_t>(job.height_px);
  return 8 * (width + 1) * height + (1 << 20);  // four channels of 16 bits that cannot be squeezed, and words
}

std::string png_of_preview(const JobPreview& preview) {
  io::Image image(preview.width_px, preview.height_px, {"R", "G", "B"});
  std::transform(preview.rgb.begin(), preview.rgb.end(), image.data.begin(),
                 [](std::uint8_t code) { return static_cast<float>(code) / 255.0f; });
  return io::encode_raster_png(image);
}

JobPreview read_png_preview(const std::string& png, const std::string& place) {
  JobPreview preview;
  read_png_sides(png, place, preview.width_px, preview.height_px);
  const io::Image image = io::decode_raster(png, place);
  const int red = std::max(0, image.channel("R")), green = std::max(0, image.channel("G")),
            blue = std::max(0, image.channel("B"));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (const int c : {red, green, blue})
        preview.rgb.push_back(static_cast<std::uint8_t>(std::lround(255.0f * image.at(x, y, c))));
  return preview;
}

}  // namespace gonio::print
