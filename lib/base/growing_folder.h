// A folder of files that appears whole or not at all. It is filled under another name beside the target, whose place it
// takes with commit(); without that it goes, and killed midway it stays hidden there under that other name.
#pragma once
#include <filesystem>
#include <functional>
#include <string>

namespace gonio {

class GrowingFolder {
 public:
  // What is there already is replaced where `replaceable` says so of the name of everything in it: Error(cannot_create)
  // otherwise.
  GrowingFolder(const std::filesystem::path& path, std::function<bool(const std::string& name)> replaceable);
  ~GrowingFolder();
  GrowingFolder(const GrowingFolder&) = delete;
  GrowingFolder& operator=(const GrowingFolder&) = delete;
  const std::filesystem::path& filling() const { return filling_; }  // where files are written, by write_file()
  void commit();

 private:
  void check_replaceable() const;
  std::filesystem::path path_, filling_;
  std::function<bool(const std::string&)> replaceable_;
};

}  // namespace gonio
