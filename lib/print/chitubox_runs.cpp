// See chitubox_runs.h.
#include "print/chitubox_runs.h"

#include <algorithm>

#include "io/little_endian.h"
#include "print/archive_checks.h"
#include "print/chitubox.h"

namespace gonio::print {
namespace {

constexpr std::size_t longest_grey_run = 0xfffffff, longest_bit_run = 0x7d, longest_colour_run = 0xfff;
constexpr std::uint32_t run_of_colour = 0x20;

[[noreturn]] void refuse_runs(const std::string& place, const std::string& problem) {
  refuse_archive(place, problem, "copy or slice it again");
}

void append_grey_run(std::string& out, std::uint8_t grey, std::size_t length) {
  if (length == 0) return;
  out += static_cast<char>(grey | (length > 1 ? 0x80 : 0));
  if (length == 1) return;
  const int further = length < 0x80 ? 0 : length < 0x4000 ? 1 : length < 0x200000 ? 2 : 3;
  constexpr std::uint32_t marks[] = {0, 0x80, 0xc0, 0xe0};
  for (int byte = further; byte >= 0; --byte)
    out += static_cast<char>((length >> (8 * byte) & 0xff) | (byte == further ? marks[further] : 0));
}

// The length behind a grey with its highest bit set; `at` moves behind it.
std::size_t length_of_run(std::string_view runs, std::size_t& at, const std::string& place) {
  if (at >= runs.size()) refuse_runs(place, "ends within a run");
  const auto head = static_cast<std::uint8_t>(runs[at++]);
  const int further = head < 0x80 ? 0 : head < 0xc0 ? 1 : head < 0xe0 ? 2 : head < 0xf0 ? 3 : 4;
  if (further == 4) refuse_runs(place, "has a run of no known length");
  if (runs.size() - at < static_cast<std::size_t>(further)) refuse_runs(place, "ends within a run");
  std::size_t length = static_cast<std::size_t>(head & 0x7f >> further);
  for (int i = 0; i < further; ++i) length = length << 8 | static_cast<std::uint8_t>(runs[at++]);
  return length;
}

void refuse_beyond(const std::string& place, std::size_t pixels) {
  refuse_runs(place, "goes on behind its last pixel, number " + std::to_string(pixels));
}

}  // namespace

std::string encode_grey_runs(std::span<const std::uint8_t> picture) {
  std::string out;
  for (std::size_t i = 0, end = 0; i < picture.size(); i = end) {
    const auto grey = static_cast<std::uint8_t>(picture[i] >> 1);
    for (end = i; end < picture.size() && end - i < longest_grey_run && picture[end] >> 1 == grey;) ++end;
    append_grey_run(out, grey, end - i);
  }
  return out;
}

void decode_grey_runs(std::string_view runs, std::span<std::uint8_t> picture, const std::string& place) {
  std::size_t pixel = 0;
  for (std::size_t at = 0; at < runs.size();) {
    const auto code = static_cast<std::uint8_t>(runs[at++]);
    const std::size_t length = code < 0x80 ? 1 : length_of_run(runs, at, place);
    const auto grey7 = static_cast<std::uint8_t>(code & 0x7f);
    if (length > picture.size() - pixel) refuse_beyond(place, picture.size());
    std::fill_n(picture.begin() + static_cast<std::ptrdiff_t>(pixel), length,
                static_cast<std::uint8_t>(grey7 == 0 ? 0 : grey7 << 1 | 1));
    pixel += length;
  }
  if (pixel != picture.size())
    refuse_runs(place, "ends after " + std::to_string(pixel) + " of " + std::to_string(picture.size()) + " pixels");
}

std::string encode_level_sets(std::span<const std::uint8_t> picture) {
  std::string all;
  for (std::size_t set = 0; set < written_level_sets; ++set) {
    // Greys are rounded to 0 to 8 lit sets; the first is lit where all are.
    const auto lit = [&](std::uint8_t grey) { return (grey + 17) / 32 >= static_cast<int>(written_level_sets - set); };
    std::string runs;
    for (std::size_t i = 0, end = 0; i < picture.size(); i = end) {
      const bool here = lit(picture[i]);
      for (end = i; end < picture.size() && end - i < longest_bit_run && lit(picture[end]) == here;) ++end;
      runs += static_cast<char>((end - i) | (here ? 0x80 : 0));
    }
    std::string length(4, '\0');
    io::store_at(length, 0, static_cast<std::uint32_t>(runs.size()));
    all += length + runs;
  }
  return all;
}

void count_level_set(std::string_view runs, std::span<std::uint8_t> counts, const std::string& place) {
  std::size_t pixel = 0;
  for (const char run : runs) {
    const auto code = static_cast<std::uint8_t>(run);
    const std::size_t length = code & 0x7f;
    if (length > counts.size() - pixel) refuse_beyond(place, counts.size());
    for (std::size_t i = 0; code >= 0x80 && i < length; ++i) ++counts[pixel + i];
    pixel += length;
  }
  if (pixel != counts.size())
    refuse_runs(place, "ends after " + std::to_string(pixel) + " of " + std::to_string(counts.size()) + " pixels");
}

std::uint8_t grey_of_levels(std::size_t lit, std::size_t sets) {
  return static_cast<std::uint8_t>(lit == 0 ? 0 : 256 * lit / sets - 1);
}

std::string encode_preview(const JobPreview& preview) {
  const auto colour = [&](std::size_t i) {
    const std::uint8_t* p = preview.rgb.data() + 3 * i;
    return static_cast<std::uint32_t>(p[0] >> 3 << 11 | p[1] >> 3 << 6 | p[2] >> 3);
  };
  std::string out;
  const auto append = [&](std::uint32_t word) {
    out += static_cast<char>(word & 0xff);
    out += static_cast<char>(word >> 8);
  };
  const std::size_t pixels = preview.rgb.size() / 3;
  for (std::size_t i = 0, end = 0; i < pixels; i = end) {
    for (end = i; end < pixels && end - i < longest_colour_run && colour(end) == colour(i);) ++end;
    append(colour(i) | (end - i > 1 ? run_of_colour : 0));
    if (end - i > 1) append(0x3000 | static_cast<std::uint32_t>(end - i - 1));
  }
  return out;
}

void decode_preview(std::string_view runs, JobPreview& preview, const std::string& place) {
  const std::size_t pixels = static_cast<std::size_t>(preview.width_px) * static_cast<std::size_t>(preview.height_px);
  const auto word = [&](std::size_t at) { return std::uint32_t{io::stored_at<std::uint16_t>(runs, at)}; };
  for (std::size_t at = 0; at + 2 <= runs.size();) {
    const std::uint32_t colour = word(at);
    at += 2;
    std::size_t length = 1;
    if ((colour & run_of_colour) != 0) {
      if (at + 2 > runs.size()) refuse_runs(place, "ends within a run");
      length += word(at) & 0xfff;
      at += 2;
    }
    if (length > pixels - preview.rgb.size() / 3) refuse_beyond(place, pixels);
    for (std::size_t i = 0; i < length; ++i)
      for (const int shift : {11, 6, 0}) preview.rgb.push_back(static_cast<std::uint8_t>((colour >> shift & 31) << 3));
  }
  if (preview.rgb.size() != 3 * pixels)
    refuse_runs(place,
                "ends after " + std::to_string(preview.rgb.size() / 3) + " of " + std::to_string(pixels) + " pixels");
}

void turn_with_key(std::string& bytes, std::uint32_t key, std::uint32_t layer) {
  if (key == 0) return;
  const std::uint32_t step = key * 0x2d83cdacu + 0xd8a83423u;
  std::uint32_t word = (layer * 0x1e1530cdu + 0xec3d47cdu) * step;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<char>(static_cast<std::uint8_t>(bytes[i]) ^ (word >> (8 * (i % 4)) & 0xff));
    if (i % 4 == 3) word += step;
  }
}

}  // namespace gonio::print
