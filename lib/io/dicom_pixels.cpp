#include "io/dicom_pixels.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
#include <type_traits>

#include "io/dicom_codec.h"
#include "io/little_endian.h"
#include "io/volume_bytes.h"
#include "io/volume_grid.h"

namespace gonio::io {
namespace {

constexpr std::uint32_t fragment_tag = 0xe000fffe, fragments_end = 0xe0ddfffe;  // as little endian numbers
constexpr std::uint64_t longest_frame = std::uint64_t{1} << 32;

std::uint32_t big16(std::string_view bytes, std::size_t at) {
  return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at])) << 8 |
         static_cast<unsigned char>(bytes[at + 1]);
}
std::uint32_t big32(std::string_view bytes, std::size_t at) {
  return big16(bytes, at) << 16 | big16(bytes, at + 2);
}

// Values of the fragments, the first of which is the table of offsets.
DicomPieces fragments_of(const DicomFile& file) {
  const std::string place = file.path.string();
  const std::uint64_t length = length_of_file(file.path), end = file.pixels_at + file.pixels_bytes;
  const auto bytes = bytes_of_files({{.path = file.path}}, length);
  DicomPieces places;
  for (std::uint64_t at = file.pixels_at; at + 8 <= end;) {
    std::string head(8, '\0');
    bytes->read(at, head);
    const auto tag = stored_at<std::uint32_t>(head, 0), size = stored_at<std::uint32_t>(head, 4);
    if (tag == fragments_end) return places;
    if (tag != fragment_tag) refuse_volume(place, "has no fragment of pixels at byte " + std::to_string(at));
    if (size > end - at - 8)
      refuse_volume(place, "has " + std::to_string(end - at - 8) + " bytes in its last fragment of pixels where " +
                               std::to_string(size) + " are stated: truncated");
    places.emplace_back(at + 8, size);
    at += 8 + std::uint64_t{size};
  }
  return places;  // written by some without an end
}

// Bits that are not stored: copies of the sign, or zeros.
template <class T>
void extend(std::string& bytes, int bits, bool is_signed) {
  const int shift = static_cast<int>(8 * sizeof(T)) - bits;
  if (shift <= 0) return;
  for (std::size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T)) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    const auto raised = static_cast<T>(static_cast<std::make_unsigned_t<T>>(value) << shift);
    value = is_signed ? static_cast<T>(raised >> shift)
                      : static_cast<T>(static_cast<std::make_unsigned_t<T>>(raised) >> shift);
    std::memcpy(bytes.data() + at, &value, sizeof(T));
  }
}

void to_this_machine(std::string& bytes, std::size_t sample, bool big) {
  if (sample == 1 || big == (std::endian::native == std::endian::big)) return;
  for (std::size_t at = 0; at + sample <= bytes.size(); at += sample)
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                 bytes.begin() + static_cast<std::ptrdiff_t>(at + sample));
}

// ITU-T T.81: markers of the frame, of which SOF3 alone is lossless; T.87: SOF55 and the step NEAR of its scan.
DicomStream jpeg_stream(std::string_view stored, bool ls, const std::string& place) {
  DicomStream stream;
  for (std::size_t at = 2; at + 4 <= stored.size() && stored[at] == '\xff';) {
    const auto marker = static_cast<unsigned char>(stored[at + 1]);
    if (marker == 0xff) {  // fill
      ++at;
      continue;
    }
    const std::size_t size = big16(stored, at + 2);
    if (size < 2 || stored.size() - at - 2 < size) break;
    if (marker == (ls ? 0xf7 : 0xc3) && size >= 8) {
      stream = {big16(stored, at + 5), big16(stored, at + 7), static_cast<unsigned char>(stored[at + 4]),
                static_cast<unsigned char>(stored[at + 9])};
    } else if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) {
      refuse_volume(place, "calls its pixels lossless, and the JPEG in it loses",
                    "get the series as it was reconstructed");
    } else if (marker == 0xda) {
      if (ls && size >= 8 && stored[at + 2 + size - 3] != 0)
        refuse_volume(place, "calls its pixels lossless, and the JPEG-LS in it loses",
                      "get the series as it was reconstructed");
      if (stream.rows > 0) return stream;
      break;
    }
    at += 2 + size;
  }
  refuse_volume(place, "has no JPEG of its kind where its pixels belong");
}

// Of what stands before the scan only what a lossless JPEG needs (ITU-T T.81, annex H): its frame SOF3, its Huffman
// tables and the restart interval. GDCM has assertions where it meets a revision of JFIF, a transform of Adobe's or a
// marker that it does not know.
std::string bare_jpeg(std::string_view stored) {
  std::string bare(stored.substr(0, 2));
  for (std::size_t at = 2; at + 4 <= stored.size();) {
    const auto marker = static_cast<unsigned char>(stored[at + 1]);
    if (marker == 0xda) return bare.append(stored.substr(at));
    const std::size_t length = marker == 0xff ? 1 : std::size_t{2} + big16(stored, at + 2);
    if (marker == 0xc3 || marker == 0xc4 || marker == 0xdd) bare.append(stored.substr(at, length));
    at += length;
  }
  return bare;
}

// ISO 15444-1, annex A: SIZ states the size; COD, whether the wavelet is the one that rounds (5-3) and can be undone.
DicomStream jpeg_2000_stream(std::string_view stored, const std::string& place) {
  DicomStream stream;
  for (std::size_t at = 2; at + 4 <= stored.size() && stored[at] == '\xff';) {
    const auto marker = static_cast<unsigned char>(stored[at + 1]);
    const std::size_t size = big16(stored, at + 2);
    if (size < 2 || stored.size() - at - 2 < size || marker == 0x90) break;
    if (marker == 0x51 && size >= 41) {
      const std::uint32_t width = big32(stored, at + 6), height = big32(stored, at + 10);
      const std::uint32_t left = big32(stored, at + 14), top = big32(stored, at + 18);
      const auto depth = static_cast<unsigned char>(stored[at + 40]);
      stream = {height > top ? height - top : 0, width > left ? width - left : 0, (depth & 127) + 1,
                static_cast<int>(big16(stored, at + 38)), (depth & 128) != 0};
      if (stored[at + 41] != 1 || stored[at + 42] != 1)
        refuse_volume(place, "has a JPEG 2000 of fewer samples than pixels");
    }
    if (marker == 0x52 && size >= 12) {
      if (stored[at + 13] != 1)
        refuse_volume(place, "calls its pixels lossless, and the JPEG 2000 in it loses",
                      "get the series as it was reconstructed");
      if (stream.rows > 0) return stream;
    }
    at += 2 + size;
  }
  refuse_volume(place, "has no JPEG 2000 where its pixels belong");
}

}  // namespace

DicomStream dicom_stream(std::string_view stored, DicomPixels pixels, const std::string& place) {
  const bool jpeg = stored.starts_with("\xff\xd8"), jpeg_2000 = stored.starts_with("\xff\x4f");
  if (pixels == DicomPixels::jpeg_2000 ? !jpeg_2000 : !jpeg)
    refuse_volume(place, "has other pixels than its transfer syntax says");
  return jpeg_2000 ? jpeg_2000_stream(stored, place) : jpeg_stream(stored, pixels == DicomPixels::jpeg_ls, place);
}

std::vector<DicomPieces> dicom_frames(const DicomFile& file) {
  const std::string place = file.path.string();
  std::vector<DicomPieces> frames;
  if (file.pixels == DicomPixels::plain) {
    for (std::size_t f = 0; f < file.frames; ++f)
      frames.push_back({{file.pixels_at + std::uint64_t{f} * file.frame_bytes(), file.frame_bytes()}});
    return frames;
  }
  DicomPieces fragments = fragments_of(file);
  if (!fragments.empty()) fragments.erase(fragments.begin());
  if (file.frames == 1 && !fragments.empty()) return {fragments};  // a frame may come in pieces
  if (fragments.size() != file.frames)
    refuse_volume(place, "has " + std::to_string(fragments.size()) + " fragments of pixels for " +
                             std::to_string(file.frames) + " frames");
  for (const auto& fragment : fragments) frames.push_back({fragment});
  return frames;
}

std::string decode_run_lengths(std::string_view stored, std::size_t pixels, std::size_t bytes_of_pixel,
                               const std::string& place) {
  if (stored.size() < 64 || stored_at<std::uint32_t>(stored, 0) != bytes_of_pixel)
    refuse_volume(place, "has pixels in runs whose head does not fit the pixels");
  std::string out(pixels * bytes_of_pixel, '\0');
  for (std::size_t s = 0; s < bytes_of_pixel; ++s) {
    std::size_t at = stored_at<std::uint32_t>(stored, 4 + 4 * s), made = 0;
    const auto put = [&](char c) {
      if (made < pixels) out[made * bytes_of_pixel + (bytes_of_pixel - 1 - s)] = c;
      ++made;
    };
    while (made < pixels) {
      if (at >= stored.size()) refuse_volume(place, "has runs that end after " + std::to_string(made) + " pixels");
      const int n = static_cast<signed char>(stored[at++]);
      if (n == -128) continue;
      const std::size_t needed = n >= 0 ? static_cast<std::size_t>(n) + 1 : 1;
      if (stored.size() - at < needed) refuse_volume(place, "has runs that end within one");
      for (std::size_t c = 0; n >= 0 && c < needed; ++c) put(stored[at + c]);
      for (int c = 0; n < 0 && c < 1 - n; ++c) put(stored[at]);
      at += needed;
    }
  }
  return out;
}

std::string dicom_frame(const DicomFile& file, const DicomPieces& pieces) {
  const std::string place = file.path.string();
  std::string stored;
  for (const auto& [at, length] : pieces) {
    if (length > longest_frame - stored.size()) refuse_volume(place, "has a frame of more than 4 GiB");
    const std::size_t before = stored.size();
    stored.resize(before + static_cast<std::size_t>(length));
    bytes_of_files({{.path = file.path, .first = at}}, length)->read(0, std::span(stored).subspan(before));
  }
  const std::size_t sample = static_cast<std::size_t>(file.bits_allocated / 8);
  int bits = file.bits_stored;
  if (file.pixels == DicomPixels::run_lengths) {
    stored = decode_run_lengths(stored, file.rows * file.columns, sample, place);
  } else if (file.pixels != DicomPixels::plain) {
    const DicomStream stream = dicom_stream(stored, file.pixels, place);
    if (stream.rows != file.rows || stream.columns != file.columns || stream.components != 1 ||
        stream.bits > file.bits_allocated || stream.bits < 2)
      refuse_volume(place, "has a head for " + std::to_string(file.columns) + " x " + std::to_string(file.rows) +
                               " pixels of " + std::to_string(file.bits_allocated) + " bits, and in it " +
                               std::to_string(stream.columns) + " x " + std::to_string(stream.rows) + " of " +
                               std::to_string(stream.bits));
    if (stream.is_signed && !file.is_signed)
      refuse_volume(place, "states samples without a sign, and the stream in it has them with one",
                    "export the series without compression");
    bits = stream.bits;
    if (file.pixels == DicomPixels::jpeg_lossless) stored = bare_jpeg(stored);
    stored = decode_by_gdcm(file, stored, stream.bits, stream.is_signed);
  }
  to_this_machine(stored, sample, file.big_endian);
  if (sample == 1) extend<std::int8_t>(stored, bits, file.is_signed);
  if (sample == 2) extend<std::int16_t>(stored, bits, file.is_signed);
  if (sample == 4) extend<std::int32_t>(stored, bits, file.is_signed);
  return stored;
}

}  // namespace gonio::io
