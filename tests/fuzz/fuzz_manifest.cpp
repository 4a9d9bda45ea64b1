// Any bytes as a manifest: a document that prints and reads back to the same content id, or Error(data).
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "manifest/document.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace gonio::manifest;
  try {
    const std::string_view text(reinterpret_cast<const char*>(bytes), size);
    const Document document = parse_document(text, "fuzz.json", ".");
    const Document again = parse_document(print_document(document, "."), "again.json", ".");
    if (content_id(document) != content_id(again)) __builtin_trap();
  } catch (const gonio::Error& error) {
    if (error.code() != gonio::Exit::data) __builtin_trap();
  }
  return 0;
}
