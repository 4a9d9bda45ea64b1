// Bytes as an archive of layer images, for the fuzz targets of its readers: a file in memory, whose job is read and
// layers of which are read in and against their order. What comes out is a job of finite numbers and pictures of its
// size, or Error(data | no_input).
#pragma once
#include "print/archive.h"
#include "volume_input.h"

namespace gonio::fuzz {

inline int open_and_read(const print::ArchiveFormat& format, const std::uint8_t* bytes, std::size_t size) {
  static const MemoryFile file;
  const auto path = file.hold(bytes, size);
  try {
    const auto reader = format.open(path);
    const print::Job& job = reader->job();
    if (reader->layers() == 0 || job.width_px < 1 || job.height_px < 1) __builtin_trap();
    if (!job.tops_m.empty() && job.tops_m.size() != reader->layers()) __builtin_trap();
    if (job.pixel_m && !(job.pixel_m->x > 0 && job.pixel_m->y > 0)) __builtin_trap();
    for (const auto& amount : {job.layer_m, job.exposure_s, job.lift_m, job.resin_m3, job.printing_s})
      if (amount && !(std::isfinite(*amount) && *amount >= 0)) __builtin_trap();
    const std::size_t pixels = static_cast<std::size_t>(job.width_px) * static_cast<std::size_t>(job.height_px);
    if (pixels > (std::size_t{1} << 16)) return 0;  // takes time and finds nothing new
    std::vector<std::uint8_t> layer(pixels);
    const std::size_t layers = std::min<std::size_t>(reader->layers(), 4);
    for (std::size_t k = layers; k-- > 0;) reader->read(k, layer);
  } catch (const Error& error) {
    if (error.code() != Exit::data && error.code() != Exit::no_input) __builtin_trap();
  }
  return 0;
}

}  // namespace gonio::fuzz
