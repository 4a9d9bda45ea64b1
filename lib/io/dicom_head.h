// The head of a DICOM file (PS3.5 section 7, PS3.10): what a slice of a volume needs of it. Read by own code, so that
// what a file states is checked before a library sees it: explicit and implicit, either order of bytes, sequences
// of known and unknown length. Lengths in millimetres, as the standard has them.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/volume.h"

namespace gonio::io {

enum class DicomPixels { plain, run_lengths, jpeg_lossless, jpeg_ls, jpeg_2000 };

struct DicomFile {
  std::filesystem::path path{};
  std::string series{}, instance{}, modality{}, photometric{}, rescale_type{};
  std::string syntax{};  // name of the transfer syntax
  DicomPixels pixels = DicomPixels::plain;
  bool big_endian = false;
  std::size_t rows = 0, columns = 0, frames = 1;
  int samples = 1, bits_allocated = 0, bits_stored = 0, high_bit = -1;
  bool is_signed = false;
  double slope = 1, intercept = 0;
  bool rescaled = false;                              // the file states slope and intercept
  std::optional<std::array<double, 2>> spacing_mm{};  // between rows, between columns
  std::optional<double> between_mm{};                 // SpacingBetweenSlices
  std::optional<Vec3> position_mm{};
  std::optional<std::array<Vec3, 2>> directions{};  // along a row, along a column
  std::vector<double> offsets_mm{};                 // GridFrameOffsetVector
  std::uint64_t pixels_at = 0, pixels_bytes = 0;    // of the fragments, too, where these are encapsulated
  std::string fault{}, remedy{};                    // why the file is refused; what stands before it was read

  VoxelType type() const;
  std::size_t frame_bytes() const { return rows * columns * static_cast<std::size_t>(bits_allocated / 8); }
};

bool begins_as_dicom(std::string_view beginning);  // the first 132 bytes

// Never throws for what the file holds: `fault` says it, and series what it belongs to as far as that was read.
// Faults are: truncation, no transfer syntax, one that loses or is not known, pixels that were compressed with loss
// before, several samples a pixel, sizes that do not fit the pixels' length. Error(no_input | io).
DicomFile read_dicom_head(const std::filesystem::path& path);

}  // namespace gonio::io
