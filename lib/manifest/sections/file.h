// "files": what the manifest names on disk.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

namespace gonio::manifest {

struct File {        // "files"
  std::string path;  // relative to the manifest's folder
  std::optional<std::uint64_t> bytes;
  std::string sha256;
};

}  // namespace gonio::manifest
