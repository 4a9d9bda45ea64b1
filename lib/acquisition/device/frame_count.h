// A camera's count of frames as one that never begins again. GigE Vision's has 16 bits without 0: 65535 is followed by
// 1; some cameras begin again whenever acquisition does.
#pragma once
#include <algorithm>
#include <cstdint>

namespace gonio::acquisition {

class FrameCount {
 public:
  void restarted() { restarted_ = true; }

  // `counted`: what the camera says of the frame that came. A frame that is older than the last one gets the number
  // that it had then, and the last one stays the last.
  std::uint64_t number_of(std::uint64_t counted) {
    if (!begun_ || (restarted_ && counted <= last_)) {
      number_ = begun_ ? number_ + 1 : counted;
    } else if (counted > last_) {
      number_ += counted - last_;
    } else if (last_ <= 65535 && last_ - counted > 32767) {
      number_ += std::max<std::uint64_t>(1, 65535 - last_ + counted);
    } else {
      return number_ - std::min(number_, last_ - counted);
    }
    begun_ = true;
    restarted_ = false;
    last_ = counted;
    return number_;
  }

  // What a chunk says, `counted`, in the numbers of the frame that carries it. Chunks may have more bits, and the frame
  // before 1 is 65535.
  static std::uint64_t number_of_chunk(std::uint64_t counted, std::uint64_t frame_counted, std::uint64_t frame_number) {
    auto ahead = static_cast<std::int64_t>(counted - frame_counted);
    if (frame_counted <= 65535) {
      ahead %= 65535;
      if (ahead > 32767) ahead -= 65535;
      if (ahead < -32767) ahead += 65535;
    }
    return frame_number + static_cast<std::uint64_t>(ahead);
  }

 private:
  bool begun_ = false, restarted_ = false;
  std::uint64_t last_ = 0, number_ = 0;
};

}  // namespace gonio::acquisition
