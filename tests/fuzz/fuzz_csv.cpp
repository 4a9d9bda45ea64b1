// Any bytes as a CSV table: rows as long as the heading, or Error(data).
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "io/csv.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  try {
    const gonio::io::Csv csv = gonio::io::parse_csv({reinterpret_cast<const char*>(bytes), size}, "fuzz.csv");
    if (csv.header.empty() || csv.rows.empty() || csv.rows.size() != csv.line.size()) __builtin_trap();
    for (const auto& row : csv.rows)
      if (row.size() != csv.header.size()) __builtin_trap();
  } catch (const gonio::Error& error) {
    if (error.code() != gonio::Exit::data) __builtin_trap();
  }
  return 0;
}
