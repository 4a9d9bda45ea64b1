// Files that tests hand to models which read one. A model that does is added here with a function that writes a tiny
// but complete file of its format.
#include <map>
#include <stdexcept>

#include "cases.h"
#include "data.h"
#include "merl_tables.h"

namespace gonio::tests {
namespace {

using Writer = void (*)(const std::filesystem::path&);

const std::map<std::string, Writer>& writers() {  // model id -> writer
  static const std::map<std::string, Writer> all = {
      {"merl",
       [](const std::filesystem::path& path) {
         io::write_merl(path, varnish_table({16, 12, 16}, 0.3));
       }},
  };
  return all;
}

}  // namespace

std::filesystem::path file_for(const manifest::ModelInfo& info) {
  const auto found = writers().find(info.id);
  if (found == writers().end()) throw std::runtime_error("tests/surface/tables.cpp has no file for " + info.id);
  static const ScratchFolder folder;
  const auto path = folder / info.id;
  if (!std::filesystem::exists(path)) found->second(path);
  return path;
}

}  // namespace gonio::tests
