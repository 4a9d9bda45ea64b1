// A picture as the packets of a GigE Vision stream. Private to desk/.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gonio::acquisition::desk {

struct GigeFigures {  // what the chunks say a frame was taken with
  double exposure_us = 0, gain_db = 0;
  std::uint64_t frame_id = 0;
};
struct GigePicture {
  std::uint64_t frame_id = 0, timestamp_ns = 0;
  std::uint32_t format_number = 0;
  int width_px = 0, height_px = 0;
  std::string pixels;  // as the format lays them out
};

inline constexpr std::uint32_t gige_chunk_bytes = 4 * 8 + 3 * 8;  // that chunks add to the pixels

// `most`: bytes a packet carries. Leader, payload, trailer: GigE Vision 1.2, sections 24 and 26; chunks behind the
// pixels, each followed by its number and length.
std::vector<std::string> packets_of(GigePicture picture, const std::optional<GigeFigures>& chunks, std::size_t most);

}  // namespace gonio::acquisition::desk
