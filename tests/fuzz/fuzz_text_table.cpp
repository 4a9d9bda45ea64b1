// Any bytes as columns of text: rows as long as the heading, or Error(data).
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "goniometry/tables/tables_text.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  try {
    const std::string_view text(reinterpret_cast<const char*>(bytes), size);
    const auto table = gonio::goniometry::parse_text_table(text, "fuzz.txt");
    if (table.heading.empty() || table.rows.size() != table.line.size()) __builtin_trap();
    for (const auto& row : table.rows)
      if (row.size() != table.heading.size()) __builtin_trap();
  } catch (const gonio::Error& error) {
    if (error.code() != gonio::Exit::data) __builtin_trap();
  }
  return 0;
}
