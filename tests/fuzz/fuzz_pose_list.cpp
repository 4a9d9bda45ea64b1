// Any bytes as a list of poses, lines or blocks: unit quaternions within reach of the base, or Error(data).
#include <cmath>
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "robot/pose_list.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace gonio::robot;
  static const PoseListFormat formats[] = {pose_list_format("matrix", "", "", "base_from_tool", "f"),
                                           pose_list_format("kuka", "", "", "tool_from_base", "f")};
  for (const PoseListFormat& format : formats) {
    try {
      const std::string_view text(reinterpret_cast<const char*>(bytes), size);
      const PoseList list = parse_pose_list(text, "fuzz.txt", format);
      if (list.poses.empty()) __builtin_trap();
      for (const ListedPose& pose : list.poses) {
        const auto& q = pose.base_from_tool.rotation;
        if (!(std::abs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1) < 1e-9)) __builtin_trap();
      }
    } catch (const gonio::Error& error) {
      if (error.code() != gonio::Exit::data) __builtin_trap();
    }
  }
  return 0;
}
