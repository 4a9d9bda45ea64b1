// Two folders change names in one step (renameat2), where the file system can; then the old one goes.
#include "base/growing_folder.h"

#include <fcntl.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/temporaries.h"

namespace gonio {
namespace {

std::filesystem::path without_slash(const std::filesystem::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

}  // namespace

GrowingFolder::GrowingFolder(const std::filesystem::path& path, std::function<bool(const std::string&)> replaceable)
    : path_(without_slash(path)), replaceable_(std::move(replaceable)) {
  throw_if_interrupted();
  check_replaceable();
  const std::filesystem::path filling = temporary_for(path_);
  make_folder(filling);
  filling_ = filling;
}

GrowingFolder::~GrowingFolder() {
  std::error_code ignored;
  if (!filling_.empty()) std::filesystem::remove_all(filling_, ignored);
}

void GrowingFolder::check_replaceable() const {
  std::error_code failure;
  if (!std::filesystem::exists(path_, failure)) return;
  if (!std::filesystem::is_directory(path_, failure))
    throw Error(Exit::cannot_create, path_.string(), "is not a folder", "choose another name");
  for (const auto& entry : std::filesystem::directory_iterator(path_, failure))
    if (const std::string name = entry.path().filename().string(); entry.is_directory() || !replaceable_(name))
      throw Error(Exit::cannot_create, path_.string(), "holds \"" + name + "\", which would be lost",
                  "name a new folder");
}

void GrowingFolder::commit() {
  throw_if_interrupted();
  check_replaceable();
  const bool exchanged = ::renameat2(AT_FDCWD, filling_.c_str(), AT_FDCWD, path_.c_str(), RENAME_EXCHANGE) == 0;
  if (!exchanged) {
    std::error_code ignored;
    if (errno != ENOENT) std::filesystem::remove_all(path_, ignored);  // a file system that cannot exchange
    if (::rename(filling_.c_str(), path_.c_str()) != 0)
      throw Error(Exit::cannot_create, path_.string(), "cannot be created: " + std::string(std::strerror(errno)),
                  "choose a folder that you may write to");
    filling_.clear();
  }
}

}  // namespace gonio
