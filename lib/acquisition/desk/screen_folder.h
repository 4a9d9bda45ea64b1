// The simulated screens behind folders, as folder:// works them: a picture that lies in FOLDER/show is shown, and
// FOLDER/shown says which one it is by its SHA-256, or why it is none. An empty file is black.
#pragma once
#include <atomic>
#include <filesystem>
#include <map>
#include <string>
#include <thread>

#include "acquisition/desk/true_state.h"

namespace gonio::acquisition::desk {

class ScreenFolders {
 public:
  // One folder a screen of the laboratory below `folder`, which is made, and removed at the end.
  ScreenFolders(TrueState& state, std::filesystem::path folder);
  ~ScreenFolders();
  ScreenFolders(const ScreenFolders&) = delete;
  ScreenFolders& operator=(const ScreenFolders&) = delete;
  std::filesystem::path folder_of(const std::string& screen) const { return folder_ / screen; }

 private:
  void serve();
  void look_at(const std::string& screen);
  TrueState& state_;
  std::filesystem::path folder_;
  std::map<std::string, std::string> answered_;                  // what `shown` says, by screen
  std::map<std::string, std::filesystem::file_time_type> read_;  // when `show` was last read
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace gonio::acquisition::desk
