// Any bytes as a chart's file: six patches or more with finite colours, or Error(data).
#include <cstddef>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "colour/chart.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto light = gonio::optics::illuminant("D50", "fuzz");
  try {
    const auto chart =
        gonio::colour::parse_chart(std::string(reinterpret_cast<const char*>(data), size), "fuzz", light, "D50");
    if (chart.patches.size() < 6) __builtin_trap();
    for (const auto& patch : chart.patches)
      if (!gonio::is_finite(patch.lab)) __builtin_trap();
  } catch (const gonio::Error& error) {
    if (error.code() != gonio::Exit::data) __builtin_trap();
  }
  return 0;
}
