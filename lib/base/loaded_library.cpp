#include "base/loaded_library.h"

#include <dlfcn.h>

#include <filesystem>

#include "base/error.h"

namespace gonio {
namespace {

// Programs lie in bin/ of a build or of an installation, tests beside bin/, proofs one folder deeper.
std::string path_of_module(const std::string& file) {
  std::error_code none;
  std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", none).parent_path();
  for (int up = 0; up < 4 && folder.has_relative_path(); ++up, folder = folder.parent_path()) {
    const std::filesystem::path there = folder / "lib" / "gonio" / file;
    if (std::filesystem::exists(there, none)) return there.string();
  }
  return file;
}

}  // namespace

void* function_in(const char* library, const char* name, const std::string& remedy) {
  void* const loaded = ::dlopen(library, RTLD_LAZY | RTLD_LOCAL);  // counts; what is loaded stays loaded
  void* const function = loaded != nullptr ? ::dlsym(loaded, name) : nullptr;
  if (function == nullptr) {
    const char* const why = ::dlerror();
    throw Error(Exit::internal, library, why != nullptr ? why : name, remedy);
  }
  return function;
}

void* function_in_module(const char* module, const char* name) {
  const std::string path = path_of_module("gonio_" + std::string(module) + ".so");
  return function_in(path.c_str(), name, "install gonio anew: lib/gonio belongs beside its bin");
}

}  // namespace gonio
