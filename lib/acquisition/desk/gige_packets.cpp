// See gige_packets.h.
#include "acquisition/desk/gige_packets.h"

#include <algorithm>

#include "acquisition/desk/network_bytes.h"

namespace gonio::acquisition::desk {

std::vector<std::string> packets_of(GigePicture picture, const std::optional<GigeFigures>& chunks, std::size_t most) {
  if (chunks) {
    NetworkBytes more;
    more.u32(1).u32(static_cast<std::uint32_t>(picture.pixels.size()));  // the picture is the first chunk
    more.real(chunks->exposure_us).u32(0x1001).u32(8).real(chunks->gain_db).u32(0x1002).u32(8);
    more.u64(chunks->frame_id).u32(0x1003).u32(8);
    picture.pixels += more.all();
  }
  const std::uint32_t kind = chunks ? 0x4001 : 0x0001;
  const auto width = static_cast<std::uint32_t>(picture.width_px),
             height = static_cast<std::uint32_t>(picture.height_px);
  const auto head = [&](std::uint32_t format, std::size_t number) {
    NetworkBytes packet;
    packet.u16(0).u16(static_cast<std::uint32_t>(picture.frame_id));
    return packet.u32(format << 24U | static_cast<std::uint32_t>(number));
  };
  std::vector<std::string> packets;
  NetworkBytes leader = head(1, 0);
  leader.u16(0).u16(kind).u64(picture.timestamp_ns).u32(picture.format_number);
  packets.push_back(leader.u32(width).u32(height).u64(0).u32(0).all());
  for (std::size_t at = 0; at < picture.pixels.size(); at += most)
    packets.push_back(head(3, packets.size()).text(std::string_view(picture.pixels).substr(at, most)).all());
  packets.push_back(head(2, packets.size()).u16(0).u16(kind).u32(height).all());
  return packets;
}

}  // namespace gonio::acquisition::desk
