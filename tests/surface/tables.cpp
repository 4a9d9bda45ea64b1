// Files that tests hand to models which read one. A model that does is added here with a function that writes a tiny
// but complete file of its format.
#include <map>
#include <stdexcept>

#include "cases.h"

namespace gonio::tests {
namespace {

using Writer = void (*)(const std::filesystem::path&);

const std::map<std::string, Writer>& writers() {  // model id -> writer
  static const std::map<std::string, Writer> all = {};
  return all;
}

}  // namespace

std::filesystem::path file_for(const manifest::ModelInfo& info) {
  const auto found = writers().find(info.id);
  if (found == writers().end()) throw std::runtime_error("tests/surface/tables.cpp has no file for " + info.id);
  const auto path = std::filesystem::temp_directory_path() / ("gonio-surface-" + info.id);
  found->second(path);
  return path;
}

}  // namespace gonio::tests
