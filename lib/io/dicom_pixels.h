// The pixels of a DICOM file's frames, decoded: plain ones and runs of lengths by own code, JPEG lossless, JPEG-LS and
// JPEG 2000 by GDCM's codecs, after what their streams state was held against the head.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/dicom_head.h"

namespace gonio::io {

// Where the bytes of one frame lie: places and lengths of its pieces.
using DicomPieces = std::vector<std::pair<std::uint64_t, std::uint64_t>>;
// All frames of a file without a fault. Error(data) where fragments are not as many as frames.
std::vector<DicomPieces> dicom_frames(const DicomFile& file);

// One frame as frame_bytes() bytes in this machine's order, bits above the stored ones filled as the sign has them.
std::string dicom_frame(const DicomFile& file, const DicomPieces& pieces);

// PS3.5 annex G: segments of bytes, the most significant first, each in runs. Error(data) where they are too short.
std::string decode_run_lengths(std::string_view stored, std::size_t pixels, std::size_t bytes_of_pixel,
                               const std::string& place);

// What a compressed stream states of itself. Error(data) where it states nothing, or that it loses.
struct DicomStream {
  std::size_t rows = 0, columns = 0;
  int bits = 0, components = 0;
  bool is_signed = false;
};
DicomStream dicom_stream(std::string_view stored, DicomPixels pixels, const std::string& place);

}  // namespace gonio::io
